"""How a rig's measured tables are taken: what drives the model, and what happens between readings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Driven:
    """An input that a column of the table gives, with its sign in direction 1 and 2."""

    column: str
    sign: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True)
class Protocol:
    """How a campaign is run.

    Args:
        inputs: model input -> the column that gives it while a point is held; 0 during the stop
        room: model input of the room temperature. Its reading is taken at the end of a point: constant before the
            first one, in a straight line from each reading to the next
        oil: part of the model that holds the oil of the test
        stop: time without load between the two halves of a test [s], where the table does not say
        notes: further columns of the rig's own table, which only its reader needs
    """

    inputs: Mapping[str, Driven]
    room: str
    oil: str
    stop: float
    notes: tuple[str, ...] = ()
