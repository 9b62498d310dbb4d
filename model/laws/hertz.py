"""Dry contacts of curved bodies after Hertz, elliptical ones; the line contact is `cycloid_pin.hertz_line_pressure`."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num

#: Steps of the arithmetic-geometric mean: to rounding for R_y/R_x up to 1e5.
MEANS = 7
#: Steps of the search for the axes: to rounding for R_y/R_x up to 1e5.
STEPS = 30


def elliptic_integrals(k: Num) -> tuple[Num, Num]:
    """Complete elliptic integrals of the first and second kind of a modulus sqrt(1 - 1/k^2) [1].

    Args:
        k: ratio of the axes of an ellipse, 1 or more [1]
    """
    a, b, rest, power = 1.0, 1 / k, (1 - 1 / k**2) / 2, 1.0
    for _ in range(MEANS):
        a, b, c = (a + b) / 2, ca.sqrt(a * b), (a - b) / 2
        rest, power = rest + power * c**2, 2 * power
    first = ca.pi / (2 * a)
    return first, first * (1 - rest)


@law(source="Hertz1881", where="axes of the ellipse of contact", valid="R_y >= R_x", verified=False)
def ellipse_ratio(R_x: Num, R_y: Num) -> Num:
    r"""Ratio of the axes of an elliptical contact [1], by iteration with the complete elliptic integrals K and E.

    .. math:: k^2 = \frac{(R_y/R_x) (K - E) + K}{E}

    Args:
        R_x: reduced radius in the narrow direction [m]
        R_y: reduced radius across it [m]
    """
    k = (R_y / R_x) ** (2 / 3)
    for _ in range(STEPS):
        first, second = elliptic_integrals(k)
        k = ca.sqrt((R_y / R_x * (first - second) + first) / second)
    return k


@law(source="Hertz1881", where="elliptical contact", valid="R_y >= R_x", verified=False)
def hertz_ellipse(F: Num, R_x: Num, R_y: Num, E_eff: Num) -> tuple[Num, Num, Num]:
    r"""Greatest pressure [Pa], narrow and wide half axis [m] of a dry elliptical contact.

    .. math:: p = \frac{3 F}{2 \pi a b},\quad b = k a = \left(\frac{6 k^2 E F R}{\pi E'}\right)^{1/3},\quad
        \frac{1}{R} = \frac{1}{R_x} + \frac{1}{R_y}

    Args:
        F: normal force, above 0 [N]
        R_x: reduced radius in the narrow direction [m]
        R_y: reduced radius across it [m]
        E_eff: effective modulus, 2/E' = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    k = ellipse_ratio(R_x, R_y)
    _, second = elliptic_integrals(k)
    b = (6 * k**2 * second * F / (ca.pi * E_eff * (1 / R_x + 1 / R_y))) ** (1 / 3)
    return 1.5 * F * k / (ca.pi * b**2), b / k, b
