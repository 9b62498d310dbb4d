"""Bearings that carry more than assumed."""

from .cause import Cause, Shape, Size
from .forms import OIL_SHARE_BEARING, REGIME, STRATA, extra_part, extra_values, regime_of

PARTS, NETS = extra_part("extra_preload", "wall")
CAUSE = Cause(
    id="losses.bearing_preload",
    doc="A friction torque that hardly follows load: bearings preloaded more or less than assumed.",
    size=Size("P_ref", "W", "loss at 200 rpm and 75 cSt", 50.0, -150.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.9, 1.4, 1.05, 0.12),
        Shape("b", "1", "exponent of the viscosity, as warmth loosens or tightens", -0.5, 0.5, 0.0, 0.2),
        OIL_SHARE_BEARING,
        *REGIME,
    ),
    exposes="drag torque measured by hand, temperature at the bearings",
    like="friction of shafts: preload and seal drag are the same torque to every steady instrument",
    parts=PARTS,
    connections=NETS,
    acts=regime_of,
    strata=STRATA,
    values=lambda base, theta, rows: extra_values("extra_preload", theta),
)
