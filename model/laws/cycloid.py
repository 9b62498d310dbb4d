"""Forces and friction losses of a cycloid disc on its pins, its output rollers and its eccentric bearing.

Half of the pins and half of the output rollers carry, each in proportion to its lever (the same stiffness everywhere);
the force of a single pin is `cycloid_pin.pin_load`. The sums below are those of many pins, whose mean over a turn they
are: for 14 pins and 8 rollers within 0.1 %. Speeds are magnitudes: disc and output turn against the input.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num


@law(source="Vasic2022", where="pin forces, in closed form", valid="no clearance", verified=False)
def pin_force_sum(T_disc: Num, e: Num, Zc: Num) -> Num:
    r"""Sum of the forces between a disc and its pins [N], mean over a turn.

    .. math:: \sum F_N = \frac{4 T}{\pi e Z_c}

    Args:
        T_disc: torque of one disc about its centre [N.m]
        e: eccentricity [m]
        Zc: number of lobes of the disc [1]
    """
    return 4 * T_disc / (math.pi * e * Zc)


@law(source="Vasic2022", where="output roller forces, in closed form", valid="no clearance", verified=False)
def roller_force_sum(T_disc: Num, R_0: Num) -> Num:
    r"""Sum of the forces between a disc and the output rollers [N], mean over a turn; all are parallel to the crank.

    .. math:: \sum F_K = \frac{4 T}{\pi R_0}

    Args:
        T_disc: torque of one disc about its centre [N.m]
        R_0: radius on which the rollers stand [m]
    """
    return 4 * T_disc / (math.pi * R_0)


@law(source="Vasic2022", where="largest output roller force", valid="no clearance", verified=False)
def largest_roller_force(T_disc: Num, u: Num, R_0: Num) -> Num:
    r"""Force of the output roller that carries most [N].

    .. math:: F_{K,max} = \frac{4 T}{u R_0}

    Args:
        T_disc: torque of one disc about its centre [N.m]
        u: number of output rollers [1]
        R_0: radius on which the rollers stand [m]
    """
    return 4 * T_disc / (u * R_0)


@law(source="Vasic2022", where="pin forces along the crank, in closed form", valid="0 < K < 1", verified=False)
def pin_force_along_crank(T_disc: Num, K: Num, e: Num, Zc: Num) -> Num:
    r"""Component of the sum of all pin forces along the crank [N], mean over a turn; it relieves the bearing.

    .. math:: \frac{2 T}{\pi e Z_c} \left(\frac{1}{K} - \frac{1 - K^2}{2 K^2} \ln \frac{1 + K}{1 - K}\right)

    Args:
        T_disc: torque of one disc about its centre [N.m]
        K: short-width coefficient [1]
        e: eccentricity [m]
        Zc: number of lobes of the disc [1]
    """
    shape = 1 / K - (1 - K**2) / (2 * K**2) * ca.log((1 + K) / (1 - K))
    return 2 * T_disc * shape / (math.pi * e * Zc)


@law(source="Vasic2022", where="eccentric bearing force", valid="0 < K < 1", verified=False)
def eccentric_force(T_disc: Num, K: Num, e: Num, Zc: Num, R_0: Num) -> Num:
    r"""Force of the eccentric bearing of one disc [N], which balances pins and output rollers.

    .. math:: F_E = \sqrt{\left(\frac{T}{e Z_c}\right)^2 + \left(\sum F_K - F_{N,x}\right)^2}

    Args:
        T_disc: torque of one disc about its centre, not negative [N.m]
        K: short-width coefficient [1]
        e: eccentricity [m]
        Zc: number of lobes of the disc [1]
        R_0: radius on which the output rollers stand [m]
    """
    along = roller_force_sum(1.0, R_0) - pin_force_along_crank(1.0, K, e, Zc)
    return T_disc * ca.sqrt((e * Zc) ** -2 + along**2)


@law(source="Vasic2022", where="eq 2, eccentric bearing", verified=False)
def bearing_loss_torque(mu_r: Num, D: Num, F: Num) -> Num:
    r"""Loss torque of a bearing, referred to its own turning [N.m].

    .. math:: t = \mu_r \frac{D}{2} F

    Args:
        mu_r: coefficient of rolling friction [1]
        D: mean diameter of the rollers' path [m]
        F: force [N]
    """
    return mu_r * D / 2 * F


@law(source="Vasic2022", where="eq 2, rollers on pins", verified=False)
def roller_loss_torque(mu_r: Num, D: Num, mu_s: Num, d: Num, F: Num) -> Num:
    r"""Loss torque of rollers that turn on pins and roll on a disc, referred to their own turning [N.m].

    .. math:: t = \left(\mu_r \frac{D}{2} + \mu_s \frac{d}{2}\right) F

    Args:
        mu_r: coefficient of rolling friction between roller and disc [1]
        D: outer diameter of a roller [m]
        mu_s: coefficient of sliding friction between roller and pin [1]
        d: diameter of a pin, the bore of its roller [m]
        F: sum of the forces [N]
    """
    return (mu_r * D + mu_s * d) / 2 * F


@law(source="Vasic2022", where="eq 1, corrected: the torques are referred to the input", verified=False)
def malhotra_efficiency(tau_loss: Num, P_in: Num, w_in: Num) -> Num:
    r"""Efficiency of a reducer whose loss torque is referred to the input [1].

    .. math:: \eta = 1 - t \omega_{in} / P_{in}

    Args:
        tau_loss: sum of the loss torques at rated load [N.m]
        P_in: rated power at the input [W]
        w_in: rated speed of the input [rad/s]
    """
    return 1 - tau_loss * w_in / P_in


@law(source="Vasic2022", where="eq 2, with the rollers' own speeds", verified=False)
def output_roller_power(F_K: Num, e: Num, w_rel: Num, D: Num, d: Num, mu_r: Num, mu_s: Num) -> Num:
    r"""Friction power of the output rollers of one disc [W]: the hole runs round each roller at e w.

    .. math:: P = \sum F_K \, e \, \omega \left(\mu_r + \mu_s \frac{d}{D}\right)

    Args:
        F_K: sum of the roller forces [N]
        e: eccentricity [m]
        w_rel: speed of the crank against the disc, not negative [rad/s]
        D: outer diameter of a roller [m]
        d: diameter of a pin [m]
        mu_r: coefficient of rolling friction [1]
        mu_s: coefficient of sliding friction between roller and pin [1]
    """
    return F_K * e * w_rel * (mu_r + mu_s * d / D)


@law(source="Vasic2022", where="eq 2, with the rollers' own speeds", verified=False)
def ring_roller_power(F_N: Num, Rp: Num, w_disc: Num, D: Num, d: Num, mu_r: Num, mu_s: Num) -> Num:
    r"""Friction power of the pin rollers of one disc [W]: the disc passes each at its distance from the pole.

    .. math:: P = \sum F_{N,i} \left(D_i - \frac{D}{2}\right) \omega \left(\mu_r + \mu_s \frac{d}{D}\right),\quad
        \sum F_{N,i} D_i = R_p \sum F_N

    Args:
        F_N: sum of the pin forces [N]
        Rp: radius of the pin circle [m]
        w_disc: speed of the disc, not negative [rad/s]
        D: outer diameter of a roller [m]
        d: diameter of a pin [m]
        mu_r: coefficient of rolling friction [1]
        mu_s: coefficient of sliding friction between roller and pin [1]
    """
    return F_N * (Rp - D / 2) * w_disc * (mu_r + mu_s * d / D)
