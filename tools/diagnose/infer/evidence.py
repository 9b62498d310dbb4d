"""Evidence of sizes by Gaussian algebra: a residual r ~ N(G t, V), with a prior of t that is a mixture of widths.

All is whitened: e = L^-1 r and g = L^-1 G with V = L L'. A size t counts in half widths of its prior. The mixture keeps
both small and large effects; a one-sided size keeps half of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotri
from scipy.special import log_ndtr

#: Widths of a size's prior, as multiples of its stated half width. The last one is for what dominates a campaign: a
#: dead fan, a seal that seizes. Without it two causes share such an effect.
WIDTHS = np.array([0.5, 1.5, 4.5, 13.5])
#: Those of an instrument's error: a fan may be dead, a probe is not that wrong.
INSTRUMENT = np.array([0.5, 1.0, 2.0, 4.0])


@dataclass(frozen=True)
class White:
    """Units in which a residual is white: `L` (M, M) is the lower root of its covariance."""

    L: np.ndarray

    @staticmethod
    def of(covariance: np.ndarray) -> White:
        """Whitening by a covariance (M, M)."""
        return White(np.linalg.cholesky(covariance))

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """A vector (M,) or columns (M, k) in those units."""
        return self._solved(columns, 1)

    def back(self, columns: np.ndarray) -> np.ndarray:
        """The inverse covariance times columns (M,) or (M, k)."""
        return self.turned(self(columns))

    def turned(self, columns: np.ndarray) -> np.ndarray:
        """Whitened columns (M, k) such that their product with others is that of both whitened."""
        return self._solved(columns, 0)

    def _solved(self, columns: np.ndarray, turned: int) -> np.ndarray:
        """What L, or L', times the result is; LAPACK by hand, as checks take longer than such sizes do."""
        return np.asarray(dtrsm(1.0, self.L.T, columns, trans_a=turned)).reshape(columns.shape)

    @property
    def inverse(self) -> np.ndarray:
        """The inverse covariance (M, M)."""
        upper = np.asarray(dpotri(self.L.T)[0])
        return np.asarray(upper + np.triu(upper, 1).T)

    @property
    def log_det(self) -> float:
        """Logarithm of the covariance's determinant."""
        return float(2 * np.log(np.diag(self.L)).sum())

    def log_density(self, e: np.ndarray) -> float:
        """Log density of a whitened residual, without the constant of 2 pi."""
        return float(-0.5 * e @ e - 0.5 * self.log_det)


def log_bayes_factors(
    s: np.ndarray, q: np.ndarray, low: np.ndarray, high: np.ndarray, widths: np.ndarray
) -> np.ndarray:
    """Log Bayes factors of k signatures against none, each alone.

    Args:
        s: signature times residual (..., k)
        q: squared length of the signature (k,)
        low, high: bounds of the size (k,)
        widths: standard deviations of the size's prior, all as likely (w, k)
    """
    logs, inside = by_width(s, q, low, high, widths)
    return averaged(logs + inside, prior_mass(low, high, widths))


def by_width(
    s: np.ndarray | float, q: np.ndarray | float, low: np.ndarray, high: np.ndarray, widths: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The same at each width (w, ..., k): without bounds, and the log share of the posterior inside them."""
    v = widths.reshape(len(widths), *[1] * (np.ndim(s) - widths.ndim + 1), *widths.shape[1:]) ** 2
    post = v / (1 + v * q)
    return 0.5 * s**2 * post - 0.5 * np.log1p(v * q), log_inside(post * s, np.sqrt(post), low, high)


def prior_mass(low: np.ndarray, high: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """Log share of the prior inside the bounds at each width (w, k)."""
    return log_inside(0.0, widths.reshape(len(widths), -1), low, high)


def averaged(logs: np.ndarray, prior: np.ndarray) -> np.ndarray:
    """Log Bayes factors over all widths, of what `by_width` says together, and `prior_mass`."""
    logs = logs - prior.reshape(len(prior), *[1] * (logs.ndim - prior.ndim), -1)
    most = logs.max(axis=0)
    return np.asarray(most + np.log(np.exp(logs - most).mean(axis=0)))


def log_bayes_factor(g: np.ndarray, e: np.ndarray, low: np.ndarray, high: np.ndarray, widths: np.ndarray) -> float:
    """Log Bayes factor of several signatures together against none.

    Args:
        g: whitened signatures (M, k)
        e: whitened residual (M,)
        low, high: bounds of the sizes (k,)
        widths: standard deviations of their priors, all as likely (w, k)
    """
    A, b = g.T @ g, g.T @ e
    each = np.array(list(product(*widths.T)))
    D, eye = each[:, None, :] ** 2, np.eye(len(b))
    C = np.linalg.inv(A + eye / D)
    mean, sd = C @ b, np.sqrt(np.diagonal(C, axis1=1, axis2=2))
    logs = 0.5 * mean @ b - 0.5 * np.linalg.slogdet(eye + A * D)[1]
    logs += (log_inside(mean, sd, low, high) - log_inside(0.0, each, low, high)).sum(axis=1)
    return float(np.logaddexp.reduce(logs) - np.log(len(logs)))


def split_error(
    covariance: np.ndarray, passing: np.ndarray, residual: np.ndarray, kept: np.ndarray, held: np.ndarray
) -> np.ndarray:
    """What kept entries leave of held ones: without a part of what ties them, and with all of it (2, k).

    Args:
        covariance: of all entries (M, M)
        passing: of what is another in each test or mounting, with all entries (M, M)
        residual: (M,)
        kept, held: numbers of entries
    """
    known = White.of(covariance[np.ix_(kept, kept)]).back(residual[kept])
    left = residual[held] - covariance[np.ix_(held, kept)] @ known
    return np.array([left + passing[np.ix_(held, kept)] @ known, left])


def log_inside(
    mean: np.ndarray | float, sd: np.ndarray | float, low: np.ndarray | float, high: np.ndarray | float
) -> np.ndarray:
    """Log share of a normal distribution inside bounds, however far beyond one of them it lies."""
    a, b = (low - mean) / sd, (high - mean) / sd
    beyond, below = log_ndtr(np.where(a > 0, -b, a)), log_ndtr(np.where(a > 0, -a, b))
    return np.asarray(below + np.log1p(-np.exp(beyond - below)))
