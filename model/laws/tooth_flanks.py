"""What flanks of teeth feel along their path of contact: share of the load, flash temperature, scuffing limits, films.

No print of the standards was at hand. Two public programs agree on most forms, and a report of KISSsoft prints results
of all of them for one gear pair; what stands on one witness alone is said at the law.
"""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .film_line import line_film_minimum
from .smooth import LINE_WIDTH, V_WIDTH, Num, smooth_abs, smooth_magnitude

#: Factor of Blok's flash temperature under a Hertzian pressure, root of 2/pi [1].
HERTZIAN = 0.7978846
#: The same as ISO/TS 6336-20 and -21 have it, 1.11 over root of 2 [1].
ROUNDED = 0.7848885
#: Lowest and highest load of a pair among two that carry, of a spur gear without relief; one alone carries all [1].
TWO_PAIRS = (1 / 3, 2 / 3)
#: How much more than the mean the ends of helical contact lines carry from an overlap ratio of 1 on [1].
BUTTRESS = 0.3


@law(
    source="ISO6336-20",
    where="load sharing factor without profile modification, quality grade 7 or finer, with buttressing",
    valid="transverse contact ratio of 1 to 2",
)
def load_share(g: Num, path: Num, p_et: Num, eps_beta: Num, beta_b: Num, rho_C: Num) -> Num:
    r"""Share of the mesh force on the pair that touches at a point of the path of contact [1].

    .. math:: X = X_{but} \cdot \begin{cases} 1/\varepsilon_\alpha & \varepsilon_\alpha + \varepsilon_\beta > 2 \\
        1/3 + \frac{g}{3 (g_\alpha - p_{et})} & \text{two pairs} \\ 1 & \text{one pair} \end{cases}

    Args:
        g: distance from the begin of contact [m]
        path: length of the path of contact [m]
        p_et: transverse base pitch [m]
        eps_beta: overlap ratio [1]
        beta_b: helix angle at the base cylinder [rad]
        rho_C: radius of curvature of the first gear at the pitch point [m]
    """
    end, double = ca.fmin(g, path - g), path - p_et
    low, high = TWO_PAIRS
    two, wide = end < double, path / p_et + eps_beta > 2
    by_pairs = two * (low + (high - low) * end / double) + (1 - two)
    mean = wide * p_et / path + (1 - wide) * by_pairs
    width = 0.2 * ca.sin(beta_b) * rho_C + 1e-9 * path  # no corner without a helix
    return mean * (1 + BUTTRESS * ca.fmin(eps_beta, 1.0) * ca.fmax(0.0, 1 - end / width))


def _load_over_speed(line_load: Num, v_sum: Num, R: Num) -> Num:
    """Load over speed and radius as both friction formulas have it [N/mm over m/s mm]."""
    return smooth_abs(line_load, LINE_WIDTH) / (smooth_abs(v_sum, V_WIDTH) * R) * 1e-6


@law(
    source="ISO6336-20",
    where="mean coefficient of friction, method C: as public programs quote it; KISSsoft prints 12 % less",
    valid="pitch line up to 50 m/s",
    verified=False,
)
def friction_flash(line_load: Num, v_sum: Num, R: Num, eta_oil: Num, Ra: Num, X_L: Num) -> Num:
    r"""Mean friction coefficient of the flash temperature method [1].

    .. math:: \mu = 0.060 \left(\frac{w}{v_\Sigma \rho}\right)^{0.2} \eta^{-0.05} R_a^{0.25} X_L

    Args:
        line_load: tangential force per face width [N/m]
        v_sum: sum of the rolling speeds at the pitch point, either sign [m/s]
        R: reduced radius in the transverse plane at the pitch point [m]
        eta_oil: dynamic viscosity at the oil's temperature [Pa.s]
        Ra: mean roughness of the two flanks [m]
        X_L: lubricant factor, 1 for mineral oils [1]
    """
    load = _load_over_speed(line_load, v_sum, R)
    return 0.060 * load**0.2 * (1e3 * eta_oil) ** -0.05 * (1e6 * Ra) ** 0.25 * X_L


