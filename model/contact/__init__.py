"""Mixed elastohydrodynamic contacts solved on a grid (numpy and scipy, no CasADi): the source of film maps."""

from __future__ import annotations

from math import inf

from .case import Contact, Lubricant
from .film import Film
from .hertz import Hertz, hertz
from .line import solve_line
from .point import solve_point

__all__ = ["Contact", "Film", "Hertz", "Lubricant", "hertz", "solve"]


def solve(
    contact: Contact,
    *,
    n: int = 257,
    domain: tuple[float, float, float] | None = None,
    tolerance: float = 1e-6,
) -> Film:
    """The steady film of a contact.

    Args:
        contact: the contact
        n: nodes along a side of the finest grid, 2^k + 1; of a line contact, any number
        domain: first x, last x and largest y over the half width a of the Hertz contact
        tolerance: scaled residual at which it stops, in units of the Hertz pressure [1]

    Raises:
        ScenarioError: n or the contact make no problem
    """
    if contact.R_y == inf and contact.edge_radius == 0:
        return solve_line(contact, n=n, domain=domain[:2] if domain else None, tolerance=tolerance)
    return solve_point(contact, n=n, domain=domain, tolerance=tolerance)
