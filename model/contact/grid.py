"""Grids of a contact from coarse to fine, and how fields pass between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .case import Array
from .kernel import Deformation

#: Nodes along a side of the coarsest grid, whose equations are solved directly.
COARSEST = 17


@dataclass(frozen=True)
class Grid:
    """Equidistant nodes, the border included, in units of the half width of the Hertz contact.

    Args:
        x: first and last node along x
        y: first and last node along y
        n: nodes along x and along y
        elastic: deformation of a unit of the integral of pressure over distance
    """

    x: tuple[float, float]
    y: tuple[float, float]
    n: int
    elastic: float

    @property
    def hx(self) -> float:
        """Distance of the nodes along x."""
        return (self.x[1] - self.x[0]) / (self.n - 1)

    @property
    def hy(self) -> float:
        """Distance of the nodes along y."""
        return (self.y[1] - self.y[0]) / (self.n - 1)

    @cached_property
    def nodes(self) -> tuple[Array, Array]:
        """Places of the nodes: along x (1, n) and along y (n, 1)."""
        return np.linspace(*self.x, self.n)[None, :], np.linspace(*self.y, self.n)[:, None]

    @cached_property
    def deformation(self) -> Deformation:
        """The elastic deformation on this grid."""
        return Deformation(self.n, self.n, self.hx, self.hy, self.elastic)

    @cached_property
    def full_deformation(self) -> Array:
        """The deformation as a matrix, for the coarsest grid."""
        i = np.abs(np.subtract.outer(np.arange(self.n), np.arange(self.n)))
        near = self.deformation.near[i[:, None, :, None], i[None, :, None, :]]
        return np.asarray(near.reshape(self.n**2, self.n**2))

    @cached_property
    def coarser(self) -> Grid:
        """The grid of every other node."""
        return Grid(self.x, self.y, (self.n + 1) // 2, self.elastic)


def restrict(f: Array) -> Array:
    """Weighted mean of a field (n, n) at every other node; the border takes no part."""
    rows = f[2:-2:2] / 2 + (f[1:-3:2] + f[3:-1:2]) / 4
    out = np.zeros(((f.shape[0] + 1) // 2, (f.shape[1] + 1) // 2))
    out[1:-1, 1:-1] = rows[:, 2:-2:2] / 2 + (rows[:, 1:-3:2] + rows[:, 3:-1:2]) / 4
    return out


def prolong(f: Array) -> Array:
    """A field (m, m) at the nodes of the grid of half the distance, linear between nodes."""
    rows = np.empty((2 * f.shape[0] - 1, f.shape[1]))
    rows[::2] = f
    rows[1::2] = (f[1:] + f[:-1]) / 2
    out = np.empty((rows.shape[0], 2 * f.shape[1] - 1))
    out[:, ::2] = rows
    out[:, 1::2] = (rows[:, 1:] + rows[:, :-1]) / 2
    return out
