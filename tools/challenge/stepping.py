"""Fixed graded steps of a linearly implicit method, over many columns at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: Slope of all columns: (temperatures (nodes, columns), share of the stretch gone by) -> K/s.
Rate = Callable[[np.ndarray, float], np.ndarray]

#: L-stable choice of the two-stage method.
GAMMA = 1.0 - 1.0 / np.sqrt(2.0)


@dataclass(frozen=True, eq=False)
class Clock:
    """Shares of both halves and of the stop at which steps end, and every how many steps the matrix is refreshed."""

    halves: tuple[np.ndarray, np.ndarray]
    stop: np.ndarray
    refresh: int


def graded(duration: float, first: float = 12.0, growth: float = 1.35, largest: float = 480.0) -> np.ndarray:
    """Shares of a stretch [s] at which steps end: small after the jump at its beginning, growing to `largest`."""
    ends, step = [0.0], first
    while ends[-1] < duration:
        ends.append(ends[-1] + step)
        step = min(step * growth, largest)
    return np.array(ends) / ends[-1]


def march(rate: Rate, T: np.ndarray, shares: np.ndarray, duration: np.ndarray, refresh: int) -> np.ndarray:
    """Temperatures at all shares of a stretch (steps + 1, nodes, columns).

    The two-stage Rosenbrock method of Verwer: second order whatever matrix it is given, so the matrix (by differences)
    is refreshed now and then only. Heat paths that open while the rig warms up must not make it stale.

    Args:
        rate: slope
        T: temperatures at the beginning (nodes, columns)
        shares: where steps end, from 0 to 1
        duration: length of the stretch per column [s]
        refresh: every how many steps the matrix is refreshed
    """
    unit = np.eye(len(T))
    path = np.empty((len(shares), *T.shape))
    path[0] = T
    for i in range(len(shares) - 1):
        share, step = float(shares[i]), float(shares[i + 1] - shares[i])
        slope = rate(T, share)
        if i % refresh == 0:
            matrix = _matrix(rate, T, share, slope)
        dt = step * duration
        inverse = np.linalg.inv(unit - (GAMMA * dt)[:, None, None] * matrix)
        k_1 = np.einsum("cij,jc->ic", inverse, slope)
        k_2 = np.einsum("cij,jc->ic", inverse, rate(T + dt * k_1, share + step) - 2.0 * k_1)
        T = T + dt * (1.5 * k_1 + 0.5 * k_2)
        path[i + 1] = T
    return path


def _matrix(rate: Rate, T: np.ndarray, share: float, slope: np.ndarray, dT: float = 1e-3) -> np.ndarray:
    """Derivative of the slope by differences (columns, nodes, nodes)."""
    matrix = np.empty((T.shape[1], len(T), len(T)))
    for j in range(len(T)):
        moved = T.copy()
        moved[j] += dT
        matrix[:, :, j] = ((rate(moved, share) - slope) / dT).T
    return matrix
