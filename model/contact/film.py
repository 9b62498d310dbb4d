"""What a solved contact gives: fields, films, friction, rolling moment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .case import Array, Contact
from .grid import Grid
from .newton import State
from .scale import Scaled

#: Share of the smallest film by which a film may exceed it and still count as closed [1].
TOUCHING = 1e-3

#: Films up to which factor of the smallest make a parabola with it; beyond, the nodes do not resolve it [1].
RESOLVED = 2.0


@dataclass(frozen=True)
class Film:
    """Solution of one contact at one moment; fields have shape (x, y).

    Args:
        contact: the contact
        x: places along the direction of rolling [m]
        y: places across it [m]
        p: pressure, fluid and asperities together [Pa]
        h: film [m]
        p_asperity: the part of the pressure that the touching surfaces carry [Pa]
        h_c: film at x = y = 0 [m]
        h_min: smallest film, of the parabola through the nodes around it [m]
        approach: of the bodies, from the first touch without load [m]
        asperity_share: load on touching surfaces over the load [1]
        mu: friction coefficient of sliding [1]
        rolling_moment: -integral of x p [N.m]; half of it loads each surface
        load_error: load missing over the load [1]
        residual: scaled residual of the equations, in units of the Hertz pressure [1]
        residuals: the same before each Newton step on the finest grid
        work: products with the deformation on the finest grid's Newton steps [1]
    """

    contact: Contact
    x: Array
    y: Array
    p: Array
    h: Array
    p_asperity: Array
    h_c: float
    h_min: float
    approach: float
    asperity_share: float
    mu: float
    rolling_moment: float
    load_error: float
    residual: float
    residuals: tuple[float, ...]
    work: int


def film_of(case: Scaled, grid: Grid, state: State, gap: Array, floor: float) -> Film:
    """What is told of a solution.

    Args:
        case: the contact in its units
        grid: its grid
        state: pressure and approach on it
        gap: gap of the undeformed surfaces (n, n) [1]
        floor: film at which the surfaces touch [m]
    """
    contact, unit = case.contact, case.unit
    x, y = (np.asarray(c.ravel() * unit.a) for c in grid.nodes)
    p = np.ascontiguousarray(state.p.T * unit.p)
    film = state.h_0 + gap + grid.deformation(state.p)
    h = np.maximum(np.ascontiguousarray(film.T * unit.h), floor)
    p_asperity = np.where(h < floor * (1 + TOUCHING), p, 0.0)
    cell = float((x[1] - x[0]) * (y[1] - y[0]))
    return Film(
        contact=contact,
        x=x,
        y=y,
        p=p,
        h=h,
        p_asperity=p_asperity,
        h_c=float(np.interp(0.0, x, h[:, h.shape[1] // 2])),
        h_min=max(smallest(h), floor),
        approach=-state.h_0 * unit.h,
        asperity_share=float(p_asperity.sum() * cell / contact.F),
        mu=friction(contact, p, h, p_asperity, cell),
        rolling_moment=float(-(x[:, None] * p).sum() * cell),
        load_error=float(p.sum() * cell / contact.F - 1),
        residual=state.residuals[-1],
        residuals=state.residuals,
        work=state.work,
    )


def friction(contact: Contact, p: Array, h: Array, p_asperity: Array, cell: float | Array) -> float:
    """Friction coefficient of sliding: Eyring's shear of the film, and boundary friction where surfaces touch [1].

    Args:
        contact: the contact
        p: pressure [Pa]
        h: film [m]
        p_asperity: pressure on touching surfaces [Pa]
        cell: area of a node, or of each node [m2]
    """
    v, oil = abs(contact.u_1 - contact.u_2), contact.lubricant
    if v == 0:
        return 0.0
    p_fluid = p - p_asperity
    shear = oil.tau_eyring * np.arcsinh(oil.viscosity(p_fluid) * v / (h * oil.tau_eyring))
    tau = np.where(p_fluid > 0, shear, 0.0) + contact.mu_boundary * p_asperity
    return float((tau * cell).sum() / contact.F)


def smallest(h: Array) -> float:
    """The smallest value of a field, of the parabolas through the smallest node and its neighbours."""
    at = np.unravel_index(int(np.argmin(h)), h.shape)
    low = float(h[at])
    found = low
    for axis in (0, 1):
        i = at[axis]
        if not 0 < i < h.shape[axis] - 1:
            continue
        line = np.take(h, at[1 - axis], axis=1 - axis)
        slope, bend = (line[i + 1] - line[i - 1]) / 2, line[i + 1] - 2 * line[i] + line[i - 1]
        if bend > 0 and max(line[i + 1], line[i - 1]) < RESOLVED * low:
            found -= float(slope**2 / bend / 2)
    return found
