"""The units in which a contact is solved, the part of the plane it takes, and the first guess of its film."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, exp, inf, log, pi, sqrt

import numpy as np

from ..errors import ScenarioError
from .case import Array, Contact, hertz
from .grid import COARSEST, Grid
from .reynolds import Reynolds

#: Speed below which a contact rests: its film would be thinner than an atom.
REST = 1e-12


def central_film(contact: Contact) -> float:
    """Central film expected [m], for a first guess and the size of the grid.

    The thicker of the elastic film of Hamrock and Dowson (J. Lubr. Technol. 99, 1977) and that between rigid bodies
    (Brewe, Hamrock and Taylor, J. Lubr. Technol. 101, 1979); of a line contact, Dowson's (Proc. IMechE 182, 1968).
    """
    oil, e, r = contact.lubricant, contact.E_eff, contact.R_x
    if contact.u_m <= 0:
        return 0.0
    u, g = oil.eta_0 * contact.u_m / (e * r), oil.alpha_p * e
    if contact.R_y == inf or contact.edge_radius > 0:
        w = contact.F / contact.length / (e * r)
        return float(2.65 * r * u**0.7 * g**0.54 * w**-0.13)
    w, ratio = contact.F / (e * r**2), contact.R_y / r
    elastic = 2.69 * u**0.67 * g**0.53 * w**-0.067 * (1 - 0.61 * exp(-0.73 * 1.03 * ratio**0.64))
    leakage = ratio / (1 + 2 / (3 * ratio)) ** 2 * (0.131 * atan(ratio / 2) + 1.683) ** 2
    return float(r * max(elastic, 128 * leakage * (u / w) ** 2))


@dataclass(frozen=True)
class Units:
    """What lengths, pressures, films and speeds are measured by.

    Args:
        a: half width of a Hertz contact [m]
        b: its half length, or half of the length of a roller [m]
        p: its peak pressure [Pa]
        h: film [m]
        u: mean speed [m/s]
    """

    a: float
    b: float
    p: float
    h: float
    u: float


def units(contact: Contact) -> Units:
    """The units in which a contact is of the order of 1."""
    dry = hertz(contact)
    b = dry.b if contact.edge_radius == 0 else contact.length / 2
    return Units(dry.a, b, dry.p_max, dry.a**2 / contact.R_x, max(contact.u_m, REST))


@dataclass(frozen=True)
class Scaled:
    """A contact in such units.

    Args:
        contact: the contact
        unit: the units
    """

    contact: Contact
    unit: Units

    @property
    def load(self) -> float:
        """Integral of the pressure [1]."""
        return self.contact.F / (self.unit.p * self.unit.a**2)

    @property
    def elastic(self) -> float:
        """Deformation of a unit of the integral of pressure over distance [1]."""
        return 2 * self.unit.p * self.unit.a / (pi * self.contact.E_eff * self.unit.h)

    @property
    def film(self) -> float:
        """Central film expected [1]."""
        return central_film(self.contact) / self.unit.h

    def gap(self, grid: Grid) -> Array:
        """Gap of the undeformed bodies over the grid (n, n) [1]."""
        (x, y), c = grid.nodes, self.contact
        curve = self.unit.a**2 / (2 * self.unit.h)
        side = y**2 / c.R_y
        if c.edge_radius > 0:
            side = side + np.maximum(np.abs(y) - c.length / (2 * self.unit.a), 0.0) ** 2 / c.edge_radius
        return np.asarray(curve * (x**2 / c.R_x + side))

    def reynolds(
        self, grid: Grid, floor: float, faster: float = 1.0, squeeze: float = 0.0, past: Array | float = 0.0
    ) -> Reynolds:
        """Reynolds' equation of the contact.

        Args:
            grid: the grid
            floor: film at which the surfaces touch [1]
            faster: factor on the unit of speed, and so on the mean speed [1]
            squeeze: factor of the present d(rho h)/dt [1]
            past: what earlier moments add to d(rho h)/dt (n, n) [1]
        """
        oil, unit = self.contact.lubricant, self.unit
        kappa = unit.h**2 * unit.p / (12 * oil.eta_0 * unit.u * faster * unit.a)
        wedge = self.contact.u_m / unit.u if self.contact.u_m > REST else 0.0
        if wedge == 0 and squeeze == 0:
            kappa = 0.0  # at rest the oil has left
        return Reynolds(oil, unit.p, kappa, wedge, grid.hx, grid.hy, squeeze, past, floor, self.contact.edge_radius > 0)

    def grid(self, n: int, domain: tuple[float, float, float] | None = None) -> Grid:
        """The finest grid.

        Args:
            n: nodes along a side
            domain: first x, last x and largest y, over a; without it, wide enough for a flooded inlet
        """
        x_in, x_out, side = domain or self._domain()
        return Grid((x_in, x_out), (-side, side), n, self.elastic)

    def _domain(self) -> tuple[float, float, float]:
        """First x, last x and largest y. The inlet reaches twice as far ahead as starvation begins to thin the film
        (Hamrock and Dowson, J. Lubr. Technol. 99, 1977, part IV), and the middle of the contact is a node."""
        ahead = 6.1 * self.film**0.58
        parts = COARSEST - 1
        x_out = 1.5
        k = next((k for k in range(parts // 2, 13) if x_out * k / (parts - k) >= 1 + ahead), 12)
        x_out = max(x_out, (1 + ahead) * (parts - k) / k)
        slender, ends = self.unit.b / self.unit.a, 0.0
        if self.contact.edge_radius:  # as far as the rounded ends are twice as far apart as a line contact approaches
            ends = sqrt(2 * self.contact.edge_radius * self.unit.h * (log(2 * slender) + 0.5)) / self.unit.a
        return -x_out * k / (parts - k), x_out, slender + ends + 0.5 + 0.45 * ahead


def check_film(contact: Contact) -> Contact:
    """The contact, if it has a film in the plane.

    Raises:
        ScenarioError: the oil enters from the wrong side, or the contact has no ends
    """
    if contact.u_m < 0:
        raise ScenarioError(
            f"contact: the mean speed {contact.u_m:g} m/s points out of the inlet. "
            "Let x point the way the oil is drawn in: swap the signs of u_1 and u_2."
        )
    if contact.R_y == inf and contact.edge_radius == 0:
        raise ScenarioError("contact: a line contact has no ends. Give R_y or edge_radius for a grid in the plane.")
    return contact
