"""Geometry of helical gears. An internal gear has a negative number of teeth and negative diameters."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num


@law(source="ISO21771", where="transverse pressure angle")
def transverse_pressure_angle(alpha_n: Num, beta: Num) -> Num:
    r"""Transverse pressure angle [rad].

    .. math:: \tan\alpha_t = \tan\alpha_n / \cos\beta

    Args:
        alpha_n: normal pressure angle [rad]
        beta: helix angle at the reference cylinder [rad]
    """
    return ca.atan(ca.tan(alpha_n) / ca.cos(beta))


@law(source="ISO21771", where="base helix angle")
def base_helix_angle(alpha_n: Num, beta: Num) -> Num:
    r"""Helix angle at the base cylinder [rad].

    .. math:: \sin\beta_b = \sin\beta \cos\alpha_n

    Args:
        alpha_n: normal pressure angle [rad]
        beta: helix angle at the reference cylinder [rad]
    """
    return ca.asin(ca.sin(beta) * ca.cos(alpha_n))


@law(source="ISO21771", where="working transverse pressure angle", valid="a_w > a cos(alpha_t)")
def working_pressure_angle(alpha_t: Num, a: Num, a_w: Num) -> Num:
    r"""Working transverse pressure angle [rad].

    .. math:: \cos\alpha_{wt} = \frac{a}{a_w} \cos\alpha_t

    Args:
        alpha_t: transverse pressure angle [rad]
        a: reference centre distance [m]
        a_w: working centre distance [m]
    """
    return ca.acos(a / a_w * ca.cos(alpha_t))


@law(source="ISO21771", where="reference diameter")
def reference_diameter(m_n: Num, z: Num, beta: Num) -> Num:
    r"""Reference diameter [m], negative for an internal gear.

    .. math:: d = m_n z / \cos\beta

    Args:
        m_n: normal module [m]
        z: number of teeth, negative for an internal gear [1]
        beta: helix angle at the reference cylinder [rad]
    """
    return m_n * z / ca.cos(beta)


@law(source="ISO21771", where="base diameter")
def base_diameter(d: Num, alpha_t: Num) -> Num:
    r"""Base diameter [m], negative for an internal gear.

    .. math:: d_b = d \cos\alpha_t

    Args:
        d: reference diameter, negative for an internal gear [m]
        alpha_t: transverse pressure angle [rad]
    """
    return d * ca.cos(alpha_t)


@law(source="ISO21771", where="tip diameter without tip alteration", valid="addendum of one module")
def tip_diameter(d: Num, m_n: Num, x: Num) -> Num:
    r"""Tip diameter [m], negative for an internal gear.

    .. math:: d_a = d + 2 m_n (1 + x)

    Args:
        d: reference diameter, negative for an internal gear [m]
        m_n: normal module [m]
        x: profile shift coefficient; shift outwards is positive, for an internal gear inwards [1]
    """
    return d + 2 * m_n * (1 + x)


@law(source="ISO21771", where="transverse base pitch on the path of contact")
def transverse_base_pitch(m_n: Num, beta: Num, alpha_t: Num) -> Num:
    r"""Transverse base pitch [m].

    .. math:: p_{et} = \pi m_n \cos\alpha_t / \cos\beta

    Args:
        m_n: normal module [m]
        beta: helix angle at the reference cylinder [rad]
        alpha_t: transverse pressure angle [rad]
    """
    return math.pi * m_n * ca.cos(alpha_t) / ca.cos(beta)


@law(source="ISO21771", where="addendum contact ratio", valid="the tip lies beyond the pitch point")
def addendum_contact_ratio(d_a: Num, d_b: Num, alpha_wt: Num, p_et: Num) -> Num:
    r"""Part of the transverse contact ratio between the pitch point and the tip of one gear [1].

    .. math:: \varepsilon = \frac{d_b}{2 p_{et}} \left(\sqrt{(d_a/d_b)^2 - 1} - \tan\alpha_{wt}\right)

    One form for external and internal gears, by the sign of the diameters. The sum over both gears of a mesh is the
    transverse contact ratio.

    Args:
        d_a: tip diameter, negative for an internal gear [m]
        d_b: base diameter, negative for an internal gear [m]
        alpha_wt: working transverse pressure angle [rad]
        p_et: transverse base pitch [m]
    """
    return d_b * (ca.sqrt((d_a / d_b) ** 2 - 1) - ca.tan(alpha_wt)) / (2 * p_et)


@law(source="ISO21771", where="radius of curvature at the pitch point")
def curvature_radius(d_b: Num, alpha_wt: Num) -> Num:
    r"""Transverse radius of curvature of a flank at the pitch point [m], negative for an internal gear.

    .. math:: \rho = \frac{d_b}{2} \tan\alpha_{wt}

    Args:
        d_b: base diameter, negative for an internal gear [m]
        alpha_wt: working transverse pressure angle [rad]
    """
    return 0.5 * d_b * ca.tan(alpha_wt)


@law(source="Dias2014", where="reduced radius of curvature at the pitch point")
def reduced_radius(rho_1: Num, rho_2: Num, beta_b: Num) -> Num:
    r"""Reduced radius of curvature of two helical flanks, normal to the contact line [m].

    .. math:: R = \frac{1}{\cos\beta_b} \frac{\rho_1 \rho_2}{\rho_1 + \rho_2}

    Args:
        rho_1: transverse radius of curvature of the first flank [m]
        rho_2: the same of the second flank, negative for an internal gear [m]
        beta_b: helix angle at the base cylinder [rad]
    """
    return rho_1 * rho_2 / (rho_1 + rho_2) / ca.cos(beta_b)


@law(source="ISO21771", where="overlap ratio", verified=False)
def overlap_ratio(b: Num, m_n: Num, beta: Num) -> Num:
    r"""Overlap ratio [1], 0 for spur gears.

    .. math:: \varepsilon_\beta = \frac{b \sin\beta}{\pi m_n}

    Args:
        b: face width [m]
        m_n: normal module [m]
        beta: helix angle at the reference diameter [rad]
    """
    return b * ca.sin(beta) / (math.pi * m_n)


@law(source="Dias2014", where="length of the contact lines")
def contact_length(b: Num, eps_alpha: Num, beta_b: Num) -> Num:
    r"""Mean length of all contact lines of a helical mesh [m].

    .. math:: l = b \varepsilon_\alpha / \cos\beta_b

    Args:
        b: face width [m]
        eps_alpha: transverse contact ratio [1]
        beta_b: helix angle at the base cylinder [rad]
    """
    return b * eps_alpha / ca.cos(beta_b)


def involute(alpha: Num) -> Num:
    r"""Involute function :math:`\mathrm{inv}\,\alpha = \tan\alpha - \alpha` [rad].

    Args:
        alpha: profile angle [rad]
    """
    return ca.tan(alpha) - alpha


@law(source="ISO21771", where="sum of the profile shift coefficients, no backlash")
def profile_shift_sum(alpha_wt: Num, alpha_t: Num, alpha_n: Num, z_sum: Num) -> Num:
    r"""Sum of the profile shift coefficients with which two gears mesh without backlash [1].

    .. math:: x_1 + x_2 = \frac{(z_1 + z_2)(\mathrm{inv}\,\alpha_{wt} - \mathrm{inv}\,\alpha_t)}{2\tan\alpha_n}

    Args:
        alpha_wt: working transverse pressure angle [rad]
        alpha_t: transverse pressure angle [rad]
        alpha_n: normal pressure angle [rad]
        z_sum: sum of the numbers of teeth [1]
    """
    return z_sum * (involute(alpha_wt) - involute(alpha_t)) / (2 * ca.tan(alpha_n))


@law(source="ISO21771", where="transverse tooth thickness at the tip cylinder", verified=False)
def tip_thickness(z: Num, x: Num, alpha_n: Num, alpha_t: Num, d_a: Num, d_b: Num) -> Num:
    r"""Transverse tooth thickness at the tip of an external gear [m].

    .. math:: s_a = d_a \left(\frac{\pi/2 + 2x\tan\alpha_n}{z} + \mathrm{inv}\,\alpha_t
        - \mathrm{inv}\,\alpha_{at}\right),\quad \cos\alpha_{at} = d_b/d_a

    Args:
        z: number of teeth [1]
        x: profile shift coefficient [1]
        alpha_n: normal pressure angle [rad]
        alpha_t: transverse pressure angle [rad]
        d_a: tip diameter [m]
        d_b: base diameter [m]
    """
    alpha_at = ca.acos(d_b / d_a)
    return d_a * ((math.pi / 2 + 2 * x * ca.tan(alpha_n)) / z + involute(alpha_t) - involute(alpha_at))


@law(source="ISO21771", where="profile shift at the limit of undercut, rack of one module addendum", verified=False)
def undercut_shift(z: Num, alpha_t: Num, beta: Num) -> Num:
    r"""Profile shift below which the teeth of an external gear are undercut [1].

    .. math:: x_{min} = 1 - \frac{z \sin^2\alpha_t}{2\cos\beta}

    Args:
        z: number of teeth [1]
        alpha_t: transverse pressure angle [rad]
        beta: helix angle at the reference cylinder [rad]
    """
    return 1 - z * ca.sin(alpha_t) ** 2 / (2 * ca.cos(beta))
