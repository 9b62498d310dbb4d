"""Grids of a contact from coarse to fine, the deformation on them, and how fields pass between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.fft

from .case import Array

#: Nodes along a side of the coarsest grid, whose equations are solved directly.
COARSEST = 17


def love(nx: int, ny: int, hx: float, hy: float) -> Array:
    """Integral of 1/distance over a cell at the origin, at the nodes 0..ny-1 by 0..nx-1 away from it.

    Args:
        nx: nodes along x
        ny: nodes along y
        hx: width of a cell along x
        hy: width of a cell along y
    """
    x = (np.arange(nx + 1) - 0.5)[None, :] * hx
    y = (np.arange(ny + 1) - 0.5)[:, None] * hy
    # x asinh(y/|x|) + y asinh(x/|y|): the antiderivative without loss of digits for negative x and y
    f = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    return np.asarray(f[1:, 1:] - f[:-1, 1:] - f[1:, :-1] + f[:-1, :-1])


class Deformation:
    """The elastic deformation of a half-space by a pressure that is constant in each cell of a grid of ny by nx nodes.

    The influence of one cell is Love's closed form (Johnson, Contact Mechanics, equation 3.25); the sum over all cells
    is a convolution, by FFT on a grid padded with zeros, so that nothing wraps around (Liu, Wang and Liu, Wear 243,
    2000). Cells of constant pressure give the deformation to second order in the size of the cell.

    Args:
        nx: nodes along x
        ny: nodes along y
        hx: distance of the nodes along x
        hy: distance of the nodes along y
        factor: deformation of a unit of the integral of pressure over distance
    """

    def __init__(self, nx: int, ny: int, hx: float, hy: float, factor: float) -> None:
        self.near = factor * love(nx, ny, hx, hy)
        self._size = (_pad_length(2 * ny - 1), _pad_length(2 * nx - 1))
        self._shape = (ny, nx)
        even = np.zeros(self._size)
        even[:ny, :nx] = self.near
        even[-ny + 1 :, :nx] = self.near[:0:-1]
        even[:, -nx + 1 :] = even[:, nx - 1 : 0 : -1]
        self._symbol = np.ascontiguousarray(scipy.fft.rfft2(even).real)

    def __call__(self, p: Array) -> Array:
        """Deformation at the nodes under the pressure `p` of shape (ny, nx)."""
        spectrum = scipy.fft.rfft2(p, s=self._size)
        spectrum *= self._symbol
        ny, nx = self._shape
        return np.asarray(scipy.fft.irfft2(spectrum, s=self._size)[:ny, :nx])


def _pad_length(n: int) -> int:
    """Length of a fast transform of at least n points."""
    return int(scipy.fft.next_fast_len(n, real=True))


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
