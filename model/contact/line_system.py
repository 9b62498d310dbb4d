"""The equations of a line contact at one moment: film, Reynolds, cavitation, touching surfaces and load as one system.

In units of a reference contact: x by its half width b, p by p_unit, h by b^2/R. The pressure is that of the fluid
where a film is left and that of the touching surfaces where none is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from ..errors import SolveError
from .case import Array, Lubricant

#: Share of the nodes that stand in the layers at the edges of the contact.
IN_LAYERS = 0.5
#: Numbers of nodes.
Places = NDArray[np.intp]
#: Film below which its logarithm is no longer taken, in units of b^2/R.
LEAST_FILM = 1e-12
#: Largest step of the pressure in one Newton step, in units of p_H.
LARGEST_STEP = 0.5
#: Share of the film that one Newton step may take away.
FILM_STEP = 0.8


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


@dataclass(frozen=True)
class Moment:
    """What the pressure depends on at one moment.

    Args:
        grid: the nodes (n)
        lubricant: the oil
        p_unit: unit of the pressure [Pa]
        couette: 12 eta_0 u_m R^2 / (b^3 p_unit) [1], with the sign of the mean speed
        load: integral of the pressure over x [1]
        gap: distance of the undeformed surfaces but for their approach (n)
        squeeze: factor of density times film in the rate of their change [1]
        past: what the moments before bring to that rate (n), None in steady state
    """

    grid: LineGrid
    lubricant: Lubricant
    p_unit: float
    couette: float
    load: float
    gap: Array
    squeeze: float = 0.0
    past: Array | None = None

    @cached_property
    def upstream(self) -> tuple[Places, Places, Array]:
        """For the face after each node but the last: the node upstream, the one before it, and how far to go on."""
        x, n = self.grid.x, len(self.grid.x)
        i = np.arange(n - 1)
        near = i if self.couette > 0 else i + 1
        far = np.clip(near - 1 if self.couette > 0 else near + 1, 0, n - 1)
        ahead = (x[:-1] + x[1:]) / 2 - x[near]
        return near, far, np.where(near == far, 0.0, ahead / np.where(near == far, 1.0, x[near] - x[far]))

    @property
    def dry(self) -> bool:
        """Whether nothing moves the oil."""
        return self.couette == 0 and self.past is None

    def film(self, p: Array, h_0: float) -> Array:
        """Film (n) of a pressure.

        Args:
            p: pressure (n)
            h_0: approach
        """
        return np.asarray(h_0 + self.gap + self.grid.deformation @ p)


@dataclass(frozen=True)
class LineState:
    """Pressure (n), approach, film (n), where surfaces touch (n), in units of the reference; residuals on the way."""

    p: Array
    h_0: float
    h: Array
    touching: NDArray[np.bool_]
    residuals: tuple[float, ...]


def newton(moment: Moment, p: Array, h_0: float, tolerance: float = 1e-10, steps: int = 40) -> LineState:
    """Newton's method on all equations; which of them holds at a node is found on the way.

    Args:
        moment: what is to be solved
        p: pressure to begin with (n)
        h_0: approach to begin with
        tolerance: largest residual, in units of the pressure
        steps: largest number of steps

    Raises:
        SolveError: it does not arrive
    """
    at = _Point(moment, p, h_0)
    norms = [at.norm]
    for _ in range(steps):
        if norms[-1] < tolerance:
            return LineState(at.p, at.h_0, at.h, at.touching & (at.p > 0), tuple(norms))
        try:
            d = np.linalg.solve(at.jacobian(), -at.residual)
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(d).all():
            break
        at = _search(at, d)
        norms.append(at.norm)
    raise SolveError(
        f"contact: no film found on {len(p)} nodes of a line (residual {norms[-1]:.1e} after {len(norms) - 1} steps). "
        "Refine the grid, or come from a neighbouring contact."
    )


def _search(at: _Point, d: Array) -> _Point:
    """The point that a step leads to, shortened where the film would be used up or the residual rise."""
    share = min(1.0, LARGEST_STEP / max(float(np.abs(d[:-1]).max()), 1e-300))
    if not at.moment.dry:
        dh = at.moment.grid.deformation @ d[:-1] + d[-1]
        open_, falls = at.h > LEAST_FILM, dh < 0
        room = np.where(open_ & falls, FILM_STEP * at.h / np.where(falls, -dh, 1.0), inf)
        share = min(share, max(float(room.min()), 1e-3))
    size, best = float(np.linalg.norm(at.residual)), None
    for _ in range(7):
        tried = _Point(at.moment, at.p + share * d[:-1], at.h_0 + share * float(d[-1]))
        found = float(np.linalg.norm(tried.residual))
        if best is None or found < best[0]:
            best = (found, tried)
        if found < (1 - 0.1 * share) * size:
            break
        share /= 2
    assert best is not None
    return best[1]


class _Point:
    """All equations at a pressure (n) and an approach.

    At each node the least of three is zero: the pressure (cavitation), Reynolds' residual (a film), the film itself
    (surfaces that touch), each in units of the pressure. The last equation is the load.

    Flow by pressure is central; the fluidity between two nodes is its mean over the pressures between them, so that
    the pressure spike may lie between two nodes. Flow by motion is taken from upstream, linear between two nodes.
    Both are of second order.
    """

    def __init__(self, moment: Moment, p: Array, h_0: float) -> None:
        self.moment, self.p, self.h_0 = moment, p, h_0
        self.h = moment.film(p, h_0)
        self.stiffness = moment.grid.stiffness
        values = np.full(len(p), inf) if moment.dry else self._reynolds()
        cavity = p < values
        cavity[[0, -1]] = True
        values = np.where(cavity, p, values)
        self.touching = self.h / self.stiffness < values
        self.touching[[0, -1]] = False
        self.cavity = cavity & ~self.touching
        values = np.where(self.touching, self.h / self.stiffness, values)
        self.residual = np.append(values, moment.grid.weights @ p - moment.load)

    @property
    def norm(self) -> float:
        """Largest residual, in units of the pressure."""
        return float(np.abs(self.residual).max())

    def _reynolds(self) -> Array:
        """Flow that a cell loses, as a pressure (n)."""
        m, grid, oil = self.moment, self.moment.grid, self.moment.lubricant
        pressure = np.maximum(self.p, 0) * m.p_unit
        self.film = np.maximum(self.h, LEAST_FILM)
        self.rho, self.d_rho = oil.density(pressure), oil.density_slope(pressure) * m.p_unit
        ln_eta = np.log(oil.viscosity(pressure) / oil.eta_0)
        self.d_eta = oil.viscosity_slope(pressure) * m.p_unit
        ln_mobility = np.log(self.rho * self.film**3) - ln_eta
        uneven, self.by_uneven = _uneven(np.diff(ln_eta) / 2)
        self.mobility = np.exp((ln_mobility[1:] + ln_mobility[:-1]) / 2) * uneven / grid.gaps
        self.by_pressure = -self.mobility * np.diff(self.p)
        mass, flow = self.rho * self.h, self.by_pressure
        if m.couette != 0:
            near, far, share = m.upstream
            flow = flow + m.couette * (mass[near] + share * (mass[near] - mass[far]))
        cells = grid.weights[1:-1]
        lost = np.diff(flow) / cells
        if m.past is not None:
            lost = lost + m.squeeze * mass[1:-1] + m.past[1:-1]
        scale = (self.mobility[1:] + self.mobility[:-1]) / cells
        scale += (1.5 * abs(m.couette) / cells + m.squeeze) * self.rho[1:-1] * self.stiffness[1:-1]
        self.scale = cells * scale
        return np.concatenate([[0.0], lost / scale, [0.0]])

    def jacobian(self) -> Array:
        """Slopes of all equations by all unknowns (n + 1, n + 1)."""
        n, grid = len(self.p), self.moment.grid
        by_film = np.column_stack([grid.deformation, np.ones(n)])
        found = np.zeros((n + 1, n + 1))
        if not self.moment.dry:
            found[1 : n - 1] = self._by_reynolds(by_film)
        rows = np.flatnonzero(self.cavity)
        found[rows] = 0
        found[rows, rows] = 1
        found[:-1][self.touching] = by_film[self.touching] / self.stiffness[self.touching, None]
        found[n, :n], found[n, n] = grid.weights, 0
        return found

    def _by_reynolds(self, by_film: Array) -> Array:
        """Slopes of what the inner cells lose (n - 2, n + 1), at constant scale."""
        m = self.moment
        nodes, faces = np.arange(len(self.p)), np.arange(len(self.p) - 1)
        by_all = (3 / self.film * (self.h > LEAST_FILM))[:, None] * by_film
        by_all[nodes, nodes] += self.d_rho / self.rho - self.d_eta
        slopes = self.by_pressure[:, None] / 2 * (by_all[1:] + by_all[:-1])
        steep = self.by_pressure * self.by_uneven / 2
        slopes[faces, faces] += self.mobility - steep * self.d_eta[:-1]
        slopes[faces, faces + 1] -= self.mobility - steep * self.d_eta[1:]
        by_mass = self.rho[:, None] * by_film
        by_mass[nodes, nodes] += self.d_rho * self.h
        if m.couette != 0:
            near, far, share = m.upstream
            slopes += m.couette * ((1 + share)[:, None] * by_mass[near] - share[:, None] * by_mass[far])
        by_lost = np.diff(slopes, axis=0)
        if m.past is not None:
            by_lost += (m.squeeze * m.grid.weights[1:-1])[:, None] * by_mass[1:-1]
        return np.asarray(by_lost / self.scale[:, None])


def _uneven(z: Array) -> tuple[Array, Array]:
    """Mean of the fluidity over the pressures between two nodes, over their geometric mean; slope of its logarithm.

    Args:
        z: half the difference of the logarithms of the viscosities (n - 1)
    """
    near = np.abs(z) < 1e-3
    far = np.where(near, 1.0, np.clip(z, -300, 300))
    mean = np.where(near, 1 + z * z / 6, np.sinh(far) / far)
    return mean, np.where(near, z / 3, 1 / np.tanh(far) - 1 / far)
