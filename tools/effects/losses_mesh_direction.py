"""Teeth that rub differently in the two directions of the power flow."""

from .cause import Cause, Shape, Size
from .forms import OIL_SHARE_TEETH, extra_part, extra_values

PARTS, NETS = extra_part("extra_direction", "gears")
CAUSE = Cause(
    id="losses.mesh_direction",
    doc="A loss under load in one direction of the power flow only.",
    size=Size("P_ref", "W", "loss as reducer less loss as multiplier, at 200 rpm and 2000 N.m", 50.0, -300.0, 300.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.6, 1.4, 1.0, 0.15),
        Shape("c", "1", "exponent of the torque", 0.5, 1.6, 1.1, 0.2),
        Shape("reducer", "1", "share of the difference that the reducer has", 0.0, 1.0),
        OIL_SHARE_TEETH,
    ),
    exposes="the halves of a test in reversed order",
    parts=PARTS,
    connections=NETS,
    values=lambda base, theta, rows: extra_values(
        "extra_direction", {**theta, "forward": theta["reducer"] - 1.0, "backward": theta["reducer"]}
    ),
)
