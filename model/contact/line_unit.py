"""The units in which a line contact is solved, the film to expect, and how much of the plane it takes."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf, pi, sqrt

from ..errors import ScenarioError
from .case import Array, Contact, Hertz, hertz
from .line_system import LineGrid, Moment

#: Film below which there is none: the size of an atom [m].
ATOM = 1e-10
#: Thickness of the layers at the edges of the contact, over the power 2/3 of the film.
LAYER = 2.0


@dataclass(frozen=True)
class LineUnit:
    """The units of a line contact: its half width and pressure when dry, and b^2/R for films.

    Args:
        contact: the contact
        dry: the same without oil
    """

    contact: Contact
    dry: Hertz

    @property
    def film(self) -> float:
        """Unit of films [m]."""
        return self.dry.a**2 / self.contact.R_x

    def rate(self, contact: Contact) -> float:
        """12 eta_0 R^2 / (b^3 p_unit) of a contact in these units [s/m]; times a speed it is the flow by motion."""
        scale = self.contact.R_x**2 / (self.dry.a**3 * self.dry.p_max)
        return 12 * contact.lubricant.eta_0 * scale

    def moment(self, contact: Contact, grid: LineGrid, roughness: Array | float = 0.0) -> Moment:
        """The equations of a contact, which may differ from that of the units in load, radius, speed and oil.

        Args:
            contact: the contact
            grid: the nodes (n)
            roughness: height of the surfaces, which narrows the gap [m] (n)
        """
        load = contact.F / contact.length / (self.dry.p_max * self.dry.a)
        gap = grid.x**2 / 2 * (self.contact.R_x / contact.R_x) - roughness / self.film
        speed = contact.u_m if film_number(contact) * hertz(contact).a ** 2 / contact.R_x > ATOM else 0.0
        return Moment(grid, contact.lubricant, self.dry.p_max, self.rate(contact) * speed, load, gap)


def line_unit(contact: Contact) -> LineUnit:
    """The units of a line contact. Raises ScenarioError for another shape."""
    if contact.R_y < inf or contact.edge_radius > 0:
        raise ScenarioError("contact: R_y or edge_radius is given. A line contact has neither: take solve instead.")
    return LineUnit(contact, hertz(contact))


def numbers(contact: Contact) -> tuple[float, float]:
    """The load number M and the lubricant number L of Moes, with the sum of the speeds; M is infinite at rest."""
    U = 2 * contact.lubricant.eta_0 * abs(contact.u_m) / (contact.E_eff * contact.R_x)
    W = contact.F / contact.length / (contact.E_eff * contact.R_x)
    return (W / sqrt(U) if U > 0 else inf), contact.lubricant.alpha_p * contact.E_eff * sqrt(sqrt(U))


def film_number(contact: Contact) -> float:
    """Central film by the asymptotes of Moes, in units of b^2/R."""
    M, L = numbers(contact)
    if isinf(M):
        return 0.0
    isoviscous = ((2.448 / M) ** (7 / 3) + (2.621 * M**-0.2) ** (7 / 3)) ** (3 / 7)
    stiff = min(1.287 * L ** (2 / 3), 1.311 * M**-0.125 * L**0.75)
    return float(max(isoviscous, stiff) * pi / (8 * M))


def layer(contact: Contact) -> float:
    """Thickness of the layers at the edges of the contact, in half widths."""
    return float(min(max(LAYER * film_number(contact) ** (2 / 3), 0.01), 1.0))


def find_flooded_ends(contact: Contact) -> tuple[float, float]:
    """First and last x of a flooded contact, over its half width; the oil comes from where the speed says."""
    width = sqrt(2 * film_number(contact))
    inlet, outlet = -(3.0 + 12 * width + 8 * width**2 / (1 + width)), 1.5 + 2 * width
    return (inlet, outlet) if contact.u_m >= 0 else (-outlet, -inlet)
