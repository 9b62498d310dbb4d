"""A line contact over time: load, radius, speeds and oil change, rough surfaces move, and films are squeezed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..errors import ScenarioError, SolveError
from .case import Array, Contact
from .film import Film
from .line import film_of, settle
from .line_system import LineState, Moment, grade_grid, newton
from .line_unit import find_flooded_ends, line_unit

#: How often a time step may be halved before the cycle is given up.
HALVINGS = 8
#: Factor from a halved step that succeeded to the next one.
LONGER = 2.0

#: Height of a surface over the place on it [m].
Profile = Callable[[Array], Array]


@dataclass(frozen=True)
class Past:
    """Density times film at the last two moments (n) and the step between them [s]; none before the first step."""

    mass: Array
    before: Array | None = None
    step: float = 0.0


def solve_line_cycle(
    contacts: Sequence[Contact],
    times: Sequence[float],
    *,
    n: int = 301,
    steps: int = 4,
    domain: tuple[float, float] | None = None,
    surfaces: tuple[Profile | None, Profile | None] = (None, None),
    tolerance: float = 1e-8,
) -> list[Film]:
    """The films of a line contact at given moments, from the steady film at the first of them. Second order in time.

    Between two moments load, radius, speeds and viscosity change linearly.

    Args:
        contacts: the contact at each moment
        times: the moments, rising [s]
        n: number of nodes, at equal distances
        steps: time steps between two moments
        domain: first and last x over the half width of each Hertz contact
        surfaces: height of each of the two surfaces over the place on it [m]; at the first moment it lies over x
        tolerance: largest residual, in units of the first Hertz pressure [1]

    Raises:
        ScenarioError: moments and contacts do not belong to each other
        SolveError: no solution found at some moment
    """
    if len(contacts) != len(times) or len(times) < 1 or not (np.diff(times) > 0).all() or steps < 1:
        raise ScenarioError("contact: give one contact for each moment, moments that rise, and at least one step.")
    march = _March(tuple(contacts), tuple(times), n, domain, surfaces, tolerance)
    films = [march.film()]
    for i in range(len(times) - 1):
        march.on(i, (times[i + 1] - times[i]) / steps)
        films.append(march.film())
    return films


class _March:
    """The state on its way through time."""

    def __init__(
        self,
        contacts: tuple[Contact, ...],
        times: tuple[float, ...],
        n: int,
        domain: tuple[float, float] | None,
        surfaces: tuple[Profile | None, Profile | None],
        tolerance: float,
    ) -> None:
        self.contacts, self.times, self.surfaces, self.tolerance = contacts, times, surfaces, tolerance
        self.unit = line_unit(contacts[0])
        spans = [np.multiply(domain or find_flooded_ends(c), line_unit(c).dry.a / self.unit.dry.a) for c in contacts]
        first, last = min(s[0] for s in spans), max(s[1] for s in spans)
        self.span = float(first), float(last)
        self.t, self.contact, self.moved = times[0], contacts[0], np.zeros(2)
        even = partial(grade_grid, *self.span, layer=0.0)
        self.moment, self.state = settle(self.unit, even, n, lambda x: self._heights(x, self.moved), tolerance)
        self.grid = self.moment.grid
        self.past = Past(self._mass(self.moment, self.state))

    def _heights(self, x: Array, moved: Array) -> Array:
        """Sum of the heights of both surfaces at the nodes [m]."""
        places = x * self.unit.dry.a
        found = [profile(places - s) for profile, s in zip(self.surfaces, moved, strict=True) if profile is not None]
        return np.asarray(sum(found, np.zeros_like(x)))

    def _mass(self, moment: Moment, state: LineState) -> Array:
        pressure = np.maximum(state.p, 0) * moment.p_unit
        return np.asarray(moment.lubricant.density(pressure) * state.h)

    def film(self) -> Film:
        """The film at the present moment."""
        return film_of(self.unit, self.contact, self.moment, self.state)

    def on(self, i: int, step: float) -> None:
        """To the end of an interval.

        Args:
            i: number of the interval
            step: time step to begin with [s]
        """
        end, halved = self.times[i + 1], 0
        while self.t < end * (1 - 1e-12) - 1e-300:
            taken = min(step, end - self.t)
            if end - self.t - taken < 1e-6 * step:
                taken = end - self.t
            try:
                self._step(i, taken)
                step = min(step * LONGER, (end - self.times[i])) if halved else step
                halved = max(halved - 1, 0)
            except SolveError:
                halved += 1
                step = taken / 2
                if halved > HALVINGS:
                    raise

    def _step(self, i: int, dt: float) -> None:
        """One step of the backward differences of second order, of first order where there is no past."""
        t, past = self.t + dt, self.past
        there = _between(self.contacts[i], self.contacts[i + 1], t, self.times[i], self.times[i + 1])
        speeds = np.array([there.u_1 + self.contact.u_1, there.u_2 + self.contact.u_2]) / 2
        moved = self.moved + speeds * dt
        now, rate = 1 / dt, -past.mass / dt
        if past.before is not None:
            r = dt / past.step
            now = (1 + 2 * r) / (1 + r) / dt
            rate = (-(1 + r) * past.mass + r**2 / (1 + r) * past.before) / dt
        factor = self.unit.rate(there) * self.unit.dry.a
        moment = self.unit.moment(there, self.grid, self._heights(self.grid.x, moved))
        moment = replace(moment, squeeze=factor * now, past=factor * rate)
        state = newton(moment, self.state.p, self.state.h_0, self.tolerance)
        self.t, self.contact, self.moved, self.moment, self.state = t, there, moved, moment, state
        self.past = Past(self._mass(moment, state), past.mass, dt)


def _between(a: Contact, b: Contact, t: float, t_a: float, t_b: float) -> Contact:
    """The contact at a moment between two."""
    s = min((t - t_a) / (t_b - t_a), 1.0)

    def mean(p: float, q: float) -> float:
        return p + s * (q - p)

    oil = replace(a.lubricant, eta_0=mean(a.lubricant.eta_0, b.lubricant.eta_0))
    radius = 1 / mean(1 / a.R_x, 1 / b.R_x)
    speeds = {"u_1": mean(a.u_1, b.u_1), "u_2": mean(a.u_2, b.u_2)}
    return replace(a, F=mean(a.F, b.F), R_x=radius, lubricant=oil, **speeds)
