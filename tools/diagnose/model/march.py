"""Tests as runs of the rig, dwells and stops one after the other, with exact sensitivities.

An implicit Runge-Kutta method of third order takes the steps. The discrete solution is differentiated, so its
sensitivities are exact at any step. A steady state is the end of a very long dwell by Euler's implicit method: the last
steps are Newton's. The march itself is in C.
"""

from __future__ import annotations

import ctypes
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....fmu.batch_library import LANES, WIDER, instructions, share_rows
from ....scenarios.measured.table import PLACES, Campaign
from .plant import Plant, library, record

#: Shares of a dwell where steps end: of 18 machines, 40 steps move no reading by more than .024 of its deviations.
DWELL = (np.arange(1, 8) / 7) ** 1.2
#: The same where it was logged, with short steps for what warms first, and the steps after which it is read.
LOGGED = np.sort([0.015, 0.04, 0.15, 0.4, 0.8, *PLACES, 1.0])
READ = tuple(np.flatnonzero(np.isin(LOGGED, [*PLACES, 1.0])).tolist())
#: The same of a stop, and of the time to a steady state [s].
STOP = np.array([1.0])
STEADY = 60.0 * 4.0 ** np.arange(14)
#: A kind of sensor that reads zero where the machine stands.
RESTS = ("torque", "speed", "power")


@dataclass(frozen=True)
class Phases:
    """What N runs go through, all with the same number of phases; a phase of no length changes nothing.

    Args:
        length: of each phase [s] (N, F)
        u0, u1: inputs at begin and end, a line between (N, F, nu)
        row: which row of its test a phase belongs to (F,), in 0..H-1
        steps: shares of the length where steps end, for each phase
        read: for each phase the steps (indices) after which is read
        start: by how much the start temperatures follow the given readings of the first row (N, given)
        local0, local1: weight of the reading of each given sensor in each row of the test in the inputs at begin and
            end of each phase (N, F, given, H)
        steady: whether what is read are steady states
    """

    length: np.ndarray
    u0: np.ndarray
    u1: np.ndarray
    row: tuple[int, ...]
    steps: tuple[np.ndarray, ...]
    read: tuple[tuple[int, ...], ...]
    local0: np.ndarray
    local1: np.ndarray
    start: np.ndarray
    steady: bool

    def of(self, runs: np.ndarray) -> Phases:
        """Those of some of the runs."""
        names = ("length", "u0", "u1", "local0", "local1", "start")
        return replace(self, **{name: getattr(self, name)[runs] for name in names})


def duty(c: Campaign, rows: np.ndarray, starts: np.ndarray) -> Phases:
    """All tests as runs: a dwell for each row, a stop before each but the first. A logged dwell is read along it, too.

    Args:
        rows: which of its rows each is (tests, H); the last of the test where it has fewer
        starts: by how much the start temperature of a test follows the given readings of its first row (tests, given)

    Returns:
        phases without inputs
    """
    height = rows.shape[1]
    n, n_given = c.n_tests, len(c.given)
    absent = np.arange(height) >= np.bincount(c.test)[:, None]
    dwell = np.where(absent, 0.0, np.where(np.isinf(c.dwell), STEADY.sum(), c.dwell)[rows])
    stop = np.where(absent, 0.0, c.stop[rows])
    one = np.eye(height)
    room = np.array([s.kind == "ambient" for s in c.given], dtype=bool)
    moving = np.array([s.kind in RESTS for s in c.given], dtype=bool)
    shares = np.cumsum(STEADY) / STEADY.sum() if c.steady else LOGGED if c.series else DWELL
    reached = np.tile(one[0], (n, 1))  # weights of the rows in the room's temperature so far
    phases: list[tuple[np.ndarray, np.ndarray, int, np.ndarray, tuple[int, ...]]] = []
    for h in range(height):
        if h:
            share = (stop[:, h] / np.maximum(stop[:, h] + dwell[:, h], 1e-9))[:, None]
            after = reached + share * (one[h] - reached)
            weights = np.zeros((2, n, n_given, height))
            weights[0][:, room], weights[1][:, room] = reached[:, None], after[:, None]
            weights[:, :, ~room & ~moving] = one[h]
            phases.append((stop[:, h], weights, h, STOP, ()))
            reached = after
        weights = np.tile(one[h], (2, n, n_given, 1))
        if not c.steady:
            weights[0][:, room] = reached[:, None]
        reached = np.tile(one[h], (n, 1))
        phases.append((dwell[:, h], weights, h, shares, READ if c.series else (len(shares) - 1,)))
    lengths, local, row, steps, read = zip(*phases, strict=True)
    begin, end = np.array(local).transpose(1, 2, 0, 3, 4)
    empty = np.empty((n, len(row), 0))
    return Phases(np.array(lengths).T, empty, empty, row, steps, read, begin, end, starts, c.steady)


