"""Oil that flows: the energy it carries, what it takes from a wall, and the pressure it loses."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs

#: Mass flow rate [kg/s] below which its direction is blurred; oil at rest mixes as if half of this went either way.
M_WIDTH = 1e-4
#: Pressure difference [Pa] below which the flow through an orifice is proportional to it.
P_WIDTH = 100.0


@law(source="Franke2009", where="balance of a stream in the direction of its flow", verified=False)
def carried_enthalpy(m_flow: Num, h_a: Num, h_b: Num) -> Num:
    r"""Enthalpy flow rate from a to b [W]: the oil brings the enthalpy of where it comes from.

    .. math:: \dot H = \max(\dot m, 0) h_a + \min(\dot m, 0) h_b

    Rounded in `M_WIDTH`, so that oil at rest still mixes a little; what leaves one side enters the other.

    Args:
        m_flow: mass flow rate from a to b [kg/s]
        h_a: specific enthalpy at a [J/kg]
        h_b: specific enthalpy at b [J/kg]
    """
    return (m_flow * (h_a + h_b) + smooth_abs(m_flow, M_WIDTH) * (h_a - h_b)) / 2


@law(source="Incropera2007", where="effectiveness, all exchangers with a capacity ratio of zero", verified=False)
def stream_conductance(m_flow: Num, c_p: Num, G: Num) -> Num:
    r"""Heat that a stream takes from a wall, over the difference of wall and inlet temperature [W/K].

    .. math:: \dot m c_p (1 - \exp(-G / (\dot m c_p)))

    Args:
        m_flow: mass flow rate, either direction [kg/s]
        c_p: specific heat of the oil [J/(kg.K)]
        G: conductance between stream and wall, heat transfer coefficient times area [W/K]
    """
    C = smooth_abs(m_flow, M_WIDTH) * c_p
    return C * (1 - ca.exp(-G / C))


@law(
    source="Merritt1967",
    where="turbulent orifice",
    valid="sharp edge; short, so that viscosity does not count",
    verified=False,
)
def orifice_flow(dp: Num, rho: Num, d: Num, C_d: Num) -> Num:
    r"""Mass flow rate through an orifice [kg/s], in the direction in which the pressure falls.

    .. math:: \dot m = C_d \frac{\pi}{4} d^2 \sqrt{2 \rho \Delta p}

    Args:
        dp: pressure difference [Pa]
        rho: density [kg/m3]
        d: diameter [m]
        C_d: discharge coefficient [1]
    """
    return C_d * math.pi / 4 * d**2 * ca.sqrt(2 * rho) * dp / (dp**2 + P_WIDTH**2) ** 0.25


@law(source="Merritt1967", where="laminar flow through a passage, linear in flow rate and viscosity", verified=False)
def laminar_pressure(m_flow: Num, nu: Num, R: Num, p_bypass: Num, *, sharpness: int = 8) -> Num:
    r"""Pressure [Pa] that a filter or a pipe takes, up to that at which its bypass valve is open.

    .. math:: \Delta p = R \nu \dot m

    Args:
        m_flow: mass flow rate, either direction [kg/s]
        nu: kinematic viscosity [m2/s]
        R: resistance: of a pipe of length L and diameter d, 128 L / (pi d^4) [1/m3]
        p_bypass: largest pressure difference [Pa]
        sharpness: of the bend where the valve opens, even [1]
    """
    x = R * nu * m_flow / p_bypass
    return p_bypass * x * (1 + x**sharpness) ** (-1 / sharpness)


@law(
    source="Merritt1967",
    where="torque of a positive-displacement pump, ideal and by its mechanical efficiency",
    verified=False,
)
def pump_loss_torque(dp: Num, D: Num, eta_m: Num) -> Num:
    r"""Friction torque of a positive-displacement pump [N.m], never negative; the ideal one is D dp.

    .. math:: \tau = \left(\frac{1}{\eta_m} - 1\right) D |\Delta p|

    Args:
        dp: pressure that the pump adds [Pa]
        D: displacement per radian [m3]
        eta_m: mechanical efficiency [1]
    """
    return (1 / eta_m - 1) * D * smooth_abs(dp, P_WIDTH)


@law(source="Merritt1967", where="laminar leakage of a positive-displacement pump, by its displacement", verified=False)
def pump_slip(dp: Num, D: Num, eta_oil: Num, C_s: Num) -> Num:
    r"""Volume flow rate that leaks back inside a positive-displacement pump [m3/s], with the sign of the pressure.

    .. math:: Q_s = C_s \frac{D \Delta p}{\eta}

    Args:
        dp: pressure that the pump adds [Pa]
        D: displacement per radian [m3]
        eta_oil: dynamic viscosity [Pa.s]
        C_s: slip coefficient [1]
    """
    return C_s * D * dp / eta_oil
