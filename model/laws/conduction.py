"""Heat conduction through walls, along fins, through joints and rolling bearings, and into the ground."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import SPEED_WIDTH, Num, smooth_abs, smooth_max


@law(source="Incropera2007", where="conduction through a plane wall")
def plane_wall(k: Num, A: Num, d: Num) -> Num:
    r"""Thermal conductance of a plane wall [W/K].

    .. math:: G = k A / d

    Args:
        k: thermal conductivity [W/(m.K)]
        A: area [m2]
        d: thickness [m]
    """
    return k * A / d


@law(source="Incropera2007", where="conduction through a cylindrical wall", verified=False)
def cylinder_wall(k: Num, L: Num, r_i: Num, r_o: Num) -> Num:
    r"""Thermal conductance of a cylindrical wall in radial direction [W/K].

    .. math:: G = \frac{2 \pi k L}{\ln(r_o/r_i)}

    Args:
        k: thermal conductivity [W/(m.K)]
        L: length [m]
        r_i: inner radius [m]
        r_o: outer radius [m]
    """
    return 2 * math.pi * k * L / ca.log(r_o / r_i)


@law(
    source="Incropera2007",
    where="efficiency of a straight fin of uniform cross-section",
    valid="adiabatic tip, thin fin",
    verified=False,
)
def fin_efficiency(h: Num, k: Num, thickness: Num, length: Num, *, width: float = 1e-4) -> Num:
    r"""Heat flow of a straight fin over that of a fin without thermal resistance [1].

    .. math:: \eta_f = \frac{\tanh(m L)}{m L},\quad m = \sqrt{\frac{2 h}{k t}}

    Args:
        h: heat transfer coefficient on both sides, not negative [W/(m2.K)]
        k: thermal conductivity of the fin [W/(m.K)]
        thickness: thickness of the fin [m]
        length: height of the fin from root to tip [m]
        width: rounding of m L at zero heat transfer [1]
    """
    mL = ca.sqrt(2 * h * length**2 / (k * thickness) + width**2)
    return ca.tanh(mL) / mL


@law(
    source="Incropera2007",
    where="conduction shape factors, disk of constant temperature on a semi-infinite medium",
    valid="insulated beside the pad, ground of room temperature far away",
)
def half_space(k: Num, A: Num) -> Num:
    r"""Thermal conductance from a pad into the ground below it [W/K], by a disc of the same area.

    .. math:: G = 2 D k,\quad D = \sqrt{4 A / \pi}

    Args:
        k: thermal conductivity of the ground [W/(m.K)]
        A: area of the pad [m2]
    """
    return 4 * k * ca.sqrt(A / math.pi)


@law(source="Yovanovich1982", where="contact conductance of conforming rough surfaces", verified=False)
def contact_coefficient(p: Num, k: Num, sigma: Num, m: Num, hardness: Num) -> Num:
    r"""Heat transfer coefficient of two rough metal faces by their spots of contact [W/(m2.K)].

    A law of machine tool joints, 8000 k (p / (3 R_m) 15 um / (2 Rz))^0.86, has a fifth of it at 10 N/mm2 between ground
    steel faces: either is far more than what the metal behind the faces conducts.

    .. math:: h = 1.25 \frac{k m}{\sigma} \left(\frac{p}{H}\right)^{0.95}

    Args:
        p: pressure between the faces [Pa]
        k: harmonic mean of the thermal conductivities [W/(m.K)]
        sigma: root mean square roughness of both, square root of the sum of squares [m]
        m: mean slope of both roughnesses [1]
        hardness: of the softer face, H [Pa]
    """
    return 1.25 * k * m / sigma * (p / hardness) ** 0.95


@law(source="Schaefer1993", where="radial heat conductance of ball bearings", valid="ball bearings", verified=False)
def ball_bearing_conductance(w: Num, Z: Num, D_w: Num, d_m: Num, *, rest: float = 1.0, width: float = 0.1) -> Num:
    r"""Thermal conductance from ring to ring of a ball bearing [W/K]; below 1 rad/s it is that of 1 rad/s.

    .. math:: G = 590 Z D_w^2 \sqrt{7 + \ln\frac{\omega d_m}{2000 D_w}}

    Args:
        w: speed of one ring over the other, either direction [rad/s]
        Z: number of balls [1]
        D_w: diameter of a ball [m]
        d_m: pitch diameter of the balls [m]
        rest: speed below which it stays what it is [rad/s]
        width: rounding there [rad/s]
    """
    speed = smooth_max(smooth_abs(w, SPEED_WIDTH), rest, width)
    return 590 * Z * D_w**2 * ca.sqrt(7 + ca.log(speed * d_m / (2000 * D_w)))
