"""Seals that brake more than assumed."""

from .cause import Cause, Shape, Size
from .forms import DIRECTION, OIL_SHARE_BEARING, SPEED, WARMTH, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_seal", "wall")
REGIMES = Regimes(
    (
        *SPEED,
        *WARMTH,
        *DIRECTION,
    )
)
CAUSE = Cause(
    id="losses.seal_drag",
    doc="A friction torque without load dependence: lips that press more, or run dry.",
    size=Size("P_ref", "W", "loss at 200 rpm and 75 cSt", 40.0, -80.0, 300.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.6, 1.5, 1.0, 0.18),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.4),
        OIL_SHARE_BEARING,
        *REGIMES.shapes,
    ),
    exposes="drag torque measured by hand, temperature at the lips",
    like="friction of shafts: preload and seal drag are the same torque to every steady instrument",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_seal", theta, REGIMES.of(theta)),
)
