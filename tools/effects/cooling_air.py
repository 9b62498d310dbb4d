"""Convection that is stronger or weaker than assumed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import extra_conductor

PARTS, NETS = extra_conductor("extra_air", "surface.heat", "room.floor")
#: Upper ends of the share of each regime: everywhere, above, below a temperature; the range of thresholds [K].
EVERYWHERE, ABOVE, LOW, HIGH = 0.6, 0.8, 315.0, 358.0


def acts(theta: Theta) -> tuple[str, float] | None:
    """Above or below which temperature."""
    if theta["regime"] <= EVERYWHERE:
        return None
    return "T+" if theta["regime"] <= ABOVE else "T-", LOW + theta["threshold"] * (HIGH - LOW)


def conductance(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The extra conductance and where it acts."""
    values = {f"extra_air.{k}": theta[k] for k in ("G_ref", "e", "c")}
    regime = acts(theta)
    if regime is None:
        return values | {"extra_air.T_on": 0.0, "extra_air.T_side": 1.0}
    side, threshold = regime
    return values | {"extra_air.T_on": threshold, "extra_air.T_side": 1.0 if side == "T+" else -1.0}


CAUSE = Cause(
    id="cooling.air",
    doc="More or less convection: draught, a cover, a fan.",
    size=Size("G_ref", "W/K", "conductance to the air more than assumed, at 35 K and 200 rpm", 2.5, -8.0, 20.0),
    shapes=(
        Shape("e", "1", "exponent of the temperature difference", -0.3, 0.4, 0.05, 0.2),
        Shape("c", "1", "exponent of the speed: a fan on the shaft", -0.2, 1.0, 0.0, 0.2),
        Shape("regime", "1", "where it acts: everywhere, above (0.7) or below (0.9) a temperature", 0.0, 1.0),
        Shape("threshold", "1", "place of the threshold in its range", 0.0, 1.0),
    ),
    exposes="a fan switched on and off at one point; a cold room",
    parts=PARTS,
    connections=NETS,
    values=conductance,
    acts=acts,
    strata=(EVERYWHERE, ABOVE, 1.0),
)
