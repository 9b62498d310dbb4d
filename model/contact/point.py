"""A steady contact in the plane: Newton's method on grids from coarse to fine, each starting from the one before."""

from __future__ import annotations

from math import ceil, log

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film, friction, smallest
from .grid import COARSEST, Grid, prolong
from .newton import Problem, State, newton
from .scale import REST, Scaled, central_film, scaled

#: Nodes along a side of the grid on which a contact is first solved.
FIRST = 33
#: Largest number of Newton steps on a grid.
STEPS = 60
#: Films are resolved by a grid down to this times the square of the distance of its nodes.
RESOLVED = 10.0
#: Largest factor by which the speed falls from one solution to the next.
SLOWER = 4.0
#: Tolerance of solutions that only start the next one.
COARSE = 1e-3
#: Film at which surfaces touch: a few molecules of oil [m].
FLOOR = 1e-9


def solve_point(
    contact: Contact,
    *,
    n: int = 257,
    domain: tuple[float, float, float] | None = None,
    tolerance: float = 1e-6,
    floor: float = FLOOR,
) -> Film:
    """A steady elliptical contact or a roller of finite length.

    Args:
        contact: the contact
        n: nodes along a side of the finest grid, 2^k + 1
        domain: first x, last x and largest y over the half width a of the Hertz contact
        tolerance: scaled residual at which it stops, in units of the Hertz pressure [1]
        floor: film at which the surfaces touch [m]

    Raises:
        ScenarioError: n or the contact make no problem
        SolveError: no solution found
    """
    unit = scaled(contact)
    grids = hierarchy(unit.grid(checked(n), domain))
    speed = resolvable(unit, grids[0])
    state = first_guess(unit, grids[0], speed)
    for i, grid in enumerate(grids):
        if i:
            state = finer(state)
        for faster in descent(speed, resolvable(unit, grid) if i < len(grids) - 1 else 1.0):
            speed = faster
            problem = Problem(grid, unit.reynolds(grid, speed), unit.gap(grid), unit.load, floor / unit.film_unit)
            last = i == len(grids) - 1 and speed == 1.0
            state = newton(problem, state, tolerance if last else max(tolerance, COARSE), STEPS)
    if not state.residuals[-1] < tolerance:
        raise SolveError(
            f"contact: no film found on {n} x {n} nodes (residual {state.residuals[-1]:.1e}). "
            "Refine the grid: n = 2^k + 1, larger."
        )
    return film_of(unit, grids[-1], state, floor)


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


def resolvable(unit: Scaled, grid: Grid) -> float:
    """Factor on the speed, at least 1, at which the film is not below what the grid can resolve.

    Args:
        unit: the contact
        grid: the grid
    """
    film = central_film(unit.contact) / unit.film_unit
    return max(1.0, (RESOLVED * grid.hx**2 / film) ** 1.5) if film > 0 else 1.0


def descent(start: float, end: float) -> list[float]:
    """Factors on the speed from that of the last solution down to the next one.

    Args:
        start: factor of the last solution
        end: factor wanted
    """
    steps = max(1, ceil(log(start / end) / log(SLOWER)))
    return [end * (start / end) ** (1 - k / steps) for k in range(1, steps + 1)]


def first_guess(unit: Scaled, grid: Grid, speed: float) -> State:
    """Hertz pressure, raised to the film of a formula.

    Args:
        unit: the contact
        grid: the coarsest grid
        speed: factor on the speed
    """
    x, y = grid.nodes
    if unit.dry.b < np.inf:
        inside = 1 - x**2 - (y * unit.dry.a / unit.dry.b) ** 2
    else:
        inside = (1 - x**2) * (np.abs(y) <= unit.contact.length / 2 / unit.dry.a)
    p = np.sqrt(np.maximum(inside, 0.0))
    p *= unit.load / (p.sum() * grid.hx * grid.hy)
    film = central_film(unit.contact) / unit.film_unit * speed**0.67
    h_0 = film - float((unit.gap(grid) + grid.deformation(p)).min())
    return State(p, h_0, np.full(p.shape, unit.contact.u_m < REST) & (p > 0))


def finer(state: State) -> State:
    """A state on the grid of half the distance."""
    touching = prolong(state.touching.astype(float)) > 0.5
    return State(prolong(state.p), state.h_0, touching, work=state.work)


def film_of(unit: Scaled, grid: Grid, state: State, floor: float) -> Film:
    """What is told of a solution.

    Args:
        unit: the contact
        grid: its grid
        state: pressures and approach on it
        floor: film at which the surfaces touch [m]
    """
    contact, a, p_h = unit.contact, unit.dry.a, unit.dry.p_max
    x, y = (np.asarray(c.ravel() * a) for c in grid.nodes)
    p = np.ascontiguousarray(state.p.T * p_h)
    p_asperity = np.where(state.touching.T, p, 0.0)
    film = state.h_0 + unit.gap(grid) + grid.deformation(state.p)
    h = np.maximum(np.ascontiguousarray(film.T * unit.film_unit), floor)
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
        work=state.work,
    )


def _central(x: Array, h: Array) -> float:
    """Film at the origin [m]."""
    return float(np.interp(0.0, x, h[:, h.shape[1] // 2]))
