"""The mesh of a cycloid disc with the pins of its housing: curve, curvature, pin load and speeds of a contact.

Angles `theta` are those of a pin from the crank's line (from the pole, the crank's side), seen from the centre of the
pins: a mesh cycle is 0 to 2 pi, the loaded half 0 to pi. `K` = e Zp / Rp is the short-width coefficient of the trochoid
and S = sqrt(1 + K^2 - 2 K cos(theta)) the distance of a pin from the pole over the radius of the pin circle. Speeds
are those of the crank's line against the pins.
"""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num


@law(source="CycloidPinEHL", where="short-width coefficient", valid="0 < K < 1", verified=False)
def width_coefficient(e: Num, Zp: Num, Rp: Num) -> Num:
    r"""Short-width coefficient of the trochoid [1]; the disc has cusps from 1 on.

    .. math:: K = e Z_p / R_p

    Args:
        e: eccentricity [m]
        Zp: number of pins [1]
        Rp: radius of the pin circle [m]
    """
    return e * Zp / Rp


@law(source="CycloidPinEHL", where="distance of a pin from the pole", verified=False)
def pole_distance(K: Num, theta: Num) -> Num:
    r"""Distance of a pin's centre from the pole, over the radius of the pin circle [1].

    .. math:: S = \sqrt{1 + K^2 - 2 K \cos\theta}

    Args:
        K: short-width coefficient [1]
        theta: angle of the pin from the crank's line [rad]
    """
    return ca.sqrt(1 + K**2 - 2 * K * ca.cos(theta))


@law(source="CycloidPinEHL", where="profile, relative phase corrected", verified=False)
def pin_centre(e: Num, Zp: Num, Rp: Num, theta: Num) -> tuple[Num, Num]:
    r"""Path of a pin's centre as the disc sees it [m]: the disc's profile before the pin's radius is taken off.

    .. math:: x + i y = R_p e^{i \psi} - e\, e^{i Z_p \psi},\quad \psi = \theta / (Z_p - 1)

    Args:
        e: eccentricity [m]
        Zp: number of pins, one more than lobes [1]
        Rp: radius of the pin circle [m]
        theta: angle of the pin from the crank's line [rad]
    """
    psi = theta / (Zp - 1)
    return Rp * ca.cos(psi) - e * ca.cos(Zp * psi), Rp * ca.sin(psi) - e * ca.sin(Zp * psi)


@law(source="CycloidPinEHL", where="profile, offset corrected to the pin's radius", verified=False)
def profile(e: Num, Zp: Num, Rp: Num, r_rp: Num, theta: Num) -> tuple[Num, Num]:
    r"""Profile of the disc [m]: where it touches the pin, a pin's radius from its centre towards the pole.

    .. math:: (x, y) = (x_p, y_p) + r_{rp} \vec n,\quad
        n_x + i n_y = \frac{K e^{i Z_p \psi} - e^{i \psi}}{S}

    Args:
        e: eccentricity [m]
        Zp: number of pins, one more than lobes [1]
        Rp: radius of the pin circle [m]
        r_rp: radius of a pin [m]
        theta: angle of the pin from the crank's line [rad]
    """
    K, psi, (x, y) = width_coefficient(e, Zp, Rp), theta / (Zp - 1), pin_centre(e, Zp, Rp, theta)
    offset = r_rp / pole_distance(K, theta)
    return x + offset * (K * ca.cos(Zp * psi) - ca.cos(psi)), y + offset * (K * ca.sin(Zp * psi) - ca.sin(psi))


@law(source="CycloidPinEHL", where="curvature, corrected", valid="0 < K < 1", verified=False)
def curvature(K: Num, Zp: Num, Rp: Num, theta: Num) -> Num:
    r"""Curvature of the path of a pin's centre [1/m]; positive where the disc is convex.

    .. math:: \kappa = \frac{1 + Z_p K^2 - K (Z_p + 1) \cos\theta}{R_p S^3}

    Args:
        K: short-width coefficient [1]
        Zp: number of pins [1]
        Rp: radius of the pin circle [m]
        theta: angle of the pin from the crank's line [rad]
    """
    return (1 + Zp * K**2 - K * (Zp + 1) * ca.cos(theta)) / (Rp * pole_distance(K, theta) ** 3)


@law(source="CycloidPinEHL", where="greatest curvature, from its derivative", valid="0 < K < 1", verified=False)
def greatest_curvature(K: Num, Zp: Num, Rp: Num) -> Num:
    r"""Greatest curvature of the path of a pin's centre [1/m]; a pin of a larger radius than its inverse undercuts.

    .. math:: \cos\theta = \frac{3 (1 + Z_p K^2)}{K (Z_p + 1)} - \frac{1 + K^2}{K},\quad -1 \le \cos\theta \le 1

    Args:
        K: short-width coefficient [1]
        Zp: number of pins [1]
        Rp: radius of the pin circle [m]
    """
    c = 3 * (1 + Zp * K**2) / (K * (Zp + 1)) - (1 + K**2) / K
    return curvature(K, Zp, Rp, ca.acos(ca.fmin(ca.fmax(c, -1), 1)))


