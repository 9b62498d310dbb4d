"""How effects of factors curve: twice the loss of a bearing heats twice as much, half the cooling of a housing, too.

Along one knob logs show more than a line: errors of the filter at some values of the knob, seen along what a small
move does, tell by how much a small move would have to be larger to do the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from .logs import Filter
from .windows import Windows

#: Moves of a factor's logarithm at which its effect is seen, the smallest of which are its slope.
SEEN = np.array([-4.0, -2.0, -1.0, -0.1, 0.1, 1.0, 2.0, 4.0])
#: Windows by which it is seen, at most.
WINDOWS = 8
#: Least slope of a curve: an effect that ends does not turn round.
LEAST = 0.02


@dataclass(frozen=True)
class Curves:
    """Number of a knob -> its move to that which would have the same effect in proportion."""

    of: Mapping[int, PchipInterpolator]

    def at(self, moves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Moves in proportion to their effects, of moves (n, k), and their slopes (n, k)."""
        found, slopes = moves.copy(), np.ones_like(moves)
        for j, curve in self.of.items():
            inside = moves[:, j].clip(SEEN[0], SEEN[-1])
            slopes[:, j] = curve(inside, 1)
            found[:, j] = curve(inside) + slopes[:, j] * (moves[:, j] - inside)
        return found, slopes


def curves(own: Filter, data: Windows, base: np.ndarray) -> Curves:
    """Curves of all factors about the knobs of a machine.

    Args:
        own: the filter
        data: windows
        base: knobs (k,)
    """
    some = data.some(np.linspace(0, len(data.read) - 1, min(len(data.read), WINDOWS)).astype(int))

    def errors(j: int, move: float) -> np.ndarray:
        z = np.tile(base, (len(some.read), 1))
        z[:, j] += move
        return own.run(some, z, slopes=False).error

    sound = own.run(some, np.tile(base, (len(some.read), 1)), slopes=False)
    found = {}
    for j in (j for j, knob in enumerate(own.knobs) if knob.scaled):
        effects = np.array([sound.error - errors(j, move) for move in SEEN])
        near = np.flatnonzero(abs(SEEN) == abs(SEEN).min())
        by = (effects[near[1]] - effects[near[0]]) / (SEEN[near[1]] - SEEN[near[0]]) / sound.variance
        along = np.nansum(effects * by, axis=(1, 2, 3)) / max(float(np.nansum(by * by * sound.variance)), 1e-12)
        if np.isfinite(along).all():
            steps = np.maximum(
                np.diff([*along[: near[1]], 0.0, *along[near[1] :]]),
                LEAST * np.diff([*SEEN[: near[1]], 0.0, *SEEN[near[1] :]]),
            )
            x = np.insert(SEEN, near[1], 0.0)
            y = np.r_[0.0, np.cumsum(steps)]
            found[j] = PchipInterpolator(x, y - y[near[1]])
    return Curves(found)
