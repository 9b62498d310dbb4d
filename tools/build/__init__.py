"""A rig from a name plate."""
