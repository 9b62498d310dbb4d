"""Catalogue values in use that were never checked against their source."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ...fmu.effective import effective
from ...model.core.flat import FlatModel
from ...scenarios.scenario import Scenario


def find_unchecked(scenario: Scenario, flat: FlatModel, filled: Iterable[tuple[str, str]] = ()) -> list[dict[str, Any]]:
    """Catalogue entries in use with values that were never checked against a print; values without effect left out.

    Args:
        scenario: the rig as set
        flat: its model
        filled: part and name of further entries that a run fills parts with, such as the oils of a campaign
    """
    acting = {q.name for q in effective(flat).parameters}
    found = {entry: [p for p in paths if p in acting] for entry, paths in scenario.unchecked(filled).items()}
    return [{"catalogue": kind, "entry": name, "values": paths} for (kind, name), paths in found.items() if paths]
