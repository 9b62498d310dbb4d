"""What can be missing in a model or wrong with an instrument: one file a cause, all of them in `CAUSES`."""
