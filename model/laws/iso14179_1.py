"""Losses of enclosed gear drives after ISO/TR 14179-1, the method of AGMA 6013 and 6123.

The forms are those that secondary literature quotes; the constants were compared with no print of the standard. Losses
of bearings are those of `rolling.needle_torque_viscous` and `needle_torque_load`, which hold for all rolling bearings.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import SPEED_WIDTH, Num, smooth_abs, smooth_max, smooth_power, to_rpm

#: Arrangement constant of the churning formulas [1].
ARRANGEMENT = 0.2
#: Torque over shaft diameter of a lip seal of nitrile rubber (NBR) [N.m/m].
NBR = 2.429
#: Heat that leaves the housing, over its area and the rise of the sump [W/(m2.K)]: a large room with little draught.
STILL_AIR = 17.0
#: Helix angle below which the churning of the teeth is that of this angle [rad].
LEAST_HELIX = math.radians(10.0)


@law(source="ISO14179-1", where="load intensity, the K factor", valid="external gears", verified=False)
def load_intensity(F_t: Num, b: Num, d_w1: Num, u: Num) -> Num:
    r"""Load intensity of a mesh [Pa].

    .. math:: K = \frac{F_t}{b d_{w1}} \frac{u + 1}{u}

    Args:
        F_t: tangential force at the pitch cylinder [N]
        b: face width [m]
        d_w1: pitch diameter of the pinion [m]
        u: teeth ratio z_2/z_1 [1]
    """
    return F_t / (b * d_w1) * (u + 1) / u


@law(
    source="ISO14179-1",
    where="mesh coefficient of friction",
    valid="mineral oils, K 1.4 to 14 N/mm2, pitch line 2 to 25 m/s",
    ranges={"K": (1.4e6, 14e6), "v": (2.0, 25.0)},
    verified=False,
)
def mesh_friction(nu: Num, K: Num, v: Num, *, K_width: float = 1e4, v_width: float = 1e-2) -> Num:
    r"""Mean friction coefficient of a mesh [1].

    .. math:: f_m = \frac{\nu^{-0.223} K^{-0.4}}{3.239 \, v^{0.7}}

    Args:
        nu: kinematic viscosity at the temperature of the sump [m2/s]
        K: load intensity [Pa]
        v: speed of the pitch line, either direction [m/s]
        K_width: rounding at zero load [Pa]
        v_width: rounding at standstill [m/s]
    """
    nu_cSt, K_N_mm2, v_m_s = 1e6 * nu, 1e-6 * smooth_abs(K, K_width), smooth_abs(v, v_width)
    return nu_cSt**-0.223 * K_N_mm2**-0.4 / (3.239 * v_m_s**0.7)


@law(source="ISO14179-1", where="sliding ratio at the tip, H_s and H_t", valid="external gears", verified=False)
def tip_sliding(d_a: Num, d_w: Num, alpha_wt: Num, u: Num) -> Num:
    r"""Sliding speed over pitch line speed where the tip of a gear is in contact [1].

    .. math:: H = (u + 1) \left(\sqrt{(d_a/d_w)^2 - \cos^2\alpha_{wt}} - \sin\alpha_{wt}\right)

    Args:
        d_a: tip diameter of this gear [m]
        d_w: pitch diameter of this gear [m]
        alpha_wt: working transverse pressure angle [rad]
        u: teeth of this gear over those of the other [1]
    """
    return (u + 1) * (ca.sqrt((d_a / d_w) ** 2 - ca.cos(alpha_wt) ** 2) - ca.sin(alpha_wt))


@law(source="ISO14179-1", where="mesh loss and mesh mechanical advantage", valid="external gears", verified=False)
def mesh_loss(P_a: Num, mu: Num, H_s: Num, H_t: Num, alpha_wt: Num, beta: Num) -> Num:
    r"""Friction power of a mesh [W].

    .. math:: P_M = P \frac{f_m \cos^2\beta_w}{M},\quad M = \frac{2\cos\alpha_{wt}(H_s + H_t)}{H_s^2 + H_t^2}

    M is the inverse of the mean sliding speed over the pitch line speed and the cosine of the pressure angle, of a load
    that stays the same along the path of contact.

    Args:
        P_a: magnitude of the power through the mesh [W]
        mu: mean friction coefficient f_m [1]
        H_s: tip sliding of the wheel [1]
        H_t: tip sliding of the pinion [1]
        alpha_wt: working transverse pressure angle [rad]
        beta: helix angle at the pitch cylinder [rad]
    """
    M = 2 * ca.cos(alpha_wt) * (H_s + H_t) / (H_s**2 + H_t**2)
    return P_a * mu * ca.cos(beta) ** 2 / M


@law(source="ISO14179-1", where="windage and churning of the sides of a disc", verified=False)
def side_churning(w: Num, nu: Num, D: Num, dip: Num) -> Num:
    r"""Power that the sides of a gear lose in oil and air [W].

    .. math:: P = \frac{1.474 f_g \nu n^3 D^{5.7}}{A_g 10^{26}} \;[\mathrm{kW}]

    Args:
        w: speed of the gear, either direction [rad/s]
        nu: kinematic viscosity at the temperature of the sump [m2/s]
        D: tip diameter [m]
        dip: depth of immersion over the tip diameter, the factor f_g: 0 above the oil, 1 below [1]
    """
    nu_cSt, D_mm, n_width = 1e6 * nu, 1e3 * D, to_rpm(SPEED_WIDTH)
    return 1e-23 * 1.474 * dip * nu_cSt * smooth_power(to_rpm(w), 3, n_width) * D_mm**5.7 / ARRANGEMENT


@law(source="ISO14179-1", where="windage and churning of the teeth", verified=False)
def tooth_churning(w: Num, nu: Num, D: Num, b: Num, beta: Num, m_t: Num, dip: Num) -> Num:
    r"""Power that the teeth of a gear lose in oil and air [W].

    .. math:: P = \frac{7.37 f_g \nu n^3 D^{4.7} b R_f}{A_g 10^{26} \sqrt{\tan\beta}} \;[\mathrm{kW}],\quad
        R_f = 7.93 - \frac{4.648}{m_t}

    A helix angle below 10 deg counts as 10 deg, a module so small that R_f falls below 1 as one with R_f = 1.

    Args:
        w: speed of the gear, either direction [rad/s]
        nu: kinematic viscosity at the temperature of the sump [m2/s]
        D: tip diameter [m]
        b: face width [m]
        beta: helix angle [rad]
        m_t: transverse module [m]
        dip: depth of immersion over the tip diameter, the factor f_g: 0 above the oil, 1 below [1]
    """
    nu_cSt, D_mm, b_mm, m_mm, n_width = 1e6 * nu, 1e3 * D, 1e3 * b, 1e3 * m_t, to_rpm(SPEED_WIDTH)
    R_f, helix = smooth_max(7.93 - 4.648 / m_mm, 1.0, 1e-3), smooth_max(beta, LEAST_HELIX, 1e-4)
    n_3 = smooth_power(to_rpm(w), 3, n_width)
    return 1e-23 * 7.37 * dip * nu_cSt * n_3 * D_mm**4.7 * b_mm * R_f / ca.sqrt(ca.tan(helix)) / ARRANGEMENT


@law(source="ISO14179-1", where="oil seals, nitrile rubber", verified=False)
def seal_torque(d_sh: Num, c_sh: Num = NBR) -> Num:
    r"""Friction torque of a radial lip seal [N.m], the same at any speed.

    .. math:: T_s = 2.429 \cdot 10^{-3} d_{sh} \;[\mathrm{N.m, mm}]

    Args:
        d_sh: diameter of the shaft under the lip [m]
        c_sh: torque over the diameter [N]
    """
    return c_sh * d_sh
