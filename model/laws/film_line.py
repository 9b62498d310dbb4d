"""Films of line contacts: regressions of solved contacts, in the numbers of their authors and from what a part knows.

The numbers of Moes are written with the sum of the speeds of the surfaces:
U = eta_0 u_sum / (E_eff R), M = F' / (E_eff R) U^(-1/2), L = alpha_p E_eff U^(1/4), film H = h/R U^(-1/2).
"""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import LINE_WIDTH, U_WIDTH, Num, smooth_abs

#: H M of a rigid cylinder in oil of constant viscosity, from the solution of Reynolds' equation: 4.896/2.
RIGID = 2.448


@law(
    source="Moes1992",
    where="central film of a line contact over four asymptotes",
    valid="isothermal, smooth, fully flooded; 8 % against solved contacts for M and L above 5, 25 % elsewhere",
    ranges={"M": (1.0, 1000.0), "L": (0.5, 25.0)},
    verified=False,
)
def moes_central(M: Num, L: Num, *, rigid: float = RIGID) -> Num:
    r"""Central film of a line contact [1], H = h/R U^(-1/2).

    .. math:: H = \left[(H_{RI}^{7/3} + H_{EI}^{7/3})^{3s/7} + (H_{RP}^{-7/2} + H_{EP}^{-7/2})^{-2s/7}\right]^{1/s},
        \quad s = \frac{7 + 8 e^{-2 H_{EI}/H_{RI}}}{5}

    with :math:`H_{RI} = 2.448/M,\ H_{RP} = 1.287 L^{2/3},\ H_{EI} = 2.621 M^{-1/5},\ H_{EP} = 1.311 M^{-1/8} L^{3/4}`.

    Args:
        M: load number [1]
        L: lubricant number [1]
        rigid: H M of rigid surfaces and constant viscosity; 3 in some prints, which no solved contact approaches [1]
    """
    H_RI, H_EI = rigid / M, 2.621 * M**-0.2
    H_RP, H_EP = 1.287 * L ** (2 / 3), 1.311 * M**-0.125 * L**0.75
    s = (7 + 8 * ca.exp(-2 * H_EI / H_RI)) / 5
    isoviscous = (H_RI ** (7 / 3) + H_EI ** (7 / 3)) ** (3 / 7)
    return (isoviscous**s + (H_RP**-3.5 + H_EP**-3.5) ** (-2 * s / 7)) ** (1 / s)


@law(
    source="DowsonHigginson1966",
    where="minimum film of a line contact",
    valid="piezoviscous and elastic: M above 5, L above 5",
    ranges={"U": (1e-13, 1e-10), "G": (1000.0, 8000.0), "W": (1e-5, 5e-4)},
    verified=False,
)
def dowson_higginson_minimum(U: Num, G: Num, W: Num) -> Num:
    r"""Minimum film of a line contact over its reduced radius [1].

    .. math:: h_{min}/R = 1.6\, G^{0.6} U^{0.7} W^{-0.13}

    Args:
        U: speed number with the mean speed, eta_0 u_m / (E_eff R) [1]
        G: material number, alpha_p E_eff [1]
        W: load number, F' / (E_eff R) [1]
    """
    return 1.6 * G**0.6 * U**0.7 * W**-0.13


def line_film_central(
    eta_0: Num, u_sum: Num, alpha_p: Num, F_n_l: Num, R: Num, E_eff: Num, *, u_width: float = U_WIDTH
) -> Num:
    """Central film of a line contact after Moes [m]; zero at standstill, to the fourth of a power below it.

    Args:
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
        u_width: rounding at standstill [m/s]
    """
    speed = smooth_abs(u_sum, u_width)
    root = ca.sqrt(eta_0 * speed / (E_eff * R))
    M, L = smooth_abs(F_n_l, LINE_WIDTH) / (E_eff * R * root), alpha_p * E_eff * ca.sqrt(root)
    return moes_central(M, L) * R * root * (u_sum / speed) ** 2


def line_film_minimum(eta_0: Num, u_sum: Num, alpha_p: Num, F_n_l: Num, R: Num, E_eff: Num) -> Num:
    """Minimum film of a line contact after Dowson and Higginson [m]; zero at standstill.

    Args:
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    speed = smooth_abs(u_sum, U_WIDTH)
    W = smooth_abs(F_n_l, LINE_WIDTH) / (E_eff * R)
    h = R * dowson_higginson_minimum(eta_0 * speed / (2 * E_eff * R), alpha_p * E_eff, W)
    return h * (u_sum / speed) ** 2
