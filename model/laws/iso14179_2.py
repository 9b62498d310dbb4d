"""Losses and heat of enclosed gear drives after ISO/TR 14179-2, the method of Niemann and Winter.

What stands here was compared with no print of the standard. The rest of the method is elsewhere: tooth friction is
`mesh.friction_schlenk` with the load per face width; the tooth loss factor, with 1 - eps_1 - eps_2 + eps_1^2 + eps_2^2,
is `mesh.tooth_loss_factor` for one to two pairs in contact; seals are `sealing.lip_seal_torque`, bearings
`rolling.needle_torque_viscous` and `needle_torque_load`, radiation is `radiation.radiation_coefficient`.
"""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs

#: Heat transfer from the oil to the inner wall [W/(m2.K)].
H_OIL = 200.0


@law(source="ISO14179-2", where="splash oil factor", valid="splash lubrication", verified=False)
def splash_factor(e_max: Num, h_c: Num, l_h: Num) -> Num:
    r"""Factor of the hydraulic loss of a gear stage for the room that the oil has [1].

    .. math:: C_{Sp} = \left(\frac{4 e_{max}}{3 h_c}\right)^{1.5} \frac{2 h_c}{l_h}

    Args:
        e_max: depth to which the deeper gear dips [m]
        h_c: height of the pitch point above the lowest point of that gear [m]
        l_h: four times the area of the sump over its circumference [m]
    """
    return (4 * e_max / (3 * h_c)) ** 1.5 * 2 * h_c / l_h


@law(source="ISO14179-2", where="hydraulic loss torque of a gear stage", valid="splash lubrication", verified=False)
def hydraulic_torque(v: Num, e: Num, b: Num, C_Sp: Num, *, v_width: float = 1e-2) -> Num:
    r"""Torque that a gear stage loses in the oil [N.m]; here it acts on the shaft of the gear that dips deeper.

    .. math:: T_H = C_{Sp} C_1 \exp\left(C_2 \frac{v}{v_0}\right),\quad
        C_1 = 0.063 \frac{e}{e_0} + 0.0128 \left(\frac{b}{b_0}\right)^3,\quad C_2 = \frac{e}{80 e_0} + 0.2

    with e_0 = b_0 = 10 mm and v_0 = 10 m/s. It does not depend on the viscosity.

    Args:
        v: speed of the pitch line, either direction [m/s]
        e: sum of the depths to which both gears dip [m]
        b: face width [m]
        C_Sp: splash oil factor [1]
        v_width: rounding at standstill [m/s]
    """
    e_rel, b_rel = e / 0.010, b / 0.010
    return C_Sp * (0.063 * e_rel + 0.0128 * b_rel**3) * ca.exp((e_rel / 80 + 0.2) * smooth_abs(v, v_width) / 10)


@law(source="ISO14179-2", where="free convection of the housing", valid="warmer than the air", verified=False)
def free_convection(T_s: Num, T_f: Num, height: Num, *, dT_width: float = 1e-2) -> Num:
    r"""Heat transfer coefficient of a housing in still air [W/(m2.K)].

    .. math:: \alpha = 18 h^{-0.1} \left(\frac{T_s - T_f}{T_f}\right)^{0.3}

    Args:
        T_s: temperature of the surface [K]
        T_f: temperature of the air [K]
        height: height of the housing [m]
        dT_width: rounding at equal temperatures [K]
    """
    return 18 * height**-0.1 * (smooth_abs(T_s - T_f, dT_width) / T_f) ** 0.3
