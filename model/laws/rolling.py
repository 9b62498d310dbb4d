"""Friction torques of rolling bearings. Torques are magnitudes, never negative: the component gives them their sign.

The geometric variables G_rr and G_sl are catalogue variables: numbers for millimetres and newtons that make torques in
N.mm. They stay in those units; the laws that make torques of them return N.m.

Two things fall with rising viscosity and are meant to: the share of boundary friction (Stribeck), and with rising speed
the rolling torque of a bearing whose inlet heats up. Beyond the ranges of the formulas, thicker oil never drags less.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import F_WIDTH, Num, smooth_abs, smooth_cap, smooth_magnitude, smooth_max, smooth_min, smooth_power, to_rpm

#: Speed times mean diameter [m/s] at which makers' limiting speeds of ball bearings end: n d_m = 1e6 mm/min. The source
#: of the friction moments states no end of its own.
FASTEST = 1e6 * 1e-3 * math.pi / 30


@law(
    source="SKF2018",
    where="friction, inlet shear heating reduction factor",
    valid="n d_m up to 1e6 mm/min",
    ranges={"w * d_m": (-FASTEST, FASTEST)},
    regimes={"w * d_m": "faster than makers let ball bearings turn: their friction there is extrapolated"},
)
def shear_heating(w: Num, nu: Num, d_m: Num) -> Num:
    r"""Reduction of the rolling torque by heating of the oil in the inlet [1].

    .. math:: \phi_{ish} = \frac{1}{1 + 1.84 \cdot 10^{-9} (n d_m)^{1.28} \nu^{0.64}}

    Args:
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        d_m: mean diameter, (d + D)/2 [m]
    """
    n, nu_cSt, d_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d_m
    heating = 1.84e-9 * (n * d_mm) ** 1.28 * nu_cSt**0.64
    return 1 / (1 + smooth_cap(heating, 10.0))  # from 15 on nu^0.6 phi_ish would fall with nu


@law(source="SKF2018", where="friction, kinematic replenishment/starvation reduction factor", verified=False)
def starvation_exponent(w: Num, nu: Num, d: Num, D: Num, K_rs: Num, K_Z: Num) -> Num:
    r"""How fast oil is thrown out of the track, as the exponent of the starvation factor [1].

    .. math:: s = K_{rs} \nu n (d + D) \sqrt{\frac{K_Z}{2 (D - d)}}

    Args:
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        d: bore diameter [m]
        D: outside diameter [m]
        K_rs: starvation constant: 0 for a bath to the lowest roller or more, 3e-8 for less, 6e-8 for grease [1]
        K_Z: geometry constant of the bearing type [1]
    """
    n, nu_cSt, d_mm, D_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d, 1e3 * D
    # Dias2014 prints the exponent without the speed n, which its text lists
    return K_rs * nu_cSt * n * (d_mm + D_mm) * ca.sqrt(K_Z / (2 * (D_mm - d_mm)))


@law(
    source="SKF2018",
    where="friction, kinematic replenishment/starvation reduction factor",
    valid="as long as the rolling torque rises with viscosity, s below 0.6",
    ranges={"s": (0.0, 0.6)},
    verified=False,
)
def starvation(s: Num, phi_ish: Num) -> Num:
    r"""Reduction of the rolling torque by lack of oil in the track [1].

    .. math:: \phi_{rs} = e^{-\min(s, q)},\quad q = 0.64 \phi_{ish} - 0.04

    The source has no minimum and lets the torque of a cold bearing fall to zero; the rest of the torque rises at least
    as nu^q, so that with it the torque never falls.

    Args:
        s: exponent, see `starvation_exponent` [1]
        phi_ish: shear heating factor, above 1/16 [1]
    """
    return ca.exp(-smooth_cap(s, 0.64 * phi_ish - 0.04))


@law(source="SKF2018", where="friction, rolling frictional moment")
def rolling_torque(G_rr: Num, w: Num, nu: Num, phi: Num) -> Num:
    r"""Rolling friction torque [N.m].

    .. math:: M_{rr} = \phi G_{rr} (\nu n)^{0.6}

    Args:
        G_rr: rolling variable of the catalogue, in its units
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        phi: product of the shear heating and the starvation factor [1]
    """
    n, nu_cSt, N_m = to_rpm(smooth_abs(w)), 1e6 * nu, 1e-3
    return N_m * phi * G_rr * (nu_cSt * n) ** 0.6


def _contact_sine(F_a: Num, C_0: Num) -> Num:
    """Sine of the contact angle under axial load, at most 24.6 deg; Dias2014 prints it without that factor."""
    return ca.sin(math.radians(24.6) * smooth_cap(smooth_abs(F_a, F_WIDTH) / C_0, 1.0, 16.0) ** 0.24)


@law(
    source="SKF2018",
    where="friction, Table 1a, deep groove ball bearings",
    valid="F_a up to half of C_0",
    ranges={"F_a / C_0": (-0.5, 0.5)},
)
def dgb_rolling_variable(F_r: Num, F_a: Num, d_m: Num, R_1: Num, R_2: Num, C_0: Num) -> Num:
    r"""Rolling variable of a deep groove ball bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{1.96} \left(F_r + \frac{R_2 F_a}{\sin\alpha_F}\right)^{0.54},\quad
        \alpha_F = 24.6^\circ (F_a/C_0)^{0.24}

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: first rolling constant of the catalogue [1]
        R_2: second rolling constant of the catalogue [1]
        C_0: basic static load rating [N]
    """
    d_mm = 1e3 * d_m
    axial = R_2 * smooth_magnitude(F_a, F_WIDTH) / _contact_sine(F_a, C_0)
    return R_1 * d_mm**1.96 * smooth_power(smooth_magnitude(F_r, F_WIDTH) + axial, 0.54, F_WIDTH)


@law(
    source="SKF2018",
    where="friction, Table 1a, deep groove ball bearings",
    valid="F_a up to half of C_0; between the formulas with and without axial load about F_a = 0.22 F_r",
    ranges={"F_a / C_0": (-0.5, 0.5)},
)
def dgb_sliding_variable(F_r: Num, F_a: Num, d_m: Num, S_1: Num, S_2: Num, C_0: Num) -> Num:
    r"""Sliding variable of a deep groove ball bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{-0.26 + 0.115 \chi} \left(F_r^5 + \frac{S_2 d_m^{1.5} F_a^4}{\sin\alpha_F}\right)^{1/3},
        \quad \chi = \frac{F_a^4}{F_a^4 + (0.22 F_r)^4}

    The catalogue has an exponent of -0.26 at F_a = 0 and of -0.145 elsewhere, a jump by half. Here it goes from one to
    the other where ISO 281 begins to count an axial load, and is the catalogue's at both ends.

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: first sliding constant of the catalogue [1]
        S_2: second sliding constant of the catalogue [1]
        C_0: basic static load rating [N]
    """
    d_mm = 1e3 * d_m
    axial = S_2 * d_mm**1.5 * F_a**4 / _contact_sine(F_a, C_0)
    share = F_a**4 / (F_a**4 + (0.22 * F_r) ** 4 + F_WIDTH**4)
    return S_1 * d_mm ** (0.115 * share - 0.26) * smooth_power(smooth_power(F_r, 5, F_WIDTH) + axial, 1 / 3, F_WIDTH**5)


@law(source="SKF2018", where="friction, Table 1a, tapered roller bearings")
def trb_rolling_variable(F_r: Num, F_a: Num, d_m: Num, R_1: Num, R_2: Num, Y: Num) -> Num:
    r"""Rolling variable of a tapered roller bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{2.38} (F_r + R_2 Y F_a)^{0.31}

    Args:
        F_r: radial load [N]
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: first rolling constant of the catalogue [1]
        R_2: second rolling constant of the catalogue [1]
        Y: axial load factor of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    load = smooth_magnitude(F_r, F_WIDTH) + R_2 * Y * smooth_magnitude(F_a, F_WIDTH)
    return R_1 * d_mm**2.38 * smooth_power(load, 0.31, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1a, tapered roller bearings")
def trb_sliding_variable(F_r: Num, F_a: Num, d_m: Num, S_1: Num, S_2: Num, Y: Num) -> Num:
    r"""Sliding variable of a tapered roller bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{0.82} (F_r + S_2 Y F_a)

    Args:
        F_r: radial load [N]
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: first sliding constant of the catalogue [1]
        S_2: second sliding constant of the catalogue [1]
        Y: axial load factor of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return S_1 * d_mm**0.82 * (smooth_magnitude(F_r, F_WIDTH) + S_2 * Y * smooth_magnitude(F_a, F_WIDTH))


@law(source="SKF2018", where="friction, weighting factor for the sliding friction coefficient")
def boundary_share(w: Num, nu: Num, d_m: Num) -> Num:
    r"""Share of boundary friction in the sliding friction [1].

    .. math:: \phi_{bl} = \exp(-2.6 \cdot 10^{-8} (n \nu)^{1.4} d_m)

    Args:
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        d_m: mean diameter, (d + D)/2 [m]
    """
    n, nu_cSt, d_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d_m
    return ca.exp(-2.6e-8 * (n * nu_cSt) ** 1.4 * d_mm)


@law(source="SKF2018", where="friction, sliding friction coefficient")
def sliding_friction(phi_bl: Num, mu_bl: Num, mu_EHL: Num) -> Num:
    r"""Sliding friction coefficient between the boundary and the full film [1].

    .. math:: \mu_{sl} = \phi_{bl} \mu_{bl} + (1 - \phi_{bl}) \mu_{EHL}

    Args:
        phi_bl: share of boundary friction [1]
        mu_bl: sliding friction of the boundary film [1]
        mu_EHL: sliding friction of the full film [1]
    """
    return phi_bl * mu_bl + (1 - phi_bl) * mu_EHL


@law(source="SKF2018", where="friction, sliding frictional moment")
def sliding_torque(G_sl: Num, mu_sl: Num) -> Num:
    r"""Sliding friction torque [N.m].

    .. math:: M_{sl} = G_{sl} \mu_{sl}

    Args:
        G_sl: sliding variable of the catalogue, in its units
        mu_sl: sliding friction coefficient [1]
    """
    return 1e-3 * G_sl * mu_sl


@law(
    source="SKF2018",
    where="friction, drag losses, diagram of V_M",
    valid="read off a diagram, 25 %",
    ranges={"level": (0.0, 1.2)},
    verified=False,
)
def drag_loss_factor(level: Num, *, roller: bool = False) -> Num:
    r"""Drag loss factor of an oil level [1], a smooth curve through the diagram.

    .. math:: V_M = s \frac{x^3}{x^2 + x_0^2},\quad x = H/d_m

    Args:
        level: oil level above the lowest point of the outer raceway over mean diameter, up to 1.2 [1]
        roller: whether the bearing has rollers, not balls
    """
    s, x_0 = (1.35e-3, 0.065) if roller else (1.1e-3, 0.08)
    return s * level**3 / (level**2 + x_0**2)


def _splash(n: Num, nu_cSt: Num, d_mm: Num, D_mm: Num, H_mm: Num, K_Z: Num) -> Num:
    """Part of the drag moment [N.mm] that depends on the viscosity, common to ball and roller bearings."""
    d_m, rounding = 0.5 * (d_mm + D_mm), 1e-3  # rounded where it is dry, half and fully submerged
    cosine = smooth_min(smooth_max(1 - H_mm / (0.6 * d_m), -1.0, rounding), 1.0, rounding)  # of half the wetted angle
    t = 2 * ca.acos(cosine)
    f_t = ca.sqrt(1 - smooth_max(cosine, 0.0, rounding) ** 2)  # sin(t/2) below half, 1 above
    R_s = 0.36 * d_m**2 * (t - ca.sin(t)) * 0.05 * K_Z * (D_mm + d_mm) / (D_mm - d_mm)
    nu_power = nu_cSt * smooth_cap(nu_cSt, 500.0) ** 0.379  # nu^1.379 in the range; creeping flow, nu, beyond it
    return 1.093e-7 * n**2 * d_m**3 * (n * d_m**2 * f_t) ** -1.379 * nu_power * R_s


@law(
    source="SKF2018",
    where="friction, drag losses, ball bearings",
    valid="oil bath, horizontal shaft, inner ring turns; 250 mm2/s where more than half is submerged",
    ranges={"nu": (0.0, 500e-6)},
    verified=False,
)
def drag_torque_ball(w: Num, nu: Num, d: Num, D: Num, H: Num, V_M: Num, K_Z: Num, i_rw: Num = 1.0) -> Num:
    r"""Drag torque of a ball bearing in an oil bath [N.m].

    .. math:: M_{drag} = 0.4 V_M K_{ball} d_m^5 n^2
        + 1.093 \cdot 10^{-7} n^2 d_m^3 \left(\frac{n d_m^2 f_t}{\nu}\right)^{-1.379} R_s,\quad
        K_{ball} = 10^{-12} i_{rw} K_Z \frac{d + D}{D - d}

    Args:
        w: speed of the inner ring, either direction [rad/s]
        nu: kinematic viscosity at the oil's temperature [m2/s]
        d: bore diameter [m]
        D: outside diameter [m]
        H: oil level above the lowest point of the outer raceway [m]
        V_M: drag loss factor of that level, see `drag_loss_factor` [1]
        K_Z: geometry constant of the bearing type [1]
        i_rw: number of rows of balls, which what they displace grows with [1]
    """
    n, nu_cSt, d_mm, D_mm, H_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d, 1e3 * D, 1e3 * H
    d_m = 0.5 * (d_mm + D_mm)
    K_ball = 1e-12 * i_rw * K_Z * (d_mm + D_mm) / (D_mm - d_mm)
    displaced = 0.4 * V_M * K_ball * d_m**5 * n**2
    return 1e-3 * (displaced + _splash(n, nu_cSt, d_mm, D_mm, H_mm, K_Z))


@law(
    source="SKF2018",
    where="friction, drag losses, roller bearings",
    valid="oil bath, horizontal shaft, inner ring turns; 250 mm2/s where more than half is submerged",
    ranges={"nu": (0.0, 500e-6)},
    verified=False,
)
def drag_torque_roller(w: Num, nu: Num, d: Num, D: Num, B: Num, H: Num, V_M: Num, K_Z: Num, K_L: Num) -> Num:
    r"""Drag torque of a roller bearing in an oil bath [N.m].

    .. math:: M_{drag} = 4 V_M K_{roll} C_W B d_m^4 n^2
        + 1.093 \cdot 10^{-7} n^2 d_m^3 \left(\frac{n d_m^2 f_t}{\nu}\right)^{-1.379} R_s,\quad
        K_{roll} = 10^{-12} K_L K_Z \frac{d + D}{D - d}

    .. math:: C_W = 2.789 \cdot 10^{-10} l_D^3 - 2.786 \cdot 10^{-4} l_D^2 + 0.0195 l_D + 0.6439,\quad
        l_D = 5 K_L B / d_m

    Args:
        w: speed of the inner ring, either direction [rad/s]
        nu: kinematic viscosity at the oil's temperature [m2/s]
        d: bore diameter [m]
        D: outside diameter [m]
        B: width of the bearing, of a tapered one over both rings [m]
        H: oil level above the lowest point of the outer raceway [m]
        V_M: drag loss factor of that level, see `drag_loss_factor` [1]
        K_Z: geometry constant of the bearing type [1]
        K_L: geometry constant of the roller bearing type [1]
    """
    n, nu_cSt, d_mm, D_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d, 1e3 * D
    B_mm, H_mm, d_m = 1e3 * B, 1e3 * H, 0.5 * (d_mm + D_mm)
    l_D = 5 * K_L * B_mm / d_m
    C_W = 2.789e-10 * l_D**3 - 2.786e-4 * l_D**2 + 0.0195 * l_D + 0.6439
    K_roll = 1e-12 * K_L * K_Z * (d_mm + D_mm) / (D_mm - d_mm)
    displaced = 4 * V_M * K_roll * C_W * B_mm * d_m**4 * n**2
    return 1e-3 * (displaced + _splash(n, nu_cSt, d_mm, D_mm, H_mm, K_Z))


@law(source="Palmgren1959", where="load-independent moment", valid="oil bath or grease")
def needle_torque_viscous(w: Num, nu: Num, d_m: Num, f_0: Num, *, width: float = 0.5) -> Num:
    r"""Load-independent friction torque of a needle bearing [N.m].

    .. math:: T_0 = 10^{-10} f_0 d_m^3 \max\left(160, (\nu n)^{2/3}\right)

    The source switches at nu n = 2000 with a jump of 0.8 %; the larger of its two branches has none.

    Args:
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        d_m: mean diameter [m]
        f_0: factor of bearing type and lubrication [1]
        width: rounding where the two branches meet, of 160 [1]
    """
    n, nu_cSt, d_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d_m
    return 1e-10 * f_0 * d_mm**3 * smooth_max(160.0, (nu_cSt * n) ** (2 / 3), width)


@law(source="Palmgren1959", where="load-dependent moment")
def needle_torque_load(P_1: Num, d_m: Num, f_1: Num) -> Num:
    r"""Load-dependent friction torque of a needle bearing [N.m].

    .. math:: T_1 = f_1 P_1 d_m

    Args:
        P_1: radial load [N]
        d_m: mean diameter [m]
        f_1: factor of bearing type, 0.0002 for needle roller and cage assemblies [1]
    """
    return f_1 * smooth_magnitude(P_1, F_WIDTH) * d_m
