"""Elastic deformation of a half-space under a pressure that is constant in each cell of a grid.

The influence of one cell is Love's closed form (Johnson, Contact Mechanics, equation 3.25); the sum over all cells is
a convolution, by FFT on a grid padded with zeros, so that nothing wraps around (Liu, Wang and Liu, Wear 243, 2000).
Cells of constant pressure give the deformation to second order in the size of the cell.
"""

from __future__ import annotations

import numpy as np
import scipy.fft

from .case import Array


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
    """The deformation of a grid of ny by nx nodes as a linear map of the pressure.

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
