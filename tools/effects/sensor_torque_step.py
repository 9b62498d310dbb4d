"""A torque transducer whose zero jumps once."""

from .cause import Cause, Shape, Size
from .instruments import after, changed

CAUSE = Cause(
    id="sensor.torque.step",
    doc="Zero of a torque transducer that jumps at one moment of the campaign.",
    size=Size("step", "N.m", "zero after the jump less zero before", 8.0, -80, 80),
    shapes=(
        Shape("place", "1", "where in the running order", 0.0, 1.0, ends=tuple(k / 20 for k in range(1, 21))),
        Shape("zero", "1", "whether the zero is right before (0), behind (1) or in between", 0.0, 1.0),
    ),
    exposes="the first point repeated; a tare before each test",
    readings=lambda theta, rows, r: changed(
        r, loss=r["loss"] + theta["step"] * (after(rows, theta["place"]) - theta["zero"]) * rows.direction
    ),
)
