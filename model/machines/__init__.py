"""One file a machine: its spec and its assembly."""
