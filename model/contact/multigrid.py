"""A multigrid cycle for the linearised contact, the preconditioner of each Newton step.

It relaxes along all lines of rolling at once, with one banded matrix. The operator is J = A + B K, with two stencils A
(change with pressure) and B (change with film) and the deformation K. A change of one pressure deforms the whole
surface, so a relaxation must not act on pressures one by one: what is solved for is a change s whose pressure is
spread, p = D s with D = 1 - c (neighbours' mean). K D decays with the third power of the distance, and few entries of
it make the band (distributive line relaxation, Venner and Lubrecht, 2000, section 6.2). Where the pressure flow is
strong against the deformation c goes to 0, the ordinary relaxation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import get_lapack_funcs, lu_factor, lu_solve
from scipy.sparse import csr_array

from . import stencil
from .case import Array
from .grid import COARSEST, Grid, prolong, restrict
from .reynolds import Reynolds

#: Entries of the band on either side of the diagonal.
BAND = 4
#: Pressure flow over deformation flow at a node where half of a change is spread.
SPREAD_LIMIT = 4.0


class Lines:
    """Band matrices of all lines along x, factored together.

    Args:
        band: entries (2 reach + 1, ny, nx), the diagonal in the middle, none beyond the ends of the lines
    """

    def __init__(self, band: Array) -> None:
        self._reach = k = band.shape[0] // 2
        flat = band.reshape(2 * k + 1, -1)
        n = flat.shape[1]
        stored = np.zeros((3 * k + 1, n), order="F")
        for d in range(-k, k + 1):
            lo, hi = max(0, -d), min(n, n - d)
            stored[2 * k - d, lo + d : hi + d] = flat[k + d, lo:hi]
        factor, self._solve = get_lapack_funcs(("gbtrf", "gbtrs"), (stored,))
        self._factors, self._pivots, _ = factor(stored, k, k, overwrite_ab=True)

    def __call__(self, r: Array) -> Array:
        """Solution for the right side `r` (ny, nx)."""
        found, _ = self._solve(self._factors, self._reach, self._reach, r.ravel(), self._pivots)
        return np.asarray(found.reshape(r.shape))


class LineRelaxation:
    """Solves all lines of J D s = r, and gives D s.

    Args:
        by_p: stencil A (6, ny, nx)
        by_h: stencil B (6, ny, nx)
        near: deformation at a node by the pressure of another, by their distance (ny, nx)
        active: nodes whose pressure changes (ny, nx)
        steps: distance of the nodes along x and along y
    """

    def __init__(self, by_p: Array, by_h: Array, near: Array, active: np.ndarray, steps: tuple[float, float]) -> None:
        hx2, hy2 = steps[0] ** 2, steps[1] ** 2
        self._wx, self._wy = hy2 / (hx2 + hy2) / 2, hx2 / (hx2 + hy2) / 2
        self._active = active
        self._c = self._spread(by_p, by_h, near)
        self._lines = Lines(self._band(by_p, by_h, near))

    def _spread(self, by_p: Array, by_h: Array, near: Array) -> Array:
        """How much of a change is spread, between 0 and 1 (ny, nx)."""
        flow = by_p[stencil.EAST] + by_p[stencil.WEST] + by_p[stencil.NORTH] + by_p[stencil.SOUTH]
        deform = np.abs(by_h[stencil.CENTRE]) * near[0, 0] + 1e-300
        ratio = np.maximum(flow, 0.0) / deform / SPREAD_LIMIT
        return np.asarray(np.where(self._active, 1 / (1 + ratio**2), 0.0))

    def _band(self, by_p: Array, by_h: Array, near: Array) -> Array:
        """Entries of J D along the line: (2 BAND + 1, ny, nx), the middle one is the diagonal."""
        ny, nx = self._c.shape
        reach = BAND + 4
        y, x = np.abs(np.arange(-2, 3))[:, None], np.abs(np.arange(-reach, reach + 1))[None, :]
        k = near[np.minimum(y, ny - 1), np.minimum(x, nx - 1)]  # k[2 + dy, reach + dx]
        out = np.zeros((2 * BAND + 1, ny, nx))
        layers = {o: i for i, o in enumerate(stencil.OFFSETS)}
        for d in range(-BAND, BAND + 1):
            here = by_p[layers[0, d]] if (0, d) in layers else np.zeros((ny, nx))
            spread = np.zeros((ny, nx))
            for e in (d - 1, d + 1):
                if (0, e) in layers:
                    spread += self._wx * by_p[layers[0, e]]
            if d == 0:
                spread += self._wy * (by_p[stencil.NORTH] + by_p[stencil.SOUTH])
            own = [k[2 + b, reach + a - d] for b, a in stencil.OFFSETS]
            around = [
                self._wx * (k[2 + b, reach + a - d - 1] + k[2 + b, reach + a - d + 1])
                + self._wy * (k[2 + b + 1, reach + a - d] + k[2 + b - 1, reach + a - d])
                for b, a in stencil.OFFSETS
            ]
            here = here + np.tensordot(own, by_h, 1)
            spread += np.tensordot(around, by_h, 1)
            lo, hi = max(0, -d), min(nx, nx - d)  # rows whose column i + d lies on the line
            out[BAND + d, :, lo:hi] = here[:, lo:hi] - self._c[:, lo + d : hi + d] * spread[:, lo:hi]
        out[:, ~self._active] = 0.0
        out[BAND, ~self._active] = 1.0
        return out

    def __call__(self, r: Array) -> Array:
        """Change of the pressure (ny, nx) that removes the residual `r` (ny, nx) of the lines."""
        s = self._lines(np.where(self._active, r, 0.0))
        c = self._c * s
        out = s.copy()
        out[:, 1:] -= self._wx * c[:, :-1]
        out[:, :-1] -= self._wx * c[:, 1:]
        out[1:] -= self._wy * c[:-1]
        out[:-1] -= self._wy * c[1:]
        return np.asarray(np.where(self._active, out, 0.0))


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
