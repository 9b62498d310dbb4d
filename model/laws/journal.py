"""Plain journal bearings: friction of the oil film, and where the film begins to carry."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import F_WIDTH, Num, smooth_abs


@law(
    source="Hamrock2004",
    where="Petrov's law",
    valid="journal in the middle of its bearing, full of oil",
    verified=False,
)
def petrov_torque(w: Num, eta_oil: Num, r: Num, b: Num, psi: Num) -> Num:
    r"""Friction torque of an unloaded journal bearing [N.m].

    .. math:: \tau_0 = \frac{2 \pi \eta \omega r^2 b}{\psi}

    Args:
        w: speed of the journal against the bearing, either direction [rad/s]
        eta_oil: dynamic viscosity in the film [Pa.s]
        r: radius of the journal [m]
        b: width of the bearing [m]
        psi: relative clearance, bearing less journal diameter over journal diameter [1]
    """
    return 2 * math.pi * eta_oil * smooth_abs(w) * r**2 * b / psi


@law(
    source="RaimondiBoyd1958",
    where="friction of the full bearing; a fit of this project to its own solutions of Reynolds' equation, within 2 %",
    valid="laminar film of one viscosity that shears all around the journal, eccentricity up to 0.95",
    ranges={"b / r": (0.5, 2.8)},
    verified=False,
)
def film_torque(tau_0: Num, F_r: Num, w: Num, eta_oil: Num, r: Num, b: Num, psi: Num) -> Num:
    r"""Friction torque of the film of a journal bearing under load [N.m].

    .. math:: \tau = \tau_0 \sqrt{1 + \frac{9}{\pi^2} \frac{So^2}{So + 0.96 q^{1.94}}
        \left(1 + \frac{3.77 q^{-0.65}}{1 + (So\,q^{1.815}/0.016)^{0.67}}\right)},\quad
        So = \frac{F \psi^2}{2 r b \eta \omega},\quad q = \frac{b}{2 r}

    Under high load it is the 3 psi / sqrt(So) of Vogelpohl1967, whatever the width; that formula alone, with the torque
    without load, is 19 % high at b = 2.8 r and 29 % low at b = 0.5 r.

    Args:
        tau_0: torque without load, see `petrov_torque` [N.m]
        F_r: radial load [N]
        w: speed of the journal against the bearing, either direction [rad/s]
        eta_oil: dynamic viscosity in the film [Pa.s]
        r: radius of the journal [m]
        b: width of the bearing [m]
        psi: relative clearance, bearing less journal diameter over journal diameter [1]
    """
    q = b / (2 * r)
    So = smooth_abs(F_r, F_WIDTH) * psi**2 / (2 * r * b * eta_oil * smooth_abs(w))
    narrow = 3.77 * q**-0.65 / (1 + (So * q**1.815 / 0.016) ** 0.67)
    return tau_0 * ca.sqrt(1 + 9 / math.pi**2 * So**2 / (So + 0.96 * q**1.94) * (1 + narrow))


@law(source="Vogelpohl1967", where="transition speed", verified=False)
def solid_share(w: Num, F_r: Num, eta_oil: Num, r: Num, b: Num, C_trans: Num) -> Num:
    r"""Share of the load that solids carry in mixed friction [1], 1 at rest and 1/e at the transition speed.

    .. math:: s = e^{-(n/n_t)^2},\quad n_t = \frac{10^{-7} F}{C \eta V}\;[\mathrm{rpm}],\quad V = \pi r^2 b

    The source has the speed; the form of the share is that of the Stribeck curve in control engineering.

    Args:
        w: speed of the journal against the bearing, either direction [rad/s]
        F_r: radial load [N]
        eta_oil: dynamic viscosity in the film [Pa.s]
        r: radius of the journal [m]
        b: width of the bearing [m]
        C_trans: transition constant, about 1 for a good surface [1]
    """
    n_t = 1e-7 * smooth_abs(F_r, F_WIDTH) / (C_trans * eta_oil * math.pi * r**2 * b)
    return ca.exp(-((w * 30 / math.pi / n_t) ** 2))
