"""Simulated readings beside measured ones: errors by channel and group, noise floor and rivals.

A row is one reading: a mapping with the simulated columns (temperatures that end in `_C`, `loss_Nm`), the measured ones
under the same name with the suffix `_meas`, and what the reading belongs to (`test`, `direction`, `oil`, `grid`,
`n_set_rpm`, `T_set_Nm`). Where the simulated values came from is not asked.

Plain statistical rivals of the simulation are fitted to the measured readings by least squares. A simulation is worth
its trouble only if it does better than these, and better means: on tests it was not fitted to.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.errors import DataError

Row = Mapping[str, Any]
Rows = Sequence[Row]
#: Column of the room.
ROOM = "T_amb_C"
#: Largest difference of the rooms of repeats [K]: beyond it, the model would be compared.
NEAR_ROOM = 5.0
#: What readings are grouped by, with the words for it.
GROUPINGS = {
    "grid": "grid",
    "n_set_rpm": "speed",
    "T_set_Nm": "torque",
    "oil": "oil",
    "direction": "direction",
}


@dataclass(frozen=True)
class Channel:
    """One thing that is measured and simulated. `relative_to` is the column of what it rises over."""

    key: str
    column: str
    label: str
    short: str
    unit: str
    relative_to: str | None = None

    @property
    def measured(self) -> str:
        """Column of the measured value."""
        return f"{self.column}_meas"


#: The channel of the losses, beside those of the thermometers.
LOSS = Channel("loss_Nm", "loss_Nm", "loss torque", "loss", "N.m")


@dataclass(frozen=True)
class Group:
    """Errors (simulated minus measured) of one channel over the readings of one group."""

    by: str
    value: Any
    channel: str
    n: int
    mean: float
    rms: float


@dataclass(frozen=True)
class Comparison:
    """Rows with their errors: over all readings (group "all") and by grid, speed, torque, oil and direction."""

    rows: Rows
    channels: tuple[Channel, ...]
    groups: tuple[Group, ...]
    noise_floor: Mapping[str, Any]

    def rmse(self) -> dict[str, dict[str, float]]:
        """Root-mean-square errors per channel: "overall" and per grid."""
        table: dict[str, dict[str, float]] = {}
        for group in self.groups:
            if group.by in ("all", "grid"):
                table.setdefault("overall" if group.by == "all" else str(group.value), {})[group.channel] = group.rms
        return table


def numbers(rows: Rows, column: str) -> np.ndarray:
    """A column as float array; NaN where a row lacks it or holds nothing."""
    return np.array([math.nan if row.get(column) is None else float(row[column]) for row in rows])


def channels_of(rows: Rows) -> tuple[Channel, ...]:
    """The channels that the rows have measured values of: thermometers, then the loss torque."""
    names = dict.fromkeys(name.removesuffix("_meas") for row in rows for name in row if name.endswith("_C_meas"))
    warm = [
        Channel(f"{c[:-2]}_K", c, f"temperature {c[:-2]}", c[:-2], "K", ROOM if ROOM in rows[0] else None)
        for c in names
    ]
    return (*warm, *([LOSS] if any(LOSS.measured in row for row in rows) else []))


def present(rows: Rows) -> tuple[Channel, ...]:
    """The channels that at least one row has both simulated and measured."""
    return tuple(c for c in channels_of(rows) if np.isfinite(errors(rows, c)).any())


def errors(rows: Rows, channel: Channel) -> np.ndarray:
    """Simulated minus measured, one value per row, NaN where either is missing."""
    simulated, measured = numbers(rows, channel.column), numbers(rows, channel.measured)
    return np.asarray(simulated - measured)


def rms(values: np.ndarray) -> float:
    """Root mean square of the finite values; NaN for none."""
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else math.nan


def compare(rows: Rows) -> Comparison:
    """Errors of all channels, overall and by group, and the noise floor.

    Raises:
        DataError: no channel has a simulated and a measured value
    """
    if not (channels := present(rows)):
        raise DataError(
            f"There is nothing to compare in {len(rows)} rows. Expected a column such as T_oil_C with T_oil_C_meas."
        )
    found = [group for channel in channels for group in _groups(rows, channel)]
    return Comparison(tuple(rows), channels, tuple(found), noise_floor(rows))


def _groups(rows: Rows, channel: Channel) -> Iterator[Group]:
    """The channel's errors over all rows, then over each group of each grouping that the rows carry."""
    error = errors(rows, channel)
    yield _group("all", "all", channel, error)
    for by in GROUPINGS:
        values = [row.get(by) for row in rows]
        for value in distinct(values):
            yield _group(by, value, channel, error[[v == value for v in values]])


def _group(by: str, value: Any, channel: Channel, error: np.ndarray) -> Group:
    finite = error[np.isfinite(error)]
    mean = float(finite.mean()) if finite.size else math.nan
    return Group(by, value, channel.key, int(finite.size), mean, rms(error))


def distinct(values: Iterable[Any]) -> list[Any]:
    """Values without repetition and without None: numbers in rising order, texts in the order met."""
    found = list(dict.fromkeys(v for v in values if v is not None))
    return sorted(found) if all(isinstance(v, int | float) for v in found) else found


def repeats(rows: Rows) -> list[tuple[int, ...]]:
    """Positions of rows that repeat one operating point: same oil, set speed, set torque and direction, rooms near."""
    points: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(rows):
        key = tuple(row.get(name) for name in ("oil", "n_set_rpm", "T_set_Nm", "direction"))
        if None not in key:
            points.setdefault(key, []).append(i)
    near = [group for found in points.values() for group in _near(rows, found)]
    return [tuple(group) for group in near if len(group) > 1]


