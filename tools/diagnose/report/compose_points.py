"""From what a search found to points: those that were repeated, and what instruments will show at others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..campaign.table import Campaign
from ..infer.evidence import White
from ..infer.fit import Fit
from ..infer.problem import Problem
from ..infer.search import Found, Hypothesis
from ..model.noise import terms
from ..model.observe import Observed
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


def predictions(setting: Setting, found: Found, h: Hypothesis, points: Campaign) -> tuple[Prediction, ...]:
    """What the instruments will show at points: calibrated without a cause, and with a hypothesis.

    Args:
        setting: the rig
        found: the search
        h: the hypothesis
        points: their conditions
    """
    data, read = found.problem.data, found.problem.data.read
    guess = {s.name: np.full(points.n, float(np.nanmean(data.campaign.values[s.name]))) for s in read}
    for _ in range(2):  # causes that follow the readings take those of the calibrated model
        filled = replace(points, sensors=(*points.given, *read), values={**points.values, **guess})
        o = Observed(setting.plant, filled, data.nuisances, setting.oils, setting.scenario.operating_point)
        nominal = _predicted(found.problem, found.null, o)
        guess = {s.name: nominal[i] for i, s in enumerate(read)}
    extended = _predicted(found.problem, h.fit, o)
    both = [[channels.in_unit(s, table[i]) for i, s in enumerate(read)] for table in (nominal, extended)]
    names = [s.name for s in read]
    return tuple(
        Prediction(point=str(int(points.points[r])), nominal=_at(names, both[0], r), extended=_at(names, both[1], r))
        for r in range(points.n)
    )


def _at(names: Sequence[str], columns: Sequence[np.ndarray], row: int) -> dict[str, float]:
    return {name: float(column[row]) for name, column in zip(names, columns, strict=True)}


def _predicted(problem: Problem, fit: Fit, o: Observed) -> np.ndarray:
    """Readings (read, n) at further points: the model, and what tolerances and remainder make of the data there."""
    seen = o.at(np.append(fit.look.z, 0.0), [(a.formula, a.t) for a in fit.look.acting])
    joint = terms([*problem.campaigns, o], [*fit.look.seen, seen], problem.day_sd, problem.nz)
    scales = {t.name: s for t, s in zip(fit.noise.loose, fit.noise.scales, strict=True)}
    known = {t.name for t in fit.noise.terms}
    V = sum(np.exp(2 * scales.get(t.name, 0.0)) * t.matrix for t in joint if t.name in known)
    white = White.of(fit.noise.covariance)
    told = V[problem.m :, : problem.m] @ white.back(problem.measured - fit.look.shown)
    table = np.full((len(o.read), o.campaign.n), np.nan)
    table[o.kind, o.row] = seen.shown + told
    return table
