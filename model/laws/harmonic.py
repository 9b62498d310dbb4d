"""Teeth of a harmonic drive: how fast their flanks slide, how they touch, and the oil film that the source prints."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import LINE_WIDTH, SLOW_WIDTH, Num, smooth_abs, smooth_power


@law(source="Kalina2021", where="pitch-line speed of the flexspline's teeth", verified=False)
def flank_speed_radius(w_0: Num, phi: Num) -> Num:
    r"""Sliding speed of the flanks over the speed of the wave generator [m].

    .. math:: u_1 / \omega = w_0 \cos 2\varphi

    Args:
        w_0: radial deflection of the flexspline [m]
        phi: angle of the tooth from the long axis of the wave generator [rad]
    """
    return w_0 * ca.cos(2 * phi)


@law(source="Kalina2021", where="equation 9, convex flank in a concave one")
def conforming_radius(r_convex: Num, r_concave: Num) -> Num:
    r"""Reduced radius of a convex flank in a slightly larger concave one [m].

    .. math:: 1/R = 1/r_{convex} - 1/r_{concave}

    Args:
        r_convex: radius of the convex flank, the smaller one [m]
        r_concave: radius of the concave flank [m]
    """
    return r_convex * r_concave / (r_concave - r_convex)


@law(source="Hertz1881", where="half width of a line contact")
def half_width(F_n_l: Num, R: Num, E_eff: Num) -> Num:
    r"""Half of the width that a line contact is flattened over [m]; the source leaves out the pi.

    .. math:: b = \sqrt{\frac{8 F' R}{\pi E'}}

    Args:
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    return ca.sqrt(8 * smooth_abs(F_n_l, LINE_WIDTH) * R / (math.pi * E_eff))


@law(source="Kalina2021", where="minimum film, Dowson and Higginson's formula with dimensions", verified=False)
def printed_film(alpha_p: Num, eta_0: Num, u_0: Num, E_eff: Num, R: Num, F_n_l: Num) -> Num:
    r"""Minimum film as the source prints it [m], zero at standstill; for an elastohydrodynamic contact.

    .. math:: h_{min} = 1.6 \alpha^{0.6} (\eta_0 u_0)^{0.7} E'^{0.03} R^{0.43} (L/F_0)^{0.13}

    Args:
        alpha_p: pressure-viscosity coefficient [1/Pa]
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_0: mean speed of the flanks, half of what they slide at, either sign [m/s]
        E_eff: effective modulus [Pa]
        R: reduced radius [m]
        F_n_l: load per face width F_0/L, either sign [N/m]
    """
    load = smooth_abs(F_n_l, LINE_WIDTH) ** -0.13
    return 1.6 * alpha_p**0.6 * eta_0**0.7 * smooth_power(u_0, 0.7, SLOW_WIDTH) * E_eff**0.03 * R**0.43 * load


@law(source="Hamrock2004", where="friction of a fixed-incline slider of infinite width", verified=False)
def pad_shear(eta_0: Num, v_slide: Num, B: Num, L: Num, h: Num, a: Num) -> Num:
    r"""Viscous drag of a converging pad [N], with the sign of the speed.

    .. math:: F = \frac{\eta_0 v B L}{h} \frac{1}{a - 1} \left[4 \ln a - \frac{6 (a - 1)}{a + 1}\right]

    Args:
        eta_0: dynamic viscosity [Pa.s]
        v_slide: sliding speed, either sign [m/s]
        B: length along the motion [m]
        L: width across it [m]
        h: film at the outlet [m]
        a: film at the inlet over film at the outlet, above 1 [1]
    """
    return eta_0 * v_slide * B * L / h * (4 * ca.log(a) - 6 * (a - 1) / (a + 1)) / (a - 1)
