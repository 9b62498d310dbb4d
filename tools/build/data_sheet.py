"""Sizes of a gear unit that its data sheet says, as they are written."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...model.errors import Problems, ScenarioError
from ...model.units import to_si


@dataclass(frozen=True)
class Wanted:
    """What a data sheet says of a unit, None where it follows from the rules.

    Args:
        centre: centre distance of the last stage [m]
        box: length, width and height of the housing [m]
        area: of the housing [m2]
        volume: of the oil [m3]
    """

    centre: float | None = None
    box: tuple[float, ...] | None = None
    area: float | None = None
    volume: float | None = None


def wanted_of(centre: str | None, housing: str | None, volume: str | None) -> Wanted:
    """What a data sheet says, in SI.

    Args:
        centre: centre distance of the last stage, as it is written, None where it says nothing
        housing: length x width x height of the housing, or its area
        volume: of the oil

    Raises:
        ScenarioError: what is no size
    """
    problems, area, box = Problems(), None, None
    size = None if centre is None else problems.of(lambda: _positive(centre, "m", "--centre-distance"))
    oil = None if volume is None else problems.of(lambda: _positive(volume, "m3", "--oil-volume"))
    sides = [side.strip() for side in re.split("[x*×]", housing or "")]
    unit = sides[-1].lstrip("0123456789., ")
    if len(sides) > 1 and (len(sides) != 3 or not all(sides)):
        problems.append(f'--housing = "{housing}" has not three sides. Write "800x370x430 mm", or an area, "1.6 m2".')
    elif len(sides) > 1 and not unit:
        problems.append(f'--housing = "{housing}" has no unit. Write "{housing} mm".')
    elif len(sides) > 1:
        lengths = [f"{side} {unit}" if side[-1] in "0123456789.," else side for side in sides]
        box = problems.of(lambda: tuple(_positive(length, "m", "--housing") for length in lengths))
    elif housing is not None:
        area = problems.of(lambda: _positive(housing, "m2", "--housing"))
    problems.check()
    return Wanted(size, box, area, oil)


def _positive(written: str, unit: str, name: str) -> float:
    """A size in SI."""
    if (value := to_si(written, unit, name=name)) <= 0:
        raise ScenarioError(f'{name} = "{written}" is no size. It must be above 0.')
    return value
