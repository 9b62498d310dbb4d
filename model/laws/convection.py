"""Heat transfer from a housing to air: Nusselt numbers, and heat transfer coefficients in air made of them.

The Nusselt laws are the cited ones. The functions that return a heat transfer coefficient choose a law, a length and
the properties of air at the film temperature. All of them are smooth at zero temperature difference and zero speed.
"""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import V_WIDTH, Num, smooth_abs, smooth_power, smooth_sign

#: Acceleration of gravity, standard value [m/s2].
GRAVITY = 9.80665
#: Rounding of a temperature difference [K].
DT_WIDTH = 1e-2
#: Temperature difference over which a hot horizontal plate's law turns into a cold one's [K].
SIGN_WIDTH = 0.05
#: Pressure of the air at sea level [Pa].
SEA_LEVEL = 101325.0
#: Gas constant of dry air [J/(kg.K)].
R_AIR = 287.05


@law(
    source="White2006",
    where="Sutherland laws for air, Tables 1-2 and 1-3",
    valid="air, 170-1900 K, 2 %",
    ranges={"T_film": (170.0, 1900.0)},
)
def air_properties(T_film: Num, *, p: Num = SEA_LEVEL) -> tuple[Num, Num, Num, Num]:
    r"""Conductivity k [W/(m.K)], kinematic viscosity nu [m2/s], Prandtl number Pr [1] and expansion beta [1/K] of air.

    .. math:: \eta = 1.716 \cdot 10^{-5} \left(\frac{T}{273}\right)^{3/2} \frac{273 + 111}{T + 111},\quad
        k = 0.0241 \left(\frac{T}{273}\right)^{3/2} \frac{273 + 194}{T + 194}

    with the density of an ideal gas, a specific heat of 1007 J/(kg.K) and beta = 1/T.

    Args:
        T_film: mean temperature of surface and air [K]
        p: pressure [Pa]
    """
    growth = (T_film / 273) ** 1.5
    eta = 1.716e-5 * growth * (273 + 111) / (T_film + 111)
    k = 0.0241 * growth * (273 + 194) / (T_film + 194)
    rho = p / (R_AIR * T_film)
    return k, eta / rho, 1007 * eta / k, 1 / T_film


