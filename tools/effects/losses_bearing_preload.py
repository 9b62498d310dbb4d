"""Bearings that carry more than assumed."""

from .cause import Cause, Shape, Size
from .forms import DIRECTION, LOAD, OIL_SHARE_BEARING, SPEED, WARMTH, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_preload", "wall")
REGIMES = Regimes(
    (
        *SPEED,
        *LOAD,
        *WARMTH,
        *DIRECTION,
    )
)
CAUSE = Cause(
    id="losses.bearing_preload",
    doc="A friction torque that hardly follows load: bearings preloaded more or less than assumed.",
    size=Size("P_ref", "W", "loss at 200 rpm and 75 cSt", 50.0, -150.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.9, 1.4, 1.05, 0.12),
        Shape("b", "1", "exponent of the viscosity, as warmth loosens or tightens", -0.5, 0.5, 0.0, 0.2),
        OIL_SHARE_BEARING,
        *REGIMES.shapes,
    ),
    exposes="drag torque measured by hand, temperature at the bearings",
    like="friction of shafts: preload and seal drag are the same torque to every steady instrument",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_preload", theta, REGIMES.of(theta)),
)
