"""Days whose cooling differs more than stated: no signature, but more scatter of a known pattern."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..effects.cause import Theta
from .evidence import White
from .problem import Linear

SCATTER = "procedure.day_scatter"
#: Standard deviations of the days' cooling beside what is stated.
SIZES = np.array([0.02, 0.04, 0.08, 0.16, 0.3])


@dataclass(frozen=True)
class Days:
    """Effects of the days of the acting campaign: `columns` (m, tests) per unit of cooling; their scatter's spectrum."""

    covariance: np.ndarray
    columns: np.ndarray
    directions: np.ndarray
    lengths: np.ndarray

    @staticmethod
    def of(linear: Linear, white: White) -> Days:
        """At a linearisation."""
        U, d, _ = np.linalg.svd(white.columns(linear.days), full_matrices=False)
        return Days(linear.covariance, linear.days, U, d)

    def covariances(self) -> Iterator[np.ndarray]:
        """The whole scatter for each size."""
        for size in SIZES:
            yield self.covariance + size**2 * self.columns @ self.columns.T

    def score(self, e: np.ndarray) -> np.ndarray:
        """Twice the gain in log likelihood at the best size, for whitened residuals (n, m)."""
        along = (e @ self.directions) ** 2
        spread = (SIZES[:, None] * self.lengths) ** 2
        gains = along @ (spread / (1 + spread)).T - np.log1p(spread).sum(axis=1)
        return np.asarray(np.maximum(gains.max(axis=1), 0.0))

    def theta(self, logs: Sequence[float]) -> Theta:
        """The mean size, by the log evidence of each."""
        weights = np.exp(np.array(logs) - max(logs))
        return {"sd": float(weights @ SIZES / weights.sum())}

    def detectable(self, needed: float) -> float:
        """The size at which the expected score reaches what is needed."""
        sizes = np.geomspace(0.002, 2.0, 60)
        spread = (sizes[:, None] * self.lengths) ** 2
        expected = (spread - np.log1p(spread)).sum(axis=1)
        return float(np.interp(needed, expected, sizes))
