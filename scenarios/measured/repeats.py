"""Repeated points in running order: what each sensor shows at the same conditions, against its stated accuracy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .table import Campaign, Sensor

#: Given conditions nearer than this part of their range are the same point [1].
NEAR_RANGE = 0.05
#: Given conditions nearer than this part of their size are the same point [1].
NEAR_SIZE = 0.02
#: Fewer degrees of freedom say nothing about a scatter.
LEAST = 3


@dataclass(frozen=True)
class Repeat:
    """Tests that ran at the same given conditions, in running order.

    Args:
        conditions: given sensor, rooms left out -> mean magnitude [SI]
        oil: of the tests, mountings may differ
        order: running order of each test (n,)
        mounting: of each test (n,)
        total, difference: read sensor -> mean of what it shows in both directions, and half their difference (n,) [SI]:
            temperatures over the room; without directions the difference is zero
    """

    conditions: Mapping[str, float]
    oil: str
    order: np.ndarray
    mounting: tuple[str, ...]
    total: Mapping[str, np.ndarray]
    difference: Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Scatter:
    """Standard deviation of one reading of a sensor by repeated points, and by the card [SI].

    Args:
        sensor: name
        total, difference: of the sum and of the difference of the directions, each as that of a single reading;
            NaN with fewer than three degrees of freedom, the difference without directions
        stated: that of the card: its own and, for a temperature, the room's
        freedom: degrees of freedom of the sum
    """

    sensor: str
    total: float
    difference: float
    stated: float
    freedom: int


def repeats(campaign: Campaign) -> tuple[Repeat, ...]:
    """Groups of tests at the same given conditions; rows that were run and not read count where they were run."""
    keys = _conditions(campaign)
    groups: list[list[int]] = []
    for test in range(campaign.n_tests):
        same = next((g for g in groups if _same(keys[g[0]], keys[test])), None)
        if same is None:
            groups.append([test])
        else:
            same.append(test)
    return tuple(_repeat(campaign, group) for group in groups if len(group) > 1)


def scatters(campaign: Campaign, found: Sequence[Repeat]) -> tuple[Scatter, ...]:
    """Scatter of each read sensor over repeated points, against the card's.

    Args:
        campaign: the readings
        found: its repeated points
    """
    rooms = [s.repeat_sd for s in campaign.given if s.kind == "ambient"]
    made = []
    for sensor in campaign.read:
        total, freedom = _pool([group.total[sensor.name] for group in found])
        difference, _ = _pool([group.difference[sensor.name] for group in found])
        both = bool((campaign.direction < 0).any())
        room = rooms[0] if rooms and sensor.kind.endswith("_temp") else 0.0
        stated = float(np.hypot(sensor.repeat_sd, room))
        scale = 2**0.5 if both else 1.0
        made.append(Scatter(sensor.name, scale * total, scale * difference if both else np.nan, stated, freedom))
    return tuple(made)


def _pool(groups: Sequence[np.ndarray]) -> tuple[float, int]:
    """Pooled standard deviation of values in groups, and its degrees of freedom."""
    known = [values[np.isfinite(values)] for values in groups]
    freedom = sum(len(values) - 1 for values in known if len(values) > 1)
    squares = sum(float(np.sum((values - values.mean()) ** 2)) for values in known if len(values) > 1)
    return (float(np.sqrt(squares / freedom)) if freedom >= LEAST else np.nan), freedom


Key = tuple[tuple[int, ...], tuple[tuple[float, float], ...], str]


def _conditions(campaign: Campaign) -> list[Key]:
    """For each test: directions of its rows, given values with their tolerance, oil."""
    drives = [s for s in campaign.given if s.kind != "ambient"]
    near = {s.name: _tolerance(campaign.values[s.name]) for s in drives}
    keys: list[Key] = []
    for test in range(campaign.n_tests):
        rows = np.flatnonzero(campaign.test == test)
        values = tuple((float(abs(campaign.values[s.name][row])), near[s.name]) for row in rows for s in drives)
        keys.append((tuple(int(d) for d in campaign.direction[rows]), values, campaign.oil[test]))
    return keys


def _tolerance(values: np.ndarray) -> float:
    """How near two values of a given sensor are that were meant to be the same."""
    sizes = np.abs(values)
    return float(min(NEAR_RANGE * np.ptp(sizes), NEAR_SIZE * np.max(sizes))) or NEAR_SIZE * float(np.max(sizes))


def _same(a: Key, b: Key) -> bool:
    (steps_a, values_a, oil_a), (steps_b, values_b, oil_b) = a, b
    if (steps_a, oil_a) != (steps_b, oil_b):
        return False
    return all(abs(x - y) <= near for (x, near), (y, _) in zip(values_a, values_b, strict=True))


def _repeat(campaign: Campaign, tests: Sequence[int]) -> Repeat:
    rows = [np.flatnonzero(campaign.test == test) for test in tests]
    drives = [s for s in campaign.given if s.kind != "ambient"]
    halves = {s.name: [_directions(campaign, s, own) for own in rows] for s in campaign.read}
    return Repeat(
        conditions={s.name: float(np.mean(np.abs(campaign.values[s.name][np.concatenate(rows)]))) for s in drives},
        oil=campaign.oil[tests[0]],
        order=campaign.order[list(tests)],
        mounting=tuple(campaign.mounting[test] for test in tests),
        total={name: np.array([(a + b) / 2 for a, b in pairs]) for name, pairs in halves.items()},
        difference={name: np.array([(a - b) / 2 for a, b in pairs]) for name, pairs in halves.items()},
    )


def _directions(campaign: Campaign, sensor: Sensor, rows: np.ndarray) -> tuple[float, float]:
    """Mean of what a sensor shows in the forward and in the reverse direction of a test; the same where it has one."""
    values = campaign.values[sensor.name][rows]
    rooms = [s.name for s in campaign.given if s.kind == "ambient"]
    if sensor.kind.endswith("_temp") and rooms:
        values = values - campaign.values[rooms[0]][rows]
    reverse = campaign.direction[rows] < 0
    if not reverse.any():
        return float(np.mean(values)), float(np.mean(values))
    forward = float(np.mean(values[~reverse])) if (~reverse).any() else np.nan
    return forward, float(np.mean(values[reverse]))
