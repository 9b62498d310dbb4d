"""Roots of small dense systems: Newton's method damped by its own contraction, and relaxation along the dynamics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: z -> (residual, Jacobian).
System = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]

#: A root is found when the next correction is below this, in scales.
TOLERANCE = 1e-10

#: Corrections below this that no longer shrink are round-off.
ROUND_OFF = 1e-7

#: Least damping factor before Newton gives up.
LEAST_STEP = 1e-5

#: Longest step of the relaxation: as a share of the time in which a deviation grows by e, and in scales.
CAUTION, FAR = 0.3, 5.0

#: Relaxation ends where steps this long [s] change nothing, and gives up below the shortest.
LONGEST, SHORTEST = 1e9, 1e-12


@dataclass(frozen=True)
class Box:
    """Where unknowns may be (both ends excluded where they are finite) and how large they typically are."""

    low: np.ndarray
    high: np.ndarray
    scale: np.ndarray

    def share(self, z: np.ndarray, d: np.ndarray) -> float:
        """Largest part of a step that stays inside and is not wild: a tenfold scale and half the value at most."""
        room = np.where(d > 0, self.high - z, z - self.low)
        most = np.minimum(0.9 * room, 10 * self.scale + 0.5 * np.abs(z))
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(d == 0, 1.0, most / np.abs(d))
        return float(min(1.0, shares.min(initial=1.0)))

    def size(self, d: np.ndarray) -> float:
        """Largest component of a step in scales."""
        return float(np.max(np.abs(d) / self.scale, initial=0.0))


@dataclass(frozen=True)
class Root:
    """Where a search ended, whether that is a root, and how many steps it took."""

    z: np.ndarray
    found: bool
    steps: int


def newton(system: System, z: np.ndarray, box: Box, most: int = 50) -> Root:
    """Newton's method with the natural monotonicity test (Deuflhard 2004, section 3.3), blind to scales of residuals.

    Args:
        system: residual and Jacobian at z
        z: where to start, inside the box
        box: bounds and scales
        most: steps before giving up
    """
    residual, jacobian = system(z)
    damping = 1.0
    for step in range(most):
        d = _correction(jacobian, residual)
        if d is None:
            return Root(z, False, step)
        length = box.size(d)
        if length <= TOLERANCE:
            return Root(z + d, True, step)
        damping = min(damping, box.share(z, d))
        while True:
            trial = z + damping * d
            new_residual, new_jacobian = system(trial)
            again = _correction(jacobian, new_residual)
            if again is not None and box.size(again) <= (1 - damping / 4) * length:
                break
            if length <= ROUND_OFF:
                return Root(z, True, step)
            damping /= 2 if again is not None else 8
            if damping < LEAST_STEP:
                return Root(z, False, step)
        z, residual, jacobian = trial, new_residual, new_jacobian
        damping = min(1.0, 4 * damping)
    return Root(z, False, most)


def _correction(jacobian: np.ndarray, residual: np.ndarray) -> np.ndarray | None:
    """The Newton step, or None where there is none."""
    if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
        return None
    try:
        d = np.linalg.solve(jacobian, -residual)
    except np.linalg.LinAlgError:
        return None
    return d if np.isfinite(d).all() else None


def relax(system: System, z: np.ndarray, box: Box, most: int = 300) -> Root:
    """Follow dz/dt = residual to rest by implicit Euler with steps that grow as long as they are easy.

    It goes where the machine would go, also where Newton's method finds no way: shafts that come to rest, the stable
    one of several balances. Steps are short where the machine runs away from itself and never far.
    """
    residual, jacobian = system(z)
    if not np.isfinite(residual).all():
        return Root(z, False, 0)
    step = float(np.clip(1 / max(box.size(residual), 1e-12), 1e-6, 1e3))
    taken = 0
    while taken < most and step > SHORTEST:
        step = min(step, CAUTION / max(growth(jacobian), 1e-300))
        inner = newton(_euler(system, z, step), z, box, most=8)
        taken += max(inner.steps, 1)
        if not inner.found or box.size((inner.z - z) / (1 + np.abs(z) / (10 * box.scale))) > FAR:
            step /= 4
            continue
        moved, z = box.size(inner.z - z), inner.z
        _, jacobian = system(z)
        if step >= LONGEST and moved < 1.0:
            last = newton(system, z, box)
            return Root(last.z, last.found, taken + last.steps)
        step = min(step * (5 if inner.steps <= 4 else 2), 10 * LONGEST)
    return Root(z, False, taken)


def growth(jacobian: np.ndarray) -> float:
    """Rate [1/s] at which a small deviation grows fastest; none below round-off."""
    if not jacobian.size or not np.isfinite(jacobian).all():
        return 0.0
    values = np.linalg.eigvals(jacobian)
    rate = float(values.real.max())
    return rate if rate > 1e-10 * float(np.abs(values).max()) else 0.0


def _euler(system: System, before: np.ndarray, step: float) -> System:
    """The equations of one implicit Euler step."""
    identity = np.eye(len(before))

    def equations(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rate, jacobian = system(z)
        return (z - before) / step - rate, identity / step - jacobian

    return equations
