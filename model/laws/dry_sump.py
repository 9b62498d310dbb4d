"""Gears under jets in a housing whose oil is drawn off: what the jets take and cool, and the mist in the air."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs

#: Heat that a film takes until it is flung off, over (k rho c_p t*)^(1/2) dT: its energy equation solved in similarity
#: variables; 95 % of it until the time t*, 98 % until 1.4 t*.
FLING_OFF = 0.981


@law(source="GearheatJet", where="momentum of the oil", verified=False)
def jet_torque(m_flow: Num, v_gain: Num, r: Num) -> Num:
    r"""Torque that brings the oil of a jet to the speed of the pitch line [N.m]; negative: the jet drives the gear.

    .. math:: \tau = \dot m r (v_t - v_j \cos\gamma)

    Args:
        m_flow: mass flow rate of the jet [kg/s]
        v_gain: speed that its oil gains along the pitch line [m/s]
        r: pitch radius [m]
    """
    return m_flow * r * v_gain


@law(
    source="GearheatJet",
    where="heat that a draining film takes, once a revolution",
    valid="flanks flooded once a revolution, the film flung off before the next: within 5 % for Pr H / r up to 40",
    ranges={"Pr": (10.0, 400.0)},
    verified=False,
)
def fling_off(w: Num, rho: Num, c_p: Num, k: Num, Pr: Num, height: Num, r: Num) -> Num:
    r"""Heat transfer coefficient of the flanks of a gear on which a jet plays [W/(m2.K)].

    .. math:: h = 0.981 \frac{\sqrt{k \rho c_p \omega}}{2 \pi} \left(Pr \frac{H}{r}\right)^{1/4}

    The form is that of DeWinter1974. A film drains along the flank under the centrifugal acceleration as long as it
    takes heat: t* = (Pr H / r)^(1/2) / w. vonPlehwe2019 solves the same problem; thinner films take less.

    Args:
        w: speed of the gear, either direction [rad/s]
        rho: density of the oil [kg/m3]
        c_p: specific heat of the oil [J/(kg.K)]
        k: conductivity of the oil [W/(m.K)]
        Pr: Prandtl number of the oil [1]
        height: of the teeth, H [m]
        r: pitch radius [m]
    """
    return FLING_OFF * ca.sqrt(k * rho * c_p * smooth_abs(w)) / (2 * math.pi) * (Pr * height / r) ** 0.25


@law(
    source="Maurer1994",
    where="exponents of speed, by dimensions",
    valid="droplets that follow the air",
    ranges={"share_oil": (0.0, 0.03)},
    verified=False,
)
def mist_factor(rho: Num, rho_air: Num, share_oil: Num) -> Num:
    r"""Windage in air with a mist of oil, over that in air [1]: by the density, as the torque rises with speed^1.9.

    .. math:: f = \left(\frac{(1 - \varphi) \rho_{air} + \varphi \rho}{\rho_{air}}\right)^{0.9}

    Anderson1980 has one part of oil in 34.25 parts of air where jets play, which is 15 times the windage.

    Args:
        rho: density of the oil [kg/m3]
        rho_air: density of the air [kg/m3]
        share_oil: share of oil in the volume [1]
    """
    return (1 - share_oil + share_oil * rho / rho_air) ** 0.9
