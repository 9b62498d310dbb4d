"""Duty cycles: what is given from outside over time, as a CSV table.

The header names the time and the inputs, each with its unit in brackets; between two rows everything runs in a
straight line, and a time written twice is a jump; times of a calendar count from the first one:

    time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]
    0,100,1500,25
    240,100,1500,26
    240,0,0,26
    245,0,0,26
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..model.core.flat import FlatModel, Quantity
from ..model.errors import DataError, GearheatError, Problems, ScenarioError, suggestion
from ..model.run.schedule import Schedule
from ..model.units import show_unit, to_si
from .csv_cells import number, numbers
from .csv_table import is_of, raise_all, read_cells, read_header, split_unit
from .measured.sensors import SI, WORDS
from .measured.times import LATEST, YEAR, find_times, seconds
from .ranges import check_range

TIME = Quantity("time", "s", "time")

#: Times nearer than this are one [s].
APART = 1e-6
#: Kinds of readings that a run gives.
RESULTS = {"oil_temp", "wall_temp"}
#: A step large enough to tell the slope of a unit's conversion from its offset without rounding.
_LARGE = 1e6


def duty_names(path: str | Path) -> tuple[str, ...]:
    """The inputs named in the header of a duty table, to tell which quantities it drives."""
    return tuple(_split_header(cell)[0] for cell in read_header(Path(path))[1:])


def read_duty(path: str | Path, inputs: FlatModel | Mapping[str, Quantity]) -> Schedule:
    """The schedule in a duty table.

    Args:
        path: a CSV file as described above
        inputs: the model that is driven, or the inputs that may be given (`Scenario.inputs()`)

    Raises:
        DataError: everything wrong with the table at once: names, units, cells, ranges, time that goes back
    """
    path = Path(path)
    known = {q.name: q for q in inputs.inputs} if isinstance(inputs, FlatModel) else inputs
    problems = Problems()
    header, rows = read_cells(path, problems=problems)
    raise_all([] if rows else problems, path.name)
    values: dict[str, np.ndarray] = {}
    for i, cell in enumerate(header):
        cells, lines = [cells[i] for _, cells in rows], [line for line, _ in rows]
        if i == 0 and find_times([cell]) == [cell] and not split_unit(cell)[1] and numbers(cells) is None:
            time, _ = seconds(cells, cell, path.name, np.array(lines), problems)
            values[TIME.name] = time - time[0]
            continue
        try:
            quantity, offset, slope = _column(cell, known if i else {TIME.name: TIME})
        except GearheatError as error:
            problems += [f"{path.name} line 1: {problem}" for problem in error.problems]
            continue
        if quantity.name in values:
            problems.append(f"{path.name} line 1: {quantity.name} is there twice. Keep one of its columns.")
        values[quantity.name] = _values(path.name, quantity, (offset, slope), cells, lines, problems)
    if len(header) == 1:
        problems.append(f"{path.name} line 1: no input beside the time. Add a column, one of: {', '.join(known)}.")
    if TIME.name in values:
        values[TIME.name] = _with_jumps(values[TIME.name])
        problems += _time_problems(path.name, rows, values[TIME.name])
    raise_all(problems, path.name)
    return Schedule(values.pop(TIME.name), values)


def _values(
    name: str,
    quantity: Quantity,
    scale: tuple[float, float],
    cells: Sequence[str],
    lines: Sequence[int],
    problems: Problems,
) -> np.ndarray:
    """A column in SI (n,), NaN where a cell is wrong."""
    offset, slope = scale
    whole = numbers(cells)
    column = np.full(len(cells), np.nan) if whole is None else offset + slope * whole
    if whole is None or any(map(quantity.problem, (column.min(), column.max()))):
        for k, cell in enumerate(cells):
            try:
                column[k] = _in_range(quantity, offset + slope * number(cell))
            except ValueError as error:
                problems.append(f'{name} line {lines[k]}: {quantity.name} = "{cell}" {error}.')
    if problems or not np.isfinite(column).any():
        return column
    for k in {int(column.argmin()), int(column.argmax())}:
        with problems:
            check_range(f"{name} line {lines[k]}: {quantity.name}", cells[k], float(column[k]), quantity)
    return column


def _with_jumps(time: np.ndarray) -> np.ndarray:
    """Times (n,), those of a jump alike that rounding has moved apart."""
    steps = np.diff(time)
    moved = np.where((steps > 0) & (steps < APART), steps, 0.0)
    return np.asarray(time - np.append(0.0, np.cumsum(moved)))


def _split_header(cell: str) -> tuple[str, str]:
    """Name and unit of a header cell."""
    match = re.fullmatch(r"(.*?)\s*[\[(](.*)[\])]", cell)
    return (match[1], match[2].strip()) if match else (cell, "")


def _column(cell: str, known: Mapping[str, Quantity]) -> tuple[Quantity, float, float]:
    """What a header cell says, and how its numbers become SI: offset and slope.

    Raises DataError for an unknown name, a missing or a wrong unit.
    """
    name, unit = _split_header(cell)
    if TIME.name in known:
        name, unit = split_unit(cell)
        if not find_times([cell]):
            raise DataError(f'the first column is "{cell}". It must be the time with its unit, such as "time [min]".')
        name = TIME.name
    if name not in known:
        close = suggestion(name, known) or _meant(name, unit, known)
        if (other := other_torque(name)) in known:  # an FMU takes either, as it is exported
            close = f' It takes {other}. An FMU that takes {name} is exported with --set "{name}=... N.m".'
        raise DataError(f'there is no input "{name}".{close}')
    quantity = known[name]
    remedy = f'Write it in brackets: "{name} [{show_unit(quantity.unit)}]".'
    if not unit and quantity.unit != "1":
        raise DataError(f'column "{cell}" has no unit. {remedy}')
    try:
        offset = to_si(f"0 {unit}", quantity.unit)
        return quantity, offset, (to_si(f"{_LARGE} {unit}", quantity.unit) - offset) / _LARGE
    except ScenarioError as error:
        if "may mean" in str(error):
            ways = f'"{name} [Hz]" for revolutions per second, "{name} [rad/s]" for radians'
            raise DataError(f'column "{cell}": its unit may mean revolutions or radians. Write {ways}.') from None
        raise DataError(f'column "{cell}": the unit does not fit {quantity.doc}. {remedy}') from None


def _meant(name: str, unit: str, known: Mapping[str, Quantity]) -> str:
    """Inputs that a name of the trade or a unit may mean, all where there is none: a user says which, and its sign."""
    low = name.casefold()
    kinds = [kind for kind, words in WORDS.items() if any(word in low for word in words)]
    if RESULTS & {*kinds}:
        return " Temperatures of oil and walls are results: leave the column out."
    units = {SI[kind] for kind in kinds} or {q.unit for q in known.values() if unit and is_of(unit, q.unit)}
    meant = [f'"{path} [{show_unit(q.unit)}]" ({q.doc})' for path, q in known.items() if q.unit in units]
    return f" Write {' or '.join(meant)}." if meant else f" Inputs: {', '.join(known)}."


def other_torque(path: str) -> str:
    """The load of the end whose torque is named, the torque of one whose load is; "" of everything else."""
    end, _, key = path.rpartition(".")
    other = {"tau": "load", "load": "tau"}.get(key)
    return f"{end}.{other}" if other else ""


def _in_range(quantity: Quantity, value: float) -> float:
    """The value. Raises ValueError where it is out of range."""
    if (problem := quantity.problem(value)) is not None:
        raise ValueError(f"is out of range. {problem.partition('out of range. ')[2].rstrip('.')}")
    return value


def _time_problems(name: str, rows: Sequence[tuple[int, list[str]]], time: np.ndarray) -> list[str]:
    """Rows where time goes back, and a table that lasts no time at all."""
    readable = np.flatnonzero(np.isfinite(time)).tolist()
    problems = [
        f"{name} line {rows[b][0]}: time goes back ({rows[b][1][0]} after {rows[a][1][0]}). Sort the rows by time."
        for a, b in pairwise(readable)
        if time[b] < time[a]
    ]
    problems += [
        f"{name} line {rows[b][0]}: the time {rows[b][1][0]} is there three times. A jump has two rows."
        for a, b in zip(readable, readable[2:], strict=False)
        if time[b] == time[a] and np.ptp(time[readable]) > 0
    ]
    problems += [
        f"{name} line {rows[k][0]}: a jump at the {end} of the duty lasts no time. Take one of its rows out."
        for k, other, end in ((1, 0, "begin"), (-1, -2, "end"))
        if len(rows) > 2 and time[k] == time[other] and np.ptp(time[readable]) > 0
    ]
    if readable and not np.abs(time[readable]).max() <= LATEST:
        problems.append(f"{name}: the time goes beyond {LATEST / YEAR:g} years. Check its unit.")
    if len(readable) == len(time) and np.ptp(time) == 0:
        problems.append(f"{name}: the table lasts no time. A duty needs at least two different times.")
    return problems
