"""Values as users write them, checked against the declarations of a part and turned into SI numbers."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..model.core.component import Component, make
from ..model.core.declare import Choice, Declaration, Input, Output, Parameter, State, list_declared
from ..model.core.flat import Quantity
from ..model.errors import GearheatError, Problems, ScenarioError, suggestion
from ..model.files import tables
from ..model.parts import PARTS
from ..model.units import in_unit, spell_unit, split_quantity, to_si
from .document import ABOUT, sources_of
from .entries import Entry, entry
from .ranges import check_range
from .shipped import FILES

#: Key of the table of standard uncertainties of a part.
UNCERTAINTIES = "uncertainties"

#: Least and largest size of everything in a gearbox, by SI unit.
SENSIBLE: Mapping[str, tuple[float, float]] = tables("scenarios", "units.toml")["sensible"]
#: The same of all other units.
OTHERS = (1e-30, 1e30)
#: Largest standard deviation of a value, as a part of it.
WIDEST = 10.0


@dataclass(frozen=True)
class PartValues:
    """What the table of one part gives: SI values and choices, where each is from, and all that is wrong.

    `uncertainties` holds the standard uncertainty of the values that state one, in the unit of the value; `units` the
    unit in which a value is written, for those that have one, `made` the part, so that it is made once.
    """

    values: dict[str, Any] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    uncertainties: dict[str, float] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    entries: dict[str, str] = field(default_factory=dict)
    problems: Problems = field(default_factory=Problems)
    made: list[Component] = field(default_factory=list)


def settable(cls: type[Component]) -> dict[str, Declaration]:
    """What may be given a value: parameters, start values of states, inputs."""
    return {k: d for kind in (Parameter, State, Input) for k, d in list_declared(cls, kind).items()}


def readable(cls: type[Component]) -> dict[str, Declaration]:
    """What a result can show: outputs, states and inputs."""
    return {k: d for kind in (Output, State, Input) for k, d in list_declared(cls, kind).items()}


def quantities(
    types: Mapping[str, type[Component]], kind: Callable[[type[Component]], Mapping[str, Declaration]]
) -> dict[str, Quantity]:
    """Quantities of parts by path.

    Args:
        types: part -> its type
        kind: which declarations of a type, such as `settable`
    """
    return {f"{n}.{k}": d.quantity(f"{n}.{k}") for n, cls in types.items() for k, d in kind(cls).items()}


def deviation(name: str, raw: object, unit: str) -> float:
    """What a value differs by, in SI: that of a temperature is a difference.

    Args:
        name: of the value, for messages
        raw: a number, or text with a unit
        unit: of the value

    Raises:
        ScenarioError: it is no number with a fitting unit
    """
    return to_si(raw, f"{unit} (difference)" if unit == "K" else unit, name=name)


def standard_deviation(name: str, raw: object, unit: str) -> float:
    """A standard deviation in SI.

    Args:
        name: what to call it in a message
        raw: a number, or text with a unit
        unit: SI unit of the value; that of a temperature is a difference

    Raises:
        ScenarioError: it is no number with a fitting unit, or below zero
    """
    if (value := deviation(name, raw, unit)) < 0:
        raise ScenarioError(f"{name} = {raw!r} is below zero. Give one standard deviation.")
    return value


def not_too_wide(name: str, raw: object, deviation: float, value: object) -> float:
    """The deviation of a value, where it can be one.

    Args:
        name: what to call it in a message
        raw: as written
        deviation: in SI
        value: what deviates, in SI

    Raises:
        ScenarioError: it is so many times the value that it is a slip
    """
    if isinstance(value, int | float) and value and abs(deviation) > WIDEST * abs(value):
        raise ScenarioError(f"{name} = {raw!r} is {abs(deviation / value):.3g} times the value. Check its unit.")
    return deviation


def in_range(where: str, raw: object, quantity: Quantity, *, sensible: bool = True) -> float:
    """A value as a number in the quantity's SI unit.

    Args:
        where: place of the value, for messages
        raw: a number, or text with a unit ("62 mm")
        quantity: what it is a value of: unit and range
        sensible: whether its size must be that of something in a gearbox

    Raises:
        ScenarioError: it is no number with a fitting unit, or out of range
    """
    name = f"{where}{quantity.name}"
    value = to_si(raw, quantity.unit, name=name)
    written = f'"{raw}"' if isinstance(raw, str) else raw
    unit = quantity.unit.removesuffix("(difference)").strip()
    if (broken := quantity.bound(value)) is not None:
        words, number = broken
        theirs = unit_of(raw) if "(" not in quantity.unit else ""
        known = f"{in_unit(number, theirs, unit):.6g} {theirs}" if theirs else f"{number:g} {unit}"
        raise ScenarioError(f"{name} = {written} is out of range. It must be {words} {known.removesuffix(' 1')}.")
    if quantity.whole and value != round(value):
        raise ScenarioError(f"{name} = {written} must be a whole number.")
    least, most = SENSIBLE.get(quantity.unit, OTHERS)
    if sensible and value and np.isfinite(quantity.low) and not least <= abs(value) <= most:
        raise ScenarioError(
            f"{name} = {written} cannot be of a gearbox: expected {least:g} to {most:g} {unit} in size."
            " Check its unit and its exponent."
        )
    if sensible:
        check_range(name, written, value, quantity)
    return value


def unit_of(raw: object) -> str:
    """The unit in which a number or a text ("62 mm") is written, "" without one."""
    return spell_unit(split_quantity(raw)[1]) if isinstance(raw, str) else ""


def guess(key: str, known: Mapping[str, str]) -> str | None:
    """The declared name that a misspelt key probably stands for, by its spelling or by its meaning.

    Args:
        key: the key as written
        known: declared name -> meaning
    """
    if near := difflib.get_close_matches(key, known, n=1):
        return near[0]
    meanings = {_brief(doc): name for name, doc in known.items()}
    described = difflib.get_close_matches(key.replace("_", " "), meanings, n=1)
    return meanings[described[0]] if described else None


def _brief(doc: str) -> str:
    """A meaning without what is said behind a comma or in brackets."""
    return doc.partition(",")[0].partition(" (")[0]


def entry_values(found: Entry, declarations: Mapping[str, Declaration]) -> dict[str, float]:
    """The values of a catalogue entry that a part declares, in SI; the others describe the thing to a reader.

    Args:
        found: the entry
        declarations: of the part, by key
    """
    where = f"{FILES[found.kind]} [{found.name}] "
    known = {key: raw for key, raw in found.values.items() if key in declarations}
    return {key: in_range(where, raw, declarations[key].quantity(key)) for key, raw in known.items()}


def part_values(where: str, name: str, cls: type[Component], table: Mapping[str, Any]) -> PartValues:
    """The values of one part from its table.

    Args:
        where: place of the table, for messages
        name: name of the part
        cls: its type
        table: keys as written: declared names, choices, catalogue names, `source`, `sources` and `uncertainties`
    """
    reader = _PartReader(where, name, cls)
    reader.read(table)
    return reader.result


class _PartReader:
    """Reads the table of one part: catalogue entries first, then the values beside them."""

    def __init__(self, where: str, name: str, cls: type[Component]) -> None:
        self.where, self.name, self.cls = where, name, cls
        self.declarations = settable(cls)
        self.choices: dict[str, Choice] = list_declared(cls, Choice)
        self.meanings = {key: d.doc for key, d in self.declarations.items()}
        self.meanings |= {key: choice.doc for key, choice in self.choices.items()}
        self.result = PartValues()

    def read(self, table: Mapping[str, Any]) -> None:
        kinds = [key for key in table if key in FILES and key not in self.declarations]
        own = {key: raw for key, raw in table.items() if key not in (*ABOUT, UNCERTAINTIES, *kinds)}
        sourced = {key: raw for key, raw in table.items() if key not in (UNCERTAINTIES, *kinds)}
        sources, problems = sources_of(self.where, sourced, self.meanings)
        self.result.problems.extend(problems)
        complete = all([self._take_entry(kind, table[kind]) for kind in kinds])
        taken = [key for key, raw in own.items() if self._take(key, raw)]
        self.result.sources.update({key: sources[key] for key in taken if key in sources})
        self._take_uncertainties(table.get(UNCERTAINTIES, {}))
        self._check_component(complete, {*own} - {*taken})

    def _take_entry(self, kind: str, name: object) -> bool:
        """Fill in what a catalogue says; False where it has no such entry."""
        try:
            found = entry(kind, str(name))
            values = entry_values(found, self.declarations)
        except GearheatError as error:
            self.result.problems.extend(f"{self.where}: {problem}" for problem in error.problems)
            return False
        if not values:
            self.result.problems.append(
                f'{self.where}: {kind} = "{name}" has none of the values of a {self.cls.__name__}. Take it out.'
            )
            return False
        self.result.values.update(values)
        self.result.sources.update({key: found.told(key, found.sources[key]) for key in values})
        self.result.entries[kind] = found.name
        return True

    def _take(self, key: str, raw: object) -> bool:
        """Take one key of the table; False if it is wrong."""
        values = self.result.values
        if key in self.choices:
            values[key] = tuple(raw) if isinstance(raw, list) else raw
            return True
        if key not in self.declarations:
            self.result.problems.append(self._unknown(key))
            return False
        with self.result.problems:
            value = in_range(f"{self.where}: ", raw, self.declarations[key].quantity(key))
            values[key] = value
            if unit := unit_of(raw):
                self.result.units[key] = unit
            return True
        return False

    def _take_uncertainties(self, table: object) -> None:
        """Take the standard uncertainties of values of this part; that of a temperature is a difference."""
        problems = self.result.problems
        if not isinstance(table, Mapping):
            problems.append(f'{self.where}: {UNCERTAINTIES} = {table!r} is no table. Write {{ key = "0.2 W/K" }}.')
            return
        known = [key for key in self.declarations if key in self.result.values]
        for key, raw in table.items():
            name = f"{self.where}: uncertainty of {key}"
            if key not in known:
                close = suggestion(key, known) or f" Values: {', '.join(known)}."
                problems.append(f"{name}: the part has no such value.{close}")
                continue
            with problems:
                sd = standard_deviation(name, raw, self.declarations[key].unit)
                self.result.uncertainties[key] = not_too_wide(name, raw, sd, self.result.values[key])

    def _unknown(self, key: str) -> str:
        if (name := guess(key, self.meanings)) is None:
            return f'{self.where}: unknown key "{key}". Known: {", ".join(self.meanings) or "none"}.'
        return f'{self.where}: unknown key "{key}". Did you mean "{name}" ({_brief(self.meanings[name])})?'

    def _check_component(self, complete: bool, failed: Iterable[str]) -> None:
        """What the part itself finds: missing values, unknown choices; without what follows from other problems."""
        try:
            self.result.made.append(make(self.cls, self.name, self.result.values))
        except GearheatError as error:
            excused = tuple(f"{key} is missing" for key in (*failed, *(guess(key, self.meanings) for key in failed)))
            for problem in error.problems:
                own = problem.removeprefix(f"{self.cls.__name__} {self.name}: ")
                if not own.startswith(excused) and (complete or " is missing (" not in own):
                    self.result.problems.append(f"{self.where}: {own}")


def oil_values(name: str) -> dict[str, float]:
    """What an oil of the catalogue gives an oil bath, by key, in SI. Raises ScenarioError for an unknown oil."""
    return entry_values(entry("oil", name), settable(PARTS["OilBath"]))
