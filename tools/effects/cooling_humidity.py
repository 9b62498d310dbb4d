"""Cooling that follows the humidity of the room."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import extra_conductor

PARTS, NETS = extra_conductor("extra_humidity", "surface.heat", "room.floor")


#: Humidity over which the conductance changes by the size [%].
SPAN = 15.0


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """Extra conductance per test in proportion to the humidity; none where it is not measured."""
    if rows is None or rows.humidity is None:
        return {}
    return {"extra_humidity.G_ref": theta["G_ref"] * (rows.per_test(rows.humidity) - theta["neutral"]) / SPAN}


CAUSE = Cause(
    id="cooling.humidity",
    doc="Cooling that changes from day to day with the humidity of the room.",
    size=Size("G_ref", "W/K", "change of the conductance for 15 % of humidity", 0.5, -4.0, 4.0),
    shapes=(Shape("neutral", "%", "humidity at which the nominal holds", 25.0, 75.0, 50.0, 8.0),),
    exposes="humidity logged in every test, two days with the same point",
    like="day to day: humidity and other scatter of the days are one answer unless humidity is measured",
    parts=PARTS,
    connections=NETS,
    values=conductance,
)
