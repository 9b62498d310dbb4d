"""Dwells of many tests, one after the other, with exact sensitivities: an implicit Runge-Kutta method of third order.

The discrete solution is differentiated, so its sensitivities are exact at any step. A steady state is the end of a very
long dwell by Euler's implicit method: the last steps are Newton's. The march itself is in C.
"""

from __future__ import annotations

import ctypes
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....fmu.batch_library import share_rows
from .plant import Plant, library, record


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


@dataclass(frozen=True)
class Slopes:
    """Derivatives of what is shown.

    Args:
        by: by the plant's knobs in each row, then by its pace (N, H, knobs + 1, reads, shown)
        local: by given readings of each row (N, given, H, reads, shown)
        tried: by the plant's tried knobs at each further setting (N, S - 1, H, tried, reads, shown)
    """

    by: np.ndarray
    local: np.ndarray
    tried: np.ndarray


@dataclass(frozen=True)
class Marched:
    """What is shown (N, reads, shown), and its derivatives where they are asked for.

    A run that has no solution, or runs away, holds NaN.
    """

    y: np.ndarray
    slopes: Slopes | None


def march(
    plant: Plant,
    phases: Phases,
    x0: np.ndarray,
    p: np.ndarray,
    pace: np.ndarray,
    wanted: Collection[int] | None = None,
) -> Marched:
    """Run all phases.

    Args:
        plant: the model
        phases: N runs
        x0: temperatures and speeds at the start (N, nx)
        p: parameters of each row at each setting (S, N, H, np): the first is run; the derivatives are taken along its
            path at each, which is the truth where the settings differ in what has no effect
        pace: share of each row's dwell that took place (N, H); a stop before it, which is not read, keeps its length
        wanted: the knobs by which derivatives are computed, none of any kind where it is None; those by other knobs
            hold what their readings alone say
    """
    n, given, height = len(x0), *phases.local0.shape[2:]
    reads = sum(map(len, phases.read))
    found = {"y": np.empty((n, reads, len(plant.shown)))}
    if wanted is not None:
        found["by"] = np.zeros((n, height, len(plant.knobs) + 1, reads, len(plant.shown)))
        found["local"] = np.zeros((n, given, height, reads, len(plant.shown)))
        found["tried"] = np.zeros((n, len(p) - 1, height, len(plant.tried), reads, len(plant.shown)))
    result = record(**({"y": 0, "by": 0, "local": 0, "tried": 0} | found))
    duty = _duty(phases, x0, p, pace, np.isin(np.arange(len(plant.knobs)), list(wanted or ())))
    places, run = [ctypes.byref(r) for r in (plant.record, duty, result)], library().march
    share_rows(lambda begin, end: int(run(*places, begin, end)), n, n, 0 if n > 1 else 1)
    return Marched(found["y"], Slopes(found["by"], found["local"], found["tried"]) if wanted is not None else None)


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
