"""A campaign in which something changes with the running order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cause import Cause, Rows, Shape, Size, Theta

COOLING, TEETH = ("cooling.A", "foot.G"), ("gear_set.k_mu",)
SHAFTS = (
    "carrier_bearing.k_loss",
    "sun_bearing.k_loss",
    "planet_bearing.k_loss",
    "carrier_seal.k_loss",
    "sun_seal.k_loss",
)
#: What changes by the shape "target", and upper ends of the shares of the prior.
TARGETS, ENDS = (COOLING, TEETH, TEETH + SHAFTS), (0.4, 0.7, 1.0)


def changing(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    """The target times 1 + change per test, from the first to the last in running order."""
    if rows is None:
        return {}
    progress = rows.per_test(rows.order) ** theta["power"] - theta["zero"]
    target = TARGETS[sum(theta["target"] > end for end in ENDS)]
    return {path: base[path] * (1 + theta["change"] * progress).clip(0.05) for path in target}


CAUSE = Cause(
    id="procedure.order",
    doc="Cooling or losses that change steadily over the campaign: dirt, season, running in, what stands around.",
    size=Size("change", "1", "relative change from the first test to the last", 0.12, -0.9, 1.5),
    shapes=(
        Shape("target", "1", "what changes: cooling, friction of the teeth, or all losses", 0.0, 1.0, ends=ENDS),
        Shape("power", "1", "exponent of the running order", 0.3, 2.0, 0.9, 0.35),
        Shape("zero", "1", "value of the order term at which the nominal holds: 0 first test, 1 last", 0.0, 1.0),
    ),
    exposes="the first point repeated at the end; tests in random order",
    values=changing,
)
