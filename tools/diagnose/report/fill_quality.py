"""What a search found of the data and the rig, as findings: values far off, scatter, repeated points, adequacy."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from ...model.units import from_si
from ...scenarios.scenario import Scenario
from ..campaign.table import Campaign
from ..infer.evidence import White
from ..infer.fit import Fit
from ..infer.problem import Problem
from ..infer.search import Hypothesis
from .fill_rows import by_row
from .findings import Calibrated
from .quality import NuisanceOff, Repeat, RepeatedPoint, VarianceComponent
from .shown import Scale, of_sensor

#: Prior standard deviations beyond which a value is told as off.
OFF = 2.5
#: Readings of a given sensor that differ by less than this share of the largest are of one point.
SAME = 0.03


def nuisances_off(problem: Problem, fit: Fit) -> tuple[NuisanceOff, ...]:
    """Values of the rig further off than 2.5 prior standard deviations, the furthest first."""
    found = []
    for nuisance, z in zip(problem.data.nuisances, fit.look.z, strict=False):
        if abs(z) > OFF:
            factor, paths = float(np.exp(nuisance.sd * z)), tuple(nuisance.paths)
            found.append(NuisanceOff(name=nuisance.name, z=float(z), factor=factor, paths=paths))
    return tuple(sorted(found, key=lambda n: -abs(n.z)))


def calibrated(problem: Problem, null: Fit, best: Fit, scenario: Scenario) -> tuple[Calibrated, ...]:
    """Values that the data moved, in the rig file's units."""
    known, found = scenario.settable(), []
    nominal, extended = values(problem, null), values(problem, best)
    for path, value in nominal.items():
        if path in known:
            unit = known[path].unit
            file = float(problem.data.plant.p[problem.data.plant.place[path]])
            shown = [float(from_si(v, unit)) for v in (file, value, extended[path])]
            with_causes = shown[2] if best.look.acting else None
            found.append(Calibrated(path=path, unit=unit, file=shown[0], nominal=shown[1], extended=with_causes))
    return tuple(found)


def values(problem: Problem, fit: Fit) -> dict[str, float]:
    """Values of the rig by path as a fit calibrates them [SI]."""
    plant, found = problem.data.plant, dict[str, float]()
    for nuisance, z in zip(problem.data.nuisances[: problem.nz], fit.look.z, strict=True):
        for path, exponent in nuisance.paths.items():
            before = found.get(path, float(plant.p[plant.place[path]]))
            found[path] = before * float(np.exp(exponent * nuisance.sd * z))
    return found


def variance(problem: Problem, fit: Fit) -> tuple[VarianceComponent, ...]:
    """Scatter as the card states it and as the data show it."""
    sensors = {f"readings of {s.name}": s for s in problem.data.campaign.sensors}
    found = []
    for term, log in zip(fit.noise.loose, fit.noise.scales, strict=True):
        sensor, ratio = sensors.get(term.name), float(np.exp(log))
        scale = of_sensor(sensor).difference if sensor else Scale("%", 100.0)
        card = scale.factor * (sensor.repeat_sd if sensor else problem.day_sd)
        name, channel = (f"a reading of {sensor.name}", sensor.name) if sensor else ("cooling from day to day", "")
        found.append(
            VarianceComponent(name=name, channel=channel, unit=scale.unit, card=card, found=ratio * card, ratio=ratio)
        )
    return tuple(found)


def repeated(problem: Problem, fit: Fit) -> tuple[RepeatedPoint, ...]:
    """Points that were measured in several tests, as deviations from a fit in running order."""
    o, c, own = problem.data, problem.data.campaign, problem.own
    found = []
    for tests in same_points(c):
        for i, sensor in enumerate(o.read):
            scale = of_sensor(sensor).difference
            left = scale(by_row(o, o.measured - fit.look.shown[own], i))
            repeats = tuple(r for k in tests if (r := _repeat(c, k, left)) is not None)
            if len(repeats) < 2:
                continue
            sums = [r.sum for r in repeats if r.sum is not None]
            rows = np.count_nonzero(c.test == tests[0])
            found.append(
                RepeatedPoint(
                    condition=condition(c, tests[0]),
                    channel=sensor.name,
                    unit=scale.unit,
                    repeats=repeats,
                    sd=float(np.std(sums, ddof=1)),
                    card=scale.factor * sensor.repeat_sd / float(np.sqrt(rows)),
                )
            )
    return tuple(found)


def _repeat(c: Campaign, test: int, left: np.ndarray) -> Repeat | None:
    """One repetition: mean of all rows, and half of what the directions differ."""
    mine = (c.test == test) & np.isfinite(left)
    if not mine.any():
        return None
    forward, backward = (left[mine & (side * c.direction > 0)] for side in (1, -1))
    both = len(forward) and len(backward)
    mean = (forward.mean() + backward.mean()) / 2 if both else left[mine].mean()
    difference = (forward.mean() - backward.mean()) / 2 if both else None
    return Repeat(test=test + 1, order=float(c.order[test]), date=c.date[test], sum=float(mean), difference=difference)


def same_points(c: Campaign) -> list[list[int]]:
    """Tests of the same oil at the same speeds and loads, where there are several."""
    driven = [np.abs(c.values[s.name]) for s in c.given if s.kind in ("speed", "torque", "power")]
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
    for s in (s for s in c.given if s.kind in ("speed", "torque", "power")):
        scale = of_sensor(s)
        said.append(f"{abs(float(np.nanmean(scale(c.values[s.name])[c.test == test]))):.0f} {scale.unit}")
    return ", ".join(said)


def adequacy(problem: Problem, hypothesis: Hypothesis) -> tuple[float, dict[str, float]]:
    """p of what is left after a hypothesis: of all readings, and of each channel.

    Args:
        problem: data and model
        hypothesis: with what stands beside its causes as scatter
    """
    white, e = hypothesis.fit.linear(problem)
    V, r = white.L @ white.L.T, white.L @ e
    if hypothesis.extra is not None:
        V = V + hypothesis.extra.covariance
    o, known = problem.data, np.zeros(problem.m, dtype=bool)
    known[problem.own] = True
    parts = {s.name: np.flatnonzero(known)[o.kind == i] for i, s in enumerate(o.read)}
    return _p(V, r, np.arange(problem.m)), {name: _p(V, r, k) for name, k in parts.items() if len(k)}


def _p(V: np.ndarray, r: np.ndarray, places: np.ndarray) -> float:
    e = White.of(V[np.ix_(places, places)])(r[places])
    return float(chi2.sf(e @ e, len(places)))
