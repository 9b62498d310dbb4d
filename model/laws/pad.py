"""Oil film of a pad that wedges and squeezes the oil: a slider of finite width, its film from the load it carries.

Lengths B along the motion and L across it; `xi` = B/L; `a` = film at the inlet over film at the outlet.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num


@law(source="Hamrock2004", where="fixed-incline slider bearing of infinite width", valid="a > 1, above 1.001 for 1e-6")
def wedge_coefficient(a: Num) -> Num:
    r"""Load coefficient of an infinitely wide converging pad [1]; largest, 0.1602, at a = 2.19.

    .. math:: C_w = \frac{6}{(a - 1)^2} \left[\ln a - \frac{2 (a - 1)}{a + 1}\right]

    Args:
        a: film at the inlet over film at the outlet, above 1 [1]
    """
    return 6 / (a - 1) ** 2 * (ca.log(a) - 2 * (a - 1) / (a + 1))


@law(source="Timoshenko1970", where="torsion of rectangular bars, the same Poisson equation as squeezed oil")
def squeeze_factor(xi: Num) -> Num:
    r"""Load of a rectangular plate that squeezes oil, over that of an infinitely wide one [1]; series to 1e-5.

    .. math:: \beta = \frac{r}{\xi} \left[1 - \frac{192 r}{\pi^5} \sum_{n\ \mathrm{odd}} \frac{\tanh(n \pi / 2 r)}{n^5}
        \right],\quad r = \min(\xi, 1/\xi),\quad F = \beta \eta L B^3 V / h^3

    Args:
        xi: B/L, above 0 [1]
    """
    r = ca.fmin(xi, 1 / xi)  # both sides of the plate give the same load; the series of the longer one converges fast
    series = sum(ca.tanh(n * math.pi / (2 * r)) / n**5 for n in (1, 3, 5, 7, 9))
    return r / xi * (1 - 192 / math.pi**5 * r * series)


@law(
    source="Hamrock2004",
    where="Reynolds equation of a fixed-incline slider of finite width",
    valid="fitted to solutions of the Reynolds equation, 0.1 % for a = 1.1 to 4 and xi = 0.02 to 20",
    ranges={"xi": (0.02, 20.0), "a": (1.0, 4.0)},
    verified=False,
)
def side_leakage(xi: Num, a: Num) -> Num:
    r"""Load of a converging pad of finite width, over that of an infinitely wide one [1].

    The factor of a plate that squeezes (the limit a = 1), times a rise to the short pad's 1 + q (0.35 + 0.0205 q).

    .. math:: \Lambda = \beta(\xi) \left[1 + \frac{q (0.35 + 0.0205 q)}{1 + m/\xi}\right],\quad q = (a - 1)^2/a,\quad
        m = 1.886 (1 + 0.304 q) + \frac{6.85 (1 + 0.209 q)}{1 + 2.51 \xi^{1.46}}

    Args:
        xi: B/L, above 0 [1]
        a: film at the inlet over film at the outlet, above 0 [1]
    """
    q = (a - 1) ** 2 / a
    m = 1.886 * (1 + 0.304 * q) + 6.85 * (1 + 0.209 * q) / (1 + 2.51 * xi**1.46)
    return squeeze_factor(xi) * (1 + q * (0.35 + 0.0205 * q) / (1 + m / xi))


@law(source="Hamrock2004", where="loads of wedge and squeeze added", valid="A + C > 0, F > 0", verified=False)
def combined_film(F: Num, A: Num, C: Num) -> Num:
    r"""Least film of a pad whose load is carried by wedge and squeeze: the positive root [m].

    The guess, the root of :math:`F h^3 = F (A/F)^{3/2} + C`, is within 6 % of it; Newton's method doubles the digits.

    .. math:: F h^3 - A h - C = 0,\quad A = \eta v L C_w \Lambda B^2,\quad C = \beta \eta L B^3 V

    Args:
        F: load, above 0 [N]
        A: wedge, load times film squared, not negative [N.m2]
        C: squeeze, load times film cubed, not negative [N.m3]
    """
    wedge, squeeze = A / F, C / F
    h = (wedge**1.5 + squeeze) ** (1 / 3)
    for _ in range(5):
        h = (2 * h**3 + squeeze) / (3 * h**2 - wedge)
    return h


@law(source="DrumMotor", where="wetted share of a cylinder partly filled", verified=False)
def fill_arc(beta: Num) -> Num:
    r"""Angle of the wetted arc of a lying cylinder [rad].

    .. math:: s = 2 \pi \beta / (1 + \beta)

    Args:
        beta: wetted over dry part of the inner surface, not negative [1]
    """
    return 2 * math.pi * beta / (1 + beta)


@law(source="DrumMotor", where="oil volume of a cylinder partly filled", verified=False)
def fill_volume_share(beta: Num) -> Num:
    r"""Volume of the oil in a lying cylinder over the cylinder's volume [1]; a segment, not the printed sector.

    .. math:: V / (\pi r^2 L) = (s - \sin s) / (2 \pi)

    Args:
        beta: wetted over dry part of the inner surface, not negative [1]
    """
    s = fill_arc(beta)
    return (s - ca.sin(s)) / (2 * math.pi)
