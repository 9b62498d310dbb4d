"""How far apart causes are, whatever the noise of the day: standard deviations between one and the nearest other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..infer.evidence import White
from ..infer.fit import bounds
from ..infer.problem import Acting

#: Distances below this are none.
APART = 3.0


@dataclass(frozen=True)
class Effects:
    """Whitened effects of candidates, forms with their shapes, per half width of the prior (m, k)."""

    candidates: tuple[Acting, ...]
    white: np.ndarray

    @staticmethod
    def of(candidates: Sequence[Acting], effects: np.ndarray, covariance: np.ndarray) -> Effects:
        """From effects (m, k) and the covariance (m, m) of readings without a cause."""
        return Effects(tuple(candidates), White.of(covariance)(effects))

    @property
    def places(self) -> Mapping[str, np.ndarray]:
        """Cause -> its candidates, the middle of its general form first."""
        names = np.array([c.id for c in self.candidates])
        return {name: np.flatnonzero(names == name) for name in dict.fromkeys(names.tolist())}

    def visible(self, cause: str, size: float = 1.0) -> float:
        """Distance of a cause from none, at a size in half widths of its prior."""
        return abs(size) * float(np.linalg.norm(self.white[:, self.places[cause][0]]))

    def distance(self, cause: str, other: str, size: float = 1.0, at: int | None = None) -> float:
        """Standard deviations between a cause and the best form of another, rescaled as its bounds allow.

        Args:
            cause, other: ids
            size: of the cause, in half widths of its prior
            at: its candidate; the middle of its general form if None
        """
        k = int(self.places[cause][0]) if at is None else at
        g, rivals = size * self.white[:, k], self.places[other]
        own, length = float(g @ g), (self.white[:, rivals] ** 2).sum(axis=0)
        low, high = (np.array([bounds(self.candidates[i])[side][0] for i in rivals]) for side in (0, 1))
        best = np.clip((g @ self.white[:, rivals]) / np.maximum(length, 1e-300), low, high)
        left = own - 2 * best * (g @ self.white[:, rivals]) + best**2 * length
        return float(np.sqrt(max(float(left.min()), 0.0)))

    def nearest(self, cause: str, size: float = 1.0) -> tuple[str, float] | None:
        """The nearest other cause and its distance."""
        others = {o: self.distance(cause, o, size) for o in self.places if o != cause}
        return min(others.items(), key=lambda item: item[1]) if others else None


@dataclass(frozen=True)
class Alike:
    """A cause with those that the design cannot tell from it; distance of the nearest of them."""

    causes: tuple[str, ...]
    distance: float
    reason: str


def alike(effects: Effects, cause: str, size: float, like: Mapping[str, str]) -> Alike | None:
    """The set that a design cannot tell from a cause, declared classes included; None where it stands alone.

    Args:
        effects: of all causes
        cause: its id
        size: in half widths of its prior
        like: cause -> class and why
    """
    if cause not in effects.places:
        return None
    distances = {o: effects.distance(cause, o, size) for o in effects.places if o != cause}
    declared = {o for o in distances if like[cause] and like[o].partition(":")[0] == like[cause].partition(":")[0]}
    near = sorted((o for o in distances if distances[o] < APART or o in declared), key=lambda o: distances[o])
    if not near:
        return None
    reason = like[cause].partition(":")[2].strip() if declared & set(near) else ""
    return Alike((cause, *near), distances[near[0]], reason)
