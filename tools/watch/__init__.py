"""The diagnosis of logs while they grow: sources, what has come so far, and an answer a window."""
