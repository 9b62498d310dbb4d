"""Convection that is stronger or weaker than assumed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import ANY_WARMTH, DIRECTION, WARMTH, Regimes, extra_conductor, limits

PARTS, NETS = extra_conductor("extra_air", "surface.heat", "room.floor")
#: What it may be limited to.
REGIMES = Regimes((*WARMTH, *DIRECTION))


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The extra conductance and where it acts."""
    values = {k: theta[k] for k in ("G_ref", "e", "c")}
    values |= {"forward": 1.0, "backward": 1.0} | ANY_WARMTH | limits(theta, REGIMES.of(theta))
    return {f"extra_air.{k}": v for k, v in values.items()}


CAUSE = Cause(
    id="cooling.air",
    doc="More or less convection: draught, a cover, a fan.",
    size=Size("G_ref", "W/K", "conductance to the air more than assumed, at 35 K and 200 rpm", 2.5, -8.0, 20.0),
    shapes=(
        Shape("e", "1", "exponent of the temperature difference", -0.5, 0.5, 0.05, 0.2),
        Shape("c", "1", "exponent of the speed: a fan on the shaft", -0.2, 1.0, 0.0, 0.2),
        *REGIMES.shapes,
    ),
    exposes="a fan switched on and off at one point; a cold room",
    parts=PARTS,
    connections=NETS,
    values=conductance,
    acts=REGIMES.of,
)
