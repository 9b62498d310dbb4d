"""A speed reading that is off by a factor."""

from .cause import Cause, Size

CAUSE = Cause(
    id="sensor.speed.gain",
    doc="The gearbox turns faster or slower than read.",
    size=Size("gain", "1", "relative error of the reading", 0.04, -0.15, 0.15),
    exposes="a stroboscope",
    values=lambda base, theta, rows: {"read.speed_gain": theta["gain"]},
)
