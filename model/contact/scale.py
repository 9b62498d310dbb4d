"""The units in which a contact is solved, the part of the plane it takes, and the first guess of its film."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, pi

import numpy as np

from ..errors import ScenarioError
from .case import Array, Contact
from .grid import COARSEST, Grid
from .hertz import Hertz, hertz
from .reynolds import Reynolds

#: Speed below which a contact rests: its film would be thinner than an atom.
REST = 1e-12


def central_film(contact: Contact) -> float:
    """Central film of an elliptical contact by Hamrock and Dowson (J. Lubr. Technol. 99, 1977) [m], a first guess."""
    oil, e, r = contact.lubricant, contact.E_eff, contact.R_x
    if contact.u_m <= 0:
        return 0.0
    u, g, w = oil.eta_0 * contact.u_m / (e * r), oil.alpha_p * e, contact.F / (e * r**2)
    k = inf if contact.R_y == inf or contact.edge_radius > 0 else 1.03 * (contact.R_y / r) ** 0.64
    if k == inf:
        w = contact.F / contact.length / (e * r)
        return 2.92 * r * u**0.692 * g**0.47 * w**-0.166
    return 2.69 * r * u**0.67 * g**0.53 * w**-0.067 * (1 - 0.61 * exp(-0.73 * k))


@dataclass(frozen=True)
class Scaled:
    """A contact in units of its Hertz contact: lengths over a, films over a^2/R_x, pressures over p_h.

    Args:
        contact: the contact
        dry: its Hertz contact, whose a, p_max are the units
    """

    contact: Contact
    dry: Hertz

    @property
    def film_unit(self) -> float:
        """Unit of films [m]."""
        return self.dry.a**2 / self.contact.R_x

    @property
    def load(self) -> float:
        """Integral of the pressure [1]."""
        return self.contact.F / (self.dry.p_max * self.dry.a**2)

    @property
    def elastic(self) -> float:
        """Deformation of a unit of the integral of pressure over distance [1]."""
        return 2 * self.dry.p_max * self.contact.R_x / (pi * self.contact.E_eff * self.dry.a)

    def gap(self, grid: Grid) -> Array:
        """Gap of the undeformed bodies over the grid (n, n) [1]."""
        x, y = grid.nodes
        c = self.contact
        side = y**2 * (c.R_x / c.R_y) / 2
        if c.edge_radius > 0:
            beyond = np.maximum(np.abs(y) - c.length / 2 / self.dry.a, 0.0)
            side = side + beyond**2 * (c.R_x / c.edge_radius) / 2
        return np.asarray(x**2 / 2 + side)

    def reynolds(self, grid: Grid, faster: float = 1.0, squeeze: float = 0.0, past: Array | float = 0.0) -> Reynolds:
        """Reynolds' equation of the contact.

        Args:
            grid: the grid
            faster: factor on the mean speed [1]
            squeeze: factor of the present d(rho h)/dt [1]
            past: what earlier moments add to d(rho h)/dt (n, n) [1]
        """
        c, unit = self.contact, self.dry
        speed = max(c.u_m, REST) * faster
        kappa = unit.p_max * unit.a**3 / (12 * c.lubricant.eta_0 * speed * c.R_x**2)
        wedge = 0.0 if c.u_m < REST else 1.0
        return Reynolds(c.lubricant, unit.p_max, kappa, wedge, grid.hx, grid.hy, squeeze, past)

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
        ahead = 6.1 * (central_film(self.contact) / self.film_unit) ** 0.58
        parts = COARSEST - 1
        x_out = 1.5
        k = next((k for k in range(parts // 2, 13) if x_out * k / (parts - k) >= 1 + ahead), 12)
        x_out = max(x_out, (1 + ahead) * (parts - k) / k)
        b = self.dry.b if self.dry.b < inf else self._half_length()
        return -x_out * k / (parts - k), x_out, b / self.dry.a + 0.5 + 0.45 * ahead

    def _half_length(self) -> float:
        """Half of the loaded length of a roller with rounded ends [m]."""
        c = self.contact
        approach = self.film_unit  # of the order of the approach of the straight part
        return c.length / 2 + (2 * c.edge_radius * approach) ** 0.5


def scaled(contact: Contact) -> Scaled:
    """The contact in its own units.

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
    return Scaled(contact, hertz(contact))
