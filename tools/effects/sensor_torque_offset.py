"""A torque transducer whose zero is off."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.torque.offset",
    doc="Zero of the torque transducers: the loss torque is off by the same amount with opposite sign in each direction.",
    size=Size(
        "offset", "N.m", "zero of the carrier's transducer, or four times that of the sun's, reversed", 6.0, -60, 60
    ),
    exposes="a tare with the shafts uncoupled; points at small load",
    readings=lambda theta, rows, r: changed(r, loss=r["loss"] + theta["offset"] * rows.direction),
)
