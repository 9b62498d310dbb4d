"""Films between flanks, and how film and asperities share load and friction."""

from __future__ import annotations

from ..sources import law
from .smooth import LINE_WIDTH, U_WIDTH, Num, smooth_abs, smooth_power, smooth_sign


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
    """
    R_x = radius_factor * R
    U = eta_0 / (2 * R_x * E_star_eff)  # per unit of speed
    G = 2 * alpha_p * E_star_eff
    W = smooth_abs(F_n_l, LINE_WIDTH) / (R_x * E_star_eff)
    return 0.975 * R_x * (U * G) ** 0.727 * smooth_power(u_sum, 0.727, U_WIDTH) * W**-0.091


@law(source="Dias2014", where="thermal reduction of the film", valid="line contact of steel", verified=False)
def thermal_film_reduction(
    beta_T: Num,
    eta_0: Num,
    u_sum: Num,
    k: Num,
    slide_roll: Num,
    *,
    coefficient: float = 14.8,
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
        slide_width: rounding at pure rolling [1]
    """
    L_power = (beta_T * eta_0 / k) ** 0.64 * smooth_power(u_sum, 1.28, U_WIDTH)
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


@law(
    source="Castro2007",
    where="load sharing in mixed lubrication",
    valid="gear and twin-disc tests",
    ranges={"Lambda": (0.2, 2.0)},
    verified=False,
)
def fluid_share(Lambda: Num, *, Lambda_width: float = 1e-6, sharpness: float = 32.0) -> Num:
    r"""Share of the load that the film carries [1]: 0 without a film, 1 from :math:`\Lambda \approx 2` on.

    .. math:: f = 0.82 \Lambda^{0.28} \le 1

    Args:
        Lambda: specific film thickness [1]
        Lambda_width: rounding without a film [1]
        sharpness: of the bend where the film carries all; 2 % below 1 at the bend itself [1]
    """
    carried = 0.82 * smooth_abs(Lambda, Lambda_width) ** 0.28
    return (1 + carried**-sharpness) ** (-1 / sharpness) * smooth_sign(Lambda, Lambda_width) ** 2


def asperity_share(Lambda: Num) -> Num:
    """Share of the load that asperities carry [1], what `fluid_share` leaves at a specific film thickness [1]."""
    return 1 - fluid_share(Lambda)


@law(source="Castro2007", where="friction coefficient in mixed lubrication", verified=False)
def mixed_friction(Lambda: Num, mu_fluid: Num, mu_boundary: Num) -> Num:
    r"""Friction coefficient of a contact whose load film and asperities share [1].

    .. math:: \mu = f \mu_{fluid} + (1 - f) \mu_{boundary}

    Args:
        Lambda: specific film thickness [1]
        mu_fluid: friction coefficient of the full film [1]
        mu_boundary: friction coefficient of touching asperities [1]
    """
    f = fluid_share(Lambda)
    return f * mu_fluid + (1 - f) * mu_boundary


@law(
    source="Castro2007",
    where="load sharing in mixed lubrication, solved for the film",
    valid="f below 0.9",
    verified=False,
)
def film_of_share(f: Num) -> Num:
    r"""Specific film thickness at which the film carries a share of the load [1]: `fluid_share` inverted.

    .. math:: \Lambda = (f / 0.82)^{1/0.28}

    Args:
        f: share of the load that the film carries [1]
    """
    return (f / 0.82) ** (1 / 0.28)
