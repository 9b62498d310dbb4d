"""Heat conduction through walls and along fins."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num


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
