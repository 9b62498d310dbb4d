"""A measured table as its card says that it was taken: protocol, lubrication and oil, for a command that plays it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...model.errors import DataError
from ...scenarios.entries import catalogue
from ...scenarios.measured import read_measured
from ...scenarios.scenario import Scenario
from ...scenarios.write import DIAGNOSED
from .card import Card, read_card
from .card_checks import card_problems
from .inputs import protocol_of, with_starts
from .lubrication import known_oils, lubricated, oil_values


def carded(scenario: Scenario, data: Path, path: Path, *, diagnosed: bool = False) -> Scenario:
    """The rig with a measured table, played as a diagnosis of the same table and card plays it.

    Args:
        scenario: the rig, with the protocol of its tables
        data: the measured table
        path: the card: its stop, the start of its tests, its lubrication, its oil where the catalogue lacks it
        diagnosed: whether the rig is one that a diagnosis extended, and has its lubricants where they belong

    Raises:
        DataError: all problems of both files
    """
    card = read_card(path)
    known, problems = known_oils([data], card)
    problems = [*card_problems(path, card), *problems]
    if problems:
        raise DataError(problems)
    campaign = with_starts(read_measured(data, protocol_of(scenario, card), oils=known), card.run)
    spec = scenario.spec if diagnosed else lubricated(scenario.spec, card.lubrication)
    scenario = replace(scenario, spec=spec, protocol=campaign.protocol, campaign=campaign)
    unknown = {reading.oil for reading in campaign.readings} - set(catalogue("oil"))
    for name in sorted(unknown):  # one at most: a card describes one oil
        scenario = _filled(scenario, name, card, path)
    return scenario


def _filled(scenario: Scenario, name: str, card: Card, path: Path) -> Scenario:
    """The rig filled with the card's oil, but for what a diagnosis found out about it."""
    sources = scenario.value_sources
    values = {p: v for p, v in oil_values(scenario, name, card).items() if not sources.get(p, "").startswith(DIAGNOSED)}
    return scenario.with_values(values, f"inferred: the oil {name} as {path.name} describes it")