def _near(rows: Rows, found: Sequence[int]) -> list[list[int]]:
    """Rows in groups whose rooms differ by no more than `NEAR_ROOM`; all together where no room was read."""
    rooms = numbers(rows, ROOM)
    if not np.isfinite(rooms[list(found)]).all():
        return [list(found)]
    groups: list[list[int]] = []
    for i in sorted(found, key=lambda i: float(rooms[i])):
        if groups and rooms[i] - rooms[groups[-1][0]] <= NEAR_ROOM:
            groups[-1].append(i)
        else:
            groups.append([i])
    return sorted(sorted(group) for group in groups)


def noise_floor(rows: Rows) -> dict[str, Any]:
    """Standard deviation of one reading, from operating points that were measured more than once.

    Repeats never have quite the same room, speed, torque and history. What that does to a reading is taken out by the
    simulation, whose own error is the same in all repeats of a point: compared is measured minus simulated. For pairs
    it is rms(difference)/sqrt(2), both directions together.

    Returns:
        channel -> standard deviation; "repeated": the tests that repeat each other; "readings": how many there are
    """
    groups = repeats(rows)
    floor: dict[str, Any] = {}
    for channel in channels_of(rows):
        left = errors(rows, channel)
        squares = [left[list(group)].var(ddof=1) * (len(group) - 1) for group in groups]
        freedom = sum(len(group) - 1 for group in groups)
        if freedom and np.isfinite(squares).all():
            floor[channel.key] = math.sqrt(sum(squares) / freedom)
    tests = dict.fromkeys(tuple(rows[i].get("test") for i in group) for group in groups)
    return {**floor, "repeated": [list(group) for group in tests], "readings": sum(len(group) for group in groups)}


Design = Callable[[Rows, Channel, Sequence[str]], np.ndarray]


@dataclass(frozen=True)
class Rival:
    """A linear model: `design` gives its columns (n x coefficients) for rows, a channel and the columns that drive."""

    name: str
    doc: str
    design: Design


@dataclass(frozen=True)
class Score:
    """Root-mean-square errors per channel on the fitted readings, and on each test when it was left out of the fit."""

    name: str
    doc: str
    coefficients: dict[str, list[float]]
    in_sample: dict[str, float]
    leave_one_test_out: dict[str, float]


def _one_number(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Rise = computed loss power / alpha*A; loss torque = constant share of the given torque."""
    torques = [name for name in drives if name.endswith("_Nm")]
    source = "P_loss_W" if channel.relative_to is not None or not torques else torques[0]
    return np.asarray(np.abs(numbers(rows, source))[:, None])


def _linear(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Constant, speeds, torques."""
    return np.column_stack([np.ones(len(rows)), *(np.abs(numbers(rows, name)) for name in drives)])


def _linear_groups(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Constant, speed, torque, and an offset for each further direction and oil."""
    offsets = [
        [float(row.get(by) == value) for row in rows]
        for by in ("direction", "oil")
        for value in distinct(row.get(by) for row in rows)[1:]
    ]
    return np.column_stack([_linear(rows, channel, drives), *offsets])


RIVALS = (
    Rival(
        "constant_alphaA",
        "T - T_amb = computed P_loss / alphaA; loss torque a constant share of the given torque",
        _one_number,
    ),
    Rival("linear", "T - T_amb and loss torque linear in speed and torque", _linear),
    Rival("linear_groups", "linear in speed and torque, with an offset for each direction and oil", _linear_groups),
)


def rivals(rows: Rows, drives: Sequence[str]) -> tuple[Score, ...]:
    """Fit every rival to the measured readings.

    Args:
        rows: with `T_amb_C`, computed `P_loss_W`, `test`, and the measured columns; a rival is left out for a channel
            whose columns are missing
        drives: columns of the given speeds and torques
    """
    return tuple(_score(rival, rows, drives) for rival in RIVALS)


def _score(rival: Rival, rows: Rows, drives: Sequence[str]) -> Score:
    coefficients: dict[str, list[float]] = {}
    in_sample: dict[str, float] = {}
    left_out: dict[str, float] = {}
    for channel in channels_of(rows):
        design, target = rival.design(rows, channel, drives), _target(rows, channel)
        if not (np.isfinite(target).all() and np.isfinite(design).all()):
            continue
        fit = least_squares(design, target)
        coefficients[channel.key] = [float(c) for c in fit]
        in_sample[channel.key] = rms(design @ fit - target)
        left_out[channel.key] = rms(_cross_validate(design, target, [row.get("test") for row in rows]))
    return Score(rival.name, rival.doc, coefficients, in_sample, left_out)


def _target(rows: Rows, channel: Channel) -> np.ndarray:
    """Measured value of the channel, temperatures as rise over the room."""
    values = numbers(rows, channel.measured)
    return values if channel.relative_to is None else values - numbers(rows, channel.relative_to)


def least_squares(design: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Least-squares coefficients, of smallest norm where the readings do not determine them."""
    scale = np.maximum(np.abs(design).max(axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(design / scale, target, rcond=None)[0] / scale)


def _cross_validate(design: np.ndarray, target: np.ndarray, tests: Sequence[Any]) -> np.ndarray:
    """Error of each reading under the fit to all other tests (both directions of a test share a day and an oil)."""
    error = np.full(len(target), np.nan)
    for test in dict.fromkeys(tests):
        out = np.array([t == test for t in tests])
        if not out.all():
            error[out] = design[out] @ least_squares(design[~out], target[~out]) - target[out]
    return error
