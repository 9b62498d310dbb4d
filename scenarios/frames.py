"""Tables of Python: a DataFrame stands for a file wherever one is read."""

from __future__ import annotations

import itertools
import json
import re
import reprlib
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from ..model.errors import DataError, GearheatError
from .csv_table import split_unit
from .measured.times import find_times

#: A CSV file, or a DataFrame whose columns are named as those of the file; a sequence of them, or none.
Table = str | Path | Any
Tables = Any

#: Name of the file of a DataFrame.
_NAME = "DataFrame.csv"
_COUNT = itertools.count()


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """Where the files of DataFrames are as long as the program runs: a watch reads its own late."""
    return tempfile.TemporaryDirectory()


def _new_file(name: str) -> Path:
    """A path of that name in a folder of its own."""
    path = Path(_folder().name) / str(next(_COUNT)) / name
    path.parent.mkdir()
    return path


def path_of(table: Table, *, duty: bool = False, name: str = "table") -> Path:
    """The file of a table; of a DataFrame one that is written, with an index that has a name or holds times.

    Args:
        table: file, or DataFrame
        duty: whether times of a calendar are those since the first row [s]; else they are written as they are
        name: what to call it in a message

    Raises:
        DataError: it is neither; the index of a duty may be the time, and does not say so
    """
    if isinstance(table, str | Path):
        return Path(table)
    if not hasattr(table, "to_csv") or not hasattr(table, "columns"):
        raise DataError(f"{name}: {reprlib.repr(table)} is no table. Give a CSV file, or a DataFrame of pandas.")
    path = _new_file(_NAME)
    frame = _timed(table, duty)
    if duty and frame.index.name is None and not find_times(map(str, frame.columns[:1])):
        raise DataError("the DataFrame has no time. Name its index 'time [s]', or put such a column first.")
    frame.to_csv(path, index=frame.index.name is not None)
    return path


def path_or_none(table: Table | None) -> Path | None:
    """The file of a table, where there is one."""
    return None if table is None else path_of(table)


def card_file(card: Any) -> Path | None:
    """The file of a card; of one that `gearheat.card` made, or of a dict, one that is written.

    Args:
        card: file, card, dict or None

    Raises:
        DataError: it is none of them
    """
    if card is None or isinstance(card, str | Path):
        return None if card is None else Path(card)
    keys = card if isinstance(card, dict) else card.as_dict() if hasattr(card, "as_toml") else None
    if keys is None:
        raise DataError(f"card: {reprlib.repr(card)} is no card. Give a TOML or JSON file, a dict, or a gearheat.card.")
    path = _new_file("card.json")
    path.write_text(json.dumps(keys), encoding="utf-8")
    return path


def paths_of(tables: Tables) -> tuple[Path, ...]:
    """The files of tables: of one, of several, or of none.

    Args:
        tables: a table, a sequence of them, or None
    """
    if tables is None:
        return ()
    return tuple(map(path_of, [tables] if isinstance(tables, str | Path) or hasattr(tables, "columns") else tables))


@contextmanager
def rows_told() -> Iterator[None]:
    """Within it problems tell rows of a DataFrame, counted from 0 as `iloc` does, instead of lines of its file."""
    try:
        yield
    except GearheatError as error:
        raise type(error)([_told(problem) for problem in error.problems]) from None


def _told(problem: str) -> str:
    rows = re.sub(rf"{_NAME} line (\d+)", lambda m: f"row {int(m[1]) - 2} of the DataFrame", problem)
    many = rf"{_NAME} lines (\d+) to (\d+)"
    rows = re.sub(many, lambda m: f"rows {int(m[1]) - 2} to {int(m[2]) - 2} of the DataFrame", rows)
    return rows.replace("row -1 of the DataFrame", "the DataFrame").replace(_NAME, "the DataFrame")


def _timed(frame: Any, duty: bool) -> Any:
    """A DataFrame whose times are text or seconds: those of its index, or of a column of time."""
    index, kinds = frame.index, frame.dtypes
    if getattr(index.dtype, "kind", "O") in "mM":
        title = _title("time", index, duty)
        return frame.assign(**{title: _written(index, duty)}).set_index(title)
    for name in find_times(map(str, frame.columns)):
        if getattr(kinds[name], "kind", "O") in "mM":
            times = frame[name].array
            frame = frame.assign(**{name: _written(frame[name].set_axis(times).index, duty)})
            frame = frame.rename(columns={name: _title(split_unit(name)[0], kinds[name], duty)})
    return frame


def _title(name: str, times: Any, duty: bool) -> str:
    """Name of a column of time, with a unit where it holds numbers."""
    kind = getattr(getattr(times, "dtype", times), "kind", "O")
    return f"{name} [s]" if duty or kind == "m" else name


def _written(times: Any, duty: bool) -> list[Any]:
    """Times of an index: seconds since the first one of a duty; seconds, or text in ISO form."""
    if duty:
        return [float(step.total_seconds()) for step in times - times[0]]
    kind = times.dtype.kind
    return [float(t.total_seconds()) if kind == "m" else t.isoformat() for t in times]
