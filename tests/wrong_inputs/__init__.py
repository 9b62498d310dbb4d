"""Wrong inputs by kinds, a line each in a TOML file of its kind: what is given = part of the answer."""
