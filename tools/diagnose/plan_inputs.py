"""What a plan starts from: a rig, the causes to tell apart, and the points of a campaign, run or not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from ...model.errors import DataError, GearheatError, suggestion
from ...scenarios.measured import POINTS, Campaign, Reading, read_measured
from ...scenarios.scenario import Scenario
from ..effects.taxonomy import CAUSES
from ..readings import in_column
from .card import Card, read_card
from .card_checks import card_problems, card_warnings
from .data_checks import implausible, too_small
from .inputs import protocol_of, rig_of, with_starts
from .lubrication import known_oils, oil_values, oil_warnings

T = TypeVar("T")

#: Where a rig comes without a campaign: speeds and torques of the grid as shares of those at its operating point.
GRID = ((0.4, 0.6, 0.8, 1.0), (0.55, 0.7, 0.85, 1.0))


@dataclass(frozen=True)
class PlanRequest:
    """Options of a plan: rig, names of causes with commas between, files, and whether there is a healthy reference."""

    rig: str
    separate: str
    card: Path | None = None
    points: Path | None = None
    reference: bool = False


@dataclass(frozen=True)
class PlanInputs:
    """Everything a plan starts from: `campaign` holds conditions, `oils` the values of its oils by path."""

    scenario: Scenario
    causes: tuple[str, ...]
    card: Card
    campaign: Campaign
    oils: Mapping[str, Mapping[str, float]]
    reference: bool
    warnings: tuple[str, ...]


def read_plan(request: PlanRequest) -> PlanInputs:
    """Read and check all that a plan needs.

    Raises:
        DataError: all problems of options and files at once
    """
    causes, problems = named_causes(request.separate)

    def tried(step: Callable[[], T]) -> T | None:
        try:
            return step()
        except GearheatError as error:
            problems.extend(p for p in error.problems if p not in problems)
            return None

    card = tried(lambda: read_card(request.card))
    problems += [] if card is None else card_problems(request.card, card)
    scenario = tried(lambda: rig_of(request.rig, card))
    path = request.points
    campaign = None if path is None else tried(lambda: _points(path, scenario, card))
    if campaign is not None:
        problems += implausible(campaign) + too_small(campaign)
    if problems or scenario is None or card is None:
        raise DataError(problems)
    if campaign is None:
        campaign = own_points(scenario, card)
    names = sorted({r.oil for r in campaign.readings})
    oils = {name: oil_values(scenario, name, card) if name else {} for name in names}
    warnings = (*campaign.warnings, *card_warnings(request.card, card), *oil_warnings(oils, card))
    started = with_starts(campaign, card.run)
    return PlanInputs(scenario, causes, card, started, oils, request.reference, tuple(dict.fromkeys(warnings)))


def named_causes(text: str) -> tuple[tuple[str, ...], list[str]]:
    """Causes in a list with commas, and what is wrong with it."""
    names = [name for part in text.split(",") if (name := part.strip())]
    known = tuple(dict.fromkeys(names))
    problems = [f"--separate: {name} is there twice. Name each cause once." for name in known if names.count(name) > 1]
    for name in known:
        if name not in CAUSES:
            alike = [c for c in CAUSES if name in c.split(".") or name == c.rpartition(".")[2]]
            close = suggestion(name, CAUSES) or (f' Did you mean "{alike[0]}"?' if alike else "")
            problems.append(f'--separate: there is no cause "{name}".{close or " Known: " + ", ".join(CAUSES) + "."}')
    if len(known) < 2:
        problems.append(
            f"--separate {text.strip() or '(nothing)'}: there is nothing to tell apart."
            " Name two causes or more, for example cooling.air,cooling.emissivity."
        )
    return known, problems


def own_points(scenario: Scenario, card: Card) -> Campaign:
    """The first grid of the rig's own campaign, or a grid of 4 x 4 points up to the rig's operating point."""
    if scenario.campaign is None:
        return _made_up(scenario, card)
    first = scenario.campaign.readings[0]
    same = [
        r for r in scenario.campaign.readings if (r.oil, r.texts.get("grid")) == (first.oil, first.texts.get("grid"))
    ]
    name = f"{scenario.campaign.name}, {first.texts.get('grid', first.oil)}"
    return Campaign(name, tuple(same), protocol_of(scenario, card))


def _points(path: Path, scenario: Scenario | None, card: Card | None) -> Campaign:
    known, problems = known_oils([path], card)
    read = read_measured(path, protocol_of(scenario, card), columns=POINTS, oils=known)
    if problems:
        raise DataError(problems)
    return read


def _made_up(scenario: Scenario, card: Card) -> Campaign:
    protocol = protocol_of(scenario, card)
    if protocol is None:
        raise DataError(f"{scenario.name}: how its tests are run is not known. Give the rig file a table [campaign].")
    at = {d.column: in_column(d.column, abs(scenario.operating_point[path])) for path, d in protocol.inputs.items()}
    room = in_column("T_amb_C", scenario.operating_point[protocol.room])
    oil = "" if card.oil is None else card.oil if isinstance(card.oil, str) else "oil of the card"
    readings: list[Reading] = []
    grid = [(a, b) for a in GRID[0] for b in GRID[1]]
    for test, (a, b) in enumerate(grid, start=1):
        values = {"n_carrier_rpm": a * at["n_carrier_rpm"], "T_carrier_Nm": b * at["T_carrier_Nm"]}
        for direction, dwell in enumerate(card.run.dwell_min[:2], start=1):
            own = values | {"T_amb_C": room, "dwell_min": dwell, "T_oil_C": np.nan, "T_wall_C": np.nan}
            readings.append(Reading(0, len(readings) + 1, test, test, direction, oil, own))
    return Campaign("grid of 4 x 4 points", tuple(readings), protocol)
