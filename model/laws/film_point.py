"""Films of elliptical contacts: regressions of solved contacts, in the numbers of their authors and from a part's."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from ..sources import law
from .smooth import U_WIDTH, Num, smooth_abs

#: Width of the rounding of a force [N]: small contacts carry little.
POINT_WIDTH = 0.1
#: Range of the 34 solved contacts behind the formulas of Hamrock and Dowson.
SOLVED = {"U": (8e-13, 5.1e-11), "G": (2300.0, 6800.0), "W": (1.1e-7, 1.3e-6), "k": (1.0, 8.0)}


@law(
    source="BreweHamrock1977",
    where="ellipticity",
    valid="R_y above R_x",
    ranges={"R_y / R_x": (1.0, 100.0)},
    verified=False,
)
def ellipticity(R_x: Num, R_y: Num) -> Num:
    r"""Ratio of the axes of the contact ellipse, across over along the direction of rolling [1].

    .. math:: k = 1.0339 (R_y/R_x)^{0.636}

    Args:
        R_x: reduced radius along the direction of rolling [m]
        R_y: reduced radius across it [m]
    """
    return 1.0339 * (R_y / R_x) ** 0.636


@law(
    source="HamrockDowson1977",
    where="part III, central film",
    valid="fully flooded, isothermal, smooth; rolling along the minor axis",
    ranges=SOLVED,
    verified=False,
)
def hamrock_dowson_central(U: Num, G: Num, W: Num, k: Num) -> Num:
    r"""Central film of an elliptical contact over R_x [1].

    .. math:: h_c/R_x = 2.69\, U^{0.67} G^{0.53} W^{-0.067} (1 - 0.61 e^{-0.73 k})

    Args:
        U: speed number with the mean speed, eta_0 u_m / (E_eff R_x) [1]
        G: material number, alpha_p E_eff [1]
        W: load number, F / (E_eff R_x^2) [1]
        k: ellipticity, axis across over axis along the direction of rolling [1]
    """
    return 2.69 * U**0.67 * G**0.53 * W**-0.067 * (1 - 0.61 * ca.exp(-0.73 * k))


@law(
    source="HamrockDowson1977",
    where="part III, minimum film",
    valid="fully flooded, isothermal, smooth; rolling along the minor axis",
    ranges=SOLVED,
    verified=False,
)
def hamrock_dowson_minimum(U: Num, G: Num, W: Num, k: Num) -> Num:
    r"""Minimum film of an elliptical contact over R_x [1].

    .. math:: h_{min}/R_x = 3.63\, U^{0.68} G^{0.49} W^{-0.073} (1 - e^{-0.68 k})

    Args:
        U: speed number with the mean speed, eta_0 u_m / (E_eff R_x) [1]
        G: material number, alpha_p E_eff [1]
        W: load number, F / (E_eff R_x^2) [1]
        k: ellipticity, axis across over axis along the direction of rolling [1]
    """
    return 3.63 * U**0.68 * G**0.49 * W**-0.073 * (1 - ca.exp(-0.68 * k))


@law(
    source="Nijenbanning1994",
    where="central film of an elliptical contact over five asymptotes",
    valid="isothermal, smooth, fully flooded; constants not compared with the paper",
    ranges={"M": (1.0, 1000.0), "L": (0.5, 25.0)},
    verified=False,
)
def nijenbanning_central(M: Num, L: Num, D: Num) -> Num:
    r"""Central film of an elliptical contact [1], H = h/R_x U^(-1/2), with the sum of the speeds.

    .. math:: H = \left\{\left[H_{RI}^{3/2} + (H_{EI}^{-4} + H_{00}^{-4})^{-3/8}\right]^{2s/3}
        + (H_{RP}^{-8} + H_{EP}^{-8})^{-s/8}\right\}^{1/s},\quad s = 1.5 (1 + e^{-1.2 H_{EI}/H_{RI}})

    Solved circular contacts agree within 5 % from M = 20 on and at L of 10 or more from M = 10 on; at M = 5 the formula
    is 36 % (L = 2.5) to 31 % (L = 5) above them. While H_EI is below about twice H_RI, solved films rise with load;
    the formula is flat there, within 0.2 % up at L = 25.

    Args:
        M: load number, F / (E_eff R_x^2) U^(-3/4) [1]
        L: lubricant number, alpha_p E_eff U^(1/4) [1]
        D: R_x / R_y, 1 for a circular contact [1]
    """
    H_RI, H_EI, stiff, s = nijenbanning_asymptotes(M, L, D)
    return ((H_RI**1.5 + H_EI**1.5) ** (2 * s / 3) + stiff**s) ** (1 / s)


@law(
    source="Nijenbanning1994",
    where="its asymptotes; their blend is this project's own",
    valid="isothermal, smooth, fully flooded; blend fitted to 40 solved circular contacts, M 5 to 1000, L 2.5 to 20",
    ranges={"M": (5.0, 1000.0), "L": (2.5, 25.0)},
    verified=False,
)
def solved_central(M: Num, L: Num, D: Num) -> Num:
    r"""Central film of an elliptical contact as solved ones have it [1], H = h/R_x U^(-1/2), by the sum of speeds.

    .. math:: H = \left\{\left(H_{RI}^8 + \left(H_{EI}^{-4} + H_{00}^{-4}\right)^{-2}\right)^{s/8}
        + (H_{RP}^{-8} + H_{EP}^{-8})^{-s/8}\right\}^{1/s},\quad s = 1.5 (1 + 1.8 e^{-H_{EI}/H_{RI}})

    It ends in the same asymptotes as `nijenbanning_central`, and is within 7 % (rms 3 %) of the solved contacts, where
    that is up to 36 % above them at M = 5. From M = 50 on the two are the same within 0.1 %. From M = 5 to about 15 the
    film rises with load, as solved films do: rigid surfaces alone no longer carry, and elastic ones not yet.

    Args:
        M: load number, F / (E_eff R_x^2) U^(-3/4) [1]
        L: lubricant number, alpha_p E_eff U^(1/4) [1]
        D: R_x / R_y, 1 for a circular contact [1]
    """
    H_RI, H_EI, stiff, _ = nijenbanning_asymptotes(M, L, D)
    s = 1.5 * (1 + 1.8 * ca.exp(-H_EI / H_RI))
    return ((H_RI**8 + H_EI**8) ** (s / 8) + stiff**s) ** (1 / s)


def nijenbanning_asymptotes(M: Num, L: Num, D: Num) -> tuple[Num, Num, Num, Num]:
    """Films [1] of rigid and of elastic surfaces in oil of constant viscosity and of piezoviscous oil, and exponent s.

    The elastic film ends at H_00 = 1.8/D, the piezoviscous one joins those of rigid and elastic surfaces.

    Args:
        M: load number, F / (E_eff R_x^2) U^(-3/4) [1]
        L: lubricant number, alpha_p E_eff U^(1/4) [1]
        D: R_x / R_y, 1 for a circular contact [1]
    """
    shape = 1 + 0.006 * ca.log(D) + 0.63 * D ** (4 / 7)
    H_RI = 145 * (1 + 0.796 * D ** (14 / 15)) ** (-15 / 7) / (D * M**2)
    H_EI = 3.18 * shape ** (-14 / 25) * D ** (-1 / 15) * M ** (-2 / 15)
    H_RP = 1.29 * (1 + 0.691 * D) ** (-2 / 3) * L ** (2 / 3)
    H_EP = 1.48 * shape ** (-7 / 20) * D ** (-1 / 24) * M ** (-1 / 12) * L**0.75
    s = 1.5 * (1 + ca.exp(-1.2 * H_EI / H_RI))
    return H_RI, (H_EI**-4 + (1.8 / D) ** -4) ** -0.25, (H_RP**-8 + H_EP**-8) ** -0.125, s


def point_film_central(
    eta_0: Num,
    u_sum: Num,
    alpha_p: Num,
    F_n: Num,
    R_x: Num,
    R_y: Num,
    E_eff: Num,
    *,
    blend: Callable[[Num, Num, Num], Num] = solved_central,
) -> Num:
    """Central film of an elliptical contact by asymptotes of Nijenbanning, Venner and Moes [m]; zero at standstill.

    Args:
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
        F_n: normal force, either sign [N]
        R_x: reduced radius along the direction of rolling [m]
        R_y: reduced radius across it [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
        blend: of the asymptotes: as contacts are solved, or `nijenbanning_central` as printed
    """
    speed = smooth_abs(u_sum, U_WIDTH)
    U = eta_0 * speed / (E_eff * R_x)
    M, L = smooth_abs(F_n, POINT_WIDTH) / (E_eff * R_x**2 * U**0.75), alpha_p * E_eff * U**0.25
    return blend(M, L, R_x / R_y) * R_x * ca.sqrt(U) * (u_sum / speed) ** 2


def point_films(eta_0: Num, u_sum: Num, alpha_p: Num, F_n: Num, R_x: Num, R_y: Num, E_eff: Num) -> tuple[Num, Num]:
    """Central and minimum film of an elliptical contact after Hamrock and Dowson [m]; zero at standstill.

    Args:
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
        F_n: normal force, either sign [N]
        R_x: reduced radius along the direction of rolling [m]
        R_y: reduced radius across it [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    speed, k = smooth_abs(u_sum, U_WIDTH), ellipticity(R_x, R_y)
    numbers = eta_0 * speed / (2 * E_eff * R_x), alpha_p * E_eff, smooth_abs(F_n, POINT_WIDTH) / (E_eff * R_x**2)
    moving = R_x * (u_sum / speed) ** 2
    return moving * hamrock_dowson_central(*numbers, k), moving * hamrock_dowson_minimum(*numbers, k)
