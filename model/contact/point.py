"""A steady contact in the plane: Newton's method on grids from coarse to fine, each starting from the one before."""

from __future__ import annotations

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film, friction, smallest
from .grid import COARSEST, Grid, prolong
from .newton import State, newton
from .scale import Scaled, central_film, scaled

#: Nodes along a side of the grid on which a contact is first solved.
FIRST = 33


def solve_point(
    contact: Contact,
    *,
    n: int = 257,
    domain: tuple[float, float, float] | None = None,
    tolerance: float = 1e-6,
) -> Film:
    """A steady elliptical contact or a roller of finite length.

    Args:
        contact: the contact
        n: nodes along a side of the finest grid, 2^k + 1
        domain: first x, last x and largest y over the half width a of the Hertz contact
        tolerance: scaled residual at which it stops, in units of the Hertz pressure [1]

    Raises:
        ScenarioError: n or the contact make no problem
        SolveError: no solution found
    """
    unit = scaled(contact)
    grids = hierarchy(unit.grid(checked(n), domain))
    state = first_guess(unit, grids[0])
    for i, grid in enumerate(grids):
        if i:
            state = State(prolong(state.p), state.h_0)
        state = newton(grid, unit.reynolds(grid), unit.gap(grid), unit.load, state, tolerance, 40)
    if not state.residuals[-1] < tolerance:
        raise SolveError(
            f"contact: no film found on {n} x {n} nodes (residual {state.residuals[-1]:.1e}). "
            "Refine the grid: n = 2^k + 1, larger."
        )
    return film_of(unit, grids[-1], state)


def checked(n: int) -> int:
    """The number of nodes along a side.

    Raises:
        ScenarioError: it is not 2^k + 1 or too small
    """
    if n < FIRST or (n - 1) & (n - 2):
        raise ScenarioError(f"contact: n = {n} nodes a side. Give 2^k + 1, at least {FIRST}: 65, 129, 257, 513.")
    return n


def hierarchy(finest: Grid) -> list[Grid]:
    """The grids on which a contact is solved, coarse first."""
    grids = [finest]
    while grids[0].n > max(FIRST, COARSEST):
        grids.insert(0, grids[0].coarser())
    return grids


def first_guess(unit: Scaled, grid: Grid) -> State:
    """Hertz pressure, raised to the film of a formula.

    Args:
        unit: the contact
        grid: the coarsest grid
    """
    x, y = grid.nodes
    if unit.dry.b < np.inf:
        inside = 1 - x**2 - (y * unit.dry.a / unit.dry.b) ** 2
    else:
        inside = (1 - x**2) * (np.abs(y) <= unit.contact.length / 2 / unit.dry.a)
    p = np.sqrt(np.maximum(inside, 0.0))
    p *= unit.load / (p.sum() * grid.hx * grid.hy)
    film = central_film(unit.contact) / unit.film_unit
    return State(p, film - float((unit.gap(grid) + grid.deformation(p)).min()))


def film_of(unit: Scaled, grid: Grid, state: State) -> Film:
    """What is told of a solution.

    Args:
        unit: the contact
        grid: its grid
        state: pressure and approach on it
    """
    contact, a, p_h = unit.contact, unit.dry.a, unit.dry.p_max
    x, y = (np.asarray(c.ravel() * a) for c in grid.nodes)
    p = np.ascontiguousarray(state.p.T * p_h)
    h = np.ascontiguousarray((state.h_0 + unit.gap(grid) + grid.deformation(state.p)).T * unit.film_unit)
    p_asperity = np.zeros_like(p)
    cell = float((x[1] - x[0]) * (y[1] - y[0]))
    return Film(
        contact=contact,
        x=x,
        y=y,
        p=p,
        h=h,
        p_asperity=p_asperity,
        h_c=_central(x, h),
        h_min=smallest(h),
        approach=-state.h_0 * unit.film_unit,
        asperity_share=float(p_asperity.sum() * cell / contact.F),
        mu=friction(contact, p, h, p_asperity, cell),
        rolling_moment=float(-(x[:, None] * p).sum() * cell),
        load_error=float(p.sum() * cell / contact.F - 1),
        residual=state.residuals[-1],
        residuals=state.residuals,
        work=state.products,
    )


def _central(x: Array, h: Array) -> float:
    """Film at the origin [m]."""
    return float(np.interp(0.0, x, h[:, h.shape[1] // 2]))
