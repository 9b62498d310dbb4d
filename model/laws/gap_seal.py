"""Drag of air or oil in the gaps of a labyrinth seal: a shaft that turns in a ring it does not touch.

The flow is laminar up to the speed at which vortices form, which oil in a gearbox never reaches, and turbulent far
beyond, where only air at high speed comes. Clearances are small against the shaft.
"""

from __future__ import annotations

import math

from ..sources import law
from .smooth import Num, smooth_abs, smooth_magnitude, smooth_max

#: Taylor number at which vortices form between a turning shaft and a resting ring of little clearance.
TAYLOR = 41.3


@law(source="White2006", where="flow between rotating concentric cylinders", valid="laminar", verified=False)
def laminar_gap_torque(w: Num, eta_oil: Num, r: Num, gap: Num, L: Num) -> Num:
    r"""Torque of laminar flow between a turning shaft and a resting ring [N.m], a magnitude.

    .. math:: \tau = 4 \pi \eta |\omega| L \frac{r^2 (r + s)^2}{(r + s)^2 - r^2}

    Args:
        w: speed of the shaft, either direction [rad/s]
        eta_oil: dynamic viscosity of what fills the gap [Pa.s]
        r: radius of the shaft [m]
        gap: radial clearance s [m]
        L: length of the gap along the shaft [m]
    """
    return 4 * math.pi * eta_oil * smooth_magnitude(w) * L * r**2 * (r + gap) ** 2 / (gap * (2 * r + gap))


@law(
    source="Bilgen1973",
    where="transition in narrow gaps",
    valid="smooth cylinders without flow along them, s / r up to 0.07",
    verified=False,
)
def vortex_factor(Ta: Num, *, width: float = 0.02) -> Num:
    r"""Torque with vortices over that of laminar flow [1].

    .. math:: \psi = 1 + 1.4472 \left(1 - \frac{41.3^2}{\max(Ta, 41.3)^2}\right)

    Args:
        Ta: Taylor number Re (s / r)^(1/2) [1]
        width: rounding where the vortices begin, in (Ta / 41.3)^2 [1]
    """
    return 1 + 1.4472 * (1 - 1 / smooth_max((Ta / TAYLOR) ** 2, 1.0, width))


@law(
    source="Bilgen1973",
    where="torque coefficients of the third and fourth regime",
    valid="smooth cylinders without flow along them, Re above 500",
    verified=False,
)
def turbulent_gap_coefficient(Re: Num, gap_share: Num, *, sharpness: int = 16) -> Num:
    r"""Torque coefficient of a gap [1]: torque over 1/2 pi rho w^2 r^4 L.

    .. math:: C = \max\left(1.03\, Re^{-1/2},\; 0.065\, Re^{-1/5}\right) \left(\frac{s}{r}\right)^{0.3}

    The source changes at Re = 1e4, where both are all but equal.

    Args:
        Re: Reynolds number w r s / nu, above 0 [1]
        gap_share: clearance over radius s / r [1]
        sharpness: of the mean that joins both [1]
    """
    slow, fast = 1.03 * Re**-0.5, 0.065 * Re**-0.2
    return (slow**sharpness + fast**sharpness) ** (1 / sharpness) * gap_share**0.3


@law(
    source="Bilgen1973",
    where="torque over all regimes",
    valid="smooth concentric cylinders without flow along them; grooves and steps of a labyrinth count by their length",
    ranges={"gap / r": (0.0, 0.07)},
    verified=False,
)
def gap_torque(w: Num, rho: Num, nu: Num, r: Num, gap: Num, L: Num) -> Num:
    r"""Torque with which a fluid in the gap brakes the shaft [N.m], a magnitude, zero at standstill.

    .. math:: \tau = (1 - x)\, \psi\, \tau_{lam} + x\, \tfrac{\pi}{2} C \rho \omega^2 r^4 L,\quad
        x = \frac{Re^8}{Re^8 + 500^8},\quad Re = \frac{\omega r s}{\nu}

    The source changes its formula at Re = 500, with a jump of up to 17 %.

    Args:
        w: speed of the shaft, either direction [rad/s]
        rho: density of what fills the gap [kg/m3]
        nu: kinematic viscosity of what fills the gap [m2/s]
        r: radius of the shaft [m]
        gap: radial clearance s [m]
        L: length of the gap along the shaft [m]
    """
    Re = smooth_abs(w) * r * gap / nu
    laminar = vortex_factor(Re * (gap / r) ** 0.5) * laminar_gap_torque(w, rho * nu, r, gap, L)
    turbulent = 0.5 * math.pi * turbulent_gap_coefficient(Re, gap / r) * rho * w * w * r**4 * L
    share = 1 / (1 + (500 / Re) ** 8)
    return (1 - share) * laminar + share * turbulent
