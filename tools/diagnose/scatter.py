"""Days whose cooling differs more than stated: no signature, but more scatter of a known pattern."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..effects.cause import Theta
from .evidence import White

SCATTER = "procedure.day_scatter"
#: Standard deviations of the days' cooling beside what is stated.
SIZES = np.array([0.02, 0.04, 0.08, 0.16])


@dataclass(frozen=True)
class Days:
    """Spectrum of the effects of the acting campaign's days per unit of cooling: `directions` (m, tests), `lengths`."""

    directions: np.ndarray
    lengths: np.ndarray

    @staticmethod
    def of(columns: np.ndarray, white: White) -> Days:
        """From the effects of the days (m, tests)."""
        U, d, _ = np.linalg.svd(white.columns(columns), full_matrices=False)
        return Days(U, d)

    def score(self, e: np.ndarray) -> np.ndarray:
        """Twice the gain in log likelihood at the best size, for whitened residuals (n, m)."""
        return self.gain((e @ self.directions) ** 2)

    def gain(self, along: np.ndarray) -> np.ndarray:
        """The same from squared residuals along the directions (n, tests)."""
        spread = (SIZES[:, None] * self.lengths) ** 2
        gains = along @ (spread / (1 + spread)).T - np.log1p(spread).sum(axis=1)
        return np.asarray(np.maximum(gains.max(axis=1), 0.0))

    def expected(self, sizes: np.ndarray) -> np.ndarray:
        """The mean score where days scatter by sizes (k)."""
        spread = (sizes[:, None] * self.lengths) ** 2
        return np.asarray((spread - np.log1p(spread)).sum(axis=1))

    def theta(self, logs: Sequence[float]) -> Theta:
        """The mean size, by the log evidence of each."""
        weights = np.exp(np.array(logs) - max(logs))
        return {"sd": float(weights @ SIZES / weights.sum())}

    def detectable(self, needed: float) -> float:
        """The size at which the expected score reaches what is needed."""
        sizes = np.geomspace(0.002, 2.0, 60)
        return float(np.interp(needed, self.expected(sizes), sizes))
