"""How far apart causes are, whatever the noise of the day: standard deviations between one and the nearest other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..infer.evidence import White
from ..infer.problem import Acting
from ..infer.screen import limits
from .findings import CauseSet, Isolability

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

    @cached_property
    def places(self) -> Mapping[str, np.ndarray]:
        """Cause -> its candidates, the middle of its general form first."""
        found: dict[str, list[int]] = {}
        for k, c in enumerate(self.candidates):
            found.setdefault(c.id, []).append(k)
        return {name: np.array(own) for name, own in found.items()}

    @cached_property
    def _gram(self) -> np.ndarray:
        """Products of all pairs of effects (k, k)."""
        return np.asarray(self.white.T @ self.white)

    @cached_property
    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest sizes (k,), in half widths of the priors."""
        return limits(self.candidates)

    def visible(self, cause: str, size: float = 1.0) -> float:
        """Distance of a cause from none, at a size in half widths of its prior."""
        k = self.places[cause][0]
        return abs(size) * float(np.sqrt(self._gram[k, k]))

    def distances(self, cause: str, size: float = 1.0) -> dict[str, float]:
        """Standard deviations between a cause and the best form of each other, rescaled as its bounds allow.

        Args:
            cause: in the middle of its general form
            size: in half widths of its prior
        """
        k, (low, high) = self.places[cause][0], self._bounds
        across, length = size * self._gram[k], np.diag(self._gram)
        best = np.clip(across / np.maximum(length, 1e-300), low, high)
        left = size**2 * self._gram[k, k] - 2 * best * across + best**2 * length
        found = {o: float(left[own].min()) for o, own in self.places.items() if o != cause}
        return {o: float(np.sqrt(max(value, 0.0))) for o, value in found.items()}

    def nearest(self, cause: str, size: float = 1.0) -> tuple[str, float] | None:
        """The nearest other cause and its distance."""
        return min(self.distances(cause, size).items(), key=lambda item: item[1], default=None)


def alike(effects: Effects, cause: str, size: float, like: Mapping[str, str]) -> CauseSet | None:
    """The set that a design cannot tell from a cause, declared classes included; None where it stands alone.

    Args:
        effects: of all causes
        cause: its id
        size: in half widths of its prior
        like: cause -> class and why
    """
    if cause not in effects.places:
        return None
    distances = effects.distances(cause, size)
    declared = {o for o in distances if like[cause] and like[o].partition(":")[0] == like[cause].partition(":")[0]}
    near = sorted((o for o in distances if distances[o] < APART or o in declared), key=lambda o: distances[o])
    if not near:
        return None
    reason = like[cause].partition(":")[2].strip() if declared & set(near) else ""
    return CauseSet(causes=(cause, *near), distance=distances[near[0]], reason=reason)


def isolability(effects: Effects) -> tuple[Isolability, ...]:
    """What the design says of every cause of usual size."""
    near = {cause: effects.nearest(cause) or ("", None) for cause in effects.places}
    told = [
        Isolability(cause=cause, visible=effects.visible(cause), nearest=name, distance=distance)
        for cause, (name, distance) in near.items()
    ]
    return tuple(sorted(told, key=lambda i: -i.visible))
