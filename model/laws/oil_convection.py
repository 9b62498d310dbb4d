"""Heat transfer between oil and the walls and gears along which it flows.

The Nusselt laws are the cited ones. The functions that return a heat transfer coefficient take the properties at the
temperature of the oil; all are smooth at rest and at equal temperatures.
"""

from __future__ import annotations

from ..sources import law
from .convection import DT_WIDTH, GRAVITY, nusselt_vertical_plate
from .smooth import V_WIDTH, Num, smooth_abs


@law(
    source="Incropera2007",
    where="plate in parallel flow, average over the laminar part",
    valid="laminar up to Re 5e5, Pr from 0.6 on: oils of any thickness",
    ranges={"Re": (0.0, 5e5), "Pr": (0.6, 1e9)},
)
def nusselt_laminar_plate(Re: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a plate along which a fluid flows [1], length that along the flow.

    .. math:: Nu = 0.664 Re^{1/2} Pr^{1/3}

    Args:
        Re: Reynolds number, above 0 [1]
        Pr: Prandtl number [1]
    """
    return 0.664 * Re**0.5 * Pr ** (1 / 3)


@law(
    source="Newman1966",
    where="rotating disc, three terms for a large Schmidt number; a Prandtl number for heat",
    valid="laminar up to Re 2e5, smooth disc away from walls, Pr from 10 on within 0.8 %",
    ranges={"Re": (0.0, 2e5), "Pr": (10.0, 1e9)},
    verified=False,
)
def nusselt_rotating_disc(Re: Num, Pr: Num) -> Num:
    r"""Nusselt number of a face of a disc that turns in a fluid [1], length its radius, the same at every radius.

    .. math:: Nu = \frac{0.62048 Re^{1/2} Pr^{1/3}}{1 + 0.2980 Pr^{-1/3} + 0.14514 Pr^{-2/3}}

    Args:
        Re: Reynolds number w r^2 / nu, above 0 [1]
        Pr: Prandtl number [1]
    """
    return 0.62048 * Re**0.5 * Pr ** (1 / 3) / (1 + 0.2980 * Pr ** (-1 / 3) + 0.14514 * Pr ** (-2 / 3))


def forced_wall_in_oil(v: Num, nu: Num, Pr: Num, k: Num, L: Num) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a wall along which oil flows.

    Args:
        v: speed of the oil along the wall, either direction [m/s]
        nu: kinematic viscosity of the oil [m2/s]
        Pr: Prandtl number of the oil [1]
        k: conductivity of the oil [W/(m.K)]
        L: length of the wall along the flow [m]
    """
    return nusselt_laminar_plate(smooth_abs(v, V_WIDTH) * L / nu, Pr) * k / L


def speed_along_wall(v: Num, L: Num) -> Num:
    r"""Speed of thrown oil along a wall [m/s]: that which the gear gives it, at most that of a fall along the wall.

    .. math:: v_w = \frac{v}{[1 + v^4 / (2 g L)^2]^{1/4}}

    What has hit a wall is no longer driven by the gear but by its weight. The exponent only rounds the bend, where the
    speed is 16 % below both.

    Args:
        v: speed that the gear gives the oil, either direction [m/s]
        L: height of the wall [m]
    """
    return v / (1 + v**4 / (2 * GRAVITY * L) ** 2) ** 0.25


def forced_disc_in_oil(w: Num, nu: Num, Pr: Num, k: Num, r: Num) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a disc that turns in oil.

    Args:
        w: speed of the disc, either direction [rad/s]
        nu: kinematic viscosity of the oil [m2/s]
        Pr: Prandtl number of the oil [1]
        k: conductivity of the oil [W/(m.K)]
        r: radius; for the Reynolds number alone, the coefficient is the same for every radius [m]
    """
    return nusselt_rotating_disc(smooth_abs(w) * r**2 / nu, Pr) * k / r


def natural_wall_in_oil(T_s: Num, T_f: Num, nu: Num, Pr: Num, k: Num, expansion: Num, L: Num) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a vertical wall in oil at rest.

    Args:
        T_s: temperature of the wall [K]
        T_f: temperature of the oil [K]
        nu: kinematic viscosity of the oil [m2/s]
        Pr: Prandtl number of the oil [1]
        k: conductivity of the oil [W/(m.K)]
        expansion: thermal expansion of the oil [1/K]
        L: height of the wall [m]
    """
    Ra = GRAVITY * expansion * smooth_abs(T_s - T_f, DT_WIDTH) * L**3 * Pr / nu**2
    return nusselt_vertical_plate(Ra, Pr) * k / L
