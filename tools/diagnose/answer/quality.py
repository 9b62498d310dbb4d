"""What is to be known of data and rig before any cause is named.

Gross readings, values far off, scatter against the card, and tables of means of what the calibrated rig leaves.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from itertools import product
from typing import Any

import numpy as np

from ....scenarios.measured import repeats
from ....scenarios.measured.table import Campaign, Sensor
from ..infer.fit import Fit
from ..infer.found import Found, Hypothesis
from ..infer.problem import SET_ASIDE, Aside, Problem
from . import channels
from .decide import p_adequacy
from .evidence import DataQuality, GrossReading, NuisanceOff, Repeat, RepeatedPoint, ResidualMean, VarianceComponent
from .numbers import array

#: Prior standard deviations beyond which a value of the rig is told.
OFF = 2.0
#: Chi-square by which a given reading may explain less than another one of its row.
AS_WELL = 4.0
#: Mean deviation from the rig as filed that is told: this [K], and so many tolerances of the instruments.
FELT = 1.0
TOLERANCES = 3.0
#: What residuals are averaged over: one quantity, or two against each other.
TABLES = (("mounting", "speed"), ("mounting", "direction"), ("load", "speed"), ("oil",), ("running order",))
#: A quantity has at most this many groups in a table; neighbouring levels are joined beyond.
MOST = 6
#: Parts of the campaign in running order.
QUARTERS = 4
#: Standard errors from which a mean stands out: among 200 means of noise one in a hundred campaigns has such a one.
FAR = 4.0


def check_data(found: Found, h: Hypothesis) -> DataQuality:
    """Gross readings, values far off, scatter against the card, by a hypothesis."""
    return DataQuality(
        gross=gross_readings(found, h),
        nuisances=values_off(found, h),
        variance=scatters(found, h),
        repeated=list_repeats(found),
        adequacy=adequacy(found, h),
        as_filed=errors_as_filed(found.problem),
    )


def gross_readings(found: Found, h: Hypothesis) -> tuple[GrossReading, ...]:
    """All readings that were set aside, by what a hypothesis says of them."""
    problem, told = found.problem, []
    for aside, size_sd, error in sorted(distances(problem, h.fit), key=lambda far: -abs(far[1])):
        o, row, name = problem.source(aside)
        campaign, s, expected = o.campaign, o.campaign.sensor(name), None
        if not aside.sensor:
            row, expected = int(o.row[row]), float(channels.in_unit(s, problem.measured[aside.number] - error))
        line = int(campaign.lines[row])
        told.append(
            GrossReading(
                row=line - 1,
                line=line,
                point=f"{int(campaign.points[row])}{'' if o is problem.data else f' of {campaign.name}'}",
                channel=name,
                size_sd=size_sd,
                shown=float(channels.in_unit(s, campaign.values[name][row])),
                expected=expected,
                unit=channels.unit(s),
                instead=explain_as_well(problem, h.fit, aside),
            )
        )
    return tuple(told)


def explain_as_well(problem: Problem, fit: Fit, aside: Aside) -> tuple[str, ...]:
    """Other given sensors of a row that explain as well what a given one does that is set aside there."""
    given = [s.name for s in problem.source(aside)[0].given if aside.sensor]
    far = [k for k, t in enumerate(fit.noise.terms) if t.name == SET_ASIDE]
    if not given or len(far) != len(problem.aside):
        return ()
    left, terms, place = {}, list(fit.noise.terms), far[sorted(problem.aside).index(aside)]
    for name in given:
        terms[place] = problem.far(Aside(aside.number, name), fit.look)
        e = replace(fit, noise=replace(fit.noise, terms=tuple(terms))).linear(problem)[1]
        left[name] = float(e @ e)
    return tuple(name for name in given if name != aside.sensor and left[name] < left[aside.sensor] + AS_WELL)


def distances(problem: Problem, fit: Fit) -> list[tuple[Aside, float, float]]:
    """How far each reading set aside lies from what the others say: in standard deviations; of compared ones in SI."""
    white, e = fit.linear(problem)
    inverse, a, found = white.inverse, white.turned(e), []
    for aside in sorted(problem.aside):
        c = problem.far(aside, fit.look).effects[:, 0] / problem.FAR
        length, along = c @ inverse @ c, c @ a  # c of a compared reading: its own standard deviation, and zeros
        own = along / np.sqrt(length * max(1 - problem.FAR**2 * length, 1e-9))
        found.append((aside, float(own), float(along / length * c.sum())))
    return found


def values_off(found: Found, h: Hypothesis) -> tuple[NuisanceOff, ...]:
    """Nuisances beyond `OFF` of their prior, the farthest first."""
    plant, told = found.problem.data.plant, []
    for nuisance, z, sd in zip(found.problem.data.nuisances, h.fit.look.z, h.fit.look.sd, strict=False):
        if abs(z) <= OFF * sd:
            continue
        factors = {path: float(np.exp(e * nuisance.sd * z)) for path, e in nuisance.paths.items()}
        path, factor = next(iter(factors.items()))
        known: dict[str, Any] = {}
        if len(factors) == 1:
            place = plant.place[path]
            file = float(plant.p[place])
            known = {"file": file, "found": file * factor, "unit": plant.flat.parameters[place].unit}
        told.append(NuisanceOff(name=nuisance.name, z=z / sd, factor=factor, paths=tuple(factors), **known))
    return tuple(sorted(told, key=lambda o: -abs(o.z)))


def scatters(found: Found, h: Hypothesis) -> tuple[VarianceComponent, ...]:
    """The loose terms of the scatter, as they were found."""
    noise, told = h.fit.noise, []
    sensors = {f"readings of {s.name}": s for s in found.problem.data.campaign.sensors}
    for term, scale, sd in zip(noise.loose, noise.scales, scale_sds(found, h), strict=True):
        s, ratio = sensors.get(term.name), float(np.exp(scale))
        card = channels.difference(s, s.repeat_sd) if s else found.problem.day_sd
        low, high = (card * float(np.exp(scale + 1.96 * sd * sign)) for sign in (-1.0, 1.0))
        told.append(
            VarianceComponent(
                name=term.name,
                channel=s.name if s else "",
                unit=channels.unit_of_difference(s) if s else "1",
                card=card,
                found=card * ratio,
                ratio=ratio,
                ci95=(low, high),
            )
        )
    return tuple(told)


def scale_sds(found: Found, h: Hypothesis) -> np.ndarray:
    """Standard deviations of the logarithms of the scales, by the information of the data and of the prior."""
    noise, inverse = h.fit.noise, h.fit.linear(found.problem)[0].inverse
    weighted = [inverse @ noise.scaled([t]) for t in noise.loose]
    information = np.array([2 * float((W * W.T).sum()) for W in weighted])
    prior = np.array([t.loose for t in noise.loose])
    return np.asarray(1 / np.sqrt(information + prior**-2))


def adequacy(found: Found, h: Hypothesis) -> dict[str, float]:
    """Compared sensor -> p of what a hypothesis leaves in it, where it leaves something free."""
    own = channels.compared(found.problem.data)
    told = {s.name: p_adequacy(found, h, np.flatnonzero(mine)) for _, s, mine in own}
    return {name: p for name, p in told.items() if p is not None}


def errors_as_filed(problem: Problem) -> dict[str, float]:
    """Thermometer -> mean of measured less simulated by the rig before it is calibrated [K], where it is told."""
    o, sound = problem.data, ~np.isin(np.arange(problem.data.m), problem.entries_aside)
    look = problem.look(np.zeros(problem.nz))
    left = (problem.measured - look.shown)[problem.own]
    erred = np.hstack([t.effects for t in problem.scatters(look) if t.name.startswith("tolerance")])[problem.own]
    own = {s.name: sound & (o.kind == i) for i, s in enumerate(o.read) if s.kind.endswith("_temp")}
    means = {name: (float(left[k].mean()), np.linalg.norm(erred[k].mean(axis=0))) for name, k in own.items() if k.any()}
    return {name: mean for name, (mean, sd) in means.items() if is_apart(mean, sd)}


def is_apart(mean: float, sd: float | np.floating) -> bool:
    """Whether a mean deviation from the rig as filed [K] is told, beside what the tolerances of instruments make."""
    return bool(abs(mean) > max(FELT, TOLERANCES * sd))


def list_repeats(found: Found) -> tuple[RepeatedPoint, ...]:
    """What the calibrated rig leaves at points that were measured in several tests, less its mean, in running order."""
    problem, o, told = found.problem, found.problem.data, []
    left = problem.measured - found.null.look.shown
    left[problem.entries_aside] = np.nan
    rows = {s.name: o.over_rows(i, left[problem.own])[0] for i, s in enumerate(o.read)}
    campaign = o.campaign
    for group in repeats.repeats(campaign, rows):
        both = bool(np.ptp(campaign.direction[campaign.test == group.tests[0]]) > 0)
        for sensor in campaign.read:
            unit, name = channels.difference(sensor, 1.0), sensor.name
            sums, apart = unit * group.total[name], unit * group.difference[name] * (1.0 if both else np.nan)
            if np.isfinite(sums).sum() < 2:  # cells of this sensor are empty
                continue
            numbers = [campaign.numbers[k] for k in group.tests]
            each = zip(group.tests, numbers, array(sums), array(apart), strict=True)
            told.append(
                RepeatedPoint(
                    condition=condition(campaign, group),
                    channel=name,
                    unit=channels.unit_of_difference(sensor),
                    repeats=tuple(
                        Repeat(test=test, order=campaign.order[k], date=campaign.date[k], sum=a, difference=b)
                        for k, test, a, b in each
                    ),
                    sd=float(np.nanstd(sums, ddof=1)),
                    card=unit * repeats.stated(campaign, sensor) / (2**0.5 if both else 1.0),
                )
            )
    return tuple(told)


def condition(campaign: Campaign, point: repeats.Repeat) -> str:
    """What drives a point, in words."""
    said = [point.oil] if point.oil else []
    for name, value in point.conditions.items():
        sensor = campaign.sensor(name)
        number = float(channels.in_unit(sensor, np.array(value)))
        said.append(f"{number:{'.0f' if abs(number) >= 100 else '.3g'}} {channels.unit(sensor)}")
    return ", ".join(said)


def average_residuals(found: Found) -> tuple[ResidualMean, ...]:
    """Means of measured less calibrated readings for each channel and table, those of single readings left out."""
    problem, o = found.problem, found.problem.data
    left = (problem.measured - found.null.look.shown)[problem.own]
    noise = found.null.noise  # a scatter that calibration shrinks makes nothing stand out
    V = replace(noise, scales=np.maximum(noise.scales, 0.0)).covariance[problem.own, problem.own]
    sound = ~np.isin(np.arange(o.m), problem.entries_aside)
    groups, means = group_rows(o.campaign), []
    for names in TABLES:
        # a quantity that does not vary has no groups, and its tables no cells
        for cell in product(*(groups.get(name, {}).items() for name in names)):
            rows = reduce(np.intersect1d, (group for _, group in cell))
            for i, s in enumerate(o.read):
                mine = np.flatnonzero(sound & (o.kind == i) & np.isin(o.row, rows))
                if not len(mine):
                    continue
                mean, sd = float(left[mine].mean()), float(np.sqrt(V[np.ix_(mine, mine)].mean()))
                means.append(
                    ResidualMean(
                        channel=s.name,
                        unit=channels.unit_of_difference(s),
                        by=names,
                        cell=tuple(name for name, _ in cell),
                        n=len(mine),
                        mean=channels.difference(s, mean),
                        sd=channels.difference(s, sd),
                        stands_out=abs(mean) > FAR * sd,
                    )
                )
    return tuple(means)


def group_rows(campaign: Campaign) -> dict[str, dict[str, np.ndarray]]:
    """Quantity -> name of a group -> its rows; quantities that do not vary are left out."""
    named = {"mounting": np.array(campaign.mounting)[campaign.test], "oil": np.array(campaign.oil)[campaign.test]}
    named["direction"] = np.array([f"{d:+.0f}" for d in campaign.direction])
    groups = {q: {str(v): np.flatnonzero(names == v) for v in dict.fromkeys(names)} for q, names in named.items()}
    for quantity, kind in (("speed", "speed"), ("load", "torque")):
        sensor = next((s for s in (*campaign.given, *campaign.read) if s.kind == kind), None)
        groups[quantity] = {} if sensor is None else _along(campaign, sensor)
    parts, order = np.unique(campaign.order), campaign.order[campaign.test]
    quarters = np.array_split(parts, min(QUARTERS, len(parts)))
    groups["running order"] = {f"{q[0]:.10g} to {q[-1]:.10g}": np.flatnonzero(np.isin(order, q)) for q in quarters}
    return {quantity: found for quantity, found in groups.items() if len(found) > 1}


def _along(campaign: Campaign, sensor: Sensor) -> dict[str, np.ndarray]:
    """Rows by the levels of a given sensor, neighbours joined where there are many."""
    values = np.abs(campaign.values[sensor.name])
    each = channels.levels(values)
    parts = np.array_split(np.arange(len(each)), min(MOST, len(each)))
    joined = [np.concatenate([each[k] for k in part]) for part in parts]
    unit = channels.unit(sensor)
    return {f"{channels.difference(sensor, float(values[rows].mean())):.4g} {unit}": rows for rows in joined}
