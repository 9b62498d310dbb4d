"""A torque transducer whose zero is off."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.torque.offset",
    doc="Zero of a torque transducer: the loss torque is off by one amount, with opposite sign in each direction.",
    size=Size("offset", "N.m", "zero of the carrier's transducer, or four times the sun's", 6.0, -60, 60),
    exposes="a tare with the shafts uncoupled; points at small load",
    readings=lambda theta, rows, r: changed(r, loss=r["loss"] + theta["offset"] * rows.direction),
)
