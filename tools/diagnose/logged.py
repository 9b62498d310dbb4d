"""Courses of tests, reduced to a few places of each half: what a time series adds to the steady readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scenarios.measured import Test
from .series import Series

#: Places in a half as shares of its dwell; half width over which samples are averaged, if there are so many.
SHARES, WIDTH, MANY = (0.05, 0.12, 0.2, 0.3, 0.45, 0.65, 0.85), 0.02, 5
#: A half that was logged over a dwell other than stated by less than this is compared place by place.
AS_STATED = 0.03


@dataclass(frozen=True)
class Sampled:
    """What the series says of one half: dwell as logged and interval of the samples [s], temperatures [K] at places."""

    half: int
    dwell: float
    interval: float
    shares: np.ndarray
    T_oil: np.ndarray
    T_wall: np.ndarray


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
        shares = (time - begin) / stated if as_stated else np.empty(0)
        temperatures = [columns[c][mine] + 273.15 for c in ("T_oil_C", "T_wall_C")]
        found.append(Sampled(k, end - begin, interval, *_places(shares, temperatures)))
        as_stated = as_stated and abs((end - begin) / stated - 1) < AS_STATED
    return found


def _places(share: np.ndarray, columns: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places that were logged, and both temperatures there: between the samples around each, or a line through many."""
    kept = [place for place in SHARES if len(share) and share[0] <= place <= share[-1]]
    values = np.zeros((len(kept), 2))
    for k, place in enumerate(kept):
        near = np.abs(share - place) <= WIDTH
        for i, column in enumerate(columns):
            if near.sum() >= MANY:
                values[k, i] = np.polynomial.Polynomial.fit(share[near], column[near], 1)(place)
            else:
                values[k, i] = np.interp(place, share, column)
    return np.array(kept), values[:, 0], values[:, 1]
