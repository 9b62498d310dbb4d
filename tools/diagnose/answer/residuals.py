"""What the calibrated rig leaves, as tables of means, before any cause is named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ....scenarios.measured.table import Campaign, Sensor
from ..infer.found import Found
from . import channels
from .evidence import ResidualMean
from .gain import levels

#: What residuals are averaged over: one quantity, or two against each other.
TABLES = (("mounting", "speed"), ("mounting", "direction"), ("load", "speed"), ("oil",), ("running order",))
#: A quantity has at most this many groups in a table; neighbouring levels are joined beyond.
MOST = 6
#: Parts of the campaign in running order.
QUARTERS = 4
#: Standard errors from which a mean stands out: among 200 means of noise one in a hundred campaigns has such a one.
FAR = 4.0


def average_residuals(found: Found) -> tuple[ResidualMean, ...]:
    """Means of measured less calibrated readings for each channel and table, those of single readings left out."""
    problem, o = found.problem, found.problem.data
    left = (problem.measured - found.null.look.shown)[problem.own]
    noise = found.null.noise  # a scatter that calibration shrinks makes nothing stand out
    V = replace(noise, scales=np.maximum(noise.scales, 0.0)).covariance[problem.own, problem.own]
    sound = ~np.isin(np.arange(o.m), [a.number for a in problem.aside if not a.sensor])
    groups, means = group_rows(o.campaign), []
    for names in TABLES:
        for cell, rows in _cells(groups, names):
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
                        cell=cell,
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
    tests = np.array_split(np.argsort(campaign.order, kind="stable"), min(QUARTERS, campaign.n_tests))
    orders = [(campaign.order[part].min(), campaign.order[part].max(), part) for part in tests]
    groups["running order"] = {f"{a:g} to {b:g}": np.flatnonzero(np.isin(campaign.test, part)) for a, b, part in orders}
    return {quantity: found for quantity, found in groups.items() if len(found) > 1}


def _along(campaign: Campaign, sensor: Sensor) -> dict[str, np.ndarray]:
    """Rows by the levels of a given sensor, neighbours joined where there are many."""
    values = np.abs(campaign.values[sensor.name])
    each = levels(values)
    joined = [np.concatenate(part) for part in _split(each, MOST)]
    unit = channels.unit(sensor)
    return {f"{channels.difference(sensor, float(values[rows].mean())):.4g} {unit}": rows for rows in joined}


def _split(groups: Sequence[np.ndarray], most: int) -> Iterator[Sequence[np.ndarray]]:
    for part in np.array_split(np.arange(len(groups)), min(most, len(groups))):
        yield [groups[k] for k in part]


def _cells(
    groups: Mapping[str, Mapping[str, np.ndarray]], names: Sequence[str]
) -> Iterator[tuple[tuple[str, ...], np.ndarray]]:
    """Groups of one quantity, or of two against each other, with their rows; none where one does not vary."""
    if any(name not in groups for name in names):
        return
    first, *second = (groups[name] for name in names)
    for a, rows in first.items():
        if not second:
            yield (a,), rows
        for b, others in second[0].items() if second else ():
            yield (a, b), np.intersect1d(rows, others)
