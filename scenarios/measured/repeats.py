"""Repeated points in running order: what each sensor shows at the same conditions beyond what a model says of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .table import Campaign, Sensor

#: Given conditions nearer than this part of their range are the same point [1].
NEAR_RANGE = 0.05
#: Given conditions nearer than this part of their size are the same point [1].
NEAR_SIZE = 0.02


@dataclass(frozen=True)
class Repeat:
    """Tests that ran at the same given conditions, in running order.

    Args:
        conditions: given sensor, rooms left out -> mean magnitude [SI]
        oil: of the tests, mountings may differ
        tests: their numbers, from 0 (n,)
        total, difference: read sensor -> mean in both directions of what it shows beyond the model, and half their
            difference (n,) [SI], each less its mean; NaN where there is none
    """

    conditions: Mapping[str, float]
    oil: str
    tests: Sequence[int]
    total: Mapping[str, np.ndarray]
    difference: Mapping[str, np.ndarray]


def repeats(campaign: Campaign, left: Mapping[str, np.ndarray]) -> tuple[Repeat, ...]:
    """Groups of tests at the same given conditions; rows that were run and not read count where they were run.

    Args:
        campaign: the readings
        left: read sensor -> what it shows less what a model says of it (n,) [SI]
    """
    keys = _conditions(campaign)
    groups: list[list[int]] = []
    for test in range(campaign.n_tests):
        same = next((g for g in groups if _same(keys[g[0]], keys[test])), None)
        if same is None:
            groups.append([test])
        else:
            same.append(test)
    return tuple(_repeat(campaign, left, group) for group in groups if len(group) > 1)


def stated(campaign: Campaign, sensor: Sensor) -> float:
    """Standard deviation by the card of one reading less a model [SI]: its own and, of a temperature, the room's.

    Args:
        campaign: the readings
        sensor: one that is compared
    """
    rooms = [s.repeat_sd for s in campaign.given if s.kind == "ambient"]
    return float(np.hypot(sensor.repeat_sd, rooms[0] if rooms and sensor.kind.endswith("_temp") else 0.0))


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


def _repeat(campaign: Campaign, left: Mapping[str, np.ndarray], tests: Sequence[int]) -> Repeat:
    rows = [np.flatnonzero(campaign.test == test) for test in tests]
    drives = [s for s in campaign.given if s.kind != "ambient"]
    reverse = campaign.direction < 0
    halves = {s.name: np.array([_directions(left[s.name][k], reverse[k]) for k in rows]) for s in campaign.read}
    return Repeat(
        conditions={s.name: float(np.mean(np.abs(campaign.values[s.name][np.concatenate(rows)]))) for s in drives},
        oil=campaign.oil[tests[0]],
        tests=tests,
        total={name: _centred(pair.sum(axis=1) / 2) for name, pair in halves.items()},
        difference={name: _centred(-np.diff(pair)[:, 0] / 2) for name, pair in halves.items()},
    )


def _directions(values: np.ndarray, reverse: np.ndarray) -> tuple[float, float]:
    """Means in the forward and in the reverse direction of a test; the same where it has one."""
    means = [float(np.mean(values[way])) for way in (~reverse, reverse) if way.any()]
    return means[0], means[-1]


def _centred(values: np.ndarray) -> np.ndarray:
    """Values less their mean."""
    return values - np.nanmean(values) if np.isfinite(values).any() else values
