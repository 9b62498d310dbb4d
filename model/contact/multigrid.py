"""A multigrid cycle for the linearised contact, the preconditioner of each Newton step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csr_array

from . import stencil
from .case import Array
from .grid import COARSEST, Grid, prolong, restrict
from .relax import LineRelaxation
from .reynolds import Reynolds


@dataclass(frozen=True)
class Linear:
    """The change of the equations with pressure and approach: A p + B (K p + h_0) at the active nodes, and the load.

    Args:
        grid: its grid
        by_p: stencil A (6, n, n)
        by_h: stencil B (6, n, n)
        active: nodes whose pressure changes (n, n)
        touching: nodes whose equation is that of the gap (n, n)
    """

    grid: Grid
    by_p: Array
    by_h: Array
    active: np.ndarray
    touching: np.ndarray

    def __call__(self, p: Array, h_0: float = 0.0) -> Array:
        """Change of the equations (n, n), 0 where the pressure does not change.

        Args:
            p: change of the pressure (n, n)
            h_0: change of the approach
        """
        film = self.grid.deformation(p) + h_0
        out = stencil.apply(self.by_p, p) + stencil.apply(self.by_h, film)
        return np.asarray(np.where(self.active, out, 0.0))

    def load(self, p: Array) -> float:
        """Integral of a pressure (n, n)."""
        return float(p.sum()) * self.grid.hx * self.grid.hy


def linearise(grid: Grid, layers: tuple[Array, Array], active: np.ndarray, touching: np.ndarray) -> Linear:
    """The equations around a state.

    Args:
        grid: the grid
        layers: change of Reynolds' equation with pressure and with film, two stencils; they are changed
        active: nodes whose pressure changes (n, n)
        touching: nodes where the surfaces touch: the film does not change there (n, n)
    """
    by_p, by_h = layers
    fluid = active & ~touching
    by_p *= fluid
    by_h *= fluid
    by_h[stencil.CENTRE][touching] = -1.0
    return Linear(grid, by_p, by_h, active, touching)


class Cycle:
    """V-cycle over the grids below a linearised contact.

    Args:
        linear: the equations on the finest grid
        reynolds: Reynolds' equation on it
        p: pressure of the fluid (n, n)
        h: film (n, n)
    """

    def __init__(self, linear: Linear, reynolds: Reynolds, p: Array, h: Array) -> None:
        grid = linear.grid
        self.linear = linear
        if grid.n <= COARSEST:
            self._direct = _factor(linear)
            return
        self._relax = LineRelaxation(linear.by_p, linear.by_h, grid.deformation.near, linear.active, (grid.hx, grid.hy))
        coarse = replace(reynolds, hx=2 * reynolds.hx, hy=2 * reynolds.hy)
        p_c, h_c = np.ascontiguousarray(p[::2, ::2]), np.ascontiguousarray(h[::2, ::2])
        active, touching = linear.active[::2, ::2].copy(), linear.touching[::2, ::2].copy()
        below = linearise(grid.coarser, coarse.linear(p_c, h_c), active, touching)
        self._coarse = Cycle(below, coarse, p_c, h_c)

    def __call__(self, r: Array, load: float) -> tuple[Array, float]:
        """Changes of pressure (n, n) and approach that roughly remove a residual.

        Args:
            r: residual of the equations (n, n)
            load: missing load
        """
        linear = self.linear
        if linear.grid.n <= COARSEST:
            return self._solved(r, load)
        p = self._relax(r)
        p += self._relax(r - linear(p))
        left = r - linear(p)
        coarse = self._coarse.linear
        r_c = np.where(coarse.touching, restrict(np.where(linear.touching, left, 0.0)), 0.0)
        r_c += np.where(coarse.touching, 0.0, restrict(np.where(linear.touching, 0.0, left)))
        p_c, h_0 = self._coarse(r_c, load - linear.load(p))
        p += np.where(linear.active, prolong(p_c), 0.0)
        p += self._relax(r - linear(p, h_0))
        return p, h_0

    def _solved(self, r: Array, load: float) -> tuple[Array, float]:
        """The direct solution on the coarsest grid."""
        active = self.linear.active
        found = lu_solve(self._direct, np.append(r[active], load))
        p = np.zeros_like(r)
        p[active] = found[:-1]
        return p, float(found[-1])


def _factor(linear: Linear) -> tuple[Array, np.ndarray]:
    """LU factors of the equations of all active nodes and of the load."""
    grid, n = linear.grid, linear.grid.n
    active = linear.active.ravel()
    by_p, by_h = _sparse(linear.by_p), _sparse(linear.by_h)
    inner = by_p.toarray() + by_h @ grid.full_deformation
    full = np.zeros((n * n + 1, n * n + 1))
    full[:-1, :-1] = inner
    full[:-1, -1] = by_h.sum(axis=1)
    full[-1, :-1] = grid.hx * grid.hy
    keep = np.append(active, True)
    factors = lu_factor(full[np.ix_(keep, keep)])
    return factors[0], factors[1]


def _sparse(layers: Array) -> csr_array:
    """A stencil as a sparse matrix; entries beyond the border are 0 because its rows are."""
    _, ny, nx = layers.shape
    rows = np.arange(ny * nx).reshape(ny, nx)[1:-1, 1:-1]
    i, j, v = [], [], []
    for layer, (dy, dx) in zip(layers, stencil.OFFSETS, strict=True):
        i.append(rows.ravel())
        j.append(np.maximum(rows + dy * nx + dx, 0).ravel())
        v.append(layer[1:-1, 1:-1].ravel())
    data = (np.concatenate(v), (np.concatenate(i), np.concatenate(j)))
    return csr_array(data, shape=(ny * nx, ny * nx))
