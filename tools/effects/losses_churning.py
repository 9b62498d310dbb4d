"""No-load loss of what turns in the oil."""

from .cause import Cause, Shape, Size
from .forms import OIL_SHARE_TEETH, SPEED, WARMTH, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_churning", "gears")
REGIMES = Regimes(
    (
        *SPEED,
        *WARMTH,
    )
)
CAUSE = Cause(
    id="losses.churning",
    doc="A loss without load that grows with speed: gears, planets and carrier move the oil.",
    size=Size("P_ref", "W", "loss at 200 rpm and 75 cSt", 60.0, 0.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 1.2, 2.8, 2.0, 0.45),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.35),
        OIL_SHARE_TEETH,
        *REGIMES.shapes,
    ),
    exposes="points at higher speed and little load; coast-down without load",
    like="no-load oil loss: churning, windage and oil level differ only in how the oil is reached",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_churning", theta, REGIMES.of(theta)),
)
