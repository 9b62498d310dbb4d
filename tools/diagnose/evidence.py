"""Evidence of hypotheses about a residual r ~ N(sizes times signatures, V), by Gaussian algebra.

All is whitened: e = L^-1 r with V = L L', and G = L^-1 [signatures]. A size has a normal prior, a mixture over widths,
so that neither small nor large effects are cut off; a one-sided size keeps half of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.special import logsumexp, ndtr

#: Widths of a size's prior, as multiples of its stated half width.
WIDTHS = np.array([0.4, 0.8, 1.6, 3.2])


@dataclass(frozen=True)
class White:
    """A residual in units of its own scatter."""

    L: np.ndarray
    e: np.ndarray

    @staticmethod
    def of(residual: np.ndarray, covariance: np.ndarray) -> White:
        """Whiten a residual (m) by its covariance (m, m)."""
        L = cholesky(covariance, lower=True)
        return White(L, solve_triangular(L, residual, lower=True))

    def columns(self, signatures: np.ndarray) -> np.ndarray:
        """Signatures (m, k) in the same units."""
        return np.asarray(solve_triangular(self.L, signatures, lower=True))


def log_gauss(white: White) -> float:
    """Log density of a residual without any cause."""
    return float(-0.5 * white.e @ white.e - np.log(np.diag(white.L)).sum())


def log_bayes_factors(s: np.ndarray, q: np.ndarray, sd: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Log Bayes factor of each signature against none.

    Args:
        s: signature times residual (k)
        q: squared length of the signature (k)
        sd: prior half width of the size (k)
        low, high: bounds of the size (k)
    """
    found = []
    for width in WIDTHS:
        v = (sd * width) ** 2
        post_v = v / (1 + v * q)
        mean = post_v * s
        log_bf = 0.5 * s * mean - 0.5 * np.log1p(v * q)
        inside = _mass(mean, np.sqrt(post_v), low, high)
        prior = _mass(np.zeros_like(mean), np.sqrt(v), low, high)
        found.append(log_bf + np.log(np.maximum(inside, 1e-300)) - np.log(np.maximum(prior, 1e-300)))
    return np.asarray(logsumexp(np.stack(found), axis=0) - np.log(len(WIDTHS)))


def _mass(mean: np.ndarray, sd: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return np.asarray(ndtr((high - mean) / sd) - ndtr((low - mean) / sd))


def log_bayes_factors_pair(
    s: tuple[np.ndarray, np.ndarray],
    q: tuple[np.ndarray, np.ndarray],
    cross: np.ndarray,
    sd: tuple[np.ndarray, np.ndarray],
    bounds: tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> np.ndarray:
    """Log Bayes factor (k, l) of every pair of a signature of one family with one of another, against none."""
    found = []
    for wa in WIDTHS:
        for wb in WIDTHS:
            va, vb = (sd[0] * wa)[:, None] ** 2, (sd[1] * wb)[None, :] ** 2
            # posterior precision [[1/va + qa, c], [c, 1/vb + qb]]
            pa, pb = 1 / va + q[0][:, None], 1 / vb + q[1][None, :]
            det = pa * pb - cross**2
            sa, sb = s[0][:, None], s[1][None, :]
            ma, mb = (pb * sa - cross * sb) / det, (pa * sb - cross * sa) / det
            log_bf = 0.5 * (sa * ma + sb * mb) - 0.5 * np.log(det * va * vb)
            log_in = np.zeros_like(log_bf)
            for m, p, other, v, (low, high), axis in (
                (ma, pb, det, va, bounds[0], 1),
                (mb, pa, det, vb, bounds[1], 0),
            ):
                lo, hi = np.expand_dims(low, axis), np.expand_dims(high, axis)
                log_in += np.log(np.maximum(_mass(m, np.sqrt(p / other), lo, hi), 1e-300))
                log_in -= np.log(np.maximum(_mass(np.zeros_like(m), np.sqrt(v) + 0 * m, lo, hi), 1e-300))
            found.append(log_bf + log_in)
    return np.asarray(logsumexp(np.stack(found), axis=0) - np.log(len(found)))


def score(s: np.ndarray, q: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Directed likelihood ratio of each signature: twice the gain in log likelihood at the best legal size."""
    size = np.clip(s / np.maximum(q, 1e-300), low, high)
    return np.asarray(2 * size * s - size**2 * q)
