"""Nodes along a line contact, denser where film and pressure bend, and the deformation between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from .case import Array

#: Share of the nodes that stand in the layers at the edges of the contact.
IN_LAYERS = 0.5


@dataclass(frozen=True)
class LineGrid:
    """Nodes across a line contact in units of the half width of the Hertz contact.

    Args:
        x: places of the nodes, rising (n)
    """

    x: Array

    @cached_property
    def gaps(self) -> Array:
        """Distances of neighbours (n - 1)."""
        return np.diff(self.x)

    @cached_property
    def weights(self) -> Array:
        """Weights of the trapezoidal rule (n)."""
        return np.asarray((np.append(self.gaps, 0) + np.append(0, self.gaps)) / 2)

    @cached_property
    def deformation(self) -> Array:
        """Deformation by the pressure at each node, linear between nodes, in units of b^2/R for p_H (n, n)."""
        u = np.subtract.outer(self.x, self.x)
        with np.errstate(divide="ignore", invalid="ignore"):
            twice = np.where(u == 0, 0.0, u * u / 2 * np.log(np.abs(u)) - 0.75 * u * u)  # integral of ln, twice
        kernel = np.zeros_like(u)
        slope = np.diff(twice, axis=1) / self.gaps
        kernel[:, 1:-1] = slope[:, 1:] - slope[:, :-1]
        ends = u[:, [0, -1]]
        once = np.where(ends == 0, 0.0, ends * (np.log(np.abs(np.where(ends == 0, 1.0, ends))) - 1))
        kernel[:, 0] = slope[:, 0] + once[:, 0]
        kernel[:, -1] = -slope[:, -1] - once[:, 1]
        return np.asarray(-kernel / pi)

    @cached_property
    def stiffness(self) -> Array:
        """Deformation at each node by its own pressure beyond that of its neighbours (n)."""
        own, beside = self.deformation.diagonal(), self.deformation.diagonal(1)
        inner = own[1:-1] - (beside[1:] + self.deformation.diagonal(-1)[:-1]) / 2
        return np.concatenate([inner[:1], inner, inner[-1:]])


def grade_grid(first: float, last: float, n: int, layer: float) -> LineGrid:
    """A grid with nodes gathered about x = -1 and x = 1.

    Args:
        first, last: where it begins and ends, in half widths
        n: number of nodes
        layer: thickness of the layers at the edges of the contact, in half widths; 0 for equal distances
    """
    if layer == 0:
        return LineGrid(np.linspace(first, last, n))
    fine = np.linspace(first, last, 40 * n)
    share = np.arctan((fine + 1) / layer) + np.arctan((fine - 1) / layer)
    level = (1 - IN_LAYERS) * (fine - first) / (last - first)
    level += IN_LAYERS * (share - share[0]) / (share[-1] - share[0])
    x = np.interp(np.linspace(0, 1, n), level, fine)
    for _ in range(3):  # Newton, so that the nodes lie smoothly
        share_x = np.arctan((x + 1) / layer) + np.arctan((x - 1) / layer)
        value = (1 - IN_LAYERS) * (x - first) / (last - first)
        value += IN_LAYERS * (share_x - share[0]) / (share[-1] - share[0])
        slope = 1 / (1 + ((x + 1) / layer) ** 2) + 1 / (1 + ((x - 1) / layer) ** 2)
        slope = (1 - IN_LAYERS) / (last - first) + IN_LAYERS * slope / layer / (share[-1] - share[0])
        x = x - (value - np.linspace(0, 1, n)) / slope
    x[0], x[-1] = first, last
    return LineGrid(x)
