"""Oil and grease: viscosity, density, conductivity, and the slopes of viscosity that films need."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num

#: Lower temperature at which data sheets give the viscosity, 40 degC [K].
T_40 = 313.15
#: Upper temperature at which data sheets give the viscosity, 100 degC [K].
T_100 = 373.15
#: Temperature at which data sheets give the density, 15 degC [K].
T_15 = 288.15
#: Zero of the Celsius scale [K].
T_0 = 273.15
#: Viscosity [mm2/s] at which the charts of ASTM D341 end; the line is held there, far below any pour point.
LARGEST_VISCOSITY = 2e7


@law(source="ASTMD341", where="two-point constants", valid="mineral oils and base oils from -70 to 370 degC")
def walther_constants(nu_40: Num, nu_100: Num) -> tuple[Num, Num]:
    r"""Constants (m, n) of the Walther line through the viscosities at 40 and 100 degC, for decimal logarithms.

    .. math:: n = \frac{W(\nu_{40}) - W(\nu_{100})}{\lg 373.15 - \lg 313.15},\quad m = W(\nu_{40}) + n \lg 313.15,
        \quad W = \lg\lg(\nu + 0.7)

    Args:
        nu_40: kinematic viscosity at 40 degC [m2/s]
        nu_100: kinematic viscosity at 100 degC [m2/s]
    """
    nu_40_cSt, nu_100_cSt = 1e6 * nu_40, 1e6 * nu_100
    W_40, W_100 = ca.log10(ca.log10(nu_40_cSt + 0.7)), ca.log10(ca.log10(nu_100_cSt + 0.7))
    n = (W_40 - W_100) / math.log10(T_100 / T_40)
    return W_40 + n * math.log10(T_40), n


@law(
    source="ASTMD341",
    where="two-point line",
    valid="mineral and base oils that flow; synthetic oils with a few percent between the points",
    ranges={"T": (233.15, 423.15), "T - T_pour": (0.0, 2000.0)},
)
def kinematic_viscosity(T: Num, nu_40: Num, nu_100: Num, T_pour: Num = 0.0, *, sharpness: float = 100.0) -> Num:
    r"""Kinematic viscosity [m2/s] on the Walther line through two points, written with natural logarithms.

    .. math:: \nu = \exp(\exp(W)) - 0.7,\quad
        W = W_{40} + (W_{100} - W_{40}) \frac{\ln (T/313.15)}{\ln (373.15/313.15)},\quad W = \ln\ln(\nu + 0.7)

    Where it leaves the source's charts, at 2e7 mm2/s, the viscosity stays what it is.

    Args:
        T: temperature [K]
        nu_40: kinematic viscosity at 40 degC [m2/s]
        nu_100: kinematic viscosity at 100 degC [m2/s]
        T_pour: pour point; bounds the range alone: below it the line goes on for oil that does not flow [K]
        sharpness: of the bend at the largest viscosity; it is felt within 5 K of it [1]
    """
    nu_40_cSt, nu_100_cSt = 1e6 * nu_40, 1e6 * nu_100
    W_40, W_100 = ca.log(ca.log(nu_40_cSt + 0.7)), ca.log(ca.log(nu_100_cSt + 0.7))
    share = ca.log(T / T_40) / math.log(T_100 / T_40)
    reciprocal = ca.exp(-W_40 - (W_100 - W_40) * share)  # of ln(nu + 0.7); its largest power keeps the limit
    held = (reciprocal**sharpness + math.log(LARGEST_VISCOSITY) ** -sharpness) ** (1 / sharpness)
    return 1e-6 * (ca.exp(1 / held) - 0.7)


@law(source="Dias2014", where="oil properties, density", verified=False)
def density(T: Num, rho_15: Num, alpha_T: Num) -> Num:
    r"""Density [kg/m3], linear in the temperature.

    .. math:: \rho = \rho_{15} (1 + \alpha_T (T - 288.15))

    Args:
        T: temperature [K]
        rho_15: density at 15 degC [kg/m3]
        alpha_T: relative change of density with temperature, negative [1/K]
    """
    return rho_15 * (1 + alpha_T * (T - T_15))


@law(source="Gold2001", where="pressure-viscosity coefficient up to 0.2 GPa", valid="base oils of the constants' type")
def pressure_viscosity(nu: Num, s: Num, t: Num) -> Num:
    r"""Pressure-viscosity coefficient [1/Pa].

    .. math:: \alpha_p = 10^{-9} s \nu^t

    The constants appear interchanged in some programs, which makes the coefficient about seven times too large.

    Args:
        nu: kinematic viscosity at ambient pressure [m2/s]
        s: coefficient at 1 cSt, in 1/GPa [1]
        t: exponent [1]
    """
    nu_cSt = 1e6 * nu
    return 1e-9 * s * nu_cSt**t


@law(source="Dias2014", where="thermoviscosity from the Walther line", verified=False)
def thermoviscosity(T: Num, nu: Num, n: Num) -> Num:
    r"""Relative fall of viscosity with temperature [1/K]: minus the logarithmic slope of the Walther line.

    .. math:: \beta_T = \frac{n (\nu + 0.7) \ln(\nu + 0.7)}{\nu T}

    Args:
        T: temperature [K]
        nu: kinematic viscosity at that temperature [m2/s]
        n: slope of the Walther line [1]
    """
    nu_cSt = 1e6 * nu
    return n * (nu_cSt + 0.7) * ca.log(nu_cSt + 0.7) / (nu_cSt * T)


@law(
    source="Cragoe1929",
    where="thermal conductivity of liquids",
    valid="petroleum products; low for PAG",
    verified=False,
)
def conductivity(T: Num, rho_15: Num) -> Num:
    r"""Thermal conductivity [W/(m.K)].

    .. math:: k = \frac{120}{\rho_{15}} \left(1 - \frac{0.0005}{3} (T - 273.15)\right)

    Args:
        T: temperature [K]
        rho_15: density at 15 degC [kg/m3]
    """
    T_C = T - T_0
    return 120 * (1 - 0.0005 / 3 * T_C) / rho_15
