"""A measured table of any rig as a campaign: its columns found, converted to SI and put in running order.

Rows that were run and not read come in: where a test lacks one that nearly all others have, it took place all the same.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np

from ...model.errors import DataError, Problems, suggestion
from ...model.units import spell_unit
from ..csv_cells import fold
from ..csv_table import Column, Table, bare_name, in_si, parse, raise_all, read_cells, split_unit
from ..scenario import Scenario
from .against_model import unheld
from .card import Card
from .card_names import misnamed
from .checks import check
from .lubrication import oil_problems, oil_values, oil_warnings
from .nominal import Nominal, drive_by, unmeasured
from .sensors import (
    CONTEXT,
    DIRECTIONS,
    SI,
    Cells,
    contradictions,
    floats,
    order_warnings,
    sensors_of,
    si_of,
)
from .shafts import SLOW, torques, turned
from .table import Campaign, Sensor
from .times import logged_step

#: Share of the tests that must have run alike, for one that lacks a row to be taken to have run like them.
USUAL = 0.5
#: Magnitudes below zero by so many tolerances of the sensor are errors of its zero; so are those within `SLOW` of its
#: range.
ZERO_SD = 3.0
#: Number of a row that is not in the file.
UNREAD = 0

Step = tuple[float, float]

_ISO = re.compile(r"\d{4}-\d\d-\d\d")


def _is_day(text: str) -> bool:
    try:
        date.fromisoformat(text)
    except ValueError:
        return False
    return True


def read_campaign(path: Path, scenario: Scenario, card: Card, *, points: bool = False) -> Campaign:
    """The campaign in a table of readings, one row a reading.

    Args:
        path: CSV file
        scenario: the rig
        card: how the table is written and was taken
        points: whether the table holds conditions to predict, which need no readings

    Raises:
        DataError: everything wrong with the table and the card's sensors, at once
    """
    return _Reader(path, scenario, card, points).campaign()


def place_sensor(
    declared: Sequence[Sensor], header: Sequence[str], card: Card, name: str
) -> tuple[tuple[Sensor, ...], Problems]:
    """The sensors that a table has, each with its column, and what is wrong: columns that drive the model are missing.

    Args:
        declared: sensors as rig and card declare them
        header: names of the table's columns
        card: units of columns
        name: of the table
    """
    found, problems = [], Problems()
    for sensor in declared:
        names = (sensor.column, split_unit(sensor.column)[0])
        same = [h for h in header if h == sensor.column or split_unit(h)[0] in names]
        column = next(iter(same), None)
        if len(same) > 1:
            problems.append(f"{name} line 1: {' and '.join(same)} are columns of one sensor, {sensor.name}. Keep one.")
        elif column is not None:
            unit = card.units.get(column, split_unit(column)[1] or sensor.unit)
            found.append(replace(sensor, column=column, unit=spell_unit(unit)))
        elif sensor.role == "given":
            about = " If it was not measured, add what is known of it, and how well: channels.{}.offset_sd in the card."
            problems.append(
                f'{name} line 1: column "{sensor.column}" drives the model ({sensor.reads}) and is missing.'
                f"{suggestion(sensor.column, header, bare_name)} Add it, or name yours in the card: columns = {{"
                f' "{sensor.name}" = "..." }}.{about.format(sensor.name) if sensor.kind == "torque" else ""}'
            )
    return tuple(found), problems


class _Reader:
    """Reads one table, collecting problems all the way; nothing of it outlives the reading."""

    def __init__(self, path: Path, scenario: Scenario, card: Card, points: bool) -> None:
        self.path, self.scenario, self.card, self.points = path, scenario, card, points
        self.header, self.rows = read_cells(path, problems=[])  # rows of other lengths are told when they are parsed
        context = {name: card.columns.get(name, name) for name in CONTEXT}
        self.context = {name: column for name, column in context.items() if column in self.header}
        self.held = (
            points or card.protocol.prose == "steady" or not self.context.keys().isdisjoint(("test", "dwell_min"))
        )
        named, cells = card.columns.get("time", ""), [row for _, row in self.rows]
        if not self.held and (step := logged_step(self.header, cells, named)):
            raise DataError(
                f"{path.name}: is a log, with a row each {step:g} s. Give it by --logs, and as a table the points that"
                ' were held; or say that all rows are of steady states: protocol = "steady" in the card.'
            )
        declared = sensors_of(scenario, card)
        self.sensors, self.problems = place_sensor(declared, self.header, card, path.name)
        if not points:
            self.problems += misnamed(scenario, card, declared, self.header, path.name)
        if not (points or any(s.role == "read" for s in self.sensors)):
            names = ", ".join(s.column or s.name for s in declared if s.role == "read")
            self.problems.append(f"{path.name} line 1: there is nothing to compare. Add at least one of: {names}.")
        if self.problems and not (points or card.columns):
            self.problems.append(
                f"Or have the columns guessed: `gearheat card {scenario.name} --data {path.name} -o card.toml`, and"
                " give --card card.toml."
            )

    def campaign(self) -> Campaign:
        """All of the table, or all of its problems."""
        table, problems = parse(self.path, self._columns())
        self.problems += problems
        cells = Cells(table, self.context)
        self.problems += contradictions(cells)
        oils = {oil: table.place(row) for row, oil in reversed(list(enumerate(cells.texts("oil"))))}
        self.problems += oil_problems(self.path.name, oils, self.card)
        values = {s.name: self._values(table, s) for s in self.sensors}
        minutes = {name: self._si(cells, name) for name, (_, _, si, _, _) in CONTEXT.items() if si}
        self._check_context(cells, minutes)
        raise_all(self.problems, self.path.name)
        self.sensors, values = torques(self.scenario, self.sensors, values, self.path.name)
        found = self._ordered(cells, values, minutes)
        nominal = Nominal(drive_by(self.scenario, self.sensors))
        known = {oil: oil_values(self.scenario, oil, self.card) for oil in oils}
        own = (*oil_warnings(self.scenario, found.oil, self.card), *unmeasured(nominal, found.name, self.sensors))
        if not self.held:
            raise_all([*unheld(found, nominal, known)], found.name)
        warned = replace(found, warnings=(*found.warnings, *own))
        return _with_unread(check(warned, nominal, known, points=self.points))

    def _columns(self) -> list[Column]:
        found = [Column(s.column, s.reads, required=s.role == "given") for s in self.sensors]
        for name, column in self.context.items():
            doc, kind = CONTEXT[name][:2]
            options = DIRECTIONS if name == "direction" else ()
            above, least = (0.0 if name == n else -np.inf for n in ("dwell_min", "stop_min"))
            found.append(Column(column, doc, kind, required=False, options=options, above=above, at_least=least))
        return found

    def _values(self, table: Table, sensor: Sensor) -> np.ndarray:
        """What a sensor shows (n,) in SI."""
        cells = floats(table.columns[sensor.column])
        with self.problems:
            cells = in_si(cells, sensor.unit, si_of(sensor), name=f"{self.path.name} {sensor.column}")
        if sensor.signs != (1.0, 1.0) and (cells < 0).any():
            full = np.nanmax(np.abs(cells))
            if si_of(sensor) == SI[sensor.kind]:
                full = max(full, abs(Nominal(self.scenario).value(sensor.reads)), ZERO_SD / SLOW * sensor.offset_sd)
            said = f'{sensor.column} = "{{:g}}" is out of range. The {sensor.reads} must be at least 0.'
            far = np.flatnonzero(cells < -SLOW * full).tolist()
            wrong = ((table.lines[row], said.format(table.columns[sensor.column][row])) for row in far)
            self.problems += fold(self.path.name, wrong)
        return cells

    def _si(self, cells: Cells, name: str) -> np.ndarray:
        """A context column (n,) in SI."""
        column = self.context.get(name, name)
        unit = self.card.units.get(column, split_unit(column)[1] or split_unit(name)[1])
        numbers = cells.numbers(name)
        with self.problems:
            numbers = in_si(numbers, spell_unit(unit), CONTEXT[name][2], name=f"{self.path.name} {column}")
        return numbers

    def _check_context(self, cells: Cells, known: Mapping[str, np.ndarray]) -> None:
        """Refuse numbers of the context out of their range, and days that no calendar has."""
        for name, (doc, kind, si, low, high) in CONTEXT.items():
            unit = split_unit(name)[1]
            ends = in_si(np.array([low, high]), unit, si, name=name) if si else (low, high)
            numbers = known[name] if si else cells.numbers(name) if kind != "text" else np.full(cells.n, np.nan)
            self.problems += [
                f"{cells.table.place(int(row))}: {self.context[name]} is out of range. The {doc} must be from"
                f" {low:g} to {high:g} {unit}".rstrip()
                + "."
                for row in np.flatnonzero((numbers < ends[0]) | (numbers > ends[1]))
            ]
        self.problems += [
            f'{cells.table.place(row)}: {self.context["date"]} = "{day}" is no day. Write it as 2014-03-05.'
            for row, day in enumerate(cells.texts("date"))
            if _ISO.fullmatch(day) and not _is_day(day)
        ]

    def _ordered(self, cells: Cells, values: dict[str, np.ndarray], si: dict[str, np.ndarray]) -> Campaign:
        """The campaign with its tests in running order."""
        names = cells.texts("test") if "test" in self.context else [str(row) for row in range(cells.n)]
        order = cells.numbers("order")
        met = {name: row for row, name in reversed(list(enumerate(names)))}
        position = np.array([met[name] for name in names])
        order = np.where(np.isfinite(order), order, np.unique(position, return_inverse=True)[1] + 1)[position]
        rows = np.lexsort((np.arange(cells.n), position, order))
        first = np.append(True, np.diff(position[rows]) != 0)
        test = np.cumsum(first) - 1
        said = {name for name, table in self.card.sensors.items() if table.signs is not None}
        self.sensors, values, direction = turned(self.scenario, self.sensors, values, self._direction(cells), said)
        direction = direction[rows]
        starts = rows[first]
        points = cells.numbers("point")
        spoken = self.scenario.protocol.notes if self.scenario.protocol else ()  # of columns that nothing reads
        unused = [w for w in cells.table.warnings if not any(f'column "{name}" is not used' in w for name in spoken)]
        return Campaign(
            name=self.path.name,
            sensors=tuple(_one_way(s, direction) for s in self.sensors),
            values={name: column[rows] for name, column in values.items()},
            test=test,
            order=order[starts],
            direction=direction,
            dwell=self._dwell(cells, si["dwell_min"], rows, test),
            stop=self._stop(si["stop_min"], rows, first),
            oil=tuple(cells.texts("oil")[row] for row in starts),
            mounting=tuple(cells.texts("mounting" if "mounting" in self.context else "grid")[row] for row in starts),
            T_start=si["T_start_C"][starts],
            room_start=si["T_amb_start_C"][starts],
            humidity=si["humidity_pct"][starts],
            date=tuple(cells.texts("date")[row] for row in starts),
            lines=np.array(cells.table.lines)[rows],
            points=np.where(np.isfinite(points), points, np.arange(cells.n) + 1)[rows].astype(int),
            start_by_room=self.card.protocol.T_start_minus_amb_K,
            room_begin=self.card.protocol.ambient_start_minus_reading_K,
            names=tuple(names[row] if "test" in self.context else str(k + 1) for k, row in enumerate(starts)),
            ordered="order" in self.context,
            others=self._others(rows),
            warnings=(*unused, *order_warnings(cells)),
        )

    def _others(self, rows: np.ndarray) -> dict[str, tuple[str, ...]]:
        """Columns that neither a sensor nor the context has, as they stand, in running order."""
        used = {s.column for s in self.sensors} | set(self.context.values())
        columns = {name: k for k, name in enumerate(self.header) if name not in used}
        return {name: tuple(self.rows[row][1][k] for row in rows) for name, k in columns.items()}

    def _direction(self, cells: Cells) -> np.ndarray:
        """+1 and -1 (n,) as stated, else 0."""
        stated = cells.numbers("direction")
        return np.where(stated == 2, -1.0, np.nan_to_num(stated))

    def _dwell(self, cells: Cells, stated: np.ndarray, rows: np.ndarray, test: np.ndarray) -> np.ndarray:
        """Time each row was held [s] (n,)."""
        minutes = self.card.protocol.dwell_min
        if self.card.protocol.prose == "steady" or not (minutes or "dwell_min" in self.context):
            return np.full(cells.n, np.inf)
        place = np.arange(cells.n) - np.flatnonzero(np.append(True, np.diff(test) != 0))[test]
        usual = 60.0 * np.array([*minutes, np.inf])[np.minimum(place, max(len(minutes) - 1, 0))]
        return np.asarray(np.where(np.isfinite(stated[rows]), stated[rows], usual))

    def _stop(self, stated: np.ndarray, rows: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Time without load before each row [s] (n,)."""
        protocol = self.scenario.protocol
        usual = protocol.stop if protocol else 0.0
        usual = usual if self.card.protocol.stop_min is None else 60.0 * self.card.protocol.stop_min
        return np.asarray(np.where(first, 0.0, np.where(np.isfinite(stated[rows]), stated[rows], usual)))


