"""A room probe that the gearbox warms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Size, Theta


def bias(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """Reading less truth per test, in proportion to the power that the gearbox turns over."""
    if rows is None:
        return {}
    power = rows.per_test(rows.w * rows.tau)
    return {"read.room_bias": theta["bias"] * power / 42e3}


CAUSE = Cause(
    id="sensor.ambient.heated",
    doc="The room probe stands in the warm air of the gearbox: it reads the more too high the more heat is lost.",
    size=Size("bias", "K", "reading less truth at 200 rpm and 2000 N.m", 1.5, -1.0, 20),
    exposes="the room probe moved away; transients",
    values=bias,
)
