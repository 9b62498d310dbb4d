"""Measured steady readings: a strict table, its tests, and the duty that leads to each reading."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..model.core.flat import FlatModel
from ..model.errors import DataError, suggestion
from ..model.run.schedule import Schedule, stepped
from ..model.units import to_si
from .csv_table import Column, Table, parse, raise_all
from .entries import catalogue

#: What the ending of a column's name says about its unit, with the SI unit it becomes.
SUFFIXES: Mapping[str, tuple[str, str]] = {
    "_rpm": ("rpm", "rad/s"),
    "_Nm": ("N.m", "N.m"),
    "_C": ("degC", "K"),
    "_min": ("min", "s"),
    "_s": ("s", "s"),
    "_pct": ("percent", "1"),
}

#: Columns of a table of steady readings: what is imposed, what is read, and what a table may add.
IMPOSED = (
    Column("point", "number of the reading", "count", at_least=0),
    Column("test", "number of the test", "count", at_least=0),
    Column("order", "running order of the test in the campaign", "count", at_least=0),
    Column("direction", "direction (1 = multiplier, 2 = reducer)", "count", options=(1, 2)),
    Column("dwell_min", "time the point was held", above=0),
    Column("oil", "name of the oil", "text"),
    Column("n_carrier_rpm", "carrier speed", at_least=0),
    Column("T_carrier_Nm", "magnitude of the carrier torque", at_least=0),
    Column("T_amb_C", "room temperature", above=-273.15),
)
READ = (
    Column("T_sun_Nm", "magnitude of the sun torque", at_least=0),
    Column("T_oil_C", "oil temperature", above=-273.15),
    Column("T_wall_C", "wall temperature", above=-273.15),
)
OPTIONAL = (
    Column("T_oil2_C", "oil temperature at a second place", required=False, above=-273.15),
    Column("date", "day of the test", "text", required=False),
    Column("humidity_pct", "relative humidity of the room", required=False, at_least=0),
    Column("T_start_C", "temperature of the gearbox at the start of the test", required=False, above=-273.15),
    Column("T_amb_start_C", "room temperature at the start of the test", required=False, above=-273.15),
    Column("stop_min", "stop before this half of the test", required=False, at_least=0),
    Column("grid", "name of the test grid", "text", required=False),
    Column("n_set_rpm", "imposed carrier speed", required=False),
    Column("T_set_Nm", "imposed carrier torque", required=False),
    Column("eta_printed_pct", "efficiency as printed by the source", required=False),
    Column("loss_printed_Nm", "loss torque as printed by the source", required=False),
)
READINGS = (*IMPOSED, *READ, *OPTIONAL)
POINTS = (*IMPOSED, *(Column(c.name, c.doc, c.kind, False, c.at_least, c.above) for c in READ), *OPTIONAL)


@dataclass(frozen=True)
class Driven:
    """An input that a column of the table gives, with its sign in direction 1 and 2."""

    column: str
    sign: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True)
class Protocol:
    """How a campaign was run.

    Args:
        inputs: model input -> the column that gives it while a point is held; 0 during the stop
        room: model input of the room temperature. `T_amb_C` is its reading at the end of a point: constant before the
            first one (or a line from `T_amb_start_C`), in a straight line from each reading to the next
        oil: part of the model that holds the oil of the test
        stop: time without load between the two halves of a test [s], where the table has no `stop_min`
        notes: further columns of the rig's own table, which only its reader needs
    """

    inputs: Mapping[str, Driven]
    room: str
    oil: str
    stop: float
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reading:
    """One steady reading: `values` holds its number columns in the units of their names (NaN where left out)."""

    line: int
    point: int
    test: int
    order: int
    direction: int
    oil: str
    values: Mapping[str, float]
    texts: Mapping[str, str] = field(default_factory=dict)

    def si(self, column: str) -> float:
        """A number column in SI."""
        return column_si(column, self.values[column])

    def given(self, column: str) -> bool:
        """Whether the table has a number in this column here."""
        return bool(np.isfinite(self.values.get(column, np.nan)))


@dataclass(frozen=True)
class Test:
    """The readings of one test in the order they were taken."""

    __test__ = False  # not a test of the project

    number: int
    order: int
    oil: str
    halves: tuple[Reading, ...]


@dataclass(frozen=True)
class Campaign:
    """All readings of a table, and how they came about."""

    name: str
    readings: tuple[Reading, ...]
    protocol: Protocol | None
    warnings: tuple[str, ...] = ()

    def tests(self) -> tuple[Test, ...]:
        """The tests in running order."""
        groups: dict[int, list[Reading]] = {}
        for reading in self.readings:
            groups.setdefault(reading.test, []).append(reading)
        tests = [Test(number, rows[0].order, rows[0].oil, tuple(rows)) for number, rows in groups.items()]
        return tuple(sorted(tests, key=lambda test: test.order))

    def has(self, column: str) -> bool:
        """Whether the table has this number column."""
        return column in self.readings[0].values

    def column(self, name: str) -> np.ndarray:
        """A number column over the readings, in the unit of its name. Raises DataError with suggestions."""
        if not self.has(name):
            known = self.readings[0].values
            raise DataError(f'{self.name}: there is no column "{name}".{suggestion(name, known)}')
        return np.array([reading.values[name] for reading in self.readings])


@dataclass(frozen=True)
class TestRun:
    """What a simulation of one test needs: its duty, its oil, the start temperature [K] and when was read [s]."""

    __test__ = False  # not a test of the project

    test: Test
    schedule: Schedule
    T_start: float
    moments: tuple[float, ...]

    def start(self, flat: FlatModel) -> dict[str, float]:
        """All temperatures of a model at the start of the test."""
        return {q.name: self.T_start for q in flat.states if q.unit == "K"}


def column_si(name: str, value: float) -> float:
    """A value of a column whose name ends in its unit ("T_oil_C"), in SI; unchanged without such an ending.

    Args:
        name: of the column
        value: as it stands in the table
    """
    for suffix, (unit, si) in SUFFIXES.items():
        if name.endswith(suffix):
            return to_si(f"{float(value)!r} {unit}", si, name=name)
    return value


def read_measured(
    path: str | Path,
    protocol: Protocol | None = None,
    *,
    columns: Iterable[Column] = READINGS,
    oils: Collection[str] | None = None,
) -> Campaign:
    """The campaign in a table of steady readings, one row per reading.

    Args:
        path: CSV file
        protocol: how the campaign was run (`Scenario.protocol`); needed for `schedule_of`
        columns: `READINGS`, or `POINTS` for conditions without readings
        oils: names that may stand in the column `oil`; those of the catalogue if left out

    Raises:
        DataError: everything wrong with the table at once, by line
    """
    path = Path(path)
    table, problems = parse(path, columns)
    names = catalogue("oil") if oils is None else oils
    for row, oil in enumerate(table.columns.get("oil", ())):
        if oil and oil not in names:
            close = suggestion(oil, names) or f" Known: {', '.join(names)}."
            problems.append(f'{table.place(row)}: unknown oil "{oil}".{close}')
    problems += _test_problems(table)
    raise_all(problems, path.name)
    return Campaign(path.name, _readings(table), protocol, (*table.warnings, *_order_warnings(table)))


def _test_problems(table: Table) -> list[str]:
    """Readings that contradict each other: a point or a half twice, another oil or an earlier order within a test."""
    problems: list[str] = []
    points: dict[int, int] = {}
    halves: dict[tuple[int, int], int] = {}
    before: dict[int, tuple[int, str, int]] = {}
    rows = zip(
        *(table.columns.get(n, (None,) * len(table.lines)) for n in ("point", "test", "direction", "oil", "order")),
        strict=True,
    )
    for row, (point, test, direction, oil, order) in enumerate(rows):
        place = table.place(row)
        if point is not None and (first := points.setdefault(point, row)) != row:
            problems.append(
                f"{place}: point {point} is the number of line {table.lines[first]} too. Give each reading its own."
            )
        if None in (test, direction, oil, order):
            continue
        if (first := halves.setdefault((test, direction), row)) != row:
            problems.append(
                f"{place}: test {test} has direction {direction} in line {table.lines[first]} too. Mend one of them."
            )
        first, oil_before, order_before = before.get(test, (row, oil, order))
        if oil != oil_before:
            problems.append(
                f"{place}: test {test} has oil {oil_before} in line {table.lines[first]}, here {oil}. Mend one of them."
            )
        if order < order_before:
            problems.append(
                f"{place}: order goes back within test {test} ({order} after {order_before}). Sort its rows."
            )
        before[test] = (row, oil, order)
    return problems


def _order_warnings(table: Table) -> list[str]:
    """The first row that does not stand in running order."""
    order = table.columns["order"]
    return [
        f"{table.place(row)}: order goes back ({order[row]} after {order[row - 1]}). Tests are taken in this order."
        for row in range(1, len(order))
        if order[row] < order[row - 1]
    ][:1]


def _readings(table: Table) -> tuple[Reading, ...]:
    columns = table.columns
    rest = [name for name in columns if name not in ("point", "test", "order", "direction", "oil")]
    numbers = [name for name in rest if not isinstance(columns[name][0], str)]
    texts = [name for name in rest if name not in numbers]
    return tuple(
        Reading(
            line=line,
            point=columns["point"][row],
            test=columns["test"][row],
            order=columns["order"][row],
            direction=columns["direction"][row],
            oil=columns["oil"][row],
            values={name: columns[name][row] for name in numbers},
            texts={name: columns[name][row] for name in texts},
        )
        for row, line in enumerate(table.lines)
    )


def schedule_of(campaign: Campaign, test: Test) -> TestRun:
    """The duty of one test: each point held for its dwell, a stop without load between them, the room as read.

    Args:
        campaign: the readings, with the protocol they were taken by
        test: one of its tests

    Raises:
        DataError: the campaign was read without a protocol, or lacks a column that the protocol needs
    """
    protocol = campaign.protocol
    if protocol is None:
        raise DataError(f"{campaign.name}: how it was run is not known. Read it with the protocol of a rig's campaign.")
    missing = [d.column for d in protocol.inputs.values() if not campaign.has(d.column)]
    if missing:
        raise DataError([f'{campaign.name}: column "{m}" drives the model and is missing. Add it.' for m in missing])
    first = test.halves[0]
    room = first.si("T_amb_start_C" if first.given("T_amb_start_C") else "T_amb_C")
    T_start = first.si("T_start_C") if first.given("T_start_C") else room
    phases: list[tuple[float, dict[str, float | tuple[float, float]]]] = []
    moments, now = [], 0.0
    for half in test.halves:
        dwell, T_room = half.si("dwell_min"), half.si("T_amb_C")
        if phases:
            stop = half.si("stop_min") if half.given("stop_min") else protocol.stop
            after = room + (T_room - room) * stop / (stop + dwell)
            phases.append((stop, {path: 0.0 for path in protocol.inputs} | {protocol.room: (room, after)}))
            now, room = now + stop, after
        held = {path: d.sign[half.direction - 1] * half.si(d.column) for path, d in protocol.inputs.items()}
        phases.append((dwell, held | {protocol.room: (room, T_room)}))
        now, room = now + dwell, T_room
        moments.append(now)
    return TestRun(test, stepped(phases), T_start, tuple(moments))
