"""Worm gears with shafts at a right angle: friction by the sliding speed, and the forces of a screw with friction."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs, smooth_cap, smooth_max, smooth_min

#: Lubricant factor of the oils that the base friction is printed for, and its A [1], B [1], v_0 [m/s], n, limit [1].
BASE = {
    1.0: (0.028, 0.026, 0.17, 0.76, 0.100),  # mineral oils
    0.8: (0.026, 0.017, 0.17, 0.92, 0.096),  # polyalphaolefins
    0.7: (0.020, 0.020, 0.20, 0.97, 0.094),  # polyglycols
}
#: Square of the distance in X_L within which an oil is that of the print: 0.001, far below what oils differ by.
BLUR = 1e-6
#: What is said where the wheel would have to drive a worm that its friction holds.
HELD = (
    "self-locking, the wheel cannot drive: friction {mu} is {locking} times what a lead angle of {gamma} slides with,"
    " the efficiency backward would be {eta_mesh}. Let the worm drive, or take more starts, a thinner worm or less"
    " friction"
)
#: Centre distances between which worms were measured [m].
SIZES = (0.065, 0.250)


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


@law(
    source="DIN3996",
    where="base coefficient of tooth friction, bronze wheels, injection lubrication; as MITCalc has it",
    verified=False,
    valid="hardened and ground steel worm, bronze wheel; an oil bath is taken as injection",
    ranges={"v_slide": (-30.0, 30.0), "X_L": (0.55, 1.0)},
)
def worm_base_friction(v_slide: Num, X_L: Num, *, v_width: float = 0.05) -> Num:
    r"""Friction number of a worm mesh of 100 mm between its shafts [1], as the tangent of a friction angle.

    .. math:: \mu_{0T} = A + B (v + v_0)^{-n} \le \mu_{max}

    The constants are those of mineral oils, polyalphaolefins and polyglycols. An oil is known by its lubricant factor:
    at 1, 0.8 and 0.7 the numbers are as printed, elsewhere their mean over X_L, weighted by the inverse square of the
    distance, times X_L: this project's own reading. What the same witness has for mineral oil in a bath (0.079 where
    the formulas of the other oils have 0.0056 and 0.0032) looks like a slip and is not used.

    Args:
        v_slide: sliding speed of the flanks at the mean diameter, either sign [m/s]
        X_L: lubricant factor [1]
        v_width: speed below which the number is rounded [m/s]
    """
    v = smooth_abs(v_slide, v_width)
    weights = [1 / ((X_L - X) ** 2 + BLUR) for X in BASE]
    scaled = [smooth_cap(A + B * (v + v_0) ** -n, limit) / X for X, (A, B, v_0, n, limit) in BASE.items()]
    return X_L * sum(w * mu for w, mu in zip(weights, scaled, strict=True)) / sum(weights)


@law(
    source="DIN3996",
    where="size factor Y_S, as MITCalc has it",
    verified=False,
    valid="below 65 and above 250 mm the factor stays",
)
def worm_size_factor(a: Num, *, width: float = 0.005) -> Num:
    r"""How the friction of a worm mesh falls with its size [1].

    .. math:: Y_S = \sqrt{100\ \mathrm{mm} / a}

    Args:
        a: centre distance [m]
        width: centre distance over which the ends are rounded [m]
    """
    return (0.1 / smooth_max(smooth_min(a, SIZES[1], width), SIZES[0], width)) ** 0.5


@law(source="DIN3996", where="edition of 1998, parameter h* of the mean film, as MITCalc has it", verified=False)
def worm_film_parameter(z_1: Num, z_2: Num, m_x: Num, d_1: Num, b: Num) -> Num:
    r"""How well a worm mesh without profile shift builds a film, by its geometry [1].

    .. math:: h^* = 0.018 + \frac{q}{7.86 (q + z_2)} + \frac{1}{z_2} - \frac{u}{36300} + \frac{b}{370.4 m_x}
        - \frac{\sqrt{2 q - 1}}{213.9}

    Args:
        z_1: number of starts [1]
        z_2: number of teeth of the wheel [1]
        m_x: axial module [m]
        d_1: mean diameter of the worm, q m_x [m]
        b: face width of the wheel [m]
    """
    q = d_1 / m_x
    by_teeth = 0.018 + q / (7.86 * (q + z_2)) + 1 / z_2 - z_2 / z_1 / 36300
    return by_teeth + b / (370.4 * m_x) - ca.sqrt(2 * q - 1) / 213.9


@law(source="DIN3996", where="geometry factor Y_G, as MITCalc has it", verified=False)
def worm_geometry_factor(h_star: Num) -> Num:
    r"""How the friction of a worm mesh falls with the film of its geometry [1].

    .. math:: Y_G = \sqrt{0.07 / h^*}

    Args:
        h_star: parameter of the mean film [1]
    """
    return (0.07 / h_star) ** 0.5


@law(source="DIN3996", where="roughness factor Y_R, as MITCalc has it", verified=False)
def worm_roughness_factor(Ra: Num) -> Num:
    r"""How the friction of a worm mesh rises with the worm's roughness [1].

    .. math:: Y_R = (R_a / 0.5\ \mathrm{\mu m})^{1/4}

    Args:
        Ra: arithmetic mean roughness of the worm's flanks [m]
    """
    return (Ra / 0.5e-6) ** 0.25


@law(source="DIN3996", where="mean coefficient of tooth friction mu_zm, as MITCalc has it", verified=False)
def worm_mean_friction(mu_0T: Num, Y: Num, alpha_n: Num) -> Num:
    r"""Mean friction coefficient of a worm mesh [1].

    .. math:: \mu = \mu_{0T} Y \cos\alpha_n

    The source states the tangent of the friction angle that is added to the lead angle; the normal force of a flank at
    a pressure angle is more than the one there by 1/cos, so its coefficient is less.

    Args:
        mu_0T: base friction number [1]
        Y: product of the factors of size, geometry, material and roughness [1]
        alpha_n: normal pressure angle [rad]
    """
    return mu_0T * Y * ca.cos(alpha_n)


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


@law(source="Mott2004", where="section 10-11, self-locking worms, with the pressure angle", verified=False)
def worm_locking(mu: Num, alpha_n: Num, gamma: Num) -> Num:
    r"""Friction of a worm mesh over that from which on the wheel cannot drive [1].

    .. math:: \Lambda = \frac{\mu}{\cos\alpha_n \tan\gamma}

    Args:
        mu: friction coefficient [1]
        alpha_n: normal pressure angle [rad]
        gamma: lead angle [rad]
    """
    return mu / (ca.cos(alpha_n) * ca.tan(gamma))


@law(
    source="Mott2004",
    where="quotient of equations 10-24 and 10-25",
    ranges={"locking * drive": (-1.0, 1e3)},
    regimes={"locking * drive": HELD},
    verified=False,
)
def worm_efficiency(locking: Num, gamma: Num, drive: Num) -> Num:
    r"""Efficiency of a worm mesh [1], below zero where the wheel drives a worm that its friction holds.

    .. math:: \eta = \left(\frac{1 - \Lambda \tan^2\gamma}{1 + \Lambda}\right)_{q = 1}, \quad
        \eta = \left(\frac{1 - \Lambda}{1 + \Lambda \tan^2\gamma}\right)_{q = -1}

    Args:
        locking: friction over that from which on the wheel cannot drive [1]
        gamma: lead angle [rad]
        drive: q, 1 where the worm drives the wheel, -1 where the wheel drives [1]
    """
    L_worm, L_wheel = locking * (1 + drive) / 2, locking * (1 - drive) / 2
    tan_2 = ca.tan(gamma) ** 2
    return (1 - L_worm * tan_2 - L_wheel) / (1 + L_worm + L_wheel * tan_2)


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
