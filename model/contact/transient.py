"""A contact whose load, radii and speeds change and whose rough surfaces move through it.

Reynolds' equation has the squeeze term d(rho h)/dt, by the backward difference of second order over the last two steps
(their lengths may differ; the first step is of first order, which leaves the whole of second order). Each surface
carries its roughness with its own speed. All moments share one grid and one set of units, those of the heaviest load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film, film_of
from .grid import Grid
from .newton import Problem, State, newton
from .point import FLOOR, STEPS, Height, gap, nodes, steady
from .scale import Scaled, Units, check_film, units

#: How often a step that finds no film is halved.
HALVINGS = 6


@dataclass(frozen=True)
class Moment:
    """One moment of a transient.

    Args:
        t: time [s]
        moved: how far the two surfaces have moved [m]
        contact: load, radii and speeds
        state: pressure and approach
        mass: rho h on the grid (n, n) [1]
        gap: gap of the undeformed surfaces (n, n) [1]
    """

    t: float
    moved: tuple[float, float]
    contact: Contact
    state: State
    mass: Array
    gap: Array


@dataclass(frozen=True)
class Course:
    """What all moments of a transient share.

    Args:
        grid: the grid
        unit: the units
        surfaces: heights of the two surfaces, or none
        tolerance: scaled residual at which a step stops [1]
        floor: film at which the surfaces touch [m]
    """

    grid: Grid
    unit: Units
    surfaces: tuple[Height | None, Height | None]
    tolerance: float
    floor: float

    def ground(self, contact: Contact, moved: tuple[float, float]) -> Array:
        """Gap of the undeformed surfaces (n, n) [1].

        Args:
            contact: the contact
            moved: how far the two surfaces have moved [m]
        """
        return gap(Scaled(contact, self.unit), self.grid, *map(_shift, self.surfaces, moved))

    def moment(self, t: float, moved: tuple[float, float], contact: Contact, state: State) -> Moment:
        """A solved moment.

        Args:
            t: time [s]
            moved: how far the two surfaces have moved [m]
            contact: the contact
            state: pressure and approach
        """
        ground = self.ground(contact, moved)
        floor = self.floor / self.unit.h
        film = np.maximum(state.h_0 + ground + self.grid.deformation(state.p), floor)
        mass = Scaled(contact, self.unit).reynolds(self.grid, floor).mass(state.p, film)
        return Moment(t, moved, contact, state, mass, ground)

    def after(self, past: Sequence[Moment], t: float, contact: Contact) -> Moment | None:
        """The next moment, or None where none is found.

        Args:
            past: the moments before, the last one or two of them count
            t: its time [s]
            contact: the contact then
        """
        last, rate = past[-1], self.unit.u / self.unit.a
        step = (t - last.t) * rate
        ratio = (t - last.t) / (last.t - past[-2].t) if len(past) > 1 else 0.0
        earlier = ratio**2 / (1 + ratio) * past[-2].mass if len(past) > 1 else 0.0
        now, before = (1 + 2 * ratio) / (1 + ratio) / step, (1 + ratio) / step
        moved = tuple(
            m + (t - last.t) * (old + new) / 2
            for m, old, new in zip(
                last.moved, (last.contact.u_1, last.contact.u_2), (contact.u_1, contact.u_2), strict=True
            )
        )
        case, at, floor = Scaled(contact, self.unit), (moved[0], moved[1]), self.floor / self.unit.h
        reynolds = case.reynolds(self.grid, floor, squeeze=now, past=earlier / step - before * last.mass)
        problem = Problem(self.grid, reynolds, self.ground(contact, at), case.load, floor)
        state = newton(problem, last.state, self.tolerance, STEPS // 2)
        return self.moment(t, at, contact, state) if state.residuals[-1] < self.tolerance else None


def solve_transient(
    times: Sequence[float],
    contacts: Sequence[Contact],
    *,
    n: int = 129,
    domain: tuple[float, float, float] | None = None,
    roughness_1: Height | None = None,
    roughness_2: Height | None = None,
    tolerance: float = 1e-5,
    floor: float = FLOOR,
) -> tuple[Film, ...]:
    """Films of a contact at given times, from the steady film of smooth surfaces at the first.

    Roughness is there from the first time on, under the pressure of smooth surfaces; what that stirs up has left when
    the surfaces have moved by about the length of the contact.

    Args:
        times: increasing [s]
        contacts: the contact at each of them
        n: nodes along a side of the grid, 2^k + 1
        domain: first x, last x and largest y over the half width a of the most loaded Hertz contact
        roughness_1: height [m] of the first surface at places x, y [m], where it is at the first time
        roughness_2: the same of the second surface
        tolerance: scaled residual at which a step stops, in units of the Hertz pressure [1]
        floor: film at which the surfaces touch [m]

    Raises:
        ScenarioError: times and contacts make no transient
        SolveError: no film found
    """
    if len(times) != len(contacts) or not times or any(b <= a for a, b in pairwise(times)):
        raise ScenarioError(
            f"contact: {len(times)} times and {len(contacts)} contacts. Give one contact a time, times increasing."
        )
    course = _course([check_film(c) for c in contacts], nodes(n), domain, (roughness_1, roughness_2), tolerance, floor)
    start = steady(Scaled(contacts[0], course.unit), course.grid, None, tolerance, floor)
    past = [course.moment(times[0], (0.0, 0.0), contacts[0], start)]
    films = [_film(course, past[-1])]
    for t, contact in zip(times[1:], contacts[1:], strict=True):
        past = _advance(course, past, t, contact, HALVINGS)
        films.append(_film(course, past[-1]))
    return tuple(films)


def _course(
    contacts: Sequence[Contact],
    n: int,
    domain: tuple[float, float, float] | None,
    surfaces: tuple[Height | None, Height | None],
    tolerance: float,
    floor: float,
) -> Course:
    """Units of the most loaded contact, and a grid that holds the inlets of all."""
    heaviest = units(max(contacts, key=lambda c: units(c).a))
    unit = replace(heaviest, u=max(units(c).u for c in contacts))
    grids = [Scaled(c, unit).grid(n, domain) for c in contacts]
    ahead = min(g.x[0] for g in grids)
    grid = Grid((ahead, max(g.x[1] for g in grids)), max((g.y for g in grids), key=max), n, grids[0].elastic)
    return Course(grid, unit, surfaces, tolerance, floor)


def _advance(course: Course, past: list[Moment], t: float, contact: Contact, halvings: int) -> list[Moment]:
    """The last two moments up to time t, by half steps where a whole one finds no film."""
    found = course.after(past, t, contact)
    if found is not None:
        return [past[-1], found]
    if not halvings:
        raise SolveError(f"contact: no film found at t = {t:g} s. Give times closer to one another, or a finer grid.")
    middle = _between(past[-1].contact, contact)
    past = _advance(course, past, (past[-1].t + t) / 2, middle, halvings - 1)
    return _advance(course, past, t, contact, halvings - 1)


def _between(a: Contact, b: Contact) -> Contact:
    """The contact half way between two, linear in load, curvatures and speeds."""

    def mean(name: str, power: int = 1) -> float:
        x, y = getattr(a, name), getattr(b, name)
        return float(((x**power + y**power) / 2) ** power) if x < np.inf else x

    return replace(b, F=mean("F"), u_1=mean("u_1"), u_2=mean("u_2"), R_x=mean("R_x", -1), R_y=mean("R_y", -1))


def _shift(height: Height | None, moved: float) -> Height | None:
    """A surface after it has moved along x."""
    return None if height is None else lambda x, y: height(x - moved, y)


def _film(course: Course, moment: Moment) -> Film:
    """What is told of a moment."""
    case = Scaled(moment.contact, course.unit)
    return film_of(case, course.grid, moment.state, moment.gap, course.floor)
