"""Roots of systems, dense or sparse: damped Newton, homotopy, and pseudo-transient continuation along the dynamics.

The C code of FMU and batch holds the same methods and takes the numbers in capitals from here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

#: A Jacobian: an array, or a sparse matrix of columns.
Matrix = Any

#: z -> (residual, Jacobian).
System = Callable[[np.ndarray], tuple[np.ndarray, Matrix]]

#: A root is found when the next correction is below this, in scales.
CONVERGED = 1e-10

#: Least shortening of the next correction by a full step.
CONTRACTION = 0.75

#: Corrections below this that no longer shrink are round-off.
ROUND_OFF = 1e-7

#: Longest step of a state in Newton's method, in scales on top of half its value.
STRIDE = 10.0

#: Least damping factor before Newton gives up.
LEAST_STEP = 1e-5

#: Corrections before Newton gives up.
MOST_NEWTON = 50

#: Corrections before Newton gives up inside an implicit Euler step: a shorter step is cheaper than more of them.
MOST_EULER = 8

#: Corrections before Newton gives up behind a stride of a homotopy.
MOST_STRIDE = 15

#: First stride of a homotopy, as a share of its way.
FIRST_STRIDE = 0.25

#: Least stride of a homotopy before it gives up.
LEAST_STRIDE = 1e-3

#: Longest pseudo-transient step, as a share of the time in which a deviation grows by e.
CAUTION = 0.3

#: Longest change of a state in a pseudo-transient step, in scales; more for values of many scales, as for `STRIDE`.
FAR = 5.0

#: The pseudo-transient ends where steps this long [s] change nothing.
LONGEST = 1e9

#: Shortest step [s] before the pseudo-transient gives up.
SHORTEST = 1e-12

#: Rates below this share of the fastest one are round-off: a deviation that nothing holds does not grow.
NO_GROWTH = 1e-10

#: Corrections before the pseudo-transient gives up.
MOST_RELAX = 1000


@dataclass(frozen=True)
class Box:
    """Where unknowns may be (both ends excluded where they are finite) and how large they typically are.

    A step longer than `stride` scales and half the value is wild.
    """

    low: np.ndarray
    high: np.ndarray
    scale: np.ndarray
    stride: np.ndarray | float = STRIDE

    def share(self, z: np.ndarray, d: np.ndarray) -> float:
        """Largest part of a step that stays inside and is not wild.

        Args:
            z: unknowns (n), inside
            d: step (n)
        """
        room = np.where(d > 0, self.high - z, z - self.low)
        most = np.minimum(0.9 * room, self.stride * self.scale + 0.5 * np.abs(z))
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(d == 0, 1.0, most / np.abs(d))
        return float(min(1.0, shares.min(initial=1.0)))

    def size(self, d: np.ndarray) -> float:
        """Largest component of a step in scales."""
        return float(np.max(np.abs(d) / self.scale, initial=0.0))


@dataclass(frozen=True)
class Root:
    """Where a search ended, whether that is a root, how many steps it took, and how far a homotopy got."""

    z: np.ndarray
    found: bool
    steps: int
    share: float = 0.0


def newton(system: System, z: np.ndarray, box: Box, most: int = MOST_NEWTON) -> Root:
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
        if length <= CONVERGED:
            return Root(z + d, True, step)
        damping = min(damping, box.share(z, d))
        while True:
            trial = z + damping * d
            new_residual, new_jacobian = system(trial)
            again = _correction(jacobian, new_residual)
            if again is not None and box.size(again) <= (1 - (1 - CONTRACTION) * damping) * length:
                break
            if length <= ROUND_OFF:
                return Root(z, True, step)
            damping /= 2 if again is not None else 8
            if damping < LEAST_STEP:
                return Root(z, False, step)
        z, residual, jacobian = trial, new_residual, new_jacobian
        damping = min(1.0, 4 * damping)
    return Root(z, False, most)


def _correction(jacobian: Matrix, residual: np.ndarray) -> np.ndarray | None:
    """The Newton step, or None where there is none."""
    if not (np.isfinite(residual).all() and _finite(jacobian)):
        return None
    try:
        d = _solve(jacobian, -residual)
    except np.linalg.LinAlgError:
        return None
    return d if np.isfinite(d).all() else None


def _solve(matrix: Matrix, right: Any) -> Any:
    """x of matrix x = right. Raises LinAlgError where there is none."""
    if not sparse.issparse(matrix):
        return np.linalg.solve(matrix, right)
    try:
        return splu(matrix).solve(right.toarray() if sparse.issparse(right) else right)
    except RuntimeError as error:  # exactly singular
        raise np.linalg.LinAlgError(str(error)) from None


def _finite(matrix: Matrix) -> bool:
    return bool(np.isfinite(matrix.data if sparse.issparse(matrix) else matrix).all())


def homotopy(at: Callable[[float], System], z: np.ndarray, box: Box) -> Root:
    """Follow the root of a system that changes with a share from 0, where z is its root, to 1, in strides that adapt.

    Args:
        at: share -> the system there
        z: the root at share 0
        box: bounds and scales

    Returns:
        the root at share 1; the last one reached where it is not found
    """
    share, stride, steps = 0.0, FIRST_STRIDE, 0
    while share < 1.0 and stride > LEAST_STRIDE:
        aim = min(1.0, share + stride)
        root = newton(at(aim), z, box, MOST_STRIDE)
        steps += root.steps
        if root.found:
            z, share, stride = root.z, aim, 2 * stride
        else:
            stride /= 2
    return Root(z, share >= 1.0, steps, share)


def pseudo_transient(system: System, z: np.ndarray, box: Box, n: int) -> Root:
    """Follow dz/dt = residual to equilibrium by implicit Euler with steps that grow as long as they are easy.

    It goes where the machine would go, also where Newton's method finds no way: shafts that come to rest, the stable
    one of several equilibria. Steps are short where the machine runs away from itself and never far.

    Args:
        system: residual and Jacobian at z; the first n residuals are derivatives of the first n unknowns, the others
            are zero at every moment
        z: where to start, inside the box
        box: bounds and scales
        n: number of unknowns with a derivative
    """
    residual, jacobian = system(z)
    if not np.isfinite(residual).all():
        return Root(z, False, 0)
    states = Box(box.low[:n], box.high[:n], box.scale[:n])
    step = float(np.clip(1 / max(states.size(residual[:n]), 1e-12), 1e-6, 1e3))
    taken = 0
    while taken < MOST_RELAX and step > SHORTEST:
        step = min(step, CAUTION / max(growth(reduce_jacobian(jacobian, n)), 1e-300))
        inner = newton(_euler(system, z, step, n), z, box, MOST_EULER)
        taken += max(inner.steps, 1)
        if not inner.found or states.size(((inner.z - z) / (1 + np.abs(z) / (STRIDE * box.scale)))[:n]) > FAR:
            step /= 4
            continue
        moved, z = states.size((inner.z - z)[:n]), inner.z
        _, jacobian = system(z)
        if step >= LONGEST and moved < 1.0:
            last = newton(system, z, box)
            return Root(last.z, last.found, taken + last.steps)
        step = min(step * (5 if inner.steps <= 4 else 2), 10 * LONGEST)
    return Root(z, False, taken)


def reduce_jacobian(jacobian: Matrix, n: int) -> Matrix:
    """Jacobian of the first n residuals in the first n unknowns where the others keep theirs at zero; NaN if none.

    Args:
        jacobian: of all residuals in all unknowns (m, m)
        n: how many come first
    """
    if jacobian.shape[0] == n:
        return jacobian
    try:
        answer = _solve(jacobian[n:, n:], jacobian[n:, :n])
    except np.linalg.LinAlgError:
        return np.full((n, n), np.nan)
    if sparse.issparse(jacobian):
        answer = sparse.csc_matrix(answer)
    return jacobian[:n, :n] - jacobian[:n, n:] @ answer


def growth(jacobian: Matrix) -> float:
    """Rate [1/s] at which a small deviation grows fastest; none below round-off."""
    if sparse.issparse(jacobian):
        if _dominant(jacobian):
            return 0.0
        jacobian = jacobian.toarray()
    if not jacobian.size or not np.isfinite(jacobian).all():
        return 0.0
    values = np.linalg.eigvals(jacobian)
    rate = float(values.real.max())
    return rate if rate > NO_GROWTH * float(np.abs(values).max()) else 0.0


def _dominant(jacobian: Matrix) -> bool:
    """Whether there are scales in which every diagonal entry outweighs its row: then all deviations decay.

    They solve the system of the diagonal and of the magnitudes beside it, and are positive then and only then (an
    M-matrix: Berman and Plemmons 1994, chapter 6). It costs one sparse elimination where eigenvalues cost n^3.
    """
    own = jacobian.diagonal()
    beside = abs(jacobian - sparse.diags(own))
    held = sparse.diags(own - NO_GROWTH * np.abs(own).max(initial=0.0))
    try:
        scales = _solve((held + beside).tocsc(), -np.ones(len(own)))
    except np.linalg.LinAlgError:
        return False
    return bool((own < 0).all() and np.isfinite(scales).all() and (scales > 0).all())


def stable(jacobian: Matrix) -> bool:
    """Whether a machine stays at an equilibrium of this (reduced) Jacobian."""
    return _finite(jacobian) and growth(jacobian) == 0.0


def _euler(system: System, before: np.ndarray, step: float, n: int) -> System:
    """The equations of one implicit Euler step."""
    mass = (np.arange(len(before)) < n) / step

    def equations(z: np.ndarray) -> tuple[np.ndarray, Matrix]:
        rate, jacobian = system(z)
        whole = sparse.diags(mass, format="csc") if sparse.issparse(jacobian) else np.diag(mass)
        return mass * (z - before) - rate, whole - jacobian

    return equations
