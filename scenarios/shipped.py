"""What is shipped: rigs and catalogues by name. Nothing of it is checked here, so it is told at once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from .document import ABOUT, read_toml

ROOT = Path(str(files("gearheat.scenarios")))

#: Folder of the shipped rigs, one folder each.
RIGS = ROOT / "rigs"

#: Folder of the catalogues.
FOLDER = ROOT / "catalogue"

#: Kind of entry, as it is called in a part's table -> its file.
FILES: Mapping[str, str] = {
    "oil": "oils.toml",
    "bearing": "bearings.toml",
    "seal": "seals.toml",
    "material": "materials.toml",
    "air": "air.toml",
}

#: Key of what the values of an entry were compared with.
CHECKED = "checked"

#: Key of the series that an entry is a size of.
SERIES = "series"


def list_rigs(key: str = "doc") -> dict[str, str]:
    """The shipped rigs by name: what they are, or for "reproduces" the published results that they reproduce."""
    return {name: str(rig.get(key, "")) for name, rig in _rigs().items()}


@cache
def _rigs() -> Mapping[str, Mapping[str, Any]]:
    """What stands in each rig file before its first table: the rest takes the most time to read."""
    texts = {path.parent.name: path.read_text(encoding="utf-8") for path in sorted(RIGS.glob("*/rig.toml"))}
    return {
        name: tomllib.loads(re.split(r"^\[", text, maxsplit=1, flags=re.MULTILINE)[0]) for name, text in texts.items()
    }


@dataclass(frozen=True)
class Listed:
    """An entry of a catalogue as it is listed: what it is, and whether its values were compared with a print.

    `checked` is "all", "none", or names the values that were not; `series` is "" for an entry by itself.
    """

    doc: str
    checked: str
    series: str = ""


def read_entries(path: Path) -> dict[str, Any]:
    """The tables of a catalogue file by entry; one with `sizes` is a series of entries that share the rest.

    Its `columns` name what a size has, with its unit; "1" stands for none.
    """
    found: dict[str, Any] = {}
    for name, table in read_toml(path).items():
        if not isinstance(table, Mapping) or "sizes" not in table:
            found[name] = table
            continue
        shared = {key: value for key, value in table.items() if key not in ("columns", "sizes")}
        for own, numbers in table["sizes"].items():
            columns = zip(table["columns"].items(), numbers, strict=True)
            sizes = {key: n if unit == "1" else f"{n:g} {unit}" for (key, unit), n in columns}
            found[own] = {SERIES: name} | sizes | shared
    return found


def list_entries(kind: str) -> dict[str, Listed]:
    """The entries of a catalogue by name; its kind is a key of `FILES`."""
    found = {}
    for name, table in read_entries(FOLDER / FILES[kind]).items():
        values, checked = [key for key in table if key not in (*ABOUT, CHECKED, SERIES)], table[CHECKED]
        missing = [] if isinstance(checked, str) else [key for key in values if not checked or key not in checked]
        told = "all" if not missing else f"not {', '.join(missing)}" if checked else "none"
        found[name] = Listed(str(table.get("doc", "")), told, table.get(SERIES, ""))
    return found