@law(source="ISO6336-21", where="mean coefficient of friction; ISO/TR 15144-1 has the same", valid="1 to 50 m/s")
def friction_integral(line_load: Num, v_sum: Num, R: Num, eta_oil: Num, Ra: Num, X_L: Num) -> Num:
    r"""Mean friction coefficient of the integral temperature method and of the micropitting method [1].

    .. math:: \mu = 0.045 \left(\frac{w}{v_\Sigma \rho}\right)^{0.2} \eta^{-0.05}\,
        2.2 \left(\frac{R_a}{\rho}\right)^{0.25} X_L

    Args:
        line_load: tangential force per face width, with the factor of helical gears [N/m]
        v_sum: sum of the rolling speeds at the pitch point, either sign [m/s]
        R: reduced radius at the pitch point, normal to the teeth [m]
        eta_oil: dynamic viscosity at the oil's temperature [Pa.s]
        Ra: mean roughness of the two flanks [m]
        X_L: lubricant factor, 1 for mineral oils [1]
    """
    load = _load_over_speed(line_load, v_sum, R)
    return 0.045 * load**0.2 * (1e3 * eta_oil) ** -0.05 * 2.2 * (1e3 * Ra / R) ** 0.25 * X_L


@law(source="ISO6336-21", where="helical load factor", valid="total contact ratio of 2 to 3.5")
def helical_load_factor(eps_gamma: Num) -> Num:
    r"""Factor on the load of helical gears in the friction and the integral temperature [1].

    .. math:: K_{B\gamma} = 1 + 0.2 \sqrt{(\varepsilon_\gamma - 2)(5 - \varepsilon_\gamma)}

    Args:
        eps_gamma: total contact ratio; held at 2 and 3.5 [1]
    """
    held = ca.fmin(ca.fmax(eps_gamma, 2.0), 3.5)
    return 1 + 0.2 * ca.sqrt((held - 2) * (5 - held))


@law(source="Blok1937", where="flash temperature of a line contact, Hertzian heat source, Peclet number above 5")
def flash_temperature(
    mu: Num, w_l: Num, R: Num, E_eff: Num, v_1: Num, v_2: Num, B_M: Num, *, factor: float = HERTZIAN
) -> Num:
    r"""Rise of the contact temperature above that of the bodies, both of one material [K].

    .. math:: \Theta_{fl} = \sqrt{\frac{2}{\pi}} \frac{\mu w}{B_M \sqrt{b_H}}
        \left|\sqrt{v_1} - \sqrt{v_2}\right|,\quad b_H = \sqrt{\frac{8 w R}{\pi E'}}

    Args:
        mu: friction coefficient [1]
        w_l: load per length, not negative [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E' = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
        v_1: speed of the first surface through the contact, not negative [m/s]
        v_2: speed of the second one [m/s]
        B_M: thermal contact coefficient, root of conductivity, density and specific heat [J/(m2.K.s0.5)]
        factor: root of 2/pi; the standards round it to 1.11 over root of 2 [1]
    """
    load = smooth_abs(w_l, LINE_WIDTH)
    b_H = ca.sqrt(8 * load * R / (ca.pi * E_eff))
    roots = ca.sqrt(smooth_abs(v_1, V_WIDTH)) + ca.sqrt(smooth_abs(v_2, V_WIDTH))
    return factor * mu * load / (B_M * ca.sqrt(b_H)) * smooth_magnitude(v_1 - v_2, V_WIDTH) / roots


@law(source="ISO6336-20", where="scuffing temperature by the FZG test A/8,3/90", valid="load stages up to 14")
def scuffing_temperature(stage: Num, X_W: Num, X_L: Num, eta_oil: Num) -> Num:
    r"""Contact temperature at which an oil lets teeth scuff, in degrees Celsius [degC].

    .. math:: \Theta_S = 80 + (0.85 + 1.4 X_W) X_L \eta^{-0.05} S_{FZG}^2

    Args:
        stage: failure load stage of the oil in the FZG test A/8,3/90 of ISO 14635-1 [1]
        X_W: structural factor: 1 for case-hardened steel, 1.5 nitrided [1]
        X_L: lubricant factor, 1 for mineral oils [1]
        eta_oil: dynamic viscosity at the oil's temperature [Pa.s]
    """
    return 80 + (0.85 + 1.4 * X_W) * X_L * (1e3 * eta_oil) ** -0.05 * stage**2


@law(source="ISO6336-21", where="scuffing integral temperature by the FZG test A/8,3/90")
def integral_scuffing_temperature(tau_test: Num, X_W: Num, X_L: Num, nu_40: Num) -> Num:
    r"""Integral temperature at which an oil lets teeth scuff, in degrees Celsius [degC].

    .. math:: \Theta_{intS} = 80 + X_L T_1 \left(0.23 + 1.5 X_W \cdot 0.2 (100/\nu_{40})^{0.02}\right)

    Args:
        tau_test: torque on the test pinion at the failure load stage, 3.726 N.m times its square [N.m]
        X_W: relative structural factor: 1 for case-hardened steel, 1.5 nitrided [1]
        X_L: lubricant factor, 1 for mineral oils [1]
        nu_40: kinematic viscosity at 40 degC [m2/s]
    """
    return 80 + X_L * tau_test * (0.23 + 1.5 * X_W * 0.2 * (1e-4 / nu_40) ** 0.02)


