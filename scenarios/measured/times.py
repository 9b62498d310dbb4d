"""The column of time of a table: its names, and its cells as numbers or time stamps."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from ...model.errors import Problems
from ..csv_table import in_si, split_unit
from ..duty import LATEST, YEAR

#: Names that the column of time may have, without its unit; time stamps or a number of seconds, minutes or hours.
TIMES = ("time", "time_utc", "timestamp", "datetime", "date_time", "t", "zeit", "zeitstempel", "datum_uhrzeit")
#: A date as it is written in Germany.
_DATE = re.compile(r"^(\d\d)\.(\d\d)\.(\d{4})")
#: What a column holds that is no calendar's.
NUMBERS = "numbers"
#: A table of so many rows, taken at even steps of at most so long [s], is a log.
LOGGED_ROWS = 50
LOGGED_STEP = 900.0
#: Share of the steps that are even, and how even they are.
EVEN = 0.9


def find_times(header: Iterable[str]) -> list[str]:
    """The columns of time."""
    names = {h: (h.strip(), split_unit(h)[0]) for h in header}
    return [h for h, own in names.items() if not {re.sub("[ /]", "_", n.casefold()) for n in own}.isdisjoint(TIMES)]


def parse_time(cell: Any) -> tuple[float, str]:
    """A time as a number, and what it is. Raises TypeError, ValueError or OverflowError where it is none."""
    if not isinstance(cell, datetime) and _is_number(cell):
        if not math.isfinite(number := float(cell)):
            raise ValueError
        return number, NUMBERS
    text = _DATE.sub(r"\3-\2-\1", str(cell).strip())
    stamp = cell if isinstance(cell, datetime) else datetime.fromisoformat(text)
    if stamp.tzinfo:
        return stamp.timestamp(), "times with a zone"
    return stamp.replace(tzinfo=UTC).timestamp(), "times without a zone"


def _is_number(cell: Any) -> bool:
    if isinstance(cell, str) and cell[4:5] == cell[7:8] == "-":  # a date
        return False
    try:
        float(cell)
    except (TypeError, ValueError):
        return False
    return True


def seconds(
    cells: Sequence[Any], column: str, name: str, lines: np.ndarray, problems: Problems
) -> tuple[np.ndarray, bool]:
    """Time [s] (n,), and whether it is a calendar's.

    Args:
        cells: of the column (n,)
        column: its name
        name: of the file
        lines: of the cells in it (n,)
        problems: take what is wrong with them
    """
    unit = split_unit(column)[1] or "s"
    found, kinds = np.full(len(cells), np.nan), Counter[str]()
    if isinstance(cells, np.ndarray) and np.isfinite(cells).all():
        found, kinds, cells = cells, Counter({NUMBERS: len(cells)}), ()
    for k, cell in enumerate(cells):
        try:
            found[k], kind = parse_time(cell)
            kinds[kind] += 1
        except (TypeError, ValueError, OverflowError):
            problems.append(
                f'{name} line {lines[k]}: {column} is "{cell}". Write a time as 2016-03-14T06:00Z, or a number.'
            )
    if len(kinds) > 1:
        said = " and ".join(f"{count} {kind}" for kind, count in kinds.items())
        problems.append(f"{name}: {column} holds {said}. Write all of them alike.")
    dated = NUMBERS not in kinds
    with problems:
        found = found if dated else np.asarray(in_si(found, unit, "s", name=f"{name} {column}"))
    if np.nanmax(np.abs(found), initial=0.0) > LATEST:
        problems.append(
            f"{name}: {column} goes to {np.nanmax(np.abs(found)) / YEAR:.3g} years. Check its unit, {unit}."
        )
    return found, dated


def logged_step(header: Sequence[str], rows: Sequence[Sequence[str]]) -> float | None:
    """Step of a table that is a log [s], None where it is none: rows at even, short steps, far too short for rest.

    Args:
        header: names of its columns
        rows: its cells
    """
    times = find_times(header)
    if len(times) != 1 or len(rows) < LOGGED_ROWS:
        return None
    problems, place = Problems(), header.index(times[0])
    time, _ = seconds([row[place] for row in rows], times[0], "", np.arange(len(rows)), problems)
    if problems:
        return None
    steps = np.diff(time)
    step = float(np.median(steps))
    even = float(np.mean(np.abs(steps - step) <= (1 - EVEN) * step))
    return step if 0 < step <= LOGGED_STEP and even >= EVEN else None
