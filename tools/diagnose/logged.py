"""Courses of tests, reduced to a few places of each half: what a time series adds to the steady readings.

The temperature at a place is that of a smooth curve through all samples of the half, so that no sample is wasted. The
model's course is reduced in the same way: where a curve cannot follow, it misses both alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from ...scenarios.measured import Test
from .series import Series

#: Places in a half as shares of its dwell; the knots between the pieces of the curve, which are cubic.
SHARES, KNOTS = (0.05, 0.12, 0.2, 0.3, 0.45, 0.65, 0.85), (0.12, 0.3, 0.55)
#: Samples from which there is a curve; below, places lie on the lines between samples.
MANY = 14
#: More samples of a half than that are averaged in groups first.
MOST = 96
#: A half that was logged over a dwell other than stated by less than this is compared place by place.
AS_STATED = 0.03


@dataclass(frozen=True)
class Sampled:
    """What the series says of one half: dwell as logged and interval of the samples [s], temperatures [K] at places.

    `weights` (k, n) make the values at k places of n groups of `count` samples around shares `when` of the dwell.
    """

    half: int
    dwell: float
    interval: float
    shares: np.ndarray
    T_oil: np.ndarray
    T_wall: np.ndarray
    weights: np.ndarray
    when: np.ndarray
    count: np.ndarray

    @property
    def scatter(self) -> np.ndarray:
        """Covariance of the values at the places (k, k) as a share of the variance of one sample."""
        return np.asarray(self.weights / self.count @ self.weights.T)


def sampled(series: Series | None, test: Test, stop: float) -> list[Sampled]:
    """The logged halves of a test, `stop` [s] between them; those behind a dwell not as stated have no places."""
    columns = None if series is None else series.tests.get(test.number)
    if columns is None:
        return []
    found: list[Sampled] = []
    as_stated, end = True, -stop
    for k, half in enumerate(test.halves):
        mine = columns["direction"] == half.direction
        if mine.sum() < len(SHARES):
            break
        stated, time = half.si("dwell_min"), columns["time_s"][mine]
        interval = float(np.median(np.diff(time)))
        begin = float(np.clip(end + stop, time[0] - interval, time[0]))
        end = float(time[-1])
        first = np.unique(np.linspace(0, len(time), min(len(time), MOST) + 1).astype(int))[:-1]
        count = np.diff(np.r_[first, len(time)])
        grouped = {c: np.add.reduceat(columns[c][mine], first) / count for c in ("time_s", "T_oil_C", "T_wall_C")}
        when = (grouped["time_s"] - begin) / stated
        if not as_stated:
            when, count = when[:0], count[:0]
        places, W = _places(when)
        T_oil, T_wall = (W @ (grouped[c] + 273.15) if len(W) else np.empty(0) for c in ("T_oil_C", "T_wall_C"))
        found.append(Sampled(k, end - begin, interval, places, T_oil, T_wall, W, when, count))
        as_stated = as_stated and abs((end - begin) / stated - 1) < AS_STATED
    return found


def _places(share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places that were logged, and the weights (k, samples) of all samples in the values there."""
    kept = np.array([place for place in SHARES if len(share) and share[0] <= place <= share[-1]])
    if not len(kept):
        return kept, np.empty((0, len(share)))
    lines = np.stack([np.interp(kept, share, unit) for unit in np.eye(len(share))], axis=1)
    first, last = share[0], share[-1]
    if len(share) < MANY or first > 0.5 * SHARES[0] or last < SHARES[-1]:
        return kept, lines
    inner = first + (last - first) * np.array(KNOTS)
    knots = np.concatenate([np.full(4, first), inner, np.full(4, last)])
    B, at = (BSpline.design_matrix(x, knots, 3).toarray() for x in (share, kept))
    return kept, np.asarray(at @ np.linalg.pinv(B))
