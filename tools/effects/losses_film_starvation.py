"""Teeth whose film breaks down where it is hot or fast."""

from __future__ import annotations

from collections.abc import Mapping

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import OIL_SHARE_TEETH, THRESHOLDS, extra_part, extra_values

PARTS, NETS = extra_part("extra_starvation", "gears")
#: Ways in which it sets in, and upper ends of their shares of the prior.
KINDS, ENDS = ("", "film-", "w+"), (0.48, 0.96, 1.0)


def onset(theta: Theta) -> tuple[str, float] | None:
    """Where it sets in: nowhere but by its exponents, below a speed times viscosity, or above a speed."""
    kind = KINDS[sum(theta["onset"] > end for end in ENDS)]
    if not kind:
        return None
    low, high = THRESHOLDS[kind[:-1]]
    return kind, low + theta["threshold"] * (high - low)


def values(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, float]:
    """Friction of teeth, the more the thinner the film; where it sets in at a threshold it does so at once."""
    where = onset(theta)
    p = 0.0 if where else theta["p"]
    return extra_values("extra_starvation", {**theta, "a": theta["a"] - p, "b": -p}, where)


CAUSE = Cause(
    id="losses.film_starvation",
    doc="A loss under load that grows where films are thin: slow and hot, or so fast that they are starved.",
    size=Size("P_ref", "W", "loss at 200 rpm, 75 cSt and 2000 N.m, where it acts", 60.0, 0.0, 600.0),
    shapes=(
        Shape("p", "1", "exponent of the film (speed times viscosity) by which it falls", 0.3, 2.3, 1.2, 0.6),
        Shape("a", "1", "exponent of the speed at the same film", 0.5, 1.2, 0.85, 0.12),
        Shape("c", "1", "exponent of the torque", 0.7, 2.1, 1.2, 0.25),
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
    values=values,
)
