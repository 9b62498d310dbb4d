"""Thickness of the oil film between the flanks: a diagnosis of the regime, no part of any loss."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs, smooth_power


@law(
    source="Grubin1949",
    where="central film thickness of a line contact",
    valid="elastohydrodynamic regime, smooth surfaces, no heating",
)
def film_thickness(
    eta_0: Num,
    u_sum: Num,
    alpha_p: Num,
    F_n_l: Num,
    R: Num,
    E_star_eff: Num,
    *,
    radius_factor: float = 2.0,
    u_width: float = 1e-4,
    F_width: float = 10.0,
) -> Num:
    r"""Central film thickness of a line contact [m], zero at standstill.

    .. math:: h_0 = 0.975 R_x (U G)^{0.727} W^{-0.091},\quad U = \frac{\eta_0 u_\Sigma}{2 R_x E^*},\quad
        G = 2 \alpha_p E^*,\quad W = \frac{F_{bn}/l}{R_x E^*},\quad R_x = 2 R

    Args:
        eta_0: dynamic viscosity at the oil's temperature [Pa.s]
        u_sum: sum of the speeds of the two surfaces, either sign [m/s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
        F_n_l: normal load per length of contact line, either sign [N/m]
        R: reduced radius of curvature, 1/R = 1/r_1 + 1/r_2 [m]
        E_star_eff: E / (2 (1 - nu^2)) of two equal steels [Pa]
        radius_factor: R_x/R; only 2 makes the formula Grubin's [1]
        u_width: rounding at standstill [m/s]
        F_width: rounding at zero load [N/m]
    """
    R_x = radius_factor * R
    U = eta_0 / (2 * R_x * E_star_eff)  # per unit of speed
    G = 2 * alpha_p * E_star_eff
    W = smooth_abs(F_n_l, F_width) / (R_x * E_star_eff)
    return 0.975 * R_x * (U * G) ** 0.727 * smooth_power(u_sum, 0.727, u_width) * W**-0.091


@law(source="Dias2014", where="thermal reduction of the film", valid="line contact of steel", verified=False)
def thermal_film_reduction(
    beta_T: Num,
    eta_0: Num,
    u_sum: Num,
    k: Num,
    slide_roll: Num,
    *,
    coefficient: float = 14.8,
    u_width: float = 1e-4,
    slide_width: float = 1e-4,
) -> Num:
    r"""Reduction of the film thickness by shear heating in the inlet [1].

    .. math:: \varphi_T = \frac{1}{1 + 0.1 (1 + 14.8 V_e^{0.83}) L^{0.64}},\quad L = \frac{\beta_T \eta_0 u_\Sigma^2}{k}

    Args:
        beta_T: thermoviscosity [1/K]
        eta_0: dynamic viscosity at the oil's temperature [Pa.s]
        u_sum: sum of the speeds of the two surfaces, either sign [m/s]
        k: thermal conductivity of the oil [W/(m.K)]
        slide_roll: slide-to-roll ratio, either sign [1]
        coefficient: 14.8; the source prints 1.48 [1]
        u_width: rounding at standstill [m/s]
        slide_width: rounding at pure rolling [1]
    """
    L_power = (beta_T * eta_0 / k) ** 0.64 * smooth_power(u_sum, 1.28, u_width)
    return 1 / (1 + 0.1 * (1 + coefficient * smooth_power(slide_roll, 0.83, slide_width)) * L_power)


@law(source="Dias2014", where="specific film thickness")
def specific_film_thickness(h: Num, sigma: Num) -> Num:
    r"""Film thickness over composite roughness [1].

    .. math:: \Lambda = h / \sigma

    Args:
        h: film thickness [m]
        sigma: root of the sum of the squared roughnesses of both surfaces [m]
    """
    return h / sigma


@law(source="Grubin1949", where="exponents of the central film thickness", valid="one contact", verified=False)
def film_from_reference(
    Lambda_ref: Num, stir: Num, load: Num, *, stir_width: float = 1e-6, load_width: float = 1e-3
) -> Num:
    r"""Specific film thickness of a contact by what it is at a reference [1], zero at standstill.

    .. math:: \Lambda = \Lambda_{ref} \left(\frac{\eta u}{\eta_{ref} u_{ref}}\right)^{0.727}
        \left(\frac{F}{F_{ref}}\right)^{-0.091}

    Args:
        Lambda_ref: specific film thickness at the reference [1]
        stir: viscosity times speed over that of the reference, either sign [1]
        load: force over that of the reference, either sign [1]
        stir_width: rounding at standstill [1]
        load_width: rounding without load [1]
    """
    return Lambda_ref * smooth_power(stir, 0.727, stir_width) * smooth_abs(load, load_width) ** -0.091


@law(source="OlverSpikes1998", where="friction between full film and boundary", valid="mixed friction", verified=False)
def mixed_friction(Lambda: Num, mu_film: Num, mu_bl: Num) -> Num:
    r"""Friction coefficient of a contact that a film carries in part [1].

    .. math:: \mu = f \mu_{film} + (1 - f) \mu_{bl},\quad f = 1 - \frac{1}{(1 + \Lambda)^2}

    Args:
        Lambda: specific film thickness, not negative [1]
        mu_film: friction coefficient of a full film [1]
        mu_bl: friction coefficient without a film [1]
    """
    return mu_film + (mu_bl - mu_film) / (1 + Lambda) ** 2


@law(source="OlverSpikes1998", where="friction between full film and boundary", valid="mixed friction", verified=False)
def film_of_friction(mu: Num, mu_film: Num, mu_bl: Num) -> Num:
    r"""Specific film thickness at which a contact has a given friction coefficient [1]: `mixed_friction` inverted.

    .. math:: \Lambda = \sqrt{\frac{\mu_{bl} - \mu_{film}}{\mu - \mu_{film}}} - 1

    Args:
        mu: friction coefficient, between the other two [1]
        mu_film: friction coefficient of a full film [1]
        mu_bl: friction coefficient without a film [1]
    """
    return ca.sqrt((mu_bl - mu_film) / (mu - mu_film)) - 1
