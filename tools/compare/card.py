"""The card of a campaign: how its tables are written, every key with its default, fitted to a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...model.errors import Problems, ScenarioError
from ...model.files import flows
from ...scenarios.csv_table import read_cells
from ...scenarios.frames import Table, path_of, rows_told
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.measured.card import Card
from ...scenarios.measured.checks import too_small
from ...scenarios.measured.guess import Known, guess_card, wanted_sensors
from ...scenarios.measured.logs import read_log
from ...scenarios.measured.read import read_campaign
from ...scenarios.measured.sensors import CONTEXT
from ...scenarios.measured.times import logged_step
from ...scenarios.measured.write import as_json, as_toml, default_card
from ...scenarios.nuisances import usual_priors
from ..show.console import as_json as json_text, write
from ..show.display import Display, lines_of

#: Rows of a table that a guess of its columns shows.
SHOWN = 5


@dataclass(frozen=True, eq=False, repr=False)
class CardText(Display):
    """A card of a rig's campaigns: every key with its default.

    Attributes:
        rig: its name
        card: the card
        columns: sensor, path or column of the context -> column of the table that was looked at
        cells: its head and first rows
        problems: why that table cannot be read with the card
        reads: what columns may be: name -> what it reads or says
    """

    rig: str
    card: Card
    columns: Mapping[str, str] = field(default_factory=dict)
    cells: Sequence[Sequence[str]] = ()
    problems: tuple[str, ...] = ()
    reads: Mapping[str, str] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """What it is."""
        return f"{self.rig}: card of a campaign"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[object]]]:
        """Keys and defaults."""
        return ("key", "default"), lines_of(self.as_dict())

    def as_dict(self) -> dict[str, Any]:
        """The card as JSON has it."""
        return as_json(self.card)

    def as_toml(self) -> str:
        """The card with what every key means."""
        return as_toml(self.card)

    def save(self, path: str | Path) -> Path:
        """Write the card as .toml or .json.

        Args:
            path: file to write

        Raises:
            ScenarioError: another kind of file
            DataError: it cannot be written
        """
        place = Path(path)
        if place.suffix not in (".toml", ".json") and not flows(place):
            raise ScenarioError(f"-o {place}: unknown kind of file. Its name must end in .toml or .json.")
        write(place, json_text(self.as_dict()) if place.suffix == ".json" else self.as_toml())
        return place


@rows_told()
def card(
    rig: RigLike,
    data: Table | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    magnitudes: Mapping[str, bool] | None = None,
) -> CardText:
    """A card for the campaigns of a rig: accuracies, priors and protocol, every key with its default.

    Args:
        rig: name, file or rig
        data: table, file or DataFrame, whose columns, units and signs are guessed
        columns: those that are known: sensor, path or optional column -> column of the table, "" where it has none
        units: those that are known: column of the table -> its unit
        magnitudes: whether the column of a sensor holds magnitudes, by its name, where that is known

    Raises:
        ScenarioError: all that is wrong with the rig
        DataError: the table is none at all, or there is no such sensor or column

    Example:
        >>> import gearheat as gh
        >>> gh.card("planetary").save("card.toml")  # doctest: +SKIP
    """
    scenario = scenario_of(rig)
    priors = usual_priors(scenario)
    if data is None:
        return CardText(scenario.name, default_card(scenario, priors))
    path, problems = path_of(data, name="--data"), Problems()
    guessed = guess_card(path, scenario, Known(columns or {}, units or {}, magnitudes or {}))
    whole = default_card(scenario, priors, guessed)
    header, rows = read_cells(path)
    with problems:
        if logged_step(header, [row for _, row in rows]):
            read_log(path, scenario, whole)
        else:
            problems += too_small(read_campaign(path, scenario, whole))
    reads = {name: sensor.reads for name, sensor in wanted_sensors(scenario).items()}
    reads |= {name: text for name, (text, *_) in CONTEXT.items()}
    cells = (header, *(row for _, row in rows[:SHOWN]))
    return CardText(scenario.name, whole, guessed.columns, cells, tuple(problems), reads)
