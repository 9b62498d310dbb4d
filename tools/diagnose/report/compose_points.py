"""From what a search found to points: those that were repeated, and what instruments will show at others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..campaign.repeats import Repeat as Repeated
from ..campaign.repeats import repeats, scatters
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


def repeated(campaign: Campaign) -> tuple[RepeatedPoint, ...]:
    """Points that were measured in several tests, each sensor in running order, as deviations from the point's mean."""
    groups = repeats(campaign)
    stated = {s.sensor: s.stated for s in scatters(campaign, groups)}
    both = bool((campaign.direction < 0).any())
    told = []
    for group in groups:
        tests = [int(np.flatnonzero(campaign.order == order)[0]) for order in group.order]
        for sensor in campaign.read:
            unit, total, difference = channels.difference(sensor, 1.0), group.total[sensor.name], group.difference
            sums, apart = (unit * (v - np.nanmean(v)) for v in (total, difference[sensor.name]))
            told.append(
                RepeatedPoint(
                    condition=condition(campaign, group),
                    channel=sensor.name,
                    unit=channels.unit_of_difference(sensor),
                    repeats=tuple(
                        Repeat(test=k + 1, order=float(order), date=campaign.date[k], sum=a, difference=b)
                        for k, order, a, b in zip(tests, group.order, _known(sums), _known(apart, both), strict=True)
                    ),
                    sd=float(np.nanstd(sums, ddof=1)),
                    card=unit * stated[sensor.name] / (2**0.5 if both else 1.0),
                )
            )
    return tuple(told)


def _known(values: np.ndarray, at_all: bool = True) -> list[float | None]:
    """Numbers, None for those that there are not."""
    return [float(v) if at_all and np.isfinite(v) else None for v in values]


def condition(campaign: Campaign, point: Repeated) -> str:
    """What drives a point, in words."""
    said = [point.oil] if point.oil else []
    for name, value in point.conditions.items():
        sensor = campaign.sensor(name)
        said.append(f"{float(channels.in_unit(sensor, np.array(value))):.0f} {channels.unit(sensor)}")
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
