"""The oil of a gear unit from its name plate: how high it stands, what dips into it and what it wets."""

from __future__ import annotations

import math
from typing import Any

from ...model.units import si_of
from ...scenarios.entries import catalogue
from .sizing import Unit
from .stages import PlanetaryStage, Stage, WormStage

#: How deep the smallest wheel dips, in modules.
DIP = 3.0
#: Share of what is below the level that is oil [1].
FILLED = 0.8
#: Room below the tips [m].
BELOW = 0.040
#: Share of the housing's volume that is oil where no level follows from wheels.
SHARE = 0.16
#: Share of the walls that bath and splash reach [1].
REACHED = 0.55
#: Speed of the oil along the walls over that of the pitch line [1].
ALONG = 0.5


def wheels_dip(made: Unit) -> bool:
    """Whether wheels dip as the law of churning has it: planets and worms do otherwise."""
    return not isinstance(made.stages[0], PlanetaryStage | WormStage)


def height_of_axes(made: Unit) -> float:
    """Height of the axes of wheels that stand in one plane, above the bottom of the housing [m].

    Args:
        made: the unit
    """
    return BELOW + max(max(s.r_1, s.r_2) + s.m_n for s in made.stages)


def bath(made: Unit) -> dict[str, Any]:
    """Volume [l] and, where wheels dip, level [m] of the oil; and their rule.

    Args:
        made: the unit
    """
    if not wheels_dip(made):
        volume = SHARE * made.length * made.width * made.height
        return {"volume": 1000 * volume, "level": None, "rule": f"{100 * SHARE:.0f} % of the housing's volume"}
    smallest = min(made.stages, key=lambda s: s.r_2)
    level = height_of_axes(made) - smallest.r_2 + min(DIP * smallest.m_n, smallest.r_2)
    floor = (made.length - 2 * made.wall) * (made.width - 2 * made.wall)
    rule = f"level above the housing's bottom at which the smallest wheel dips by {DIP:g} modules; gears, ribs and"
    rule += f" shafts take {100 * (1 - FILLED):.0f} % of what is below it"
    return {"volume": 1000 * FILLED * level * floor, "level": level, "rule": rule}


def stands_in_oil(made: Unit, bearing: str) -> bool:
    """Whether a bearing of the unit reaches below the level.

    Args:
        made: the unit
        bearing: its name in the catalogue
    """
    level = bath(made)["level"]
    return level is not None and height_of_axes(made) - si_of(catalogue("bearing")[bearing].values["D"]) / 2 < level


def compute_wetted_area(stage: Stage) -> float:
    """Half of the sides of a stage's wheels and their rims [m2].

    Args:
        stage: of the unit
    """
    return stage.count * (math.pi * stage.r_2**2 + 2 * math.pi * stage.r_2 * stage.b)


def splash(made: Unit) -> dict[str, float]:
    """What the walls have from the gear that throws most: the first that dips, and the shaft it is on.

    Args:
        made: the unit
    """
    first, worm = made.stages[0], isinstance(made.stages[0], WormStage)
    return {
        "A": REACHED * made.area,
        "r": first.r_1 if worm else first.reach,
        "shaft": 0 if worm else 1,
        "share": ALONG,
        "L": made.height,
    }
