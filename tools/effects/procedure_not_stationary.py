"""Readings taken before the end of the dwell."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .cause import Cause, Readings, Rows, Shape, Size, Theta
from .instruments import changed

#: Weights of both halves by the shape "halves", and upper ends of their shares of the prior.
HALVES, ENDS = ((1.0, 1.0), (1.0, 0.0), (0.0, 1.0)), (0.6, 0.85, 1.0)


def missing(size: float, halves: float) -> tuple[float, float]:
    """Missing share of the dwell as multiplier and as reducer."""
    forward, backward = HALVES[sum(halves > end for end in ENDS)]
    return size * forward, size * backward


def values(base: object, theta: Theta, rows: Rows | None) -> Mapping[str, float]:
    """How much of each half did not take place."""
    forward, backward = missing(theta["missing"], theta["halves"])
    return {"read.missing_forward": forward, "read.missing_backward": backward}


def readings(theta: Theta, rows: Rows, shown: Readings) -> Readings:
    """A log of the test shows how long its halves were."""
    forward, backward = missing(theta["missing"], theta["halves"])
    return changed(shown, dwell=shown["dwell"] - np.where(rows.direction > 0, forward, backward))


CAUSE = Cause(
    id="procedure.not_stationary",
    doc="Readings taken earlier than the protocol says, while the gearbox still warms.",
    size=Size("missing", "1", "share of the dwell that is missing", 0.3, 0.0, 0.95, 0.75),
    shapes=(Shape("halves", "1", "in which halves: both, the first, or the second", 0.0, 1.0, ends=ENDS),),
    exposes="a logged warm-up; a longer dwell",
    values=values,
    readings=readings,
    logged=False,
)
