"""Samples of the tests of a campaign, reduced to a few places of each dwell: what they add to its readings.

The temperature at a place is that of a smooth curve through all samples of the dwell, so that no sample is wasted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import BSpline

from ...model.errors import Problems
from ...model.units import spell_unit
from ..csv_table import Column, Table, in_si, parse, raise_all, read_cells, split_unit
from ..scenario import Scenario
from .card import Card
from .read import place_sensor
from .sensors import DIRECTIONS, SI, floats, sensors_of
from .table import PLACES, Campaign, Course, Series
from .times import find_times

#: Shares of the logged time where the pieces of a curve meet, which are cubic.
KNOTS = (0.04, 0.12, 0.3, 0.55)
#: Least samples of a dwell, and those from which there is a curve.
LEAST = 7
#: Below, places lie on the lines between samples.
MANY = 14
#: A piece of a curve has so many samples at least.
PIECE = 2
#: More samples of a dwell than that are averaged in groups first.
MOST = 96
#: Behind a dwell that was longer or shorter than stated by more than this share, courses are not compared.
AS_STATED = 0.03
#: Columns beside sensors and time: which test, which of its rows (0 in a stop), and which direction (0 in a stop).
CONTEXT = (
    Column("test", "test that the sample belongs to", "text"),
    Column("point", "number of the reading that the dwell leads to", "count", required=False),
    Column("direction", "direction of the power", "count", required=False, options=DIRECTIONS),
)


def series_of(samples: Samples, campaign: Campaign) -> Series:
    """The courses of the rows of a campaign.

    Args:
        samples: of its tests
        campaign: its readings

    Raises:
        DataError: they do not belong together
    """
    numbers = {name: k for k, name in enumerate(campaign.names)}
    raise_all(list(_problems(samples, campaign)), samples.name)
    logged = [k for name, k in numbers.items() if name in samples.test]
    warnings = list(samples.warnings)
    if left := campaign.n_tests - len(logged):
        warnings.append(f"{samples.name}: {left} of {campaign.n_tests} tests of {campaign.name} were not logged.")
    dwell, courses = np.full(campaign.n, np.nan), []
    for k in logged:
        for row, length, own in _test(samples, campaign, k):
            dwell[row] = length
            courses += own
    if not courses:
        warnings.append(
            f"{samples.name}: no course could be used. Log at least {LEAST} samples of a dwell, from its start."
        )
    return Series(samples.name, tuple(courses), dwell, tuple(warnings))


def _problems(samples: Samples, campaign: Campaign) -> Iterator[str]:
    if foreign := [name for name in dict.fromkeys(samples.test) if name not in campaign.names]:
        numbers = ", ".join(foreign[:8])
        yield f"{samples.name}: {campaign.name} has no test {numbers}. Give the series of its own tests."
    if campaign.steady:
        yield (
            f"{samples.name}: {campaign.name} does not say how long its points were held."
            " Add the column dwell_min, or dwell_min to the card's [protocol]."
        )
    told = samples.point is not None
    for k, name in enumerate(campaign.names):
        own = campaign.direction[campaign.test == k]
        clear = told or len(own) == 1 or (samples.direction is not None and len(set(own)) == len(own))
        if name in samples.test and not clear:
            yield (
                f"{samples.name}: it is not clear to which reading of test {name} its samples belong."
                " Add the column point with the number of that reading, 0 in stops."
            )
            return


def _rows(samples: Samples, campaign: Campaign, test: int) -> Iterator[tuple[int, np.ndarray]]:
    """Each row of a test with its samples' places."""
    mine = samples.test == campaign.names[test]
    rows = np.flatnonzero(campaign.test == test)
    turned = None if samples.direction is None else np.where(samples.direction == 2, -1.0, samples.direction)
    for row in rows:
        if samples.point is not None:
            own = (samples.point == campaign.points[row]) & (samples.point > 0)
        elif turned is not None:
            own = (turned == campaign.direction[row]) if len(rows) > 1 else (turned != 0)
        else:
            own = np.ones_like(mine)
        yield int(row), np.flatnonzero(mine & own)


def _test(samples: Samples, campaign: Campaign, test: int) -> Iterator[tuple[int, float, list[Course]]]:
    """Rows of a test that were logged: row, dwell as logged [s] and courses, none behind a dwell not as stated."""
    as_stated, end = True, 0.0
    for row, at in _rows(samples, campaign, test):
        if len(at) < LEAST:
            return
        time, stated = samples.time[at], campaign.dwell[row]
        hole = float(np.diff(time).max())  # what is logged with holes tells begin and end no better than by one
        begin = float(np.clip(end + campaign.stop[row], time[0] - hole, time[0]))
        end = begin + stated if 0 <= begin + stated - time[-1] <= hole else float(time[-1])
        share = (time - begin) / stated
        found = [c for name, v in samples.values.items() if as_stated and (c := _course(row, name, share, v[at]))]
        yield row, end - begin, found
        as_stated = as_stated and abs((end - begin) / stated - 1) < AS_STATED


def _course(row: int, sensor: str, share: np.ndarray, values: np.ndarray) -> Course | None:
    """A sensor's course at the places, None where too little was logged."""
    known = np.isfinite(values)
    share, values = share[known], values[known]
    if len(share) < LEAST:
        return None
    first = np.unique(np.linspace(0, len(share), min(len(share), MOST) + 1).astype(int))[:-1]
    count = np.diff(np.append(first, len(share)))
    when, mean = (np.add.reduceat(column, first) / count for column in (share, values))
    there, weights = _weights(when)
    found, scatter = np.full(len(PLACES), np.nan), np.zeros((len(PLACES), len(PLACES)))
    found[there] = weights @ mean
    scatter[np.ix_(there, there)] = weights / count @ weights.T
    return Course(row, sensor, found, scatter) if there.any() else None


def _weights(share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which places were logged (k,), and the weights of all samples in the values there (logged, n)."""
    places = np.array(PLACES)
    there = (places >= share[0]) & (places <= share[-1])
    kept = places[there]
    if len(share) < MANY:
        lines = [np.interp(kept, share, unit) for unit in np.eye(len(share))]
        return there, np.stack(lines, axis=1)
    inner: list[float] = []
    for knot in share[0] + (share[-1] - share[0]) * np.array(KNOTS):
        if np.sum((share < knot) & (share >= (inner or [0.0])[-1])) >= PIECE:
            inner.append(float(knot))
    knots = np.concatenate([np.full(4, share[0]), inner, np.full(4, share[-1])])
    B, at = (BSpline.design_matrix(x, knots, 3).toarray() for x in (share, kept))
    return there, np.asarray(at @ np.linalg.pinv(B))


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
    header, _ = read_cells(path, problems=[])  # rows of other lengths are told when they are parsed
    declared = sensors_of(scenario, card)
    sensors, _ = place_sensor(declared, header, card, path.name)
    named = {
        c.name: Column(card.columns.get(c.name, c.name), c.doc, c.kind, c.required, options=c.options) for c in CONTEXT
    }
    time = next(iter(find_times(header, card.columns.get("time", ""))), "time_s")
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
