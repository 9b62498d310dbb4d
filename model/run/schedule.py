"""A duty: what is given from outside over time, piecewise linear, with jumps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..errors import DataError


@dataclass(frozen=True)
class Schedule:
    """Values of inputs over time [s], SI, linear between the points; a time given twice is a jump.

    Args:
        time: n times, not decreasing
        values: per input path n values
    """

    time: np.ndarray
    values: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        if len(self.time) < 2:
            raise DataError(f"A duty needs at least two points in time, found {len(self.time)}.")
        if (back := np.flatnonzero(np.diff(self.time) < 0)).size:
            i = int(back[0])
            raise DataError(f"Time goes back ({self.time[i + 1]:g} s after {self.time[i]:g} s).")
        for name, column in self.values.items():
            if len(column) != len(self.time):
                raise DataError(f"{name}: {len(column)} values for {len(self.time)} times.")
            if not np.isfinite(column).all():
                raise DataError(f"{name}: value at {self.time[~np.isfinite(column)][0]:g} s is not finite.")

    @property
    def start(self) -> float:
        """First time [s]."""
        return float(self.time[0])

    @property
    def stop(self) -> float:
        """Last time [s]."""
        return float(self.time[-1])

    def even(self, step: float) -> np.ndarray:
        """Times at even steps from its start on, and its end [s]."""
        return np.unique(np.append(np.arange(self.start, self.stop, step), self.stop))

    @property
    def jumps(self) -> np.ndarray:
        """The points before jumps: at each the time is given twice."""
        return np.flatnonzero(np.diff(self.time) == 0)

    def stretches(self) -> list[slice]:
        """The points between jumps: per stretch the slice of points over which all inputs are continuous."""
        edges = [0, *(self.jumps + 1), len(self.time)]
        pairs = [(a, b) for a, b in pairwise(edges) if self.time[b - 1] > self.time[a]]
        return [slice(int(a), int(b)) for a, b in pairs]


def join_phases(phases: Iterable[tuple[float, Mapping[str, float | tuple[float, float]]]]) -> Schedule:
    """A schedule from phases (duration [s], input -> constant value or (begin, end)).

    An input that a phase does not name keeps the value at the end of the phase before.
    """
    time: list[float] = []
    columns: dict[str, list[float]] = {}
    now, last = 0.0, dict[str, float]()
    for duration, values in phases:
        ends = {name: v if isinstance(v, tuple) else (v, v) for name, v in values.items()}
        ends = {name: (v, v) for name, v in last.items()} | ends
        time += [now, now + duration]
        for name, (begin, end) in ends.items():
            columns.setdefault(name, [begin] * (len(time) - 2)).extend((begin, end))
        now, last = now + duration, {name: end for name, (_, end) in ends.items()}
    return Schedule(np.array(time), {name: np.array(v) for name, v in columns.items()})
