"""More or less oil than assumed: the no-load loss changes with it."""

from .cause import Cause, Shape, Size
from .forms import OIL_SHARE_TEETH, extra_part, extra_values

PARTS, NETS = extra_part("extra_oil_level", "gears")
CAUSE = Cause(
    id="losses.oil_level",
    doc="Oil level off its mark: a no-load loss that follows viscosity and, less, speed.",
    size=Size("P_ref", "W", "loss at 200 rpm and 75 cSt", 50.0, -100.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 1.0, 2.5, 1.6, 0.4),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.6),
        OIL_SHARE_TEETH,
    ),
    exposes="the same point at two oil levels",
    like="no-load oil loss: churning, windage and oil level differ only in how the oil is reached",
    parts=PARTS,
    connections=NETS,
    values=lambda base, theta, rows: extra_values("extra_oil_level", theta),
)