@law(source="ChurchillChu1975a", where="equation for all Ra and Pr", valid="vertical plate", ranges={"Ra": (0.0, 1e12)})
def nusselt_vertical_plate(Ra: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a vertical plate in free convection [1], length its height.

    .. math:: Nu = \left(0.825 + \frac{0.387 Ra^{1/6}}{[1 + (0.492/Pr)^{9/16}]^{8/27}}\right)^2

    Args:
        Ra: Rayleigh number, above 0 [1]
        Pr: Prandtl number [1]
    """
    return (0.825 + 0.387 * Ra ** (1 / 6) / (1 + (0.492 / Pr) ** (9 / 16)) ** (8 / 27)) ** 2


@law(
    source="ChurchillChu1975b",
    where="equation for all Ra and Pr",
    valid="horizontal cylinder",
    ranges={"Ra": (1e-6, 1e12)},
)
def nusselt_horizontal_cylinder(Ra: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a horizontal cylinder in free convection [1], length its diameter.

    .. math:: Nu = \left(0.60 + \frac{0.387 Ra^{1/6}}{[1 + (0.559/Pr)^{9/16}]^{8/27}}\right)^2

    Args:
        Ra: Rayleigh number, above 0 [1]
        Pr: Prandtl number [1]
    """
    return (0.60 + 0.387 * Ra ** (1 / 6) / (1 + (0.559 / Pr) ** (9 / 16)) ** (8 / 27)) ** 2


@law(
    source="McAdams1954",
    where="hot plate facing up or cold plate facing down",
    valid="Ra 1e4-1e11, length area over perimeter",
    ranges={"Ra": (1e4, 1e11)},
)
def nusselt_plate_unstable(Ra: Num, *, sharpness: float = 20.0) -> Num:
    r"""Mean Nusselt number of a horizontal plate whose warm side is under the cold one [1].

    .. math:: Nu = \max(0.54 Ra^{1/4}, 0.15 Ra^{1/3})

    The source switches at Ra = 1e7 with a jump of 6 %; the larger of its two branches has none.

    Args:
        Ra: Rayleigh number, above 0 [1]
        sharpness: exponent of the mean that joins the branches; they meet at 3.5 % above both for 20 [1]
    """
    laminar, turbulent = 0.54 * Ra**0.25, 0.15 * Ra ** (1 / 3)
    return turbulent * (1 + (laminar / turbulent) ** sharpness) ** (1 / sharpness)


@law(
    source="McAdams1954",
    where="hot plate facing down or cold plate facing up",
    valid="Ra 1e5-1e10, length area over perimeter",
    ranges={"Ra": (1e5, 1e10)},
    verified=False,
)
def nusselt_plate_stable(Ra: Num) -> Num:
    r"""Mean Nusselt number of a horizontal plate whose warm side is over the cold one [1].

    .. math:: Nu = 0.27 Ra^{1/4}

    Args:
        Ra: Rayleigh number, above 0 [1]
    """
    return 0.27 * Ra**0.25


@law(
    source="Gnielinski1975",
    where="plate in parallel flow, laminar and turbulent combined",
    valid="Re 10-1e7, Pr 0.6-2000",
    ranges={"Re": (10.0, 1e7)},
    verified=False,
)
def nusselt_forced_plate(Re: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a plate in parallel flow with a disturbed inlet [1].

    .. math:: Nu = \sqrt{Nu_l^2 + Nu_t^2},\quad Nu_l = 0.664 Re^{1/2} Pr^{1/3},\quad
        Nu_t = \frac{0.037 Re^{0.8} Pr}{1 + 2.443 Re^{-0.1} (Pr^{2/3} - 1)}

    Args:
        Re: Reynolds number, above 0 [1]
        Pr: Prandtl number [1]
    """
    laminar = 0.664 * Re**0.5 * Pr ** (1 / 3)
    turbulent = 0.037 * Re**0.8 * Pr / (1 + 2.443 * Re**-0.1 * (Pr ** (2 / 3) - 1))
    return ca.sqrt(laminar**2 + turbulent**2)


@law(
    source="ChurchillBernstein1977",
    where="equation for all Re and Pr",
    valid="cylinder in cross flow, Re Pr above 0.2",
    ranges={"Re": (0.3, 1e7)},
)
def nusselt_forced_cylinder(Re: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a cylinder in cross flow [1], length its diameter.

    .. math:: Nu = 0.3 + \frac{0.62 Re^{1/2} Pr^{1/3}}{[1 + (0.4/Pr)^{2/3}]^{1/4}}
        \left[1 + \left(\frac{Re}{282000}\right)^{5/8}\right]^{4/5}

    Args:
        Re: Reynolds number, above 0 [1]
        Pr: Prandtl number [1]
    """
    laminar = 0.62 * Re**0.5 * Pr ** (1 / 3) / (1 + (0.4 / Pr) ** (2 / 3)) ** 0.25
    return 0.3 + laminar * (1 + (Re / 282000) ** (5 / 8)) ** 0.8


#: C and m of Nu = C Re^m Pr^(1/3) for Re 0.4-4, 4-40, 40-4e3 and 4e3-4e4.
HILPERT = ((0.989, 0.330), (0.911, 0.385), (0.683, 0.466), (0.193, 0.618))


@law(
    source="Incropera2007",
    where="Hilpert correlation, Table 7.2",
    valid="cylinder in cross flow of a gas, Re 0.4-4e4",
    ranges={"Re": (0.4, 4e4)},
)
def nusselt_hilpert(Re: Num, Pr: Num, *, sharpness: float = 100.0) -> Num:
    r"""Mean Nusselt number of a cylinder in cross flow [1], length its diameter.

    .. math:: Nu = C Re^m Pr^{1/3}

    with C and m of the row in which Re lies: the one that gives most, as the rows rise ever steeper. The row from 4e4
    to 4e5 is left out, as Vasic2022 uses the row before it there as well.

    Args:
        Re: Reynolds number, above 0 [1]
        Pr: Prandtl number [1]
        sharpness: exponent of the mean that joins the rows; they meet at 0.7 % above both for 100 [1]
    """
    last = HILPERT[-1][0] * Re ** HILPERT[-1][1]
    others = sum((C * Re**m / last) ** sharpness for C, m in HILPERT[:-1])
    return last * (1 + others) ** (1 / sharpness) * Pr ** (1 / 3)


@law(source="Vasic2022", where="eq 15", valid="flat wall of a housing in moving air", verified=False)
def flat_wall_coefficient(v: Num) -> Num:
    r"""Heat transfer coefficient [W/(m2.K)] of the flat walls of a housing.

    .. math:: h = 7 + 12 \sqrt{v}

    Args:
        v: speed of the air, either direction [m/s]
    """
    return 7 + 12 * smooth_power(v, 0.5, V_WIDTH)


@law(source="Incropera2007", where="mixed convection, exponent 3", valid="assisting flow", verified=False)
def mixed(h_natural: Num, h_forced: Num, *, width: float = 1e-3) -> Num:
    r"""Heat transfer coefficient of free and forced convection together [W/(m2.K)].

    .. math:: h = (h_n^3 + h_f^3)^{1/3}

    Args:
        h_natural: heat transfer coefficient of free convection [W/(m2.K)]
        h_forced: heat transfer coefficient of forced convection [W/(m2.K)]
        width: rounding where both vanish [W/(m2.K)]
    """
    return smooth_power(h_natural**3 + h_forced**3, 1 / 3, width**3)


def rayleigh(T_s: Num, T_f: Num, L: Num, *, p: Num = SEA_LEVEL) -> tuple[Num, Num, Num]:
    """Rayleigh number [1] of a surface in air, and Prandtl number [1] and conductivity [W/(m.K)] at film temperature.

    Args:
        T_s: temperature of the surface [K]
        T_f: temperature of the air [K]
        L: characteristic length [m]
        p: pressure of the air [Pa]
    """
    k, nu, Pr, beta = air_properties((T_s + T_f) / 2, p=p)
    return GRAVITY * beta * smooth_abs(T_s - T_f, DT_WIDTH) * L**3 * Pr / nu**2, Pr, k


def natural_vertical_plate(T_s: Num, T_f: Num, height: Num, *, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a vertical plate in still air.

    Args:
        T_s: temperature of the plate [K]
        T_f: temperature of the air [K]
        height: height of the plate [m]
        p: pressure of the air [Pa]
    """
    Ra, Pr, k = rayleigh(T_s, T_f, height, p=p)
    return nusselt_vertical_plate(Ra, Pr) * k / height


def natural_horizontal_cylinder(T_s: Num, T_f: Num, D: Num, *, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a horizontal cylinder in still air.

    Args:
        T_s: temperature of the cylinder [K]
        T_f: temperature of the air [K]
        D: diameter [m]
        p: pressure of the air [Pa]
    """
    Ra, Pr, k = rayleigh(T_s, T_f, D, p=p)
    return nusselt_horizontal_cylinder(Ra, Pr) * k / D


def natural_horizontal(T_s: Num, T_f: Num, L: Num, *, up: bool = True, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a horizontal plate in still air, hot or cold.

    Args:
        T_s: temperature of the plate [K]
        T_f: temperature of the air [K]
        L: area of the plate over its perimeter [m]
        up: whether it faces upwards, not downwards
        p: pressure of the air [Pa]
    """
    Ra, _, k = rayleigh(T_s, T_f, L, p=p)
    warmer = smooth_sign(T_s - T_f, SIGN_WIDTH)
    rises = 0.5 * (1 + warmer if up else 1 - warmer)  # share of the warm side under the cold one
    return (rises * nusselt_plate_unstable(Ra) + (1 - rises) * nusselt_plate_stable(Ra)) * k / L


def forced_plate(v: Num, T_film: Num, L: Num, *, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a plate in moving air.

    Args:
        v: speed of the air along the plate, either direction [m/s]
        T_film: mean temperature of plate and air [K]
        L: length of the plate along the flow [m]
        p: pressure of the air [Pa]
    """
    k, nu, Pr, _ = air_properties(T_film, p=p)
    return nusselt_forced_plate(smooth_abs(v, V_WIDTH) * L / nu, Pr) * k / L


def forced_cylinder(v: Num, T_film: Num, D: Num, *, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a cylinder in moving air.

    Args:
        v: speed of the air across the cylinder, either direction [m/s]
        T_film: mean temperature of cylinder and air [K]
        D: diameter [m]
        p: pressure of the air [Pa]
    """
    k, nu, Pr, _ = air_properties(T_film, p=p)
    return nusselt_forced_cylinder(smooth_abs(v, V_WIDTH) * D / nu, Pr) * k / D


@law(
    source="ISO2533",
    where="barometric formula of the troposphere",
    ranges={"altitude": (-500.0, 11000.0)},
    verified=False,
)
def air_pressure(altitude: Num) -> Num:
    r"""Pressure of the standard atmosphere [Pa].

    .. math:: p = 101325 \left(1 - \frac{0.0065\,h}{288.15}\right)^{5.2559}

    Args:
        altitude: height above sea level [m]
    """
    return SEA_LEVEL * (1 - 0.0065 * altitude / 288.15) ** (GRAVITY / (0.0065 * R_AIR))
