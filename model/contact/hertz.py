"""Dry elastic contact of smooth bodies (Hertz), the scale of every film.

Source: Johnson, Contact Mechanics (1985), section 4.2 and appendix 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt

from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

from .case import Contact


@dataclass(frozen=True)
class Hertz:
    """Half axes [m] along x and y, peak pressure [Pa] and approach [m]; of a line, `b` and `approach` are infinite."""

    a: float
    b: float
    p_max: float
    approach: float


def hertz(contact: Contact) -> Hertz:
    """The dry contact; of a line or a roller with rounded ends, that of the line with the same load per length."""
    if contact.R_y == inf or contact.edge_radius > 0:
        load = contact.F / contact.length
        a = sqrt(8 * load * contact.R_x / (pi * contact.E_eff))
        return Hertz(a, inf, 2 * load / (pi * a), inf)
    long, short = max(contact.R_x, contact.R_y), min(contact.R_x, contact.R_y)
    m = _modulus(long / short)  # squared ratio of the short to the long half axis
    first, second = float(ellipkm1(m)), float(ellipe(1 - m))
    e_star, curvature = contact.E_eff / 2, (1 / long + 1 / short) / 2
    small = (3 * contact.F * second * sqrt(m) / (2 * pi * e_star * curvature)) ** (1 / 3)
    large = small / sqrt(m)
    p_max = 3 * contact.F / (2 * pi * small * large)
    a, b = (small, large) if contact.R_y >= contact.R_x else (large, small)
    return Hertz(a, b, p_max, p_max * small * first / e_star)


def _modulus(ratio: float) -> float:
    """Square of the ratio of the half axes, short over long, for a ratio of the radii, long over short."""
    if ratio < 1 + 1e-6:
        return 1.0

    def defect(m: float) -> float:
        first, second = float(ellipkm1(m)), float(ellipe(1 - m))
        return (second / m - first) / (first - second) - ratio

    return float(brentq(defect, 0.1 / ratio**2, 1 - 1e-9, xtol=1e-15))
