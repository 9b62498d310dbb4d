"""Friction of contact seals."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_max

#: 7.69e-6 W per rpm and square millimetre of the shaft, as torque per square of its diameter [N.m/m2].
LIP_SEAL = 7.69e-6 * 1e6 * 30 / math.pi


@law(source="Dias2014", where="seal losses", valid="radial lip seal")
def lip_seal_torque(d_sh: Num, c_sh: Num = LIP_SEAL) -> Num:
    r"""Friction torque of a radial lip seal [N.m], the same at any speed.

    .. math:: P = 7.69 \cdot 10^{-6} d_{sh}^2 n \;[\mathrm{W, mm, rpm}],\quad \tau = P / \omega = c_{sh} d_{sh}^2

    Args:
        d_sh: diameter of the shaft under the lip [m]
        c_sh: torque per square of the diameter [N.m/m2]
    """
    return c_sh * d_sh**2


@law(source="Incropera2007", where="fins, infinite length", verified=False)
def lip_conductance(d_sh: Num, h: Num, k: Num) -> Num:
    r"""Conductance from the line on which a lip rubs into the shaft and from it to the oil on one side [W/K].

    .. math:: G = \frac{\pi}{2} d_{sh} \sqrt{h k d_{sh}}

    Args:
        d_sh: diameter of the shaft under the lip [m]
        h: heat transfer coefficient between shaft and oil [W/(m2.K)]
        k: conductivity of the shaft [W/(m.K)]
    """
    return math.pi / 2 * d_sh * ca.sqrt(h * k * d_sh)


@law(
    source="Linke1996",
    where="seal losses",
    valid="radial lip seal, gear oil up to 120 degC",
    ranges={"T": (273.15, 393.15)},
    verified=False,
)
def oil_seal_torque(T: Num, nu_40: Num, d_sh: Num, *, lowest: float = 40.0, width: float = 10.0) -> Num:
    r"""Friction torque of a radial lip seal by its oil [N.m]: thick oil and cold rub more, at any speed alike.

    .. math:: P = \left(145 - 1.6 \vartheta + 350 \lg\lg(\nu_{40} + 0.8)\right) 10^{-7} d_{sh}^2 n
        \;[\mathrm{W, ^\circ C, mm^2/s, mm, rpm}],\quad \tau = P / \omega

    Where hot oil would bring the bracket to zero, it stays at `lowest`.

    Args:
        T: temperature of the oil at the seal [K]
        nu_40: kinematic viscosity of the oil at 40 degC [m2/s]
        d_sh: diameter of the shaft under the lip [m]
        lowest: smallest value of the bracket [1]
        width: rounding where it is reached [1]
    """
    T_C, nu_cSt, d_mm, per_speed = T - 273.15, 1e6 * nu_40, 1e3 * d_sh, 30 / math.pi
    bracket = 145 - 1.6 * T_C + 350 * ca.log10(ca.log10(nu_cSt + 0.8))
    return 1e-7 * smooth_max(bracket, lowest, width) * d_mm**2 * per_speed
