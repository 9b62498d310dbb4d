"""A flat model as an FMI 2.0 FMU, and playing one."""
