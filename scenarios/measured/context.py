"""Columns that a table may have beside its sensors: which test a reading belongs to, when and how it was taken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..csv_table import Table

#: Columns that a table may have beside its sensors: name -> what it says, as a cell is read, and its SI unit.
CONTEXT: Mapping[str, tuple[str, Literal["number", "count", "text"], str]] = {
    "point": ("number of the reading", "count", ""),
    "test": ("test that the reading belongs to", "text", ""),
    "order": ("running order of the test in the campaign", "number", ""),
    "direction": ("direction of the power (1, or 2 and -1 for the reverse)", "count", ""),
    "dwell_min": ("time the point was held", "number", "s"),
    "stop_min": ("stop before this reading's dwell", "number", "s"),
    "oil": ("name of the oil", "text", ""),
    "mounting": ("name of the mounting or filling", "text", ""),
    "grid": ("name of the test grid", "text", ""),
    "date": ("day of the test", "text", ""),
    "humidity_pct": ("relative humidity of the room", "number", "1"),
    "T_start_C": ("temperature of the gearbox at the start of the test", "number", "K"),
    "T_amb_start_C": ("room temperature at the start of the test", "number", "K"),
}
#: Directions as tables write them.
DIRECTIONS = (1, 2, -1, 0)


@dataclass(frozen=True)
class Cells:
    """A table, and the column of the file for each column of the context that it has."""

    table: Table
    context: Mapping[str, str]

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(self.table.lines)

    def texts(self, name: str) -> list[str]:
        """A context column of text, "" where there is none."""
        column = self.context.get(name)
        return [""] * self.n if column is None else [str(cell) for cell in self.table.columns[column]]

    def numbers(self, name: str) -> np.ndarray:
        """A context column of numbers (n,) in its own unit, NaN where there is none."""
        column = self.context.get(name)
        return np.full(self.n, np.nan) if column is None else floats(self.table.columns[column])


def floats(cells: Sequence[Any]) -> np.ndarray:
    """Cells as numbers (n,), NaN where one is wrong or empty."""
    return np.array([np.nan if cell is None else cell for cell in cells], dtype=float)


def contradictions(cells: Cells) -> list[str]:
    """Rows of one test that contradict each other: another oil, or an earlier order."""
    problems: list[str] = []
    before: dict[str, tuple[int, str, float]] = {}
    if "test" not in cells.context:
        return problems
    rows = zip(cells.texts("test"), cells.texts("oil"), cells.numbers("order"), strict=True)
    for row, (test, oil, order) in enumerate(rows):
        first, oil_before, order_before = before.setdefault(test, (row, oil, order))
        place, line = cells.table.place(row), cells.table.lines[first]
        if oil != oil_before:
            problems.append(f"{place}: test {test} has oil {oil_before} in line {line}, here {oil}. Mend one of them.")
        if order < order_before:
            problems.append(
                f"{place}: order goes back within test {test} ({order:g} after {order_before:g}). Sort its rows."
            )
        before[test] = (first, oil_before, order)
    return problems


def order_warnings(cells: Cells) -> list[str]:
    """The first row that does not stand in running order."""
    order = cells.numbers("order")
    return [
        f"{cells.table.place(row)}: order goes back ({order[row]:g} after {order[row - 1]:g})."
        " Tests are taken in this order."
        for row in range(1, cells.n)
        if order[row] < order[row - 1]
    ][:1]
