"""Friction of rolling bearings after Palmgren, which both parts of ISO/TR 14179 take from bearing catalogues.

Factors for oil baths, in the middle of the ranges that older catalogues give; they were compared with no print. A part
that declares f_0 and f_1 keeps its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ...model.laws.rolling import needle_torque_load, needle_torque_viscous
from .machine import Turning

Values = Mapping[str, float]


@dataclass(frozen=True)
class Factors:
    """Viscous factor, load factor of a bearing under its loads, the load that counts [N], factor of the axial load."""

    f_0: float
    f_1: Callable[[Values, float, float], float]
    P_1: Callable[[Values, float, float], float]
    f_2: float = 0.0


def _ball(values: Values, F_r: float, F_a: float) -> float:
    """By the static equivalent load over the static rating."""
    P_0 = max(F_r, 0.6 * F_r + 0.5 * F_a)
    return float(0.00075 * (P_0 / values["C_0"]) ** 0.55)


FACTORS: Mapping[str, Factors] = {
    "DeepGrooveBallBearing": Factors(2.0, _ball, lambda _, F_r, F_a: max(3 * F_a - 0.1 * F_r, F_r)),
    "CylindricalRollerBearing": Factors(3.0, lambda *_: 0.0003, lambda _, F_r, __: F_r, f_2=0.006),
    "TaperedRollerBearing": Factors(6.0, lambda *_: 0.0004, lambda v, F_r, F_a: max(2 * v["Y"] * F_a, F_r)),
    "NeedleBearing": Factors(12.0, lambda v, *_: v["f_1"], lambda _, F_r, __: F_r),
}


def bearing_loss(bearing: Turning, nu: float) -> float:
    """Friction power of all pieces [W].

    Args:
        bearing: the bearing at work
        nu: kinematic viscosity of the oil [m2/s]
    """
    factors, v = FACTORS[type(bearing.part).__name__], bearing.part.values
    F_r, F_a = bearing.F_r + v["F_r_0"], bearing.F_a + v["F_a_0"]
    viscous = needle_torque_viscous(bearing.w, nu, v["d_m"], v.get("f_0", factors.f_0))
    loaded = needle_torque_load(factors.P_1(v, F_r, F_a), v["d_m"], factors.f_1(v, F_r, F_a))
    axial = needle_torque_load(F_a, v["d_m"], factors.f_2)
    return float(v["count"] * (viscous + loaded + axial) * abs(bearing.w))
