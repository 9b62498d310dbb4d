"""Worm gears with shafts at a right angle: friction by the sliding speed, and the forces of a screw with friction."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs


@law(
    source="AGMA6034",
    where="coefficient of friction above 10 ft/min, as in Mott2004, figure 10-18",
    valid="hardened and ground steel worm, bronze wheel, mineral oil; slower it is more than here, up to 0.15",
    ranges={"v_slide": (-30.0, 30.0)},
)
def worm_friction(v_slide: Num, *, v_width: float = 0.05) -> Num:
    r"""Mean friction coefficient of a worm mesh [1].

    .. math:: \mu = 0.103\, e^{-0.110 v^{0.450}} + 0.012

    Args:
        v_slide: sliding speed of the flanks at the mean diameter, either sign [m/s]
        v_width: end of the formula, 10 ft/min; slower the number stays [m/s]
    """
    v_ft_min = smooth_abs(v_slide, v_width) * 60 / 0.3048
    return 0.103 * ca.exp(-0.110 * v_ft_min**0.450) + 0.012


@law(source="Mott2004", where="section 10-11, lead angle", verified=False)
def lead_angle(z_1: Num, m_x: Num, d_1: Num) -> Num:
    r"""Lead angle at the mean diameter of the worm [rad].

    .. math:: \tan\gamma = z_1 m_x / d_1

    Args:
        z_1: number of starts [1]
        m_x: axial module [m]
        d_1: mean diameter of the worm [m]
    """
    return ca.atan(z_1 * m_x / d_1)


@law(source="Mott2004", where="equations 10-24 and 10-25, their denominator", verified=False)
def worm_normal_force(F_t: Num, alpha_n: Num, gamma: Num, mu: Num, drive: Num) -> Num:
    r"""Normal force of a worm mesh [N].

    .. math:: F_n = \frac{F_{t2}}{\cos\alpha_n \cos\gamma - q \mu \sin\gamma}

    Args:
        F_t: tangential force on the wheel, F_t2, which is the axial one on the worm [N]
        alpha_n: normal pressure angle [rad]
        gamma: lead angle [rad]
        mu: friction coefficient [1]
        drive: q, 1 where the worm drives the wheel, -1 where the wheel drives [1]
    """
    return F_t / (ca.cos(alpha_n) * ca.cos(gamma) - drive * mu * ca.sin(gamma))


@law(source="Mott2004", where="equation 10-24, axial force on the wheel")
def worm_tangential_force(F_n: Num, alpha_n: Num, gamma: Num, mu: Num, drive: Num) -> Num:
    r"""Tangential force on the worm [N], the axial one on the wheel; negative where the wheel turns the worm.

    .. math:: F_{t1} = F_n (\cos\alpha_n \sin\gamma + q \mu \cos\gamma)

    Args:
        F_n: normal force [N]
        alpha_n: normal pressure angle [rad]
        gamma: lead angle [rad]
        mu: friction coefficient [1]
        drive: q, 1 where the worm drives the wheel, -1 where the wheel drives [1]
    """
    return F_n * (ca.cos(alpha_n) * ca.sin(gamma) + drive * mu * ca.cos(gamma))


@law(source="Mott2004", where="equation 10-25, radial force")
def worm_radial_force(F_n: Num, alpha_n: Num) -> Num:
    r"""Radial force on worm and wheel [N].

    .. math:: F_r = F_n \sin\alpha_n

    Args:
        F_n: normal force [N]
        alpha_n: normal pressure angle [rad]
    """
    return F_n * ca.sin(alpha_n)


@law(source="Mott2004", where="friction power, normal force times friction and sliding speed", verified=False)
def worm_loss_torque(F_n: Num, mu: Num, d_1: Num, gamma: Num) -> Num:
    r"""Friction torque of a worm mesh, on the worm [N.m].

    .. math:: T_V = \mu F_n \frac{d_1}{2 \cos\gamma}

    Args:
        F_n: normal force [N]
        mu: friction coefficient [1]
        d_1: mean diameter of the worm [m]
        gamma: lead angle [rad]
    """
    return mu * F_n * d_1 / (2 * ca.cos(gamma))
