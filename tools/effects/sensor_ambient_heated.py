"""A room probe that the gearbox warms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .cause import Cause, Rows, Shape, Size, Theta

#: Rise of the oil over the room at which the size is stated [K].
RISE = 40.0


def bias(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """Reading less truth per test, by a power of the oil's rise over the room."""
    if rows is None:
        return {}
    return {"read.room_bias": theta["bias"] * (np.maximum(rows.rise_per_test, 0.0) / RISE) ** theta["e"]}


CAUSE = Cause(
    id="sensor.ambient.heated",
    doc="The room probe stands in the warm air of the gearbox: it reads the more too high the warmer the gearbox.",
    size=Size("bias", "K", "reading less truth at an oil 40 K above the room", 2.0, -1.0, 20.0),
    shapes=(Shape("e", "1", "exponent of the rise", 0.6, 1.8, 1.1, 0.25),),
    exposes="the room probe moved away; transients",
    values=bias,
)
