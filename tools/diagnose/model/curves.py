"""How effects of factors curve: twice the loss of a bearing heats twice as much, half the cooling of a housing, too.

Along one knob logs show more than a line: errors of the filter at some values of the knob, seen along what a small
move does, tell by how much a small move would have to be larger to do the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

#: Moves of a factor's logarithm at which its effect is seen, the smallest of which are its slope.
SEEN = np.array([-4.0, -2.0, -1.0, -0.1, 0.1, 1.0, 2.0, 4.0])
#: Least slope of a curve: an effect that ends does not turn round.
FLATTEST = 0.02
#: Points of a curve at which it is read backwards.
FINE = 401


@dataclass(frozen=True, eq=False)
class Curves:
    """What moves of knobs do, as numbers to which their effects are in proportion.

    Args:
        of: number of a knob -> its curve about the rig file, as an area hyperbolic sine, which is nearly straight
        base: knobs from which moves are told (k,)
    """

    of: Mapping[int, PchipInterpolator]
    base: np.ndarray

    def at(self, moves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What moves (n, k) do, and the slopes of that (n, k)."""
        found, slopes = moves.copy(), np.ones_like(moves)
        for j in self.of:
            (still,), slopes[:, j] = self._still[j]
            if moves[:, j].any():
                at, slopes[:, j] = self._of(j, self.base[j] + moves[:, j])
                found[:, j] = at - still
        return found, slopes

    @cached_property
    def _still(self) -> Mapping[int, tuple[np.ndarray, np.ndarray]]:
        """Number of a knob -> what it does that has not moved, and the slope there (1,)."""
        return {j: self._of(j, self.base[[j]]) for j in self.of}

    def _of(self, j: int, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What values of a knob do (n,), and the slopes (n,)."""
        inside = z.clip(SEEN[0], SEEN[-1])
        bent = self.of[j](inside)
        slope = np.maximum(np.cosh(bent) * self.of[j](inside, 1), FLATTEST)
        return np.sinh(bent) + slope * (z - inside), slope

    def back(self, found: np.ndarray) -> np.ndarray:
        """Knobs about the rig file (n, k) that do something (n, k); none is beyond what was seen."""
        z, fine = found.copy(), np.linspace(SEEN[0], SEEN[-1], FINE)
        for j, curve in self.of.items():
            z[:, j] = np.interp(np.arcsinh(found[:, j]), curve(fine), fine)
        return z

    def about(self, mean: np.ndarray) -> Curves:
        """The same of moves from knobs that do something (k,)."""
        return replace(self, base=self.back(mean[None])[0])
