"""Logged courses of tests, reduced to a few places of each dwell: what samples add to the readings of a campaign.

The temperature at a place is that of a smooth curve through all samples of the dwell, so that no sample is wasted.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.interpolate import BSpline

from ..csv_table import raise_all
from .samples import Samples
from .table import PLACES, Campaign, Course, Series

#: Shares of the logged time where the pieces of a curve meet, which are cubic.
KNOTS = (0.04, 0.12, 0.3, 0.55)
#: Least samples of a dwell, and those from which there is a curve.
LEAST = 7
#: Below, places lie on the lines between samples.
MANY = 14
#: A piece of a curve has so many samples at least.
PIECE = 2
#: More samples of a dwell than that are averaged in groups first.
MOST = 96
#: Behind a dwell that was longer or shorter than stated by more than this share, courses are not compared.
AS_STATED = 0.03


def series_of(samples: Samples, campaign: Campaign) -> Series:
    """The courses of the rows of a campaign.

    Args:
        samples: of its tests
        campaign: its readings

    Raises:
        DataError: they do not belong together
    """
    numbers = {name: k for k, name in enumerate(campaign.names)}
    raise_all(list(_problems(samples, campaign)), samples.name)
    logged = [k for name, k in numbers.items() if name in samples.test]
    warnings = list(samples.warnings)
    if left := campaign.n_tests - len(logged):
        warnings.append(f"{samples.name}: {left} of {campaign.n_tests} tests of {campaign.name} were not logged.")
    dwell, courses = np.full(campaign.n, np.nan), []
    for k in logged:
        for row, length, own in _test(samples, campaign, k):
            dwell[row] = length
            courses += own
    if not courses:
        warnings.append(
            f"{samples.name}: no course could be used. Log at least {LEAST} samples of a dwell, from its start."
        )
    return Series(samples.name, tuple(courses), dwell, tuple(warnings))


def _problems(samples: Samples, campaign: Campaign) -> Iterator[str]:
    if foreign := [name for name in dict.fromkeys(samples.test) if name not in campaign.names]:
        numbers = ", ".join(foreign[:8])
        yield f"{samples.name}: {campaign.name} has no test {numbers}. Give the series of its own tests."
    if campaign.steady:
        yield (
            f"{samples.name}: {campaign.name} does not say how long its points were held."
            " Add the column dwell_min, or dwell_min to the card's [protocol]."
        )
    told = samples.point is not None
    for k, name in enumerate(campaign.names):
        own = campaign.direction[campaign.test == k]
        clear = told or len(own) == 1 or (samples.direction is not None and len(set(own)) == len(own))
        if name in samples.test and not clear:
            yield (
                f"{samples.name}: it is not clear to which reading of test {name} its samples belong."
                " Add the column point with the number of that reading, 0 in stops."
            )
            return


def _rows(samples: Samples, campaign: Campaign, test: int) -> Iterator[tuple[int, np.ndarray]]:
    """Each row of a test with its samples' places."""
    mine = samples.test == campaign.names[test]
    rows = np.flatnonzero(campaign.test == test)
    turned = None if samples.direction is None else np.where(samples.direction == 2, -1.0, samples.direction)
    for row in rows:
        if samples.point is not None:
            own = (samples.point == campaign.points[row]) & (samples.point > 0)
        elif turned is not None:
            own = (turned == campaign.direction[row]) if len(rows) > 1 else (turned != 0)
        else:
            own = np.ones_like(mine)
        yield int(row), np.flatnonzero(mine & own)


def _test(samples: Samples, campaign: Campaign, test: int) -> Iterator[tuple[int, float, list[Course]]]:
    """Rows of a test that were logged: row, dwell as logged [s] and courses, none behind a dwell not as stated."""
    as_stated, end = True, 0.0
    for row, at in _rows(samples, campaign, test):
        if len(at) < LEAST:
            return
        time, stated = samples.time[at], campaign.dwell[row]
        interval = float(np.median(np.diff(time)))
        begin = float(np.clip(end + campaign.stop[row], time[0] - interval, time[0]))
        end = float(time[-1])
        share = (time - begin) / stated
        found = [c for name, v in samples.values.items() if as_stated and (c := _course(row, name, share, v[at]))]
        yield row, end - begin, found
        as_stated = as_stated and abs((end - begin) / stated - 1) < AS_STATED


def _course(row: int, sensor: str, share: np.ndarray, values: np.ndarray) -> Course | None:
    """A sensor's course at the places, None where too little was logged."""
    known = np.isfinite(values)
    share, values = share[known], values[known]
    if len(share) < LEAST:
        return None
    first = np.unique(np.linspace(0, len(share), min(len(share), MOST) + 1).astype(int))[:-1]
    count = np.diff(np.append(first, len(share)))
    when, mean = (np.add.reduceat(column, first) / count for column in (share, values))
    there, weights = _weights(when)
    found, scatter = np.full(len(PLACES), np.nan), np.zeros((len(PLACES), len(PLACES)))
    found[there] = weights @ mean
    scatter[np.ix_(there, there)] = weights / count @ weights.T
    return Course(row, sensor, found, scatter) if there.any() else None


def _weights(share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which places were logged (k,), and the weights of all samples in the values there (logged, n)."""
    places = np.array(PLACES)
    there = (places >= share[0]) & (places <= share[-1])
    kept = places[there]
    if len(share) < MANY:
        lines = [np.interp(kept, share, unit) for unit in np.eye(len(share))]
        return there, np.stack(lines, axis=1)
    inner: list[float] = []
    for knot in share[0] + (share[-1] - share[0]) * np.array(KNOTS):
        if np.sum((share < knot) & (share >= (inner or [0.0])[-1])) >= PIECE:
            inner.append(float(knot))
    knots = np.concatenate([np.full(4, share[0]), inner, np.full(4, share[-1])])
    B, at = (BSpline.design_matrix(x, knots, 3).toarray() for x in (share, kept))
    return there, np.asarray(at @ np.linalg.pinv(B))