@law(source="ISO6336-21", where="contact ratio factor", valid="transverse contact ratio of 1 to 2")
def contact_ratio_factor(eps_1: Num, eps_2: Num) -> Num:
    r"""Mean flash temperature over that at the tip of the first gear under full load [1].

    .. math:: X_\varepsilon = \frac{0.7 (\varepsilon_1^2 + \varepsilon_2^2) - 0.22 \varepsilon_\alpha + 0.52
        - 0.6 \varepsilon_1 \varepsilon_2}{2 \varepsilon_\alpha \varepsilon_1}

    and where one of the two reaches 1, which meets it there, for that one as a and the other as b

    .. math:: X_\varepsilon = \frac{0.18 \varepsilon_a^2 + 0.7 \varepsilon_b^2 + 0.82 \varepsilon_a
        - 0.52 \varepsilon_b - 0.3 \varepsilon_a \varepsilon_b}{2 \varepsilon_\alpha \varepsilon_1}

    Args:
        eps_1: addendum contact ratio of the first gear [1]
        eps_2: addendum contact ratio of the second gear [1]
    """
    eps, a, b = eps_1 + eps_2, ca.fmax(eps_1, eps_2), ca.fmin(eps_1, eps_2)
    short = 0.7 * (a**2 + b**2) - 0.22 * eps + 0.52 - 0.6 * a * b
    long = 0.18 * a**2 + 0.7 * b**2 + 0.82 * a - 0.52 * b - 0.3 * a * b
    above = a > 1
    return (above * long + (1 - above) * short) / (2 * eps * eps_1)


@law(source="ISO6336-21", where="tip relief factor, quality grade 6 or finer")
def tip_relief_factor(eps_max: Num, share: Num) -> Num:
    r"""How much tip relief and running in lower the integral temperature [1].

    .. math:: X_{Ca} = 1 + (0.06 + 0.18 s) \varepsilon + (0.02 + 0.69 s) \varepsilon^2

    Args:
        eps_max: larger addendum contact ratio [1]
        share: tip relief over what would suit, 0 to 1 [1]
    """
    return 1 + (0.06 + 0.18 * share) * eps_max + (0.02 + 0.69 * share) * eps_max**2


@law(source="ISO15144-1", where="bulk temperature, method B, without tip relief")
def bulk_rise(P: Num, mu: Num, H_v: Num, a_w: Num, b: Num, X_S: Num) -> Num:
    r"""Rise of the teeth above the oil [K].

    .. math:: \Theta_M - \Theta_{oil} = 7400 \left(\frac{P \mu H_v}{a b}\right)^{0.72} \frac{X_S}{1.2}

    Args:
        P: power through the mesh, not negative [W]
        mu: mean friction coefficient [1]
        H_v: tooth loss factor [1]
        a_w: centre distance, negative for an internal pair [m]
        b: face width [m]
        X_S: 1 dip lubrication, 1.2 injected [1]
    """
    P_kW, area_mm2 = 1e-3 * smooth_abs(P, 1.0), 1e6 * ca.fabs(a_w) * b
    return 7400 * (P_kW * mu * H_v / area_mm2) ** 0.72 * X_S / 1.2


@law(
    source="ISO15144-1",
    where="lubricant film thickness with the local sliding parameter",
    valid="pitch line above 2 m/s",
)
def sliding_film(eta_0: Num, u_sum: Num, alpha_p: Num, F_n_l: Num, R: Num, E_eff: Num, eta_B: Num, alpha_B: Num) -> Num:
    r"""Film between flanks that the flash temperature heats [m].

    .. math:: h = 1.6 R\, G^{0.6} U^{0.7} W^{-0.13} S^{0.22},\quad S = \frac{\alpha_B \eta_B}{\alpha_M \eta_M}

    Args:
        eta_0: dynamic viscosity at the temperature of the teeth [Pa.s]
        u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
        alpha_p: pressure-viscosity coefficient at the temperature of the teeth [1/Pa]
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
        eta_B: dynamic viscosity at the contact temperature [Pa.s]
        alpha_B: pressure-viscosity coefficient at the contact temperature [1/Pa]
    """
    S = alpha_B * eta_B / (alpha_p * eta_0)
    return line_film_minimum(eta_0, u_sum, alpha_p, F_n_l, R, E_eff) * S**0.22
