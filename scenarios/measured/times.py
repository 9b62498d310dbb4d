"""The column of time of a table: its names, and its cells as numbers or time stamps."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from ...model.errors import DataError, Problems
from ..csv_cells import fold
from ..csv_table import in_si, split_unit

#: Names that the column of time may have, without its unit; time stamps or a number of seconds, minutes or hours.
TIMES = ("time", "time_utc", "timestamp", "datetime", "date_time", "t", "zeit", "zeitstempel", "datum_uhrzeit")
#: Names of a column of times of day, and of that of the days beside it.
CLOCKS = ("uhrzeit", "time_of_day", "clock")
DAYS = ("date", "datum", "day", "tag")
NAMED = (TIMES, CLOCKS)
_CLOCK = re.compile(r"\d?\d:\d\d")
#: An hour without its zero.
_HOUR = re.compile(r"(?<=[ T])(?=\d:)")
#: Numbers between these in steps below a half, whose unit nothing says, are dates as Excel keeps them: days since 1900.
EXCEL_DAYS = (30000.0, 60000.0)
EXCEL_ZERO = datetime(1899, 12, 30, tzinfo=UTC)
#: A date as it is written in Germany, and one with its month or its day first, which the numbers tell if one is a day.
_DATE = re.compile(r"(\d\d?)\.(\d\d?)\.(\d{4})")
_SLASHED = re.compile(r"(\d\d?)/(\d\d?)/(\d{4})")
#: Months of a year.
MONTHS = 12
#: A time of a clock with twelve hours.
_TWELVE = re.compile(r"\b(0?\d|1[0-2])(:\d\d(?::\d\d(?:\.\d+)?)?)\s*([ap])\.?m\.?$", re.IGNORECASE)
#: What a column holds that is no calendar's, and those of which nothing says the unit.
NUMBERS = "numbers"
BARE = "numbers without a unit"
#: A table of so many rows, taken at even steps of at most so long [s], is a log.
LOGGED_ROWS = 50
LOGGED_STEP = 900.0
#: [s].
YEAR = 3.156e7
#: Latest time, since 1970 or since the begin of a table [s].
LATEST = 250 * YEAR
#: Share of the steps that are even, and how even they are.
EVEN = 0.9


def find_times(header: Iterable[str], named: str = "") -> list[str]:
    """The columns of time: the one that a card names, else those of a usual name, else those of times of day.

    Args:
        header: names of the columns
        named: by the card, with or without its unit; "" where it names none
    """
    names = {h: (h.strip(), split_unit(h)[0]) for h in header}
    spelt = {h: {re.sub("[ /]", "_", name.casefold()) for name in own} for h, own in names.items()}
    ways = ([h for h, own in names.items() if named in own], *([h for h in names if spelt[h] & {*w}] for w in NAMED))
    return next((found for found in ways if found), [])


def time_column(header: Iterable[str], named: str, name: str) -> str:
    """The one column of time.

    Args:
        header, named: as of `find_times`
        name: of the file, for messages

    Raises:
        DataError: there is none, or more than one
    """
    times = find_times(header, named)
    if len(times) > 1:
        raise DataError(f"{name}: {' and '.join(times)} are columns of time. Keep one.")
    if not times:
        raise DataError(
            f'{name}: there is no column of time. Name yours in the card, columns = {{ "time" = "..." }}, or call it'
            ' "time_utc" or "time_s".'
        )
    return times[0]


def find_days(header: Iterable[str]) -> list[str]:
    """Columns of days, which may stand beside times of day."""
    return [h for h in header if h.strip().casefold() in DAYS]


def join_days(cells: Mapping[str, Sequence[Any]], column: str) -> Sequence[Any]:
    """Cells of the column of time (n,), times of day with the day before them.

    Args:
        cells: column -> its cells (n,)
        column: of time
    """
    days, times = find_days(cells), cells[column]
    if len(days) != 1 or isinstance(times, np.ndarray) or not all(_CLOCK.match(str(time).strip()) for time in times):
        return times
    return [f"{str(day).strip()} {str(time).strip()}" for day, time in zip(cells[days[0]], times, strict=True)]


class TwoDaysError(ValueError):
    """A date that may be two."""


def parse_time(cell: Any, month_first: bool | None = None) -> tuple[float, str]:
    """A time as a number, and what it is.

    Args:
        cell: as it is written
        month_first: whether 1/2/2016 is in January; None where that is not known

    Raises:
        TypeError, ValueError, OverflowError: it is no time
        TwoDaysError: it may be two, with both
    """
    if not isinstance(cell, datetime) and _is_number(cell):
        if not math.isfinite(number := float(cell)):
            raise ValueError
        return number, NUMBERS
    stamp = cell if isinstance(cell, datetime) else datetime.fromisoformat(_iso(str(cell).strip(), month_first))
    if stamp.tzinfo:
        return stamp.timestamp(), "times with a zone"
    return stamp.replace(tzinfo=UTC).timestamp(), "times without a zone"


def _iso(text: str, month_first: bool | None) -> str:
    """A time with its year first and 24 hours; any other text as it is."""
    if match := _SLASHED.match(text) or _DATE.match(text):
        day, month, year = map(int, match.groups())
        if match.re is _SLASHED:
            month_first = months_first([text]) if month_first is None else month_first
            if month_first is None and day != month:
                ways = f'"{year}-{day:02}-{month:02}" or "{year}-{month:02}-{day:02}"'
                raise TwoDaysError(f"It may be {ways}: write one of these")
            day, month = (month, day) if month_first else (day, month)
        text = f"{year}-{month:02}-{day:02}{text[match.end() :]}"
    if match := _TWELVE.search(text):
        hour = int(match[1]) % 12 + 12 * (match[3] in "pP")
        text = f"{text[: match.start()]}{hour:02}{match[2]}"
    return _HOUR.sub("0", text)


def months_first(cells: Iterable[Any]) -> bool | None:
    """Whether dates such as 3/14/2016 have their month first, as one of them says; None where none does.

    Args:
        cells: times as they are written
    """
    found = (_SLASHED.match(cell.strip()) for cell in cells if isinstance(cell, str))
    pairs = ((int(match[1]), int(match[2])) for match in found if match)
    return next((second > MONTHS for first, second in pairs if max(first, second) > MONTHS), None)


def _is_number(cell: Any) -> bool:
    if isinstance(cell, str) and cell[4:5] == cell[7:8] == "-":  # a date
        return False
    try:
        float(cell)
    except (TypeError, ValueError):
        return False
    return True


def seconds(
    cells: Sequence[Any], column: str, name: str, lines: np.ndarray, problems: Problems, unit: str = ""
) -> tuple[np.ndarray, bool]:
    """Time [s] (n,), and whether it is a calendar's.

    Args:
        cells: of the column (n,)
        column: its name
        name: of the file
        lines: of the cells in it (n,)
        problems: take what is wrong with them
        unit: of numbers; "" where nothing says it, which are then seconds
    """
    found, kinds = np.full(len(cells), np.nan), Counter[str]()
    if isinstance(cells, np.ndarray) and np.isfinite(cells).all():
        found, kinds, cells = cells, Counter({NUMBERS: len(cells)}), ()
    wrong, month_first = [], months_first(cells)
    for k, cell in enumerate(cells):
        try:
            found[k], kind = parse_time(cell, month_first)
            kinds[kind] += 1
        except (TypeError, ValueError, OverflowError) as error:
            remedy = str(error) if isinstance(error, TwoDaysError) else "Write a time as 2016-03-14T06:00Z, or a number"
            wrong.append((lines[k], f'{column} is "{cell}". {remedy}.'))
    problems += fold(name, wrong)
    if len(kinds) > 1:
        said = " and ".join(f"{count} {kind}" for kind, count in kinds.items())
        problems.append(f"{name}: {column} holds {said}. Write all of them alike.")
    dated = NUMBERS not in kinds
    if not (dated or unit) and (said := _days_of_excel(found)):
        problems.append(f"{name}: {column} {said}")
    with problems:
        found = found if dated else np.asarray(in_si(found, unit or "s", "s", name=f"{name} {column}"))
    if np.nanmax(np.abs(found), initial=0.0) > LATEST:
        problems.append(
            f"{name}: {column} goes to {np.nanmax(np.abs(found)) / YEAR:.3g} years. Check its unit, {unit or 's'}."
        )
    return found, dated


def _days_of_excel(numbers: np.ndarray) -> str:
    """What is said of numbers (n,) that seem to be dates as Excel keeps them, "" where they do not."""
    known = numbers[np.isfinite(numbers)]
    step = float(np.median(np.abs(np.diff(known)))) if len(known) > 1 else 0.0
    (low, high), ends = EXCEL_DAYS, (known.min(initial=np.inf), known.max(initial=-np.inf))
    if not (low <= ends[0] and ends[1] <= high and 0 < step < 0.5):
        return ""
    date = EXCEL_ZERO + timedelta(days=float(ends[0]))
    return (
        f"goes from {ends[0]:.10g} to {ends[1]:.10g} in steps of {step:.3g}, as days since 1900 do, by which Excel"
        f" keeps dates. Write dates, {date:%Y-%m-%d %H:%M}, or the unit behind the"
        ' name: "time [d]", "time [s]".'
    )


def logged_step(header: Sequence[str], rows: Sequence[Sequence[str]], named: str = "") -> float | None:
    """Step of a table that is a log [s], None where it is none: rows at even, short steps, far too short for rest.

    Args:
        header: names of its columns
        rows: its cells
        named: column of time by the card; "" where it names none
    """
    times = find_times(header, named)
    if len(times) != 1 or len(rows) < LOGGED_ROWS:
        return None
    problems = Problems()
    cells = join_days({h: [row[k] for row in rows] for k, h in enumerate(header)}, times[0])
    time, _ = seconds(cells, times[0], "", np.arange(len(rows)), problems, split_unit(times[0])[1] or "s")
    if problems:
        return None
    steps = np.diff(time)
    step = float(np.median(steps))
    even = float(np.mean(np.abs(steps - step) <= (1 - EVEN) * step))
    return step if 0 < step <= LOGGED_STEP and even >= EVEN else None
