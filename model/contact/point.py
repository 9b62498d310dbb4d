"""A steady contact, in the plane by Newton's method on grids from coarse to fine, each starting from the one before."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import ceil, inf, log

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film, film_of
from .grid import Grid, prolong, restrict
from .line import solve_line
from .newton import Problem, State, newton
from .scale import REST, Scaled, check_film, units

#: Height of a rough surface [m] at places x and y [m].
Height = Callable[[Array, Array], Array]
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


def solve(
    contact: Contact,
    *,
    n: int = 257,
    domain: tuple[float, float, float] | None = None,
    roughness: Height | None = None,
    tolerance: float = 1e-6,
    floor: float = FLOOR,
) -> Film:
    """The steady film of a contact.

    Args:
        contact: the contact
        n: nodes along a side of the finest grid, 2^k + 1; of a line contact, any number
        domain: first x, last x and largest y over the half width a of the Hertz contact
        roughness: height [m] of a surface that stands still, at places x and y [m]
        tolerance: scaled residual at which it stops, in units of the Hertz pressure [1]
        floor: film at which the surfaces touch [m]; not of a line contact

    Raises:
        ScenarioError: n or the contact make no problem
        SolveError: no solution found
    """
    if not (contact.R_y < inf or contact.edge_radius > 0):
        profile = None if roughness is None else partial(_along, roughness)
        return solve_line(contact, n=n, domain=domain[:2] if domain else None, roughness=profile, tolerance=tolerance)
    case = Scaled(check_film(contact), units(contact))
    grid = case.grid(nodes(n), domain)
    state = steady(case, grid, roughness, tolerance, floor)
    if not state.residuals[-1] < tolerance:
        raise SolveError(
            f"contact: no film found on {n} x {n} nodes (residual {state.residuals[-1]:.1e}). "
            "Refine the grid: n = 2^k + 1, larger."
        )
    return film_of(case, grid, state, gap(case, grid, roughness), floor)


def _along(height: Height, x: Array) -> Array:
    """Heights of a rough surface along the middle of a line contact [m]."""
    return height(x, np.zeros_like(x))


def steady(case: Scaled, finest: Grid, roughness: Height | None, tolerance: float, floor: float) -> State:
    """Pressure and approach on the finest grid.

    Args:
        case: the contact in its units
        finest: the grid
        roughness: height of a surface that stands still, or none
        tolerance: scaled residual at which it stops [1]
        floor: film at which the surfaces touch [m]
    """
    grids = [finest]
    while grids[0].n > FIRST:
        grids.insert(0, grids[0].coarser)
    grounds = [gap(case, finest, roughness) - case.gap(finest)]
    for _ in grids[1:]:
        grounds.insert(0, restrict(grounds[0]))
    speed = _resolvable(case, grids[0], grounds[0])
    state = _guess(case, grids[0], speed)
    smallest = floor / case.unit.h
    before: Array | None = None
    for grid, rough in zip(grids, grounds, strict=True):
        last = grid is finest
        ground = case.gap(grid) + rough
        for faster in _descent(speed, 1.0 if last else _resolvable(case, grid, rough)):
            speed = faster
            problem = Problem(grid, case.reynolds(grid, smallest, speed), ground, case.load, smallest)
            enough = tolerance if last and speed == 1.0 else max(tolerance, COARSE)
            state, before = newton(problem, state, enough, STEPS, before), None
        if not last:
            film = state.h_0 + ground + grid.deformation(state.p)
            state, before = finer(state), prolong(np.maximum(film, smallest))
    return state


def gap(case: Scaled, grid: Grid, *surfaces: Height | None) -> Array:
    """Gap of the undeformed bodies less the heights of their surfaces (n, n) [1].

    Args:
        case: the contact
        grid: the grid
        surfaces: height of each [m] at places [m]
    """
    out = case.gap(grid)
    x, y = (c * case.unit.a for c in np.broadcast_arrays(*grid.nodes))
    for height in surfaces:
        if height is not None:
            out = out - height(x, y) / case.unit.h
    return out


def nodes(n: int) -> int:
    """The number of nodes along a side.

    Raises:
        ScenarioError: it is not 2^k + 1 or too small
    """
    if n < FIRST or (n - 1) & (n - 2):
        raise ScenarioError(f"contact: n = {n} nodes a side. Give 2^k + 1, at least {FIRST}: 65, 129, 257, 513.")
    return n


def _resolvable(case: Scaled, grid: Grid, rough: Array) -> float:
    """Factor on the speed, at least 1, at which the film is not below what the grid can resolve.

    A coarse grid thins a film by about the square of the distance of its nodes; a film it would close starts no
    solution on the next grid. Neither does one that the highest asperities close before they are resolved.
    """
    film = max(RESOLVED * grid.hx**2, -float(rough.min()))
    return max(1.0, (film / case.film) ** 1.5) if case.film > 0 else 1.0


def _descent(start: float, end: float) -> list[float]:
    """Factors on the speed from that of the last solution down to the next one."""
    steps = max(1, ceil(log(start / end) / log(SLOWER)))
    return [end * (start / end) ** (1 - k / steps) for k in range(1, steps + 1)]


def _guess(case: Scaled, grid: Grid, speed: float) -> State:
    """Hertz pressure on the coarsest grid, raised to the film of a formula at a factor on the speed."""
    x, y = grid.nodes
    across = y * case.unit.a / case.unit.b
    along = 1 - x**2
    p = np.sqrt(np.maximum(along * (np.abs(across) <= 1) if case.contact.edge_radius else along - across**2, 0.0))
    p *= case.load / (p.sum() * grid.hx * grid.hy)
    h_0 = case.film * speed**0.67 - float((case.gap(grid) + grid.deformation(p)).min())
    return State(p, h_0, np.full(p.shape, case.contact.u_m < REST) & (p > 0))


def finer(state: State) -> State:
    """A state on the grid of half the distance."""
    touching = prolong(state.touching.astype(float)) > 0.5
    return State(prolong(state.p), state.h_0, touching, work=state.work)
