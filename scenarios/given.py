"""Rigs as functions take them: a name, a file, a scenario, or anything that holds one; and what is set of them."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from numbers import Integral
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ..model.core.flat import Quantity
from ..model.errors import Problems, ScenarioError
from ..model.units import example, split_quantity, to_si
from .duty import TIME
from .load import load
from .scenario import Scenario


@runtime_checkable
class HoldsScenario(Protocol):
    """What stands for a rig in Python."""

    @property
    def scenario(self) -> Scenario:
        """The rig with its values."""


#: A name of a shipped rig, a rig file, or a rig in Python.
RigLike = str | Path | Scenario | HoldsScenario
#: What a user sets: name -> text with a unit, quantity of pint, or number in SI; or texts "NAME=VALUE".
Settings = Mapping[str, Any] | str | Sequence[str | tuple[str, Any]] | None


def scenario_of(rig: RigLike) -> Scenario:
    """The scenario of a rig.

    Args:
        rig: its name, its file, or the rig itself

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    if isinstance(rig, Scenario):
        return rig
    if isinstance(rig, str | Path):
        return load(rig)
    if not hasattr(rig, "scenario"):
        raise ScenarioError(f"{rig!r} is no rig. Give its name, its file, or what gearheat.load returns.")
    return rig.scenario


def spell(value: Any, quantity: Quantity | None = None, name: str = "") -> str:
    """A value as the command line has it.

    Args:
        value: text, number in SI, or quantity of pint
        quantity: what it is of, None for a choice or an entry of a catalogue
        name: what to call it in a message

    Raises:
        ScenarioError: it is none of them
    """
    if isinstance(value, str | bool):
        return str(value)
    unit = "1" if quantity is None else quantity.unit
    with suppress(TypeError, ValueError):
        number = getattr(value, "magnitude", value)
        if not np.ndim(number) and not np.iscomplexobj(number):
            if number is not value:
                return f"{float(number)!r} {value.units:~C}"
            return repr(float(value)) if unit == "1" else f"{float(value)!r} {unit}"
    raise ScenarioError(
        f'{name or "value"} = {reprlib.repr(value)} is no value. Give one text, like "{example(unit)}", number in SI,'
        " or quantity of pint."
    )


def in_seconds(value: Any, name: str) -> float:
    """A time [s].

    Args:
        value: text with a unit, number in SI, or quantity of pint
        name: what to call it in a message

    Raises:
        ScenarioError: it is no time
    """
    return to_si(spell(value, TIME, name), "s", name=name)


def range_text(given: Any, quantity: Quantity | None, name: str) -> str:
    """A range as the command line has it, "10 degC..35 degC".

    Args:
        given: such a text, or its two ends as texts with units, numbers in SI or quantities of pint
        quantity: what it is of
        name: what to call it in a message

    Raises:
        ScenarioError: it is no range
    """
    if isinstance(given, str):
        return given
    ends = list(given) if isinstance(given, Iterable) else [given]
    if len(ends) != 2:
        raise ScenarioError(f"{name}: {reprlib.repr(given)} is no range. Give its lowest and highest value.")
    return "..".join(spell(end, quantity, name) for end in ends)


def range_of(given: Any, quantity: Quantity, name: str) -> tuple[float, float]:
    """A range in SI.

    Args:
        given: text "0.4 m2..1.2 m2" or "0.4..1.2 m2", or its two ends
        quantity: what it is of
        name: what to call it in a message

    Raises:
        ScenarioError: it is none, or its first end is not below its second
    """
    first, dots, last = range_text(given, quantity, name).partition("..")
    if not dots:
        raise ScenarioError(f'{name} "{given}" is no range. Write LOW..HIGH, both with units.')
    with suppress(ValueError):
        first = first if split_quantity(first)[1] else f"{first} {split_quantity(last)[1]}"
    low, high = (to_si(end.strip(), quantity.unit, name=name) for end in (first, last))
    if not low < high:
        raise ScenarioError(f"{name} {first}..{last}: the first end must lie below the second.")
    return low, high


def grid_text(grid: Any, name: str = "--grid") -> str:
    """A grid as the command line has it, "20x10".

    Args:
        grid: such a text, or its numbers
        name: what to call it in a message

    Raises:
        ScenarioError: it is none
    """
    if isinstance(grid, str):
        return grid
    numbers = list(grid) if isinstance(grid, Iterable) else [grid]
    if not all(isinstance(n, Integral) for n in numbers):
        raise ScenarioError(
            f'{name}: {reprlib.repr(grid)} is no grid. Give whole numbers, such as "20x10" or (20, 10).'
        )
    return "x".join(map(str, numbers))


def listed(names: Any, name: str = "names") -> list[str]:
    """Texts as a list; one text is a list of one, None is none.

    Args:
        names: one text, or several
        name: what to call them in a message

    Raises:
        ScenarioError: they are no texts
    """
    if isinstance(names, str) or names is None:
        return [] if names is None else [names]
    found = list(names) if isinstance(names, Iterable) else [names]
    if wrong := [one for one in found if not isinstance(one, str)]:
        raise ScenarioError(f"{name}: {wrong[0]!r} is no text. Give a text, or a list of texts.")
    return found


def pairs_of(given: Any) -> list[tuple[str, Any] | str]:
    """What is given by name, as pairs of name and value; texts "NAME=VALUE" stay as they are, None is nothing.

    Args:
        given: anything with `items`, pairs, such texts, or one of these texts

    Raises:
        ScenarioError: it is none of them
    """
    if given is None or isinstance(given, str):
        return [] if given is None else [given]
    items = given.items() if hasattr(given, "items") else given
    found: list[Any] = list(items) if isinstance(items, Iterable) else [items]
    for one in found:
        pair = isinstance(one, tuple | list) and len(one) == 2 and isinstance(one[0], str)
        if not pair and not isinstance(one, str):
            raise ScenarioError(
                f'{reprlib.repr(one)} gives no name a value. Write {{"room.T": "25 degC"}}, pairs of name and value, or'
                ' texts such as "room.T=25 degC".'
            )
    return [one if isinstance(one, str) else (one[0], one[1]) for one in found]


def assignments_of(given: Settings, known: Callable[[], Mapping[str, Quantity]]) -> list[str]:
    """What is set as texts "NAME=VALUE".

    Args:
        given: by name, pairs, such texts, or None
        known: tells the quantity of each name that may be set; asked where values have names

    Raises:
        ScenarioError: all that is no value of a name
    """
    pairs, problems, found = pairs_of(given), Problems(), list[str]()
    quantities = {} if all(isinstance(one, str) for one in pairs) else known()
    for one in pairs:
        with problems:
            named = one if isinstance(one, str) else f"{one[0]}={spell(one[1], quantities.get(one[0]), one[0])}"
            found.append(named)
    problems.check()
    return found
