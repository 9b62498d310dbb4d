"""A rig with its measured readings, as every command that plays or compares them loads it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from ...model.errors import DataError
from ..frames import Table, path_of, rows_told
from ..given import RigLike, scenario_of
from ..scenario import Scenario
from ..write import DIAGNOSED, SET
from .card import Card, read_card
from .lubrication import lubricate, oil_values
from .nominal import Nominal, drive_by
from .read import read_campaign
from .table import Campaign, Sensor


@dataclass(frozen=True)
class Measured:
    """A rig driven and lubricated as its campaign was run.

    Args:
        scenario: the rig
        campaign: the readings
        card: how they were taken
    """

    scenario: Scenario
    campaign: Campaign
    card: Card

    @cached_property
    def nominal(self) -> Nominal:
        """The model at steady states."""
        return Nominal(self.scenario)

    def given(self, row: int) -> dict[str, float]:
        """Inputs of the model in a row, by path, with the signs of the model."""
        c = self.campaign
        direction = c.direction[row : row + 1]
        return {s.reads: float(c.values[s.name][row] * s.sign(direction)[0]) for s in c.given}

    def oil(self, test: int) -> dict[str, float]:
        """Values of the oil of a test, but for those that the user set or a diagnosis changed."""
        values = oil_values(self.scenario, self.campaign.oil[test], self.card)
        sources, kept = self.scenario.value_sources, (SET, DIAGNOSED)
        return {path: value for path, value in values.items() if not sources.get(path, "").startswith(kept)}

    @property
    def read_rows(self) -> list[int]:
        """Rows that were read, not only run."""
        return [row for row in range(self.campaign.n) if self.campaign.points[row] > 0]

    @property
    def warm(self) -> tuple[Sensor, ...]:
        """Thermometers of the gearbox."""
        return tuple(s for s in self.campaign.read if s.kind.endswith("_temp"))

    @property
    def oil_sensor(self) -> Sensor | None:
        """The first thermometer in the oil, else of the gearbox."""
        return next((s for s in self.warm if s.kind == "oil_temp"), next(iter(self.warm), None))

    @property
    def rooms(self) -> tuple[Sensor, ...]:
        """Thermometers of the surroundings."""
        return tuple(s for s in self.campaign.given if s.kind == "ambient")


@rows_told()
def read_study(scenario: Scenario, data: Table | None = None, card: str | Path | None = None) -> Measured | None:
    """A rig with the readings in a table, or with its own; None for a rig without any.

    Args:
        scenario: the rig; one that a diagnosis extended has its lubricants where they belong
        data: measured table that takes the place of the rig's own
        card: how that table was taken, as `diagnose` is told

    Raises:
        DataError: all problems of the files; a card without a table
    """
    if card is not None and data is None:
        raise DataError(f"--card {card} says how a measured table was taken. Give the table, too, as --data FILE.")
    path = scenario.data if data is None else path_of(data, name="--data")
    if path is None:
        return None
    told = Card() if card is None else read_card(Path(card))
    campaign = read_campaign(path, scenario, told)
    diagnosed = any(source.startswith(DIAGNOSED) for source in scenario.value_sources.values())
    spec = scenario.spec if diagnosed else lubricate(scenario.spec, told.lubrication)
    return Measured(drive_by(replace(scenario, spec=spec), campaign.sensors), campaign, told)


def load_rig(rig: RigLike, extended: str | Path | None = None) -> Scenario:
    """A rig, or its extension with the rig's own measured table.

    Args:
        rig: name, file or rig
        extended: rig file of the extension, which takes the rig's place

    Raises:
        GearheatError: all problems of the files
    """
    scenario = scenario_of(rig)
    if extended is None:
        return scenario
    found = scenario_of(extended)
    return replace(found, data=found.data or scenario.data, instruments=found.instruments or scenario.instruments)