@dataclass(frozen=True)
class Marched:
    """What is shown and its derivatives, which are empty where they are not asked for.

    A run that has no solution, or runs away, holds NaN.

    Args:
        y: what is shown (N, reads, shown)
        by: of it by the plant's knobs in each row, then by its pace (N, H, knobs + 1, reads, shown)
        local: by given readings of each row (N, given, H, reads, shown)
        tried: by the plant's tried knobs at each further setting (N, S - 1, H, tried, reads, shown)
    """

    y: np.ndarray
    by: np.ndarray
    local: np.ndarray
    tried: np.ndarray


def march(
    plant: Plant, phases: Phases, x0: np.ndarray, p: np.ndarray, pace: np.ndarray, wanted: Collection[int] | None = None
) -> Marched:
    """Run all phases.

    Args:
        phases: N runs
        x0: temperatures and speeds at the start (N, nx)
        p: parameters of each row at each setting (S, N, H, np): the first is run; the derivatives are taken along its
            path at each, which is the truth where the settings differ in what has no effect
        pace: share of each row's dwell that took place (N, H); a stop before it, which is not read, keeps its length
        wanted: the columns by which derivatives are computed (knobs, pace, given sensors, tried knobs of one further
            setting after the other), none of any kind where it is None; those by other knobs hold what their readings
            alone say
    """
    n, given, height = len(x0), *phases.local0.shape[2:]
    reads, shown = sum(map(len, phases.read)), len(plant.shown)
    sizes: dict[str, tuple[int, ...]] = {"by": (height, len(plant.knobs) + 1), "local": (given, height)}
    sizes["tried"] = (len(p) - 1, height, len(plant.tried))
    runs = n if wanted is not None else 0
    found = {"y": np.empty((n, reads, shown))}
    found |= {name: np.zeros((runs, *size, reads, shown)) for name, size in sizes.items()}
    result = record(**{name: values if values.size else 0 for name, values in found.items()})
    columns = np.arange(len(plant.knobs) + 1 + given + (len(p) - 1) * len(plant.tried))
    asked = _duty(phases, x0, p, pace, np.isin(columns, list(wanted or ())))
    places, run = [ctypes.byref(r) for r in (plant.record, asked, result)], library().march
    side = WIDER.get(instructions(), LANES)  # whole vectors are shared out: none is left half empty
    share_rows(lambda begin, end: int(run(*places, side * begin, min(side * end, n))), -(-n // side), n, 0)
    return Marched(**found)


def _duty(phases: Phases, x0: np.ndarray, p: np.ndarray, pace: np.ndarray, wanted: np.ndarray) -> Any:
    ends = np.cumsum([0, *map(len, phases.steps)])
    read = np.full(ends[-1], -1, dtype=np.int64)
    after = [first + k for first, own in zip(ends[:-1], phases.read, strict=True) for k in own]
    read[after] = np.arange(len(after))
    return record(
        n=len(x0),
        S=len(p),
        H=phases.local0.shape[3],
        F=len(phases.row),
        K=len(read),
        R=len(after),
        steady=int(phases.steady),
        row=np.array(phases.row, dtype=np.int64),
        first=ends.astype(np.int64),
        read=read,
        paced=np.array([len(own) > 0 for own in phases.read], dtype=np.int64),
        wanted=wanted.astype(np.int64),
        share=np.concatenate(phases.steps),
        length=phases.length,
        u0=phases.u0,
        u1=phases.u1,
        p=p,
        pace=pace,
        local0=phases.local0,
        local1=phases.local1,
        start=phases.start,
        x0=x0,
    )
