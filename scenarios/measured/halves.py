"""Rows that were run and not read: where a test lacks one that nearly all others have, it took place all the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from .table import Campaign, Sensor

#: Share of the tests that must have run alike, for one that lacks a row to be taken to have run like them.
USUAL = 0.5
#: Number of a row that is not in the file.
UNREAD = 0

Step = tuple[float, float]


def with_unread(campaign: Campaign) -> Campaign:
    """The campaign with the rows that its usual course has and a test lacks, before any that was read.

    Such a row has the given values of the next one, no reading, and 0 for its line and point. Without it a test would
    start cold where it was warm.

    Args:
        campaign: of timed tests; one of steady states is given back as it is
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
