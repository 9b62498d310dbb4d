"""How effects of factors curve: twice the loss of a bearing heats twice as much, half the cooling of a housing, too.

Along one knob logs show more than a line: errors of the filter at some values of the knob, seen along what a small
move does, tell by how much a small move would have to be larger to do the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import PchipInterpolator

from .logs import Filter
from .windows import Windows

#: Moves of a factor's logarithm at which its effect is seen, the smallest of which are its slope.
SEEN = np.array([-4.0, -2.0, -1.0, -0.1, 0.1, 1.0, 2.0, 4.0])
#: Windows by which it is seen, at most.
WINDOWS = 4
#: Least slope of a curve: an effect that ends does not turn round.
LEAST = 0.02
#: Slope between the moves next to the smallest over that of these, at most: what switches jumps, and has no curve.
SMOOTH = 2.0
#: Points of a curve at which it is read backwards.
FINE = 401
#: Least square of what a small move does, in standard deviations.
TINY = 1e-12


@dataclass(frozen=True, eq=False)
class Curves:
    """What moves of knobs do, as numbers to which their effects are in proportion.

    Args:
        of: number of a knob -> its curve about the rig file
        base: knobs from which moves are told (k,)
    """

    of: Mapping[int, PchipInterpolator]
    base: np.ndarray

    def at(self, moves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What moves (n, k) do, and the slopes of that (n, k)."""
        found, slopes = self._of(self.base + moves)
        return found - self._of(self.base + np.zeros_like(moves))[0], slopes

    def _of(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found, slopes = z.copy(), np.ones_like(z)
        for j, curve in self.of.items():
            inside = z[:, j].clip(SEEN[0], SEEN[-1])
            slopes[:, j] = np.maximum(curve(inside, 1), LEAST)
            found[:, j] = curve(inside) + slopes[:, j] * (z[:, j] - inside)
        return found, slopes

    def back(self, found: np.ndarray) -> np.ndarray:
        """Knobs about the rig file (n, k) that do something (n, k); none is beyond what was seen."""
        z, fine = found.copy(), np.linspace(SEEN[0], SEEN[-1], FINE)
        for j, curve in self.of.items():
            z[:, j] = np.interp(found[:, j], curve(fine), fine)
        return z

    def about(self, mean: np.ndarray) -> Curves:
        """The same of moves from knobs that do something (k,)."""
        return replace(self, base=self.back(mean[None])[0])


def curves(own: Filter, data: Windows) -> Curves:
    """Curves of all factors about the rig file.

    Args:
        own: the filter
        data: windows
    """
    some = np.linspace(0, len(data.read) - 1, min(len(data.read), WINDOWS)).astype(int)
    factors = [j for j, knob in enumerate(own.knobs) if knob.scaled]
    z = np.zeros((len(factors), len(SEEN), len(some), len(own.knobs)))
    for k, j in enumerate(factors):
        z[k, :, :, j] += SEEN[:, None]
    tried = own.run(data.some(np.tile(some, len(factors) * len(SEEN))), z.reshape(-1, z.shape[-1]), slopes=False)
    sound = own.run(data.some(some), np.zeros((len(some), z.shape[-1])), slopes=False)
    found, middle = {}, len(SEEN) // 2
    for j, errors in zip(factors, tried.error.reshape(*z.shape[:-1], *sound.error.shape[1:]), strict=True):
        effects = sound.error - errors
        by = (effects[middle] - effects[middle - 1]) / (SEEN[middle] - SEEN[middle - 1]) / sound.variance
        along = np.nansum(effects * by, axis=(1, 2, 3)) / max(float(np.nansum(by * by * sound.variance)), TINY)
        wide = (along[middle + 1] - along[middle - 2]) / (SEEN[middle + 1] - SEEN[middle - 2])
        if 1 / SMOOTH < wide < SMOOTH:
            x, y = (np.insert(values, middle, 0.0) for values in (SEEN, along))
            rising = np.cumsum([0.0, *np.maximum(np.diff(y), LEAST * np.diff(x))])
            found[j] = PchipInterpolator(x, rising - rising[middle])
    return Curves(found, np.zeros(z.shape[-1]))
