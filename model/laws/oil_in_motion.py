"""Oil of a sump that gears move: what they throw, until it has run down the walls, and the air in it."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .gear_churning import GRAVITY, TOOTH_HEIGHT
from .smooth import Num, smooth_magnitude, smooth_power

#: Volume flow rate [m3/s] below which the film that runs down a wall is not resolved.
Q_WIDTH = 1e-7


@law(source="Leprince2011", where="density of the oil with its air", verified=False)
def aerated_density(rho: Num, share_air: Num) -> Num:
    r"""Density of oil with air in it [kg/m3]; the weight of the air does not count.

    .. math:: \rho_m = \rho (1 - \varphi)

    Bubbles also thicken the oil; the source finds more drag in some cases, which no formula at hand describes.

    Args:
        rho: density of the oil [kg/m3]
        share_air: share of air in the volume [1]
    """
    return rho * (1 - share_air)


@law(source="GearheatThrownOil", where="oil that leaves the tooth spaces", verified=False)
def thrown_flow(w: Num, h: Num, r: Num, b: Num, m_n: Num) -> Num:
    r"""Oil that a gear throws off [m3/s]: what its tooth spaces lift, as far as it is thrown before it drips back.

    .. math:: Q = \tfrac{1}{2}\, 2.25\, m_n b |\omega| r \frac{\omega^2 r}{\omega^2 r + g} \frac{h^2}{h^2 + m_n^2}

    Args:
        w: speed of the gear, either direction [rad/s]
        h: depth by which the gear dips [m]
        r: pitch radius [m]
        b: face width [m]
        m_n: normal module [m]
    """
    a, lifted = w * w * r, TOOTH_HEIGHT / 2 * m_n * b * smooth_magnitude(w) * r
    return lifted * a / (a + GRAVITY) * h**2 / (h**2 + m_n**2)


@law(
    source="GearheatThrownOil",
    where="oil in flight, and Bird2002, falling film",
    valid="the film on the wall is laminar",
    verified=False,
)
def held_volume(Q: Num, nu: Num, width: Num, height: Num) -> Num:
    r"""Oil that is under way and so not in the sump [m3]: it falls from the ceiling or runs down the walls.

    .. math:: V = Q \sqrt{2 H / g} + B H \left(\frac{3 \nu Q}{g B}\right)^{1/3}

    Args:
        Q: oil that all gears throw [m3/s]
        nu: kinematic viscosity of the oil [m2/s]
        width: of the walls along which it runs down, B [m]
        height: of these walls above the oil, H [m]
    """
    film = (3 * nu / (GRAVITY * width)) ** (1 / 3) * smooth_power(Q, 1 / 3, Q_WIDTH)
    return Q * ca.sqrt(2 * height / GRAVITY) + width * height * film
