"""From what a search found to points: those that were repeated, and what instruments will show at others."""

from __future__ import annotations

import numpy as np

from ..answer import predict
from ..campaign.table import Campaign
from ..infer.search import Found
from ..setting import Setting
from . import channels
from .findings import Prediction
from .quality import Repeat, RepeatedPoint

#: Readings of a given sensor that differ by less than this share of the largest are of one point.
SAME = 0.03
#: Kinds of sensors that say which point it is.
POINT = ("speed", "torque", "power")


def repeated(found: Found) -> tuple[RepeatedPoint, ...]:
    """Points that were measured in several tests, as deviations from the calibrated model in running order."""
    problem, o, c = found.problem, found.problem.data, found.problem.data.campaign
    left = (problem.measured - found.null.look.shown)[problem.own]
    told = []
    for tests in same_points(c):
        for i, sensor in enumerate(o.read):
            mine, unit = o.kind == i, channels.difference(sensor, 1.0)
            line = np.full(c.n, np.nan)
            line[o.row[mine]] = unit * left[mine]
            repeats = tuple(r for k in tests if (r := _repeat(c, k, line)) is not None)
            if len(repeats) > 1:
                sd = float(np.std([r.sum for r in repeats if r.sum is not None], ddof=1))
                card = unit * sensor.repeat_sd / float(np.sqrt(np.count_nonzero(c.test == tests[0])))
                told.append(
                    RepeatedPoint(
                        condition=condition(c, tests[0]),
                        channel=sensor.name,
                        unit=channels.unit_of_difference(sensor),
                        repeats=repeats,
                        sd=sd,
                        card=card,
                    )
                )
    return tuple(told)


def _repeat(c: Campaign, test: int, left: np.ndarray) -> Repeat | None:
    """One repetition: mean of the directions, and half of what they differ."""
    mine = (c.test == test) & np.isfinite(left)
    if not mine.any():
        return None
    forward, backward = (left[mine & (side * c.direction > 0)] for side in (1, -1))
    mean, difference = float(left[mine].mean()), None
    if len(forward) and len(backward):
        mean, difference = (float(forward.mean() + side * backward.mean()) / 2 for side in (1, -1))
    return Repeat(test=test + 1, order=float(c.order[test]), date=c.date[test], sum=mean, difference=difference)


def same_points(c: Campaign) -> list[list[int]]:
    """Tests of the same oil at the same speeds and loads, where there are several."""
    driven = [np.abs(c.values[s.name]) for s in c.given if s.kind in POINT]
    if not driven:
        return []
    points = np.array([[np.nanmean(v[c.test == k]) for v in driven] for k in range(c.n_tests)])
    points /= np.maximum(np.nanmax(points, axis=0), 1e-12)
    groups: list[list[int]] = []
    for k in range(c.n_tests):
        alike = (g for g in groups if c.oil[g[0]] == c.oil[k] and np.all(np.abs(points[g[0]] - points[k]) < SAME))
        if (own := next(alike, None)) is not None:
            own.append(k)
        else:
            groups.append([k])
    return [g for g in groups if len(g) > 1]


def condition(c: Campaign, test: int) -> str:
    """What drives a test, in words."""
    said = [c.oil[test]] if c.oil[test] else []
    for s in (s for s in c.given if s.kind in POINT):
        value = float(np.nanmean(channels.in_unit(s, np.abs(c.values[s.name]))[c.test == test]))
        said.append(f"{value:.0f} {channels.unit(s)}")
    return ", ".join(said)


def predictions(setting: Setting, found: Found, points: Campaign) -> tuple[Prediction, ...]:
    """What the instruments will show at points, where the machine can be run.

    Args:
        setting: the rig
        found: the search
        points: their conditions
    """
    read = found.problem.data.read
    tables = [
        [channels.in_unit(s, row) for s, row in zip(read, table, strict=True)]
        for table in predict.predictions(setting, found, points)
    ]
    told = []
    for row in range(points.n):
        both = [{s.name: float(line[row]) for s, line in zip(read, t, strict=True)} for t in tables]
        stated = points.points[row] > 0  # else a row that a test lacks
        if stated and all(np.isfinite(v) for values in both for v in values.values()):
            told.append(Prediction(point=str(int(points.points[row])), nominal=both[0], extended=both[1]))
    return tuple(told)
