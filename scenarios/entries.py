"""Catalogues: named oils, bearings, seals, materials and air, with a source for every value."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..model.core.declare import Parameter, declared
from ..model.errors import GearheatError, ScenarioError, suggestion
from ..model.parts import PARTS
from ..model.units import to_si
from .document import ABOUT, read_toml, sources_of

#: Kind of entry, as it is called in a part's table -> its file.
FILES: Mapping[str, str] = {
    "oil": "oils.toml",
    "bearing": "bearings.toml",
    "seal": "seals.toml",
    "material": "materials.toml",
    "air": "air.toml",
}

FOLDER = Path(str(files("gearheat.scenarios").joinpath("catalogue")))

#: Keys that describe an entry to a reader, and that no part takes, with their SI unit.
DESCRIPTIVE: Mapping[str, Mapping[str, str]] = {
    "material": {"rho": "kg/m3", "k": "W/(m.K)"},
    "air": {"k": "W/(m.K)", "nu": "m2/s", "Pr": "1"},
}


@dataclass(frozen=True)
class Entry:
    """One entry: its values as written (text with units), and the source of each."""

    kind: str
    name: str
    doc: str
    values: Mapping[str, Any]
    sources: Mapping[str, str]


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
    units = {**_taken_by_parts(), **DESCRIPTIVE.get(kind, {})}
    entries: dict[str, Entry] = {}
    problems: list[str] = []
    for name, table in read_toml(path).items():
        where = f"{path.name} [{name}]"
        if not isinstance(table, Mapping):
            problems.append(f"{where}: is no table. Write the values of the entry below [{name}].")
            continue
        sources, wrong = sources_of(where, table)
        problems += wrong
        values = {key: value for key, value in table.items() if key not in ABOUT}
        for key, value in values.items():
            if key not in units:
                problems.append(f'{where}: no part takes "{key}".{suggestion(key, units)}')
                continue
            try:
                to_si(value, units[key], name=f"{where}: {key}")
            except GearheatError as error:
                problems += error.problems
        entries[name] = Entry(kind, name, str(table.get("doc", "")), values, sources)
    if problems:
        raise ScenarioError(problems)
    return entries


def _taken_by_parts() -> dict[str, str]:
    """Parameter -> its unit, over all types of parts."""
    return {key: d.unit for cls in PARTS.values() for key, d in declared(cls, Parameter).items()}


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
