"""Logs cut into windows that are run side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.signal import lfilter

from ....model.errors import DataError
from ....scenarios.measured.logs import Log
from ....scenarios.measured.table import Sensor

#: Samples of a window that count.
WINDOW = 250
#: Samples before them in which the filter settles; longer free runs would hang on what no sensor reads, a foundation.
SETTLING = 60
#: Length of a piece over which errors are averaged, about [s]: the model need not follow what is faster.
PIECE = 1800.0
#: Time in which what warms slowly follows [s].
HOURS = 5 * 3600.0
#: Temperature by which a duty is another one [K].
WARMER = 10.0


@dataclass(frozen=True, eq=False)
class Windows:
    """Pieces of logs of one rig, N windows of L samples.

    Args:
        given: inputs as logged, with the model's sign (N, L, given)
        read: readings (N, L, reads), NaN where missing
        slow: means of the readings until then, of the last hours above all (N, L, reads)
        there: whether a sample is there (N, L)
        counts: whether it counts, the settling ones do not (N, L)
        machine: number of the log of each window (N,)
        time: middle of each window [s] (N,)
        rows: row of each sample in its log (N, L), -1 where there is none
        step: of all samples [s]
    """

    given: np.ndarray
    read: np.ndarray
    there: np.ndarray
    counts: np.ndarray
    slow: np.ndarray
    machine: np.ndarray
    time: np.ndarray
    rows: np.ndarray
    step: float

    def some(self, keep: np.ndarray) -> Windows:
        """Some of the windows (N,) bool or numbers."""
        return replace(self, **{f.name: getattr(self, f.name)[keep] for f in fields(self) if f.name != "step"})

    def paired(self) -> Windows:
        """The same of what was read at moments: means of neighbours, which are means over the time between them."""
        given, read = self.given.copy(), self.read.copy()
        given[:, 1:] = (self.given[:, 1:] + self.given[:, :-1]) / 2
        both = (self.read[:, 1:] + self.read[:, :-1]) / 2
        read[:, 1:] = np.where(np.isfinite(both), both, self.read[:, 1:])  # a slow channel has no two in a row
        return replace(self, given=given, read=read)

    @property
    def piece(self) -> np.ndarray:
        """Number of the piece of its window in which each sample counts (N, L); -1 for others."""
        many = np.maximum(self.counts.sum(axis=1, keepdims=True), 1)
        pieces = np.clip(np.round(many * self.step / PIECE), 1, many)
        before = np.cumsum(self.counts, axis=1) - 1
        return np.where(self.counts, before * pieces // many, -1).astype(int)


@dataclass(frozen=True, eq=False)
class Duty:
    """What losses and heat paths may follow otherwise than their laws say: speeds, loads, a temperature and its rise.

    Args:
        loads: numbers of the inputs
        warm: number of the reading of that temperature, none where no thermometer is read
        usual: means of each, the temperature and how far it has risen in the last hours at the end (d,)
    """

    loads: Sequence[int]
    warm: Sequence[int]
    usual: np.ndarray

    @classmethod
    def of(cls, data: Windows, given: Sequence[Sensor], read: Sequence[Sensor]) -> Duty:
        """That of windows of logs with some sensors."""
        loads = [i for i, s in enumerate(given) if s.kind != "ambient"]
        warm = [i for i, s in enumerate(read) if s.kind.endswith("_temp")][:1]
        own = cls(loads, warm, np.zeros(len(loads) + 2 * len(warm)))
        return replace(own, usual=of_readings(np.mean, own._means(data)))

    def _means(self, data: Windows) -> np.ndarray:
        warm = data.read[:, :, self.warm]
        own = np.concatenate([np.abs(data.given[:, :, self.loads]), warm, warm - data.slow[:, :, self.warm]], axis=2)
        return means(np.where(data.counts[:, :, None], own, np.nan))

    def at(self, data: Windows) -> np.ndarray:
        """One, and how far means of windows lie from the usual ones, of loads by half of these (N, 1 + d)."""
        unit = np.where(np.arange(len(self.usual)) < len(self.loads), np.maximum(self.usual / 2, 1e-9), WARMER)
        far = (self._means(data) - self.usual) / unit
        return np.column_stack([np.ones(len(far)), np.where(np.isfinite(far), far, 0.0)])


def windows(
    logs: Sequence[Log], given: Sequence[str], read: Sequence[str], length: int = WINDOW, settling: int = SETTLING
) -> Windows:
    """Stretches cut into windows, each with the samples before it in which the filter settles.

    Args:
        logs: of one step
        given, read: names of the sensors that drive and that are compared, in order
        length, settling: samples; a length of 0 keeps every stretch whole, and nothing settles
    """
    parts = [(i, log, *part) for i, log in enumerate(logs) for part in _cut(log.stretch, length, settling)]
    n, longest = len(parts), max(len(rows) for _, _, rows, _ in parts)
    u, y = np.zeros((n, longest, len(given))), np.full((n, longest, len(read)), np.nan)
    slow, courses = y.copy(), [{name: _slow(log, name) for name in read if name in log.values} for log in logs]
    driven = [{name: _held(log.values[name]) for name in given} for log in logs]
    counts, there = np.zeros((2, n, longest), dtype=bool)
    at = np.full((n, longest), -1)
    for i, (number, log, rows, skipped) in enumerate(parts):
        m = len(rows)
        signs = {s.name: s.signs[0] for s in log.sensors}
        u[i, :m] = np.array([driven[number][name][rows] * signs[name] for name in given]).T
        for j, name in enumerate(read):
            if name in log.values:
                y[i, :m, j] = log.values[name][rows] * signs[name]
                slow[i, :m, j] = courses[number][name][rows] * signs[name]
        there[i, :m], counts[i, skipped:m], at[i, :m] = True, True, rows
    if not (counts[:, :, None] & np.isfinite(y)).any():
        names = ", ".join(log.name for log in logs)
        raise DataError(f"{names}: nothing is read behind the first samples of a stretch. Give longer stretches.")
    time = np.array([log.time[rows[skipped:]].mean() for _, log, rows, skipped in parts])
    return Windows(u, y, there, counts, slow, np.array([k for k, *_ in parts]), time, at, logs[0].step)


def _cut(stretch: np.ndarray, length: int, settling: int) -> Iterator[tuple[np.ndarray, int]]:
    """Rows of each window, and how many of them settle."""
    for number in np.unique(stretch):
        rows = np.flatnonzero(stretch == number)
        if not length:
            yield rows, 0
            continue
        for part in np.array_split(rows, max(round(len(rows) / length), 1)):
            begin = max(part[0] - settling, rows[0])
            settled = part[0] - begin if part[0] > rows[0] else min(settling, len(part) // 2)
            yield np.arange(begin, part[-1] + 1), settled


def _slow(log: Log, name: str) -> np.ndarray:
    """Means of a reading until each sample, of the last hours above all, of each stretch by itself (n,)."""
    found, share = _held(log.values[name]), 1 - np.exp(-log.step / HOURS)
    for rows in (np.flatnonzero(log.stretch == number) for number in np.unique(log.stretch)):
        begin = np.array([(1 - share) * found[rows[0]]])
        found[rows] = lfilter([share], [1.0, share - 1], found[rows], zi=begin)[0]
    return found


def _held(column: np.ndarray) -> np.ndarray:
    """Missing values of an input: those between their neighbours."""
    known = np.flatnonzero(np.isfinite(column))
    if not len(known):
        return np.zeros(len(column))
    return np.asarray(np.interp(np.arange(len(column)), known, column[known]))


def means(values: np.ndarray) -> np.ndarray:
    """Means of windows (n, L, reads) over their samples (n, reads), NaN where a reading has none."""
    count = np.isfinite(values).sum(axis=1)
    return np.asarray(np.nansum(values, axis=1) / np.where(count > 0, count, np.nan))


def at_duty(duty: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Knobs (n, k) at duties (n, 1 + d), from their values and slopes (n, k + k d)."""
    return np.asarray(np.einsum("na,nai->ni", duty, mean.reshape(*duty.shape, mean.shape[1] // duty.shape[1])))


def by_piece(piece: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Means of windows (n, L, reads) over each of their pieces (n, pieces, reads), NaN where a reading has none."""
    sums, many = np.zeros((2, len(piece), int(piece.max(initial=0)) + 1, values.shape[2]))
    window, sample, read = np.nonzero((piece >= 0)[:, :, None] & np.isfinite(values))
    at = window, piece[window, sample], read
    np.add.at(sums, at, values[window, sample, read])
    np.add.at(many, at, 1.0)
    return np.asarray(sums / np.where(many > 0, many, np.nan))


def of_readings(statistic: Callable[[np.ndarray], float], values: np.ndarray) -> np.ndarray:
    """A statistic of all values of each reading (..., reads), NaN where it has none."""
    known = (column[np.isfinite(column)] for column in values.reshape(-1, values.shape[-1]).T)
    return np.array([statistic(column) if len(column) else np.nan for column in known])
