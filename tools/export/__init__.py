"""A rig as an FMU, or as a system of FMUs, and what goes beside it."""
