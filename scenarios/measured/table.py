"""A campaign as arrays: rows of readings in tests, sensors with roles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np


@dataclass(frozen=True)
class Sensor:
    """One instrument: a column of the user's file and what it reads of the model.

    Args:
        name: stable name of the rig file ("T_oil")
        column: column of the user's file ("Ölsumpf")
        reads: path of an input, state or output of the model ("oil.T")
        kind: what it is, "oil_temp" or another of `tables.Kind`; "wall_temp" of any body
        role: "given" drives the model, "read" is compared
        unit: of the column
        repeat_sd: scatter from reading to reading [SI]
        offset_sd: tolerance that is fixed over the campaign [SI]
        checked: whether it was compared with a reference and found right
        signs: sign of the model's value in direction +1 and -1 where the column holds magnitudes, else (1, 1)
    """

    name: str
    column: str
    reads: str
    kind: str
    role: str
    unit: str
    repeat_sd: float
    offset_sd: float
    checked: bool = False
    signs: tuple[float, float] = (1.0, 1.0)

    def sign(self, direction: np.ndarray) -> np.ndarray:
        """Sign of the model's value over that of the column, per row (n,)."""
        return np.where(direction < 0, self.signs[1], self.signs[0])


#: Last tests in which a sensor that hangs shows the same.
STILL = 3
#: How far apart scatter brings their readings, in standard deviations.
SPREAD = 6.0
#: Places in a dwell at which its logged course is compared, as shares of the stated dwell.
PLACES = (0.08, 0.25, 0.6)


class Sensed:
    """What holds readings of sensors."""

    sensors: tuple[Sensor, ...]

    @property
    def given(self) -> tuple[Sensor, ...]:
        """Sensors that drive the model."""
        return tuple(s for s in self.sensors if s.role == "given")

    @property
    def read(self) -> tuple[Sensor, ...]:
        """Sensors that are compared."""
        return tuple(s for s in self.sensors if s.role == "read")

    def driving(self, kind: str) -> Sensor | None:
        """The first given sensor of a kind; None without one."""
        return next((s for s in self.given if s.kind == kind), None)


@dataclass(frozen=True, eq=False)
class Course:
    """What one compared sensor showed along the dwell of one row, at the k `PLACES`.

    Args:
        row: of the campaign
        sensor: its name
        values: of a smooth curve through all samples (k,), in SI; NaN at places that were not logged
        scatter: covariance of the values (k, k), as a share of the variance of one sample
    """

    row: int
    sensor: str
    values: np.ndarray
    scatter: np.ndarray


