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
from .duty import Phases
from .plant import Plant, library, record


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
    reads, shown = sum(map(len, phases.read)), len(plant.shown)
    sizes: dict[str, tuple[int, ...]] = {"by": (height, len(plant.knobs) + 1), "local": (given, height)}
    sizes["tried"] = (len(p) - 1, height, len(plant.tried))
    runs = n if wanted is not None else 0
    found = {"y": np.empty((n, reads, shown))}
    found |= {name: np.zeros((runs, *size, reads, shown)) for name, size in sizes.items()}
    result = record(**{name: values if values.size else 0 for name, values in found.items()})
    duty = _duty(phases, x0, p, pace, np.isin(np.arange(len(plant.knobs)), list(wanted or ())))
    places, run = [ctypes.byref(r) for r in (plant.record, duty, result)], library().march
    share_rows(lambda begin, end: int(run(*places, begin, end)), n, n, 0 if n > 1 else 1)
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
