"""A line contact in steady state, and what is told of a solution."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import ScenarioError
from .case import Array, Contact
from .film import Film, friction
from .line_start import settle
from .line_system import LineGrid, LineState, Moment, grade_grid
from .line_unit import LineUnit, find_flooded_ends, layer, line_unit

#: Film in whose place none is, for its shear [m].
LEAST_FILM = 1e-12
#: Fewest nodes.
FEWEST = 51


def solve_line(
    contact: Contact,
    *,
    n: int = 301,
    domain: tuple[float, float] | None = None,
    roughness: Callable[[Array], Array] | None = None,
    tolerance: float = 1e-8,
) -> Film:
    """The steady film of a line contact. The surfaces may touch; at rest the contact is that of Hertz.

    Args:
        contact: the contact, with infinite R_y and without edge_radius
        n: number of nodes, gathered at the edges of the contact
        domain: first and last x over the half width of the Hertz contact; without it, wide enough for a flooded inlet
        roughness: height of the standing surface over x [m]; the moving one is smooth
        tolerance: largest residual, in units of the Hertz pressure [1]

    Raises:
        ScenarioError: the nodes or the domain make no problem
        SolveError: no solution found
    """
    unit = line_unit(contact)
    first, last = domain or find_flooded_ends(contact)
    if n < FEWEST or not first < -1 < 1 < last:
        raise ScenarioError(
            f"contact: n = {n} nodes from {first:g} to {last:g} half widths. Give at least {FEWEST} nodes that reach "
            "beyond the contact, -1 to 1."
        )

    def grid(nodes: int) -> LineGrid:
        return grade_grid(first, last, nodes, layer(contact))

    def heights(x: Array) -> Array:
        return np.zeros_like(x) if roughness is None else roughness(x * unit.dry.a)

    moment, state = settle(unit, grid, n, heights, tolerance)
    return film_of(unit, contact, moment, state)


def film_of(unit: LineUnit, contact: Contact, moment: Moment, state: LineState) -> Film:
    """What is told of a solution; fields have shape (n, 1).

    Args:
        unit: the units it is solved in
        contact: the contact
        moment: its equations
        state: their solution
    """
    x, b, p_unit = moment.grid.x, unit.dry.a, unit.dry.p_max
    p = np.maximum(state.p, 0) * p_unit
    h = np.maximum(state.h, 0) * unit.film
    touching = np.where(state.touching, p, 0)
    cells = moment.grid.weights * b * contact.length
    return Film(
        contact=contact,
        x=x * b,
        y=np.zeros(1),
        p=p[:, None],
        h=h[:, None],
        p_asperity=touching[:, None],
        h_c=float(np.interp(0.0, x, h)),
        h_min=smallest_of_line(x, h),
        approach=-state.h_0 * unit.film,
        asperity_share=float(touching @ cells / contact.F),
        mu=friction(contact, p, np.maximum(h, LEAST_FILM), touching, cells),
        rolling_moment=float(-(x * b * p) @ cells),
        load_error=float(p @ cells / contact.F - 1),
        residual=state.residuals[-1],
        residuals=state.residuals,
        work=len(state.residuals) - 1,
    )


def smallest_of_line(x: Array, h: Array) -> float:
    """The smallest film, of the parabola through the smallest node and its neighbours.

    Args:
        x: places of the nodes (n)
        h: film (n)
    """
    i = int(np.argmin(h))
    if not 0 < i < len(x) - 1 or h[i] == 0:
        return float(h[i])
    left, right = (h[i] - h[i - 1]) / (x[i] - x[i - 1]), (h[i + 1] - h[i]) / (x[i + 1] - x[i])
    bend = (right - left) / (x[i + 1] - x[i - 1])
    slope = left + bend * (x[i] - x[i - 1])
    return float(max(h[i] - slope**2 / (4 * bend), 0.0)) if bend > 0 else float(h[i])
