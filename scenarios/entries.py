"""Catalogues: named oils, bearings, seals, materials and air, with a source for every value."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..model.core.declare import Parameter, list_declared
from ..model.errors import Problems, ScenarioError, suggestion
from ..model.parts import PARTS
from ..model.units import to_si
from .document import ABOUT, sources_of
from .shipped import CHECKED, FILES, FOLDER, SERIES, read_entries

#: Keys that describe an entry to a reader, and that no part takes, with their SI unit.
DESCRIPTIVE: Mapping[str, Mapping[str, str]] = {
    "bearing": {"C": "N"},
    "material": {"rho": "kg/m3", "k": "W/(m.K)"},
    "air": {"k": "W/(m.K)", "nu": "m2/s", "Pr": "1"},
}

_UNCHECKED = re.compile(r', unchecked \((\w+) "(.*)"\)$')


@dataclass(frozen=True)
class Entry:
    """One entry: its values as written (text with units), the source of each, and the print it was compared with.

    A value that `checked` does not name was compared with nothing.
    """

    kind: str
    name: str
    doc: str
    values: Mapping[str, Any]
    sources: Mapping[str, str]
    checked: Mapping[str, str]

    def told(self, key: str, source: str) -> str:
        """A source of one of the values, with a remark where the value was not compared with a print.

        Args:
            key: of the value
            source: where the value is from
        """
        return source if key in self.checked else f'{source}, unchecked ({self.kind} "{self.name}")'


def unchecked_entry(source: str) -> tuple[str, str] | None:
    """Kind and name of the entry that a source remarks on (`Entry.told`); none for any other source."""
    found = _UNCHECKED.search(source)
    return (found[1], found[2]) if found else None


@functools.cache
def catalogue(kind: str) -> Mapping[str, Entry]:
    """All entries of a kind ("oil", "bearing", ...) by name.

    Raises:
        ScenarioError: unknown kind, or all problems of the file at once
    """
    if kind not in FILES:
        raise ScenarioError(f'there is no catalogue "{kind}".{suggestion(kind, FILES)} Catalogues: {", ".join(FILES)}.')
    return read_catalogue(kind, FOLDER / FILES[kind])


def read_catalogue(kind: str, path: Path) -> dict[str, Entry]:
    """The entries in a catalogue file, a table each.

    Args:
        kind: of its entries, a key of `FILES`
        path: the TOML file

    Raises:
        ScenarioError: all problems of the file at once
    """
    units = {key: d.unit for cls in PARTS.values() for key, d in list_declared(cls, Parameter).items()}
    units |= DESCRIPTIVE.get(kind, {})
    entries: dict[str, Entry] = {}
    problems = Problems()
    for name, table in read_entries(path).items():
        where = f"{path.name} [{name}]"
        if not isinstance(table, Mapping):
            problems.append(f"{where}: is no table. Write the values of the entry below [{name}].")
            continue
        values = {key: value for key, value in table.items() if key not in (*ABOUT, CHECKED, SERIES)}
        sources, wrong = sources_of(where, {key: value for key, value in table.items() if key not in (CHECKED, SERIES)})
        problems += wrong
        checked, wrong = _read_checks(where, table.get(CHECKED), values)
        problems += wrong
        for key, value in values.items():
            if key not in units:
                problems.append(f'{where}: no part takes "{key}".{suggestion(key, units)}')
                continue
            with problems:
                to_si(value, units[key], name=f"{where}: {key}")
        entries[name] = Entry(kind, name, str(table.get("doc", "")), values, sources, checked)
    problems.check()
    return entries


def _read_checks(where: str, given: object, values: Mapping[str, Any]) -> tuple[dict[str, str], list[str]]:
    """What each value was compared with, from a text for all of them, a table of texts, or false; and what is wrong."""
    told = dict.fromkeys(values, given) if isinstance(given, str) else {} if given is False else given
    if not isinstance(told, Mapping) or not all(isinstance(text, str) and text.strip() for text in told.values()):
        found = f"{CHECKED} is missing" if given is None else f"{CHECKED} = {given!r} names no print"
        remedy = "Write the print that the values were compared with, a table of such texts by value, or false."
        return {}, [f"{where}: {found}. {remedy}"]
    strange = [
        f'{where}: {CHECKED} names "{k}", which has no value.{suggestion(k, values)}' for k in told if k not in values
    ]
    return dict(told), strange


def entry(kind: str, name: str) -> Entry:
    """One entry of a catalogue.

    Args:
        kind: of the entry, a key of `FILES`
        name: of the entry

    Raises:
        ScenarioError: unknown kind or name, with suggestions
    """
    known = catalogue(kind)
    if name not in known:
        close = suggestion(name, known) or f" Known: {', '.join(known)}."
        raise ScenarioError(f'unknown {kind} "{name}".{close}')
    return known[name]
