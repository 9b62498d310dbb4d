"""A line contact in steady state, and what is told of a solution.

The way to its film begins with coarse grids, a softer oil, a higher speed and smooth surfaces.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import copysign, log, sqrt

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film, friction
from .line_system import LineGrid, LineState, Moment, grade_grid, newton
from .line_unit import LineUnit, film_number, find_flooded_ends, layer, line_unit, numbers

#: How many nodes the first grid has.
FIRST = 81
#: Moes' lubricant number up to which the Hertz pressure is a good start.
SOFT = 1.5
#: Moes' load number up to which the Hertz pressure is a good start.
EASY = 10.0
#: Factor of the lubricant number in a step towards a stiffer oil.
STIFFER = 1.5
#: Factor of the speed in a step towards another one.
SLOWER = 4.0
#: Share of the roughness that a step adds.
ROUGHER = 0.25
#: Smallest share of a step before the start is given up.
LEAST_STEP = 0.02
#: Film in whose place none is, for its shear [m].
LEAST_FILM = 1e-12
#: Fewest nodes.
FEWEST = 51


def settle(
    unit: LineUnit, grids: Callable[[int], LineGrid], n: int, heights: Callable[[Array], Array], tolerance: float
) -> tuple[Moment, LineState]:
    """The equations of the units' contact in steady state, and their solution.

    Args:
        unit: the units
        grids: the grid of a number of nodes
        n: number of nodes
        heights: height of the surfaces [m] over the nodes in units of the half width
        tolerance: largest residual, in units of the Hertz pressure

    Raises:
        SolveError: no solution found
    """
    state: LineState | None = None
    before: LineGrid | None = None
    for nodes in _ladder(n):
        moment = unit.moment(unit.contact, grids(nodes))
        try:
            state, before = _smooth(unit, moment, state, before, tolerance), moment.grid
        except SolveError:  # the next grid may be fine enough
            if nodes == n:
                raise
    assert state is not None
    rough = heights(moment.grid.x)
    if not rough.any():
        return moment, state

    def at(share: float) -> tuple[Moment, float]:
        return unit.moment(unit.contact, moment.grid, share * rough), 0.0

    return at(1.0)[0], _follow(at, state, 1.0, ROUGHER, tolerance)


def _smooth(
    unit: LineUnit, moment: Moment, start: LineState | None, before: LineGrid | None, tolerance: float
) -> LineState:
    """A solution, from that on a coarser grid where there is one, else from a softer oil at a higher speed."""
    if start is not None and before is not None:
        p = np.interp(moment.grid.x, before.x, start.p)
        with suppress(SolveError):
            return newton(moment, p, start.h_0, tolerance)
    M, L = numbers(unit.contact)
    soft, faster = min(1.0, SOFT / max(L, 1e-9)), 1.0 if moment.dry else max(M / EASY, 1.0) ** 2

    def at(share: float) -> tuple[Moment, float]:
        """The equations on the way, and the film to be expected there."""
        left, c = 1 - share, unit.contact
        oil, speed = replace(moment.lubricant, alpha_p=moment.lubricant.alpha_p * soft**left), faster**left
        there = replace(c, u_1=c.u_1 * speed, u_2=c.u_2 * speed, lubricant=oil)
        return replace(moment, lubricant=oil, couette=moment.couette * speed), film_number(there)

    steps = max(abs(log(soft)) / log(STIFFER), abs(log(faster)) / log(SLOWER), 1e-9)
    return _follow(at, _first(*at(0.0), tolerance), min(1.0, 1 / steps), 1 / steps, tolerance)


def _follow(
    at: Callable[[float], tuple[Moment, float]], state: LineState, step: float, unit: float, tolerance: float
) -> LineState:
    """The solution at the end of a way of equations, from that at its beginning.

    Args:
        at: equations and film to be expected at a share of the way
        state: solution at its beginning
        step: share of the way to begin with
        unit: share of the way that is an ordinary step
        tolerance: largest residual

    Raises:
        SolveError: a step gets too short
    """
    share, film = 0.0, at(0.0)[1]
    while share < 1:
        aim = min(1.0, share + step)
        there, next_film = at(aim)
        try:
            state = newton(there, state.p, state.h_0 + next_film - film, tolerance)
        except SolveError:
            step /= 2
            if step < LEAST_STEP * unit:
                raise
            continue
        share, film = aim, next_film
    return state


def _first(moment: Moment, film: float, tolerance: float) -> LineState:
    """A solution from the Hertz pressure, or that of a rigid wedge, under several times the film expected."""
    x, width = moment.grid.x, sqrt(2 * film)
    p = np.sqrt(np.maximum(1 - x**2, 0))
    if width > 1:
        p = np.maximum(1 - ((x + copysign(width, moment.couette) / 2) / width) ** 2, 0) ** 2
    p *= moment.load / float(moment.grid.weights @ p)
    below = float(np.interp(0.0, x, moment.film(p, 0.0)))
    for times in (2.0, 4.0, 8.0, 1.0) if width < 1 else (0.7, 0.4, 1.0):
        try:
            return newton(moment, p, times * film - below, tolerance)
        except SolveError as error:
            problem = error
    raise problem


def _ladder(n: int) -> list[int]:
    """Numbers of nodes from coarse to fine."""
    steps = [n]
    while steps[0] > 2 * FIRST:
        steps.insert(0, (steps[0] + 1) // 2)
    return steps


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
