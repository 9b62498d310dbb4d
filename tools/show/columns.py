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


def rows_text(head: Iterable[str], rows: Iterable[Iterable[float | str | None]]) -> str:
    """CSV text of numbers with nine digits and of words; nothing where a value is missing.

    Args:
        head: titles of the columns
        rows: a value per column
    """

    def cell(value: float | str | None) -> str:
        return "" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)

    return "\n".join([",".join(head), *(",".join(map(cell, row)) for row in rows)]) + "\n"


#: What a spreadsheet takes a cell for that begins so: a formula.
FORMULA = ("=", "+", "-", "@")


def table_text(columns: Mapping[str, np.ndarray]) -> str:
    """CSV text of columns of numbers, by their titles."""
    line = ",".join(["%.9g"] * len(columns))
    rows = np.column_stack(list(columns.values())).tolist()
    safe = (f"'{title}" if title.startswith(FORMULA) else title for title in columns)
    titles = (f'"{title}"' if "," in title else title for title in safe)  # an element of an array: x[1,2]
    return "\n".join([",".join(titles), *(line % tuple(row) for row in rows)]) + "\n"