@dataclass(frozen=True, eq=False)
class Series:
    """Logged courses of the tests of a campaign.

    Args:
        name: of the file
        courses: of rows and sensors
        dwell: how long each row was held by the log [s] (n,), NaN where it was not logged
        warnings: what the user should know of the file
    """

    name: str
    courses: tuple[Course, ...]
    dwell: np.ndarray
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Campaign(Sensed):
    """Steady or timed readings of one rig: n rows in n_tests tests, tests in running order, rows of a test in sequence.

    Args:
        name: of the file
        sensors: what was measured
        values: sensor -> column in SI with the signs of the column (n,), NaN where a reading is missing
        test: index of each row's test (n,), never falling
        order: running order of each test (n_tests,), as in the file
        direction: +1, -1, or 0 where there is none (n,)
        dwell: time each row was held [s] (n,), inf for a steady state
        stop: time without load before each row [s] (n,), 0 for the first of a test
        oil: name of each test's oil (n_tests), "" for that of the rig
        mounting: filling or mounting of each test (n_tests), "" where there is one only
        T_start: temperature of the whole gearbox at the start of each test [K] (n_tests,), NaN: that of the room
        room_start: room at the start of each test [K] (n_tests,), NaN: as at the first reading
        start_by_room: start temperature less that of the room where it was not measured, as the card states it [K]
        room_begin: room at the start of a test less its first reading where it was not measured [K]
        humidity: relative humidity [1] (n_tests,), NaN where it is not known
        date: of each test (n_tests), "" where unknown
        lines: line of each row in the file (n,)
        points: number of each row's reading as in the file (n,), 0 where a row was run and not read
        names: of the tests, as in the file (n_tests)
        ordered: whether the file states the running order
        others: columns that no sensor has, as they stand in the file (n)
        series: logged courses of its tests, None where there are none
    """

    name: str
    sensors: tuple[Sensor, ...]
    values: Mapping[str, np.ndarray]
    test: np.ndarray
    order: np.ndarray
    direction: np.ndarray
    dwell: np.ndarray
    stop: np.ndarray
    oil: tuple[str, ...]
    mounting: tuple[str, ...]
    T_start: np.ndarray
    room_start: np.ndarray
    humidity: np.ndarray
    date: tuple[str, ...]
    lines: np.ndarray
    points: np.ndarray
    start_by_room: float = 0.0
    room_begin: float = 0.0
    names: tuple[str, ...] = ()
    ordered: bool = True
    others: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    warnings: tuple[str, ...] = field(default=())
    series: Series | None = None

    @classmethod
    def of(
        cls, name: str, sensors: Iterable[Sensor], values: Mapping[str, np.ndarray], test: np.ndarray, **more: Any
    ) -> Self:
        """Steady states in the order of their tests, with nothing else known but what is given.

        Args:
            name, sensors, values, test: as of a campaign
            more: the same
        """
        n, k = len(test), int(test.max()) + 1
        number = np.arange(1, n + 1)
        usual: dict[str, Any] = {"order": np.arange(1.0, k + 1), "direction": np.zeros(n), "dwell": np.full(n, np.inf)}
        usual |= {"stop": np.zeros(n), "lines": number + 1, "points": number}
        usual |= dict.fromkeys(("T_start", "room_start", "humidity"), np.full(k, np.nan))
        usual |= dict.fromkeys(("oil", "mounting", "date"), ("",) * k)
        return cls(name, tuple(sensors), values, test, **usual | more)

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(self.test)

    @property
    def n_tests(self) -> int:
        """Number of tests."""
        return len(self.order)

    @property
    def steady(self) -> bool:
        """Whether the readings are steady states, not ends of timed dwells."""
        return bool(np.isinf(self.dwell).all())

    def sensor(self, name: str) -> Sensor:
        """The sensor of a name."""
        return next(s for s in self.sensors if s.name == name)

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the tests: as in the file where all have one, else their places in the running order."""
        counted = bool(self.names) and all(name.isdigit() for name in self.names)
        return tuple(map(int, self.names)) if counted else tuple(range(1, self.n_tests + 1))

    def range_of(self, kind: str) -> tuple[float, float] | None:
        """Least and largest magnitude of the first given sensor of a kind; None without one."""
        sensor = self.driving(kind)
        if sensor is None:
            return None
        values = np.abs(self.values[sensor.name])
        return float(np.nanmin(values)), float(np.nanmax(values))

    def still(self, sensor: Sensor) -> bool:
        """Whether a sensor shows about the same in the last tests, or what it shows is not known."""
        values = self.values[sensor.name][np.argsort(self.order[self.test], kind="stable")]
        values = values[np.isfinite(values)]
        last = values[-max(STILL * len(values) // max(self.n_tests, 1), 2) :]
        return not len(values) or bool(np.ptp(last) <= SPREAD * sensor.repeat_sd)

    @property
    def progress(self) -> np.ndarray:
        """Running order of each row from 0 (first test) to 1 (last)."""
        return np.asarray(self.places(self.order)[self.test])

    def places(self, order: np.ndarray) -> np.ndarray:
        """The same of running orders (k,); those of its first test where all its tests have the same."""
        return np.asarray((order - self.order.min()) / (np.ptp(self.order) or 1.0))
