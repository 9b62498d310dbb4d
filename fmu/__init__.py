"""A flat model as an FMU of FMI 2.0 or 3.0, and playing one."""
