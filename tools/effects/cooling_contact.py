"""A resistance between the wall and the outer surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .cause import Cause, Rows, Shape, Size, Theta

#: Rise of the oil over the room at which the size is stated [K].
RISE = 40.0


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The joint with more resistance, per test exponential in the oil's rise: joints close or open as they warm."""
    R: Any = theta["R"]
    if rows is not None:
        R = R * np.exp(theta["e"] * (rows.rise_per_test / RISE - 1))
    return {"wall_surface.G": base["wall_surface.G"] / (1 + R * base["wall_surface.G"])}


CAUSE = Cause(
    id="cooling.contact",
    doc="A gap or gasket between wall and outer surface.",
    size=Size("R", "K/W", "resistance more than assumed, at an oil 40 K above the room", 0.006, -0.0004, 0.08, 0.03),
    shapes=(Shape("e", "1", "change of its logarithm by 40 K more", -2.0, 1.2, 0.0, 0.8),),
    exposes="transients; a second probe on the outer surface",
    values=conductance,
)
