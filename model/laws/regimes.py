"""Which of four regimes a line contact is in: whether it deforms, and whether pressure thickens its oil."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .film_line import RIGID
from .smooth import LINE_WIDTH, SLOW_WIDTH, Num, smooth_abs

#: What is said of a contact that is in any but the elastohydrodynamic regime.
_NOT_HERE = "(g_V = {g_V}, g_E = {g_E}): the elastohydrodynamic formula does not hold"


@law(source="Johnson1970", where="viscosity parameter", verified=False)
def viscosity_parameter(alpha_p: Num, eta_0: Num, u_m: Num, F_n_l: Num, R: Num) -> Num:
    r"""How much pressure thickens the oil of a line contact [1].

    .. math:: g_V = \sqrt{\frac{\alpha_p^2 F'^3}{\eta_0 u_m R^2}}

    Args:
        alpha_p: pressure-viscosity coefficient [1/Pa]
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_m: mean speed of the surfaces, either sign [m/s]
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
    """
    return alpha_p * smooth_abs(F_n_l, LINE_WIDTH) ** 1.5 / (R * ca.sqrt(eta_0 * smooth_abs(u_m, SLOW_WIDTH)))


@law(source="Johnson1970", where="elasticity parameter", verified=False)
def elasticity_parameter(eta_0: Num, u_m: Num, F_n_l: Num, R: Num, E_eff: Num) -> Num:
    r"""How much a line contact deforms [1].

    .. math:: g_E = \sqrt{\frac{F'^2}{\eta_0 u_m E' R}}

    Args:
        eta_0: dynamic viscosity at the inlet [Pa.s]
        u_m: mean speed of the surfaces, either sign [m/s]
        F_n_l: normal load per length, either sign [N/m]
        R: reduced radius [m]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
    """
    return smooth_abs(F_n_l, LINE_WIDTH) / ca.sqrt(eta_0 * smooth_abs(u_m, SLOW_WIDTH) * E_eff * R)


@law(source="Moes1992", where="asymptotes of the four regimes", verified=False)
def regime_films(g_V: Num, g_E: Num) -> tuple[Num, Num, Num, Num]:
    r"""Film numbers h F'/(eta_0 u_sum R) of the four regimes [1]: neither, piezoviscous, elastic, and both.

    .. math:: \hat h_{RI} = 2.448,\quad \hat h_{RP} = 1.287 v^{2/3},\quad \hat h_{EI} = 2.621 e^{4/5},\quad
        \hat h_{EP} = 1.311 v^{3/4} e^{-1/4},\quad v = g_V/\sqrt 2,\quad e = g_E/\sqrt 2

    Args:
        g_V: viscosity parameter, with the mean speed [1]
        g_E: elasticity parameter, with the mean speed [1]
    """
    v, e = g_V / math.sqrt(2), g_E / math.sqrt(2)  # with the sum of the speeds, as Moes has it
    return RIGID, 1.287 * v ** (2 / 3), 2.621 * e**0.8, 1.311 * v**0.75 * e**-0.25


@law(
    source="Moes1992",
    where="which asymptote is followed",
    valid="the elastohydrodynamic regime: elastic flanks and oil that pressure thickens",
    ranges=dict.fromkeys(("rigid_isoviscous", "rigid_piezoviscous", "elastic_isoviscous"), (0.0, 1.0)),
    regimes={
        "rigid_isoviscous": f"rigid-isoviscous {_NOT_HERE}",
        "rigid_piezoviscous": f"rigid-piezoviscous {_NOT_HERE}",
        "elastic_isoviscous": f"elastic-isoviscous {_NOT_HERE}",
    },
    verified=False,
)
def elastohydrodynamic(rigid_isoviscous: Num, rigid_piezoviscous: Num, elastic_isoviscous: Num) -> Num:
    """How far inside the elastohydrodynamic regime a contact is: 1 or more inside, below 1 outside [1].

    Args:
        rigid_isoviscous: lead of this regime over the others, above 1 where the contact is in it [1]
        rigid_piezoviscous: lead of this regime over the others, above 1 where the contact is in it [1]
        elastic_isoviscous: lead of this regime over the others, above 1 where the contact is in it [1]
    """
    return 1 / ca.fmax(rigid_isoviscous, ca.fmax(rigid_piezoviscous, elastic_isoviscous))


def inside_elastohydrodynamic(g_V: Num, g_E: Num) -> Num:
    """What `elastohydrodynamic` tells of a contact, so that a run names the regime where it is another one [1].

    The film follows the thicker of two: the thicker one in oil of constant viscosity, rigid or elastic, and the
    thinner one in oil that pressure thickens.

    Args:
        g_V: viscosity parameter [1]
        g_E: elasticity parameter [1]
    """
    RI, RP, EI, EP = regime_films(g_V, g_E)
    thickened = ca.fmin(RP, EP)
    rigid_piezoviscous = ca.fmin(EP / RP, RP / ca.fmax(RI, EI))
    return elastohydrodynamic(RI / ca.fmax(EI, thickened), rigid_piezoviscous, EI / ca.fmax(RI, thickened))
