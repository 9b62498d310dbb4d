"""Physics of gearboxes: laws, acausal core, parts, machines, runs. Knows no file format, no FMU, no measured data."""
