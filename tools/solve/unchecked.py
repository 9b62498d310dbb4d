"""Catalogue values in use that were compared with no print: found for every command, and told."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ...fmu.effective import effective
from ...model.core.flat import FlatModel
from ...scenarios.scenario import Scenario
from ..show.console import say


def unchecked(scenario: Scenario, flat: FlatModel, filled: Iterable[tuple[str, str]] = ()) -> list[dict[str, Any]]:
    """Catalogue entries in use with values that were compared with no print, without those that have no effect.

    Args:
        scenario: the rig as set
        flat: its model
        filled: part and name of further entries that a run fills parts with, such as the oils of a campaign
    """
    acting = {q.name for q in effective(flat).parameters}
    found = {entry: [p for p in paths if p in acting] for entry, paths in scenario.unchecked(filled).items()}
    return [{"catalogue": kind, "entry": name, "values": paths} for (kind, name), paths in found.items() if paths]


def unchecked_lines(found: Iterable[Mapping[str, Any]]) -> list[str]:
    """Unchecked entries as a person reads them, a line each."""
    return [f'{e["catalogue"]} "{e["entry"]}": {", ".join(e["values"])}' for e in found]


def print_unchecked(found: Iterable[Mapping[str, Any]]) -> None:
    """Say which values of the catalogue were compared with no print."""
    for line in unchecked_lines(found):
        say(f"catalogue values not checked against a print: {line}")
