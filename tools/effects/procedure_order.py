"""A campaign in which something changes with the running order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import extra_conductor

PARTS, NETS = extra_conductor("extra_order", "surface.heat", "room.floor")


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """Extra conductance per test, from the first to the last in running order."""
    if rows is None:
        return {}
    return {"extra_order.G_ref": theta["G_ref"] * (rows.per_test(rows.order) ** theta["power"] - theta["zero"])}


CAUSE = Cause(
    id="procedure.order",
    doc="Cooling that changes steadily over the campaign: dirt, season, what stands around.",
    size=Size("G_ref", "W/K", "conductance at the last test less that at the first", 1.5, -10.0, 10.0),
    shapes=(
        Shape("power", "1", "exponent of the running order", 0.5, 2.0, 1.0, 0.3),
        Shape("zero", "1", "where in that course the nominal holds", 0.0, 1.0),
    ),
    exposes="the first point repeated at the end; tests in random order",
    parts=PARTS,
    connections=NETS,
    values=conductance,
)
