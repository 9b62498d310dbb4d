"""The most likely scales of a scatter's loose terms: steps by a curvature that begins as expected, and learns.

A residual is r ~ N(0, V) with V = base + sum of exp(2 s) C over the loose terms; the logarithms s have normal priors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..model.entries import Term
from .evidence import White

#: Bounds of the logarithms of scales.
BOUNDS = (-1.5, 2.5)
#: Loose terms with fewer columns than this share of the entries are weighed by their columns.
FEW = 0.8
#: Steps at most.
STEPS = 25
#: Times one is halved.
HALVED = 6
#: What the last one promises of log density.
LITTLE = 1e-2
#: The longest step.
LONGEST = 1.0


def most_likely(base: np.ndarray, loose: Sequence[Term], residual: np.ndarray, begun: np.ndarray) -> np.ndarray:
    """Scales of the highest density, priors included.

    Args:
        base: covariance of what is fixed (M, M)
        loose: terms, none of them by a whole covariance
        residual: (M,)
        begun: logarithms where it begins
    """
    few = sum(t.rank for t in loose) < FEW * len(residual)
    cost = _Few(base, loose, residual) if few else _Many(base, loose, residual)
    precision = np.array([t.loose for t in loose]) ** -2.0

    def at(x: np.ndarray) -> tuple[float, np.ndarray]:
        value, slopes = cost.at(x)
        return float(value + 0.5 * precision @ x**2), slopes + precision * x

    x = np.clip(begun, *BOUNDS)
    value, gradient = at(x)
    H = cost.curvature(x) + np.diag(precision)
    for _ in range(STEPS):
        step = _bounded(x, H, gradient)
        if -0.5 * gradient @ step < LITTLE:
            return np.asarray(x + step)
        for _ in range(HALVED):
            lower, after = at(x + step)
            if lower <= value:
                break
            step /= 2
        else:
            break
        bent, along = after - gradient, H @ step
        if step @ bent > 0:
            H = H + np.outer(bent, bent) / (step @ bent) - np.outer(along, along) / (step @ along)
        x, value, gradient = x + step, lower, after
    return np.asarray(x)


def _bounded(x: np.ndarray, H: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """The step to the least of a quadratic, without what pushes against a bound, inside the bounds."""
    low, high = BOUNDS[0] - x, BOUNDS[1] - x
    free, step = ~((low >= 0) & (gradient > 0) | (high <= 0) & (gradient < 0)), np.zeros_like(x)
    if free.any():
        step[free] = -np.linalg.solve(H[np.ix_(free, free)], gradient[free])
    return np.asarray(np.clip(step / max(np.abs(step).max() / LONGEST, 1.0), low, high))


class _Many:
    """By the whole covariance; most terms are variances, and stand by their diagonals. Arguments of `most_likely`."""

    def __init__(self, base: np.ndarray, loose: Sequence[Term], residual: np.ndarray) -> None:
        self.base, self.residual = base, residual
        self.even = np.array([t.variance is not None for t in loose])
        self.columns = [t.effects for t in loose if t.variance is None]
        #: Covariances of the columns, each as one row.
        self.flat = np.array([U @ U.T for U in self.columns]).reshape(len(self.columns), base.size)
        self.variances = np.array([t.variance for t in loose if t.variance is not None])

    def at(self, scales: np.ndarray) -> tuple[float, np.ndarray]:
        """Value and slopes."""
        weights, even = np.exp(2 * scales), self.even
        V = self.base + (weights[~even] @ self.flat).reshape(self.base.shape)
        V[np.diag_indices(len(V))] += weights[even] @ self.variances
        white = White.of(V)
        self.inverse, a = white.inverse, white.back(self.residual)
        value = 0.5 * self.residual @ a + 0.5 * white.log_det
        left, slopes = self.inverse - np.outer(a, a), np.zeros(len(scales))
        slopes[even], slopes[~even] = self.variances @ np.diag(left), self.flat @ left.ravel()
        return float(value), weights * slopes

    def curvature(self, scales: np.ndarray) -> np.ndarray:
        """Expected second derivatives at the scales that were asked for last."""
        even, inverse, own = self.even, self.inverse, self.variances
        found = np.zeros((len(even), len(even)))
        found[np.ix_(even, even)] = own @ inverse**2 @ own.T
        if self.columns:
            groups = _groups([c.shape[1] for c in self.columns])
            U = np.concatenate(self.columns, axis=1)
            along = inverse @ U
            mixed = own @ along**2 @ groups.T
            found[np.ix_(even, ~even)], found[np.ix_(~even, even)] = mixed, mixed.T
            found[np.ix_(~even, ~even)] = groups @ (U.T @ along) ** 2 @ groups.T
        weights = np.exp(2 * scales)
        return 2 * np.outer(weights, weights) * found


class _Few:
    """By few columns of the loose terms beside the entries.

    The covariance is base + U W U' with W > 0: all is said by G = U' base^-1 U and b = U' base^-1 r. Arguments of
    `most_likely`; the base may lack variances.
    """

    #: Part of the smallest variance that counts with the base.
    PART = 0.5

    def __init__(self, base: np.ndarray, loose: Sequence[Term], residual: np.ndarray) -> None:
        columns = [t.effects for t in loose]
        self.counts, U = [c.shape[1] for c in columns], np.concatenate(columns, axis=1)
        self.least = self.PART * np.exp(2 * BOUNDS[0])
        white = White.of(base + self.least * U @ U.T)
        near, e = white(U), white(residual)
        self.G, self.b, self.rest = near.T @ near, near.T @ e, 0.5 * (e @ e + white.log_det)

    def at(self, scales: np.ndarray) -> tuple[float, np.ndarray]:
        """Value and slopes."""
        w = np.repeat(np.exp(2 * scales) - self.least, self.counts)
        white = White.of(self.G + np.diag(1 / w))
        S = white.inverse
        along = S @ self.b
        value = self.rest + 0.5 * (white.log_det + np.log(w).sum() - self.b @ along)
        self.inside = (np.eye(len(w)) - S / w) / w[:, None]  # U' V^-1 U
        own = np.diag(self.inside) - (along / w) ** 2
        each = [part.sum() for part in np.split(own, np.cumsum(self.counts)[:-1])]
        return float(value), np.exp(2 * scales) * np.array(each)

    def curvature(self, scales: np.ndarray) -> np.ndarray:
        """Expected second derivatives at the scales that were asked for last."""
        groups, weights = _groups(self.counts), np.exp(2 * scales)
        return np.asarray(2 * np.outer(weights, weights) * (groups @ self.inside**2 @ groups.T))


def _groups(counts: Sequence[int]) -> np.ndarray:
    """Which columns (n) belong to which group (groups, n), from how many each has."""
    return np.repeat(np.eye(len(counts)), counts, axis=1)