def _one_way(sensor: Sensor, direction: np.ndarray) -> Sensor:
    """The sensor with one sign where the power flows one way in all rows (n,)."""
    if (direction < 0).any() and (direction >= 0).any():
        return sensor
    sign = sensor.signs[1] if (direction < 0).any() else sensor.signs[0]
    return replace(sensor, signs=(sign, sign))


def _with_unread(campaign: Campaign) -> Campaign:
    """The campaign with the rows that its usual course has and a test lacks, before any that was read.

    Such a row has the given values of the next one, no reading, and 0 for its line and point. Without it a test would
    start cold where it was warm. A campaign of steady states stays as it is.
    """
    steps = [(float(d), float(t)) for d, t in zip(campaign.direction, campaign.dwell, strict=True)]
    rows = [np.flatnonzero(campaign.test == test).tolist() for test in range(campaign.n_tests)]
    courses = Counter(tuple(steps[row] for row in own) for own in rows)
    usual, times = courses.most_common(1)[0]
    if campaign.steady or len(usual) < 2 or times < USUAL * campaign.n_tests:
        return campaign
    plan = [entry for own in rows for entry in _complete_test(own, [steps[row] for row in own], usual)]
    if all(step is None for _, step in plan):
        return campaign
    inside = np.diff(campaign.test) == 0
    rooms = [s.name for s in campaign.given if s.kind == "ambient"]
    return _build(campaign, plan, {n: float(np.nanmedian(np.diff(campaign.values[n])[inside])) for n in rooms})


