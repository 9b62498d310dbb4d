"""A torque transducer whose zero drifts over the campaign."""

from .cause import Cause, Shape, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.torque.drift",
    doc="Zero of a torque transducer that moves steadily from the first test to the last.",
    size=Size("drift", "N.m", "zero at the last test less zero at the first", 8.0, -80, 80),
    shapes=(
        Shape("power", "1", "exponent of the running order", 0.5, 2.0, 1.0, 0.3),
        Shape("zero", "1", "value of the order term at which the zero is right: 0 first test, 1 last", 0.0, 1.0),
    ),
    exposes="the first point repeated at the end; a tare before each test",
    readings=lambda theta, rows, r: changed(
        r, loss=r["loss"] + theta["drift"] * (rows.order ** theta["power"] - theta["zero"]) * rows.direction
    ),
)
