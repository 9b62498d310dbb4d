"""Teeth whose film breaks down where it is hot or fast."""

from .cause import Cause, Shape, Size, Theta
from .forms import OIL_SHARE_TEETH, THRESHOLDS, extra_part, extra_values

PARTS, NETS = extra_part("extra_starvation", "gears")
#: Ways in which it sets in, and upper ends of their shares of the prior.
KINDS, ENDS = ("", "film-", "w+"), (0.45, 0.9, 1.0)


def onset(theta: Theta) -> tuple[str, float] | None:
    """Where it sets in: nowhere but by its exponents, below a speed times viscosity, or above a speed."""
    kind = KINDS[sum(theta["onset"] > end for end in ENDS)]
    if not kind:
        return None
    low, high = THRESHOLDS[kind[:-1]]
    return kind, low + theta["threshold"] * (high - low)


CAUSE = Cause(
    id="losses.film_starvation",
    doc="A loss under load that grows where films are thin: slow and hot, or so fast that they are starved.",
    size=Size("P_ref", "W", "loss at 200 rpm, 75 cSt and 2000 N.m, where it acts", 60.0, 0.0, 600.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.0, 1.6, 0.5, 0.4),
        Shape("b", "1", "exponent of the viscosity", -2.2, -0.2, -0.9, 0.45),
        Shape("c", "1", "exponent of the torque", 0.7, 1.5, 1.1, 0.2),
        OIL_SHARE_TEETH,
        Shape(
            "onset",
            "1",
            "how it sets in: by its exponents, below a speed times viscosity, above a speed",
            0.0,
            1.0,
            ends=ENDS,
        ),
        Shape("threshold", "1", "place of the threshold in its range", 0.0, 1.0),
    ),
    exposes="points at high load and low viscosity, with and without fresh oil",
    parts=PARTS,
    connections=NETS,
    acts=onset,
    values=lambda base, theta, rows: extra_values("extra_starvation", theta, onset(theta)),
)
