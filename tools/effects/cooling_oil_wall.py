"""Oil that gives its heat to the wall better or worse than assumed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import extra_conductor

PARTS, NETS = extra_conductor("extra_oil_wall", "oil.heat", "wall.heat")


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The extra conductance beside the nominal one."""
    extra = (math.exp(theta["ln_factor"]) - 1) * base["oil_wall.G"]
    return {"extra_oil_wall.G_ref": extra, "extra_oil_wall.c": theta["c"]}


CAUSE = Cause(
    id="cooling.oil_wall",
    doc="Another conductance between oil and wall: level, foam, deposits.",
    size=Size("ln_factor", "1", "logarithm of the factor on the conductance at 200 rpm", 0.5, -0.8, 2.2),
    shapes=(Shape("c", "1", "exponent of the speed", -0.8, 0.8, 0.0, 0.3),),
    exposes="transients; a second probe in the wall",
    parts=PARTS,
    connections=NETS,
    values=conductance,
)
