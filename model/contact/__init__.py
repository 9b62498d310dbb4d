"""Mixed elastohydrodynamic contacts solved on a grid (numpy and scipy, no CasADi): the source of film maps."""

from __future__ import annotations

from functools import partial
from math import inf

import numpy as np

from .case import Array, Contact, Lubricant
from .film import Film
from .hertz import Hertz, hertz
from .line import solve_line
from .line_cycle import solve_line_cycle
from .point import FLOOR, Height, solve_point
from .rough import Texture, gaussian_texture
from .transient import solve_transient

__all__ = [
    "Contact",
    "Film",
    "Hertz",
    "Lubricant",
    "Texture",
    "gaussian_texture",
    "hertz",
    "solve",
    "solve_line",
    "solve_line_cycle",
    "solve_transient",
]


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
    """
    if contact.R_y < inf or contact.edge_radius > 0:
        return solve_point(contact, n=n, domain=domain, roughness=roughness, tolerance=tolerance, floor=floor)
    profile = None if roughness is None else partial(_along, roughness)
    span = domain[:2] if domain else None
    return solve_line(contact, n=n, domain=span, roughness=profile, tolerance=tolerance)


def _along(height: Height, x: Array) -> Array:
    """Heights of a rough surface along the middle of a line contact [m]."""
    return height(x, np.zeros_like(x))