def _complete_test(own: Sequence[int], steps: Sequence[Step], usual: Sequence[Step]) -> list[tuple[int, Step | None]]:
    """Rows of a test, with the step of the usual course before each that is missing: (row it is made of, step)."""
    plan: list[tuple[int, Step | None]] = []
    left = list(usual)
    for row, step in zip(own, steps, strict=True):
        if step not in left:
            return [(row, None) for row in own]  # it did not run as usual
        while left[0] != step:
            plan.append((row, left.pop(0)))
        plan.append((row, None))
        left.pop(0)
    return plan


def _build(campaign: Campaign, plan: Sequence[tuple[int, Step | None]], change: Mapping[str, float]) -> Campaign:
    """The campaign with the rows of a plan; `change` is the median from each reading of a room to the next [K]."""
    source = np.array([row for row, _ in plan])
    unread = np.array([step is not None for _, step in plan])
    turned = np.array([1.0 if step is None else step[0] * campaign.direction[row] for row, step in plan])
    first = np.append(True, np.diff(campaign.test[source]) != 0)
    stop = float(np.median(campaign.stop[campaign.stop > 0])) if (campaign.stop > 0).any() else 0.0
    own = np.where(campaign.stop[source] > 0, campaign.stop[source], stop)
    tests = sorted({int(test) for test in campaign.test[source[unread]]})
    numbers = ", ".join(str(int(campaign.order[test])) for test in tests)
    return replace(
        campaign,
        values={s.name: _column(campaign, s, source, unread, turned, change) for s in campaign.sensors},
        test=campaign.test[source],
        direction=np.array([campaign.direction[row] if step is None else step[0] for row, step in plan]),
        dwell=np.array([campaign.dwell[row] if step is None else step[1] for row, step in plan]),
        stop=np.where(first, 0.0, own),
        lines=np.where(unread, UNREAD, campaign.lines[source]),
        points=np.where(unread, UNREAD, campaign.points[source]),
        others={name: tuple(column[row] for row in source) for name, column in campaign.others.items()},
        warnings=(
            *campaign.warnings,
            f"{campaign.name}: rows are missing in the tests of order {numbers}. They are taken to have been run like"
            " the others, without a reading.",
        ),
    )


def _column(
    campaign: Campaign,
    sensor: Sensor,
    source: np.ndarray,
    unread: np.ndarray,
    turned: np.ndarray,
    change: Mapping[str, float],
) -> np.ndarray:
    """Values of a sensor over the rows of the plan (n,)."""
    values = campaign.values[sensor.name][source]
    if sensor.role == "read":
        return np.asarray(np.where(unread, np.nan, values))
    signed = sensor.kind == "torque" and sensor.signs == (1.0, 1.0)
    made = values * (turned if signed else 1.0) - change.get(sensor.name, 0.0)
    return np.asarray(np.where(unread, made, values))
