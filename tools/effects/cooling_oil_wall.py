"""Oil that gives its heat to the wall better or worse than assumed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import W_REF


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The conductance times the factor, whose logarithm follows a power of the speed, per test."""
    speed = 1.0 if rows is None else (np.maximum(rows.per_test(rows.w), 1.0) / W_REF) ** theta["c"]
    return {"oil_wall.G": base["oil_wall.G"] * np.exp(np.clip(theta["ln_factor"] * speed, -4.0, 3.0))}


CAUSE = Cause(
    id="cooling.oil_wall",
    doc="Another conductance between oil and wall: level, foam, deposits.",
    size=Size("ln_factor", "1", "logarithm of the factor on the conductance at 200 rpm", 0.5, -3.0, 2.2, -1.5),
    shapes=(Shape("c", "1", "exponent of the speed in that logarithm", -0.8, 0.8, 0.0, 0.3),),
    exposes="transients; a second probe in the wall",
    values=conductance,
)
