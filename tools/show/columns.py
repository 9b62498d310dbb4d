"""Columns of numbers as CSV text, in the units shown to a person."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...model.units import from_si, shown


def series(time: np.ndarray, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> str:
    """A table over time as CSV, in the units shown to a person, named in the header like those of a duty."""
    head = ["time [s]", *(f"{name} [{shown(units[name])}]" for name in columns)]
    return table_text(head, [time, *(from_si(column, units[name]) for name, column in columns.items())])


def table_text(head: Sequence[str], columns: Sequence[Any]) -> str:
    """CSV text of columns of numbers."""
    line = ",".join(["%.9g"] * len(columns))
    rows = np.column_stack(columns).tolist()
    titles = (f'"{title}"' if "," in title else title for title in head)  # an element of an array: x[1,2]
    return "\n".join([",".join(titles), *(line % tuple(row) for row in rows)]) + "\n"
