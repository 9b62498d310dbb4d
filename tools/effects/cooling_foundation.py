"""Feet and shafts that conduct more or less than assumed."""

from .cause import Cause, Size

CAUSE = Cause(
    id="cooling.foundation",
    doc="Another conductance of feet and shafts to the foundation.",
    size=Size("G", "W/K", "conductance more than assumed", 2.5, -12.0, 20.0),
    exposes="transients in a cold room; the temperature of the foundation",
    values=lambda base, theta, rows: {"foot.G": base["foot.G"] + theta["G"]},
)
