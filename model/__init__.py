"""Physics of gearboxes: laws, acausal core, parts, machines and runs. Knows no file format, no FMU, no measured data."""
