"""Columns of numbers as CSV text, in the units shown to a person."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ...model.units import from_si, show_unit


def titled(columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> dict[str, np.ndarray]:
    """Columns in the units shown to a person, named like those of a duty.

    Args:
        columns: name -> values in SI
        units: SI unit of each
    """
    return {f"{name} [{show_unit(units[name])}]": from_si(column, units[name]) for name, column in columns.items()}


#: Rows that are written at a time.
BLOCK = 1000
#: What a spreadsheet takes a cell for that begins so: a formula.
FORMULA = ("=", "+", "-", "@", "\t", "\r")


def cell_text(text: str) -> str:
    """A word as a cell of CSV: no formula to a spreadsheet, in quotes where it holds a comma, a quote or a line end."""
    safe = f"'{text}" if text.startswith(FORMULA) else text
    return '"' + safe.replace('"', '""') + '"' if any(c in safe for c in ',"\r\n') else safe


def rows_text(head: Iterable[str], rows: Iterable[Iterable[float | str | None]]) -> str:
    """CSV text of numbers with nine digits and of words; nothing where a value is missing.

    Args:
        head: titles of the columns
        rows: a value per column
    """

    def cell(value: float | str | None) -> str:
        if isinstance(value, str):
            return cell_text(value)
        return "" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)

    return "\n".join([",".join(map(cell_text, head)), *(",".join(map(cell, row)) for row in rows)]) + "\n"


def table_text(columns: Mapping[str, np.ndarray]) -> str:
    """CSV text of columns of numbers, by their titles."""
    line = ",".join(["%.9g"] * len(columns))
    text = [",".join(map(cell_text, columns))]
    rows = np.column_stack(list(columns.values()))
    for first in range(0, len(rows), BLOCK):  # as Python's numbers all of them at once would take four times the memory
        text += [line % tuple(row) for row in rows[first : first + BLOCK].tolist()]
    return "\n".join(text) + "\n"
