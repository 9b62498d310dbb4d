"""Heat that is stored or appears in another body than assumed."""

from __future__ import annotations

from collections.abc import Mapping

from .cause import Cause, Rows, Shape, Size, Theta
from .forms import INSIDE, OUTSIDE

#: Share of the prior in which capacity moves.
CAPACITY = 0.7
BEARINGS = ("carrier_bearing", "sun_bearing", "carrier_seal", "sun_seal")


def values(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, float]:
    """Capacity, or heat of bearings and seals, moved from the housing to what turns."""
    if theta["heat"] > CAPACITY:
        return {f"{part}.inner_share": min(max(0.5 + theta["shift"], 0.0), 1.0) for part in BEARINGS}
    inside, outside = (sum(base[path] for path in paths) for paths in (INSIDE, OUTSIDE))
    moved = max(min(theta["shift"] * (inside + outside), 0.95 * outside), -0.95 * inside)
    factors = dict.fromkeys(INSIDE, 1 + moved / inside) | dict.fromkeys(OUTSIDE, 1 - moved / outside)
    return {path: base[path] * factor for path, factor in factors.items()}


CAUSE = Cause(
    id="thermal.split",
    doc="Capacity, or the heat of bearings and seals, belongs to what turns instead of to the housing.",
    size=Size("shift", "1", "share of all capacity, or of that heat, moved to what turns", 0.2, -0.6, 0.6),
    shapes=(Shape("heat", "1", "what moves: capacity, or heat", 0.0, 1.0, ends=(CAPACITY, 1.0)),),
    exposes="a probe on the shaft; a logged warm-up",
    values=values,
)