@law(source="CycloidPinEHL", where="reduced radius, corrected", valid="no undercut", verified=False)
def reduced_radius(kappa: Num, r_rp: Num) -> Num:
    r"""Reduced radius of disc and pin [m]: 1/R = 1/r_rp + 1/(1/kappa - r_rp).

    .. math:: R = r_{rp} (1 - \kappa r_{rp})

    Args:
        kappa: curvature of the path of the pin's centre [1/m]
        r_rp: radius of a pin [m]
    """
    return r_rp * (1 - kappa * r_rp)


@law(source="CycloidPinEHL", where="pin load, corrected", valid="0 <= theta <= pi, no clearance", verified=False)
def pin_load(T_disc: Num, K: Num, Zc: Num, Rp: Num, theta: Num) -> Num:
    r"""Force of a pin on the disc [N]: half of the pins carry, each in proportion to its lever.

    .. math:: F = \frac{4 T_{disc} \sin\theta}{K Z_c R_p S}

    Args:
        T_disc: torque of one disc about its centre [N.m]
        K: short-width coefficient [1]
        Zc: number of lobes of the disc [1]
        Rp: radius of the pin circle [m]
        theta: angle of the pin from the crank's line, in the loaded half [rad]
    """
    return 4 * T_disc * ca.sin(theta) / (K * Zc * Rp * pole_distance(K, theta))


@law(source="CycloidPinEHL", where="lever of a pin's force", verified=False)
def pin_lever(K: Num, Zp: Num, Rp: Num, theta: Num) -> Num:
    r"""Lever of a pin's force about the centre of the disc [m].

    .. math:: l = \frac{K R_p (Z_p - 1) \sin\theta}{Z_p S}

    Args:
        K: short-width coefficient [1]
        Zp: number of pins, one more than lobes [1]
        Rp: radius of the pin circle [m]
        theta: angle of the pin from the crank's line [rad]
    """
    return K * Rp * (Zp - 1) * ca.sin(theta) / (Zp * pole_distance(K, theta))


@law(source="CycloidPinEHL", where="sliding speed on a held pin", verified=False)
def sliding_speed(w_crank: Num, K: Num, Zc: Num, Rp: Num, r_rp: Num, theta: Num) -> Num:
    r"""Speed at which the disc slides over a pin that is held [m/s], with the sign of the crank's speed.

    .. math:: v_s = \omega (R_p S - r_{rp}) / Z_c

    Args:
        w_crank: speed of the crank's line against the pins [rad/s]
        K: short-width coefficient [1]
        Zc: number of lobes of the disc [1]
        Rp: radius of the pin circle [m]
        r_rp: radius of a pin [m]
        theta: angle of the pin from the crank's line [rad]
    """
    return w_crank * (Rp * pole_distance(K, theta) - r_rp) / Zc


@law(source="CycloidPinEHL", where="speed of the contact point", verified=False)
def contact_speed(w_crank: Num, K: Num, r_rp: Num, theta: Num) -> Num:
    r"""Speed of the contact point round the pin [m/s].

    .. math:: v_c = r_{rp} \omega K (K - \cos\theta) / S^2

    Args:
        w_crank: speed of the crank's line against the pins [rad/s]
        K: short-width coefficient [1]
        r_rp: radius of a pin [m]
        theta: angle of the pin from the crank's line [rad]
    """
    return r_rp * w_crank * K * (K - ca.cos(theta)) / pole_distance(K, theta) ** 2


@law(source="CycloidPinEHL", where="mean entrainment speed, corrected", verified=False)
def entrainment_speed(v_slide: Num, v_contact: Num, roll: Num) -> Num:
    r"""Mean of the speeds of both surfaces through the contact [m/s], signed: that of a held pin or of a rolling one.

    .. math:: u = v_s (1 + r) / 2 - v_c

    Args:
        v_slide: speed at which the disc slides over a held pin [m/s]
        v_contact: speed of the contact point round the pin [m/s]
        roll: speed of the pin's surface over that of the disc: 0 held, 1 rolling [1]
    """
    return v_slide * (1 + roll) / 2 - v_contact


@law(source="Hertz1881", where="line contact", verified=False)
def hertz_line_pressure(w_l: Num, R: Num, E_eff: Num) -> Num:
    r"""Greatest pressure of a dry line contact [Pa].

    .. math:: p_H = \sqrt{\frac{w E'}{2 \pi R}}

    Args:
        w_l: load per length, not negative [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E' = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    return ca.sqrt(w_l * E_eff / (2 * ca.pi * R))
