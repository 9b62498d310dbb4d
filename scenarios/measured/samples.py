"""A table of samples of the tests of a campaign, of any rig: read and checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...model.errors import Problems
from ...model.units import spell_unit
from ..columns import in_si, split_unit
from ..csv_table import Column, Table, parse, raise_all, read_cells
from ..scenario import Scenario
from .card import Card
from .context import DIRECTIONS, floats
from .logs import TIMES
from .read import place_sensor
from .sensors import SI, sensors_of

#: Columns beside sensors and time: which test, which of its rows (0 in a stop), and which direction (0 in a stop).
CONTEXT = (
    Column("test", "test that the sample belongs to", "text"),
    Column("point", "number of the reading that the dwell leads to", "count", required=False),
    Column("direction", "direction of the power", "count", required=False, options=DIRECTIONS),
)


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples in the order of their file.

    Args:
        name: of the file
        test: name of each sample's test (n,)
        time: since the start of its test [s] (n,)
        point, direction: of the row it belongs to (n,), 0 in a stop; None without such a column
        values: compared thermometer -> what it shows [K] (n,), NaN where a cell is empty
        warnings: of columns that are not used
    """

    name: str
    test: np.ndarray
    time: np.ndarray
    point: np.ndarray | None
    direction: np.ndarray | None
    values: dict[str, np.ndarray]
    warnings: tuple[str, ...]


def read_samples(path: Path, scenario: Scenario, card: Card) -> Samples:
    """The samples in a table.

    Args:
        path: CSV file
        scenario: the rig
        card: its columns, units and sensors

    Raises:
        DataError: everything wrong with the table, at once
    """
    header, _ = read_cells(path)
    declared = sensors_of(scenario, card)
    sensors, _ = place_sensor(declared, header, card, path.name)
    named = {
        c.name: Column(card.columns.get(c.name, c.name), c.doc, c.kind, c.required, options=c.options) for c in CONTEXT
    }
    time = next((h for h in header if split_unit(h)[0] in TIMES), "time_s")
    columns = [*named.values(), Column(time, "time since the start of the test", at_least=0.0)]
    columns += [Column(s.column, s.reads, required=False) for s in sensors]
    table, wrong = parse(path, columns)
    problems = Problems(wrong)
    compared = [s for s in sensors if s.role == "read" and SI[s.kind] == "K"]
    if not compared:
        names = ", ".join(s.column for s in declared if s.role == "read" and SI[s.kind] == "K")
        problems.append(f"{path.name} line 1: there is no thermometer to compare. Add at least one of: {names}.")
    problems += _backward(table, named["test"].name, time)
    seconds = _si(table, time, spell_unit(card.units.get(time, split_unit(time)[1] or "s")), "s", problems)
    values = {s.name: _si(table, s.column, s.unit, SI[s.kind], problems) for s in compared}
    raise_all(problems, path.name)
    context = {key: table.columns.get(c.name) for key, c in named.items()}
    point, direction = (None if (cells := context[key]) is None else floats(cells) for key in ("point", "direction"))
    return Samples(path.name, np.array(context["test"], dtype=str), seconds, point, direction, values, table.warnings)


def _si(table: Table, column: str, unit: str, si: str, problems: Problems) -> np.ndarray:
    """A column of numbers (n,) in SI."""
    cells = floats(table.columns.get(column, ()))
    with problems:
        cells = in_si(cells, unit, si, name=f"{table.name} {column}")
    return cells


def _backward(table: Table, test_column: str, time_column: str) -> list[str]:
    """The first sample of each test that was taken before the one above it."""
    problems: list[str] = []
    last: dict[str, float] = {}
    told: set[str] = set()
    columns = (table.columns.get(name, ()) for name in (test_column, time_column))
    for row, (test, time) in enumerate(zip(*columns, strict=False)):
        if test is None or time is None:
            continue
        if time < last.get(test, 0.0) and test not in told:
            told.add(test)
            problems.append(
                f"{table.place(row)}: time goes back in test {test} ({time:g} after {last[test]:g})."
                " Sort its samples by time."
            )
        last[test] = time
    return problems
