"""Losses and temperatures of gearboxes."""
