"""Losses and heat of a machine after both parts of ISO/TR 14179, at a temperature of the sump.

Both parts take the friction of rolling bearings after Palmgren from bearing catalogues. Its factors here are those of
oil baths, in the middle of the ranges that older catalogues give; they were compared with no print. A part that
declares f_0 and f_1 keeps its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scipy.optimize import brentq

from ...model.core.component import Component
from ...model.laws import iso14179_1 as part_1, iso14179_2 as part_2
from ...model.laws.mesh import friction_schlenk, load_per_face_width, mesh_loss, tooth_loss_factor
from ...model.laws.radiation import radiation_coefficient
from ...model.laws.rolling import needle_torque_load, needle_torque_viscous
from ...model.laws.sealing import lip_seal_torque
from .gather import Machine, Mesh, Turning

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


def _bearing_loss(bearing: Turning, nu: float) -> float:
    """Friction power of all pieces [W] in an oil of a kinematic viscosity [m2/s]."""
    factors, v = FACTORS[type(bearing.part).__name__], bearing.part.values
    F_r, F_a = bearing.F_r + v["F_r_0"], bearing.F_a + v.get("F_a_0", 0.0)  # none where it holds no shaft
    viscous = needle_torque_viscous(bearing.w, nu, v["d_m"], v.get("f_0", factors.f_0))
    loaded = needle_torque_load(factors.P_1(v, F_r, F_a), v["d_m"], factors.f_1(v, F_r, F_a))
    axial = needle_torque_load(F_a, v["d_m"], factors.f_2)
    return float(v["count"] * (viscous + loaded + axial) * abs(bearing.w))


#: Kind of loss -> part -> loss [W].
Losses = dict[str, dict[str, float]]


@dataclass(frozen=True)
class Method:
    """A reference method.

    Args:
        title: in words
        losses: of a machine at a temperature of the sump [K]
        conductance: from the sump at a temperature [K] to the air [W/K]
        assumptions: what it takes for granted, and which of its constants were compared with no print
    """

    title: str
    losses: Callable[[Machine, float], Losses]
    conductance: Callable[[Machine, float], float]
    assumptions: tuple[str, ...]


def _losses_1(machine: Machine, T: float) -> Losses:
    """Losses after ISO/TR 14179-1 at a temperature of the sump [K]."""
    nu = machine.nu(T)
    return {
        "mesh": {m.name: _mesh_1(m, nu) for m in machine.meshes},
        "churning": {m.name: _churning_1(m, nu) for m in machine.meshes},
        "bearings": {b.part.name: _bearing_loss(b, nu) for b in machine.bearings},
        "seals": _seals(machine, part_1.seal_torque),
    }


def _mesh_1(m: Mesh, nu: float) -> float:
    pair = m.pair
    (d_w1, d_w2), (d_a1, d_a2), alpha_wt = pair.pitches, pair.outsides, pair.alpha_wt
    mu = part_1.mesh_friction(nu, part_1.load_intensity(m.F_t, pair.b, d_w1, pair.u), m.v)
    H_s = part_1.tip_sliding(d_a2, d_w2, alpha_wt, pair.u)
    H_t = part_1.tip_sliding(d_a1, d_w1, alpha_wt, 1 / pair.u)
    beta_w = math.atan(math.tan(pair.beta) * d_w1 / pair.references[0])
    return float(part_1.mesh_loss(m.F_t * m.v, mu, H_s, H_t, alpha_wt, beta_w))


def _churning_1(m: Mesh, nu: float) -> float:
    m_t, total = m.pair.m_n / math.cos(m.pair.beta), 0.0
    for w, D, dip in zip(m.w, m.pair.tips, m.dips, strict=True):
        f_g = min(1.0, dip / D)
        total += float(part_1.side_churning(w, nu, D, f_g))
        total += float(part_1.tooth_churning(w, nu, D, m.pair.b, m.pair.beta, m_t, f_g))
    return total


def _losses_2(machine: Machine, T: float) -> Losses:
    """Losses after ISO/TR 14179-2 at a temperature of the sump [K]."""
    nu, eta = machine.nu(T), machine.eta(T)
    return {
        "mesh": {m.name: _mesh_2(m, eta, machine.oil["X_L"]) for m in machine.meshes},
        "churning": {m.name: _churning_2(m, machine.surfaces) for m in machine.meshes},
        "bearings": {b.part.name: _bearing_loss(b, nu) for b in machine.bearings},
        "seals": _seals(machine, lip_seal_torque),
    }


def _seals(machine: Machine, torque: Callable[[float], Any]) -> dict[str, float]:
    """Losses of the seals from the friction torque of one [N.m] over its shaft diameter [m]."""
    sizes = {s.part.name: (s.part.values, abs(s.w)) for s in machine.seals}
    return {name: v["count"] * float(torque(v["d_sh"])) * w for name, (v, w) in sizes.items()}


def _mesh_2(m: Mesh, eta: float, X_L: float) -> float:
    pair = m.pair
    v_sum = 2 * m.v * math.cos(pair.alpha_t) * math.tan(pair.alpha_wt)
    load = load_per_face_width(m.F_t / math.cos(pair.alpha_t), pair.b)
    mu = friction_schlenk(load, v_sum, pair.R, eta, pair.Ra, X_L)
    H_v = tooth_loss_factor(pair.z_1, pair.u, pair.beta_b, *pair.contact_ratios)
    return float(mesh_loss(m.F_t * m.v, mu, H_v))


def _churning_2(m: Mesh, surfaces: tuple[Component, ...]) -> float:
    e_max = max(m.dips)
    if not e_max:
        return 0.0
    deeper = m.dips.index(e_max)
    h_c, C_Sp = m.pair.tips[deeper] / 2, 1.0
    boxes = [s.values for s in surfaces if {"length", "width"} <= s.values.keys()]
    if boxes:
        length, width = boxes[0]["length"], boxes[0]["width"]
        C_Sp = float(part_2.splash_factor(e_max, h_c, 2 * length * width / (length + width)))
    return float(part_2.hydraulic_torque(m.v, sum(m.dips), m.pair.b, C_Sp)) * abs(m.w[deeper])


def _surface_2(surface: Component, T: float, T_room: float) -> float:
    """From the sump to still air: oil to wall, free convection and radiation, fins as area [W/K]."""
    v = surface.values
    wet, dry = float(v["A"]), float(v["A"] + v.get("A_fins", 0.0))

    def outside(T_wall: float) -> float:
        free = float(part_2.free_convection(T_wall, T_room, v.get("height", v.get("D", 0.0))))
        return free * dry + float(radiation_coefficient(T_wall, T_room, v["emissivity"])) * wet

    if abs(T - T_room) < 1e-6:
        return outside(T) / (1 + outside(T) / (part_2.H_OIL * wet))
    T_wall = float(brentq(lambda x: part_2.H_OIL * wet * (T - x) - outside(x) * (x - T_room), T_room, T))
    return part_2.H_OIL * wet * (T - T_wall) / (T - T_room)


NOT_COMPARED = "its constants were compared with no print of the standard; see model/sources.toml"
BEARINGS = "bearings: Palmgren's formula with factors for an oil bath from the middle of catalogue ranges"

METHODS: Mapping[str, Method] = {
    "iso14179-1": Method(
        "ISO/TR 14179-1",
        _losses_1,
        lambda machine, _: part_1.STILL_AIR * sum(s.values["A"] for s in machine.surfaces),
        (
            NOT_COMPARED,
            BEARINGS,
            "seals: nitrile rubber",
            "churning: sides and teeth of gears that dip; smooth shafts are left out, as no part declares them",
            f"heat: {part_1.STILL_AIR:g} W/(m2.K) over the bare area, fins not counted, still air; --k takes another",
        ),
    ),
    "iso14179-2": Method(
        "ISO/TR 14179-2",
        _losses_2,
        lambda machine, T: sum(_surface_2(s, T, machine.T_room) for s in machine.surfaces),
        (
            NOT_COMPARED,
            BEARINGS,
            "churning: shafts in one level plane; acts on the shaft of the gear that dips deeper; squeezing left out",
            "heat: oil to wall, free convection over bare area and fins, radiation over the bare area; no fan, no feet",
        ),
    ),
}
