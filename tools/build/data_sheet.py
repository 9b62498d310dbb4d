"""What name plate and data sheet of a gear unit say, as it is written."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

from ...model.core.flat import Quantity
from ...model.errors import Problems, ScenarioError
from ...model.units import split_quantity, to_si
from ...scenarios.given import spell

#: What `gearheat new` takes with a unit -> the SI unit.
UNITS = {"--power": "W", "--speed": "rad/s", "--motor-heat": "W", "--air-speed": "m/s"}
UNITS |= {"--centre-distance": "m", "--housing": "m2", "--oil-volume": "m3"}
#: Largest ones by SI unit: a point between thousands gives no larger ones.
LARGEST = {"W": 5e6, "rad/s": 1000.0, "m": 5.0, "m3": 5.0}
#: Between the sides of a box.
_TIMES = re.compile("[x*×]")
#: A number that may have a point between thousands.
_GROUPED = re.compile(r"(?<![\d.])[1-9]\d{0,2}\.\d{3}(?![\d.eE])")


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


def spell_all(given: Mapping[str, Any]) -> dict[str, str]:
    """What is given as the command line has it: numbers in SI and quantities of pint are texts with units.

    Args:
        given: by option

    Raises:
        ScenarioError: all that are neither
    """
    problems, texts = Problems(), dict[str, str]()
    for option, value in given.items():
        if isinstance(value, str):
            texts[option] = value
        elif option not in UNITS:
            problems.append(f"{option} = {reprlib.repr(value)} is no text.")
        else:
            spelled = problems.of(partial(spell, value, Quantity(option, UNITS[option], ""), option))
            texts[option] = (spelled or "").replace("**", "")  # a star stands between the sides of a housing
    problems.check()
    return texts


def watts_of(power: str) -> float:
    """The power at the input [W], a mechanical one.

    Args:
        power: as it is written
    """
    if re.search(r"V\W*A\s*$", power):
        raise ScenarioError(f'--power = "{power}" is apparent power. Give that of the shaft, such as "7.5 kW".')
    if re.search(r"\dmW$", power.replace(" ", "")):
        megawatts = power.replace("mW", "MW")
        raise ScenarioError(
            f'--power = "{power}" is in milliwatts. Write "{megawatts}" if megawatts are meant, else W.'
        )
    return to_si(power, "W", name="--power")


def thousands(texts: Mapping[str, str]) -> Iterator[str]:
    """Notes on numbers that may have a point between thousands.

    Args:
        texts: as they are written, by option
    """
    for option, unit in UNITS.items():
        sides = _TIMES.split(written := texts.get(option, ""))
        si = "m" if len(sides) > 1 else unit
        for number in _GROUPED.findall(written):
            with suppress(ScenarioError, ValueError):  # what cannot be read is told elsewhere
                read = f"{float(number):g} {split_quantity(sides[-1])[1]}"
                if 1000 * to_si(read, si) <= LARGEST.get(si, 0.0):
                    meant = written.replace(number, number.replace(".", ""))
                    yield f'{option}: {number} is read as {read}. Write "{meant}" if a thousand is meant.'


def mains(speed: str) -> Iterator[str]:
    """A note on a speed that may be the frequency of the mains.

    Args:
        speed: as it is written
    """
    if found := re.fullmatch(r"\s*([56]0)(\.0*)?\s*Hz\s*", speed):
        rpm = 60 * int(found[1])
        yield f"--speed {speed} is read as {rpm} rpm. On a motor's plate Hz are those of the mains: give its rpm."


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
    sides = [side.strip() for side in _TIMES.split(housing or "")]
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
