"""Oil that the teeth of a mesh squeeze out of the tooth spaces of their mates, derived from continuity and momentum.

A tooth that enters a space leaves it less and less room. The section of the pocket follows a parabola over the way
along the line of pitch, A = 0.65 m^2 + 2.9 m^2 s^2 with s from 1 where the tip enters to 0 on the line of centres, and
x_e = 2 (m r_red)^(1/2) for s = 1, which are the spaces of involute gears. Oil leaves by both ends and by the
backlash; its velocity head is lost, and laminar friction on its way along the pocket. Every pitch has two pockets. Oil
that is drawn in behind the mesh costs nothing, nor does the air of a space that is not full, which leaves first.
Compared with no measurement.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs, smooth_max

#: Least section of a pocket, in squares of the module.
LEAST = 0.65
#: How much larger the section is where the tip enters, in squares of the module.
MORE = 2.9


@law(source="GearheatSqueezing", where="when a space that is not full begins to squeeze", verified=False)
def squeezing_begins(fill: Num, *, width: float = 0.02) -> Num:
    r"""Square of the way s at which oil fills what is left of a tooth space [1].

    .. math:: s_f^2 = \max\left(0, \varphi - (1 - \varphi) \frac{0.65}{2.9}\right)

    Args:
        fill: share of the open tooth space that is oil [1]
        width: rounding where next to no oil is left to squeeze [1]
    """
    return smooth_max(fill - (1 - fill) * LEAST / MORE, 0.0, width)


@law(source="GearheatSqueezing", where="closing of a pocket", verified=False)
def pocket_closing(b: Num, m_n: Num, backlash: Num) -> Num:
    r"""Growth of the outlets of a pocket from its least section to the open space, over the least outlets [1].

    .. math:: \kappa = \frac{5.8\, m^2}{1.3\, m^2 + b j}

    Args:
        b: face width [m]
        m_n: module [m]
        backlash: normal backlash j [m]
    """
    return 2 * MORE * m_n**2 / (2 * LEAST * m_n**2 + b * backlash)


@law(
    source="GearheatSqueezing",
    where="momentum and friction of the oil",
    valid="straight teeth; along helical ones oil escapes more easily",
    ranges={"b / m_n": (3.0, 20.0), "fill": (0.0, 1.0)},
    verified=False,
)
def squeezing_torque(w: Num, rho: Num, nu: Num, fill: Num, r: Num, r_mate: Num, b: Num, m_n: Num, backlash: Num) -> Num:
    r"""Torque on a gear that the squeezing of oil in its mesh takes [N.m], a magnitude.

    .. math:: \tau = \frac{5.8}{8 \pi} \rho v^2 b^3 \frac{r}{r_{red}}
        \left(\ln(1 + \kappa_f) - \frac{\kappa_f}{1 + \kappa_f}\right)
        + \frac{64}{3 \pi} \rho \nu v b^3 \frac{r}{m x_e} \sqrt\kappa
        \left(\arctan\sqrt{\kappa_f} - \frac{\sqrt{\kappa_f}}{1 + \kappa_f}\right)

    with v the pitch line speed, 1/r_red = 1/r + 1/r_mate and kappa_f = kappa s_f^2.

    Args:
        w: speed of the gear, either direction [rad/s]
        rho: density of the oil [kg/m3]
        nu: kinematic viscosity of the oil [m2/s]
        fill: share of the tooth spaces that is oil where they enter the mesh [1]
        r: pitch radius of the gear [m]
        r_mate: pitch radius of its mate, negative for a ring [m]
        b: face width [m]
        m_n: module [m]
        backlash: normal backlash [m]
    """
    v, r_red = smooth_abs(w) * r, r * r_mate / (r + r_mate)
    kappa = pocket_closing(b, m_n, backlash)
    k = kappa * squeezing_begins(fill)
    jets = MORE / (4 * math.pi) * rho * v**2 / r_red * (ca.log(1 + k) - k / (1 + k))
    entering = 2 * ca.sqrt(m_n * r_red)
    friction = rho * nu * v / (m_n * entering) * ca.sqrt(kappa) * (ca.atan(ca.sqrt(k)) - ca.sqrt(k) / (1 + k))
    return (jets + 64 / (3 * math.pi) * friction) * b**3 * r
