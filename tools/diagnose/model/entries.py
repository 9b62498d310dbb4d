"""The measured vector of a campaign: readings at the ends of dwells, along logged courses, and dwells as logged.

Its scatter is a sum of terms. A term is a set of columns, each the effect of one independent standard normal number, or
a variance of every entry of its own. Its scale is what the card states; where it is `loose` the data may change it.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from ....scenarios.measured.table import PLACES, Campaign
from ....scenarios.nuisances import Nuisance

#: Scatter of a dwell as logged, as a share of the stated one.
DWELL = 0.02


@dataclass(frozen=True, eq=False)
class Entries:
    """The m entries, and the places at which the model is read for them: the ends of all rows, then those of courses.

    Args:
        kind: channel (m,): number of the compared sensor, plus their number along its course; the last is the dwell's
        sensor: number of the compared sensor (m,), -1 for a dwell
        row: of the campaign (m,)
        at: number of the place (m,)
        measured: values (m,) in SI; of a dwell: as logged over as stated, less one
        repeat: standard deviation of one reading or one sample (m,)
        place_row: row of each place (p,)
        step: number of the place in its row's dwell (p,): the last is its end
        share: of the dwell at each place (p,)
    """

    kind: np.ndarray
    sensor: np.ndarray
    row: np.ndarray
    at: np.ndarray
    measured: np.ndarray
    repeat: np.ndarray
    place_row: np.ndarray
    step: np.ndarray
    share: np.ndarray

    def only(self, kept: np.ndarray) -> Entries:
        """Some of the entries (k,)."""
        own = ("kind", "sensor", "row", "at", "measured", "repeat")
        return replace(self, **{name: getattr(self, name)[kept] for name in own})

    def picked(self, at_places: np.ndarray, dwells: np.ndarray) -> np.ndarray:
        """Values (m, ...) from those of sensors at places (sensors, p, ...) and those of dwells (n, ...)."""
        found = at_places[self.sensor, self.at]
        logged = self.sensor < 0
        found[logged] = dwells[self.row[logged]]
        return np.asarray(found)

    @staticmethod
    def of(c: Campaign) -> Entries:
        """All that a campaign holds."""
        read, n = c.read, c.n
        courses = c.series.courses if c.series else ()
        dwell = c.series.dwell / c.dwell - 1 if c.series else np.empty(0)
        k = len(PLACES) if c.series else 0
        logged = list(dict.fromkeys(course.row for course in courses))
        number = {s.name: i for i, s in enumerate(read)}
        found = [(i, i, r, r, c.values[s.name][r], s.repeat_sd) for i, s in enumerate(read) for r in range(n)]
        for course in courses:
            i, begin = number[course.sensor], n + k * logged.index(course.row)
            sd = read[i].repeat_sd
            found += [(len(read) + i, i, course.row, begin + q, value, sd) for q, value in enumerate(course.values)]
        found += [(2 * len(read), -1, r, r, value, DWELL) for r, value in enumerate(dwell)]
        kept = sorted((entry for entry in found if np.isfinite(entry[4])), key=lambda entry: entry[0])
        kind, sensor, row, at, measured, repeat = (np.array(column) for column in zip(*kept, strict=True))
        place_row = np.concatenate([np.arange(n), np.repeat(np.array(logged, dtype=int), k)])
        step = np.concatenate([np.full(n, k), np.tile(np.arange(k), len(logged))])
        share = np.array([*PLACES[:k], 1.0])[step]
        return Entries(kind, sensor, row, at, measured, repeat, place_row, step, share)


@dataclass(frozen=True)
class Seen:
    """Readings (m,), by nuisances and parameters of causes (m, d), by the true values of the given sensors' readings.

    `local` (m, given, H): by the reading of each given sensor in each row of the same test.
    """

    shown: np.ndarray
    by: np.ndarray
    local: np.ndarray


@dataclass(frozen=True)
class Term:
    """One term: `columns` (m, k), `variance` (m,) or `covariance` (m, m).

    `loose` is the prior's standard deviation of its log scale. What of the columns is another in each test or mounting,
    not the mean of all, is `passing` (m, k).
    """

    name: str
    columns: np.ndarray | None = None
    variance: np.ndarray | None = None
    loose: float = 0.0
    covariance: np.ndarray | None = None
    passing: np.ndarray | None = None

    @property
    def m(self) -> int:
        """Number of entries."""
        return len(next(part for part in (self.columns, self.variance, self.covariance) if part is not None))

    @property
    def rank(self) -> int:
        """Number of its `effects`."""
        return int((self.variance > 0).sum()) if self.variance is not None else self.effects.shape[1]

    @property
    def effects(self) -> np.ndarray:
        """Columns (m, k) of a term that has columns or variances."""
        if self.variance is not None:
            return np.diag(np.sqrt(self.variance))[:, self.variance > 0]
        assert self.columns is not None
        return self.columns


def summed(terms: Sequence[Term], scales: np.ndarray, m: int) -> np.ndarray:
    """The covariance of some terms together (m, m).

    Args:
        terms: n of them
        scales: logarithms of factors on their standard deviations (n,)
        m: number of entries
    """
    columns, variance = [np.zeros((m, 0))], np.zeros(m)
    for t, factor in zip(terms, np.exp(scales), strict=True):
        if t.columns is not None:
            columns.append(factor * t.columns)
        elif t.variance is not None:
            variance += factor**2 * t.variance
    whole = np.concatenate(columns, axis=1)
    found = whole @ whole.T
    found[np.diag_indices(m)] += variance
    for t, factor in zip(terms, np.exp(scales), strict=True):
        if t.covariance is not None:
            found += factor**2 * t.covariance
    return np.asarray(found)


class Measured:
    """A campaign as arrays: the measured vector, and what is known of the rows.

    Args:
        campaign: its readings
        nuisances: what may differ from the rig file
    """

    def __init__(self, campaign: Campaign, nuisances: Sequence[Nuisance]) -> None:
        self.campaign, self.nuisances = campaign, tuple(nuisances)
        counts = np.bincount(campaign.test)
        self.height = int(counts.max())
        starts = np.searchsorted(campaign.test, np.arange(campaign.n_tests))
        self.half = np.arange(campaign.n) - starts[campaign.test]
        #: Which row of the campaign each (test, half) is; the last of the test where it has fewer.
        self.rows = starts[:, None] + np.minimum(np.arange(self.height), counts[:, None] - 1)
        self.sensors = {s.name: _filled(campaign.values[s.name]) for s in campaign.sensors}
        self.signs = {s.name: s.sign(campaign.direction) for s in campaign.sensors}
        self.given, self.read = campaign.given, campaign.read
        self._hold(Entries.of(campaign))
        self.features = self._features()

    def _hold(self, entries: Entries) -> None:
        self.entries = entries
        #: Channel and row of each of the m entries, what was measured, and their number.
        self.kind, self.row, self.measured = entries.kind, entries.row, entries.measured
        self.m = len(entries.measured)

    def only(self, kept: np.ndarray) -> Self:
        """The same with some of its entries (k,)."""
        found = copy(self)
        found._hold(self.entries.only(kept))
        return found

    def over_rows(self, kind: int, *values: np.ndarray) -> np.ndarray:
        """Values of entries (m,), those of a sensor over the rows of the campaign (k, n), NaN where it has none."""
        mine, found = self.kind == kind, np.full((len(values), self.campaign.n), np.nan)
        found[:, self.row[mine]] = [v[mine] for v in values]
        return found

    def conditions(self) -> np.ndarray:
        """What drives the rows, in units of its spread: direction and given sensors but rooms (n, k)."""
        columns = [self.sensors[s.name] for s in self.given if s.kind != "ambient"]
        columns = [c for c in columns if np.ptp(c) > 1e-9 * max(abs(c).max(), 1e-300)]
        own = [(c - c.mean()) / max(c.std(), 1e-12) for c in columns]
        if np.any(self.campaign.direction != self.campaign.direction[0]):
            own.append(self.campaign.direction)
        return np.array(own).reshape(len(own), self.campaign.n).T

    def _rise(self) -> np.ndarray:
        """Oil over room (n,) [K], smooth in the conditions: what follows each reading would explain its scatter."""
        c, at = self.campaign, self.conditions()
        oil, room = (next((s.name for s in c.sensors if s.kind == kind), "") for kind in ("oil_temp", "ambient"))
        if not (oil and room and (known := np.isfinite(c.values[oil])).any()):
            return np.full(c.n, 30.0)
        products = [a * b for i, a in enumerate(at.T) for b in at.T[i:]]
        X = np.column_stack([np.ones(c.n), c.progress, np.minimum(self.half, 1), at, *products])
        rise = (self.sensors[oil] - self.sensors[room])[known]
        return np.asarray((X @ np.linalg.lstsq(X[known], rise, rcond=None)[0]).clip(rise.min(), rise.max()))

    def _features(self) -> np.ndarray:
        """Of the rows, in the order of `FEATURES`."""
        c = self.campaign
        humidity = np.nan_to_num(c.humidity, nan=0.5)[c.test]
        dwell = np.where(np.isfinite(c.dwell), c.dwell, 1e9)
        return np.array([c.progress, c.direction, self._rise(), humidity, np.minimum(self.half, 1), dwell])


def _filled(values: np.ndarray) -> np.ndarray:
    """A column whose missing values stand at the mean of the others."""
    known = values[np.isfinite(values)]
    return np.where(np.isfinite(values), values, known.mean() if len(known) else 0.0)
