"""Bodies that store more or less heat than assumed."""

from __future__ import annotations

import math
from collections.abc import Mapping

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import INSIDE, OUTSIDE, scaled

#: Bodies by the shape "bodies", and upper ends of their shares of the prior.
BODIES, ENDS = (INSIDE + OUTSIDE, OUTSIDE, INSIDE), (0.6, 0.85, 1.0)


def values(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, float]:
    """Capacities times the factor."""
    bodies = BODIES[sum(theta["bodies"] > end for end in ENDS)]
    return scaled(base, math.exp(theta["ln_factor"]), *bodies)


CAUSE = Cause(
    id="thermal.mass",
    doc="Other heat capacities: warm-ups last longer or shorter.",
    size=Size("ln_factor", "1", "logarithm of the factor on the heat capacities", 0.35, -1.5, 1.5, 1.2),
    shapes=(Shape("bodies", "1", "which: all, the housing, or what turns", 0.0, 1.0, ends=ENDS),),
    exposes="a logged warm-up",
    values=values,
)
