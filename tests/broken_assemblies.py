"""A sound small gearbox of real parts, and what a slip in it does: one function a slip, its docstring says which.

The tests ask for the message of each, and the page `howto/assemblies.md` shows them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import casadi as ca
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.declare import Output, Parameter
from gearheat.model.parts import PARTS
from gearheat.model.parts.ports import Flange, HeatPort

OIL = dict(nu_40=3.2438e-4, nu_100=3.527e-5, rho_15=859.0, alpha_T=-5.6e-4, s_p=7.382, t_p=0.1335, X_L=0.666)
BEARING = dict(count=1.0, inner_share=0.5, d_m=0.14, F_r_0=100.0, F_a_0=50.0, d=0.11, D=0.17, K_Z=3.1, K_rs=6e-8)
BEARING |= dict(mu_bl=0.1, mu_EHL=0.05, H=0.03, R_1=3.9e-7, R_2=1.7, S_1=3.23e-3, S_2=36.5, C_0=64e3)
GEAR = dict(z_1=36.0, z_2=72.0, m_n=0.002, alpha_n=math.radians(20), beta=math.radians(10), b=0.042, a_w=0.1097)
GEAR |= dict(Ra=6e-7, k_mu=1.0, line_load="F_bn/l", E=2.06e11, poisson=0.3, x_1=0.0, x_2=0.0)

#: Part -> type and values.
SOUND: dict[str, tuple[str, dict[str, Any]]] = {
    "motor": ("ShaftEnd", dict(given=("w",))),
    "gear": ("HelicalGearPair", GEAR),
    "fan": ("FanLoad", dict(k=0.1)),
    "support": ("ShaftSupport", dict(span=0.1, x=0.04, r=0.05, axial_share_a=1.0)),
    "bearing_a": ("DeepGrooveBallBearing", BEARING),
    "bearing_b": ("DeepGrooveBallBearing", BEARING),
    "oil": ("OilBath", OIL | dict(V=1e-3, c_p=2000.0)),
    "wall": ("HeatCapacity", dict(C=5000.0)),
    "film": ("ThermalConductor", dict(G=20.0)),
    "foot": ("ThermalConductor", dict(G=10.0)),
    "room": ("Room", {}),
}
#: Net -> ports that meet.
NETS: dict[str, tuple[str, ...]] = {
    "pinion": ("motor.flange", "gear.pinion", "bearing_a.shaft", "bearing_b.shaft"),
    "wheel": ("gear.wheel", "fan.flange"),
    "force": ("gear.force", "support.mesh"),
    "load_a": ("support.load_a", "bearing_a.load"),
    "load_b": ("support.load_b", "bearing_b.load"),
    "lubricant": ("oil.lubricant", "gear.lubricant", "bearing_a.lubricant", "bearing_b.lubricant"),
    "inside": ("oil.heat", "gear.gears", "bearing_a.inner", "bearing_b.inner", "film.a"),
    "outside": ("wall.heat", "bearing_a.outer", "bearing_b.outer", "film.b", "foot.a"),
    "floor": ("foot.b", "room.floor"),
}


def gearbox(parts: dict[str, Any] | None = None, nets: dict[str, tuple[str, ...]] | None = None) -> Assembly:
    """The sound gearbox with parts and nets replaced or added; an empty net goes. A part may be a class."""
    chosen = SOUND | (parts or {})
    made = []
    for name, what in chosen.items():
        made.append(what(name) if isinstance(what, type) else PARTS[what[0]](name, **what[1]))
    connections = tuple(ports for ports in (NETS | (nets or {})).values() if ports)
    return Assembly("gearbox", "", tuple(made), connections)


def without(net: str, *ports: str) -> dict[str, tuple[str, ...]]:
    """A net without some of its ports."""
    return {net: tuple(p for p in NETS[net] if p not in ports)}


BROKEN: list[Callable[[], Assembly]] = []


def broken(make: Callable[[], Assembly]) -> Callable[[], Assembly]:
    BROKEN.append(make)
    return make


@broken
def open_heat_port() -> Assembly:
    """a bearing's inner ring is in no net"""
    return gearbox(nets=without("inside", "bearing_a.inner"))


@broken
def open_load() -> Assembly:
    """nothing says what a bearing carries"""
    return gearbox(nets={"load_a": ()})


@broken
def no_lubricant() -> Assembly:
    """the gears have no oil"""
    return gearbox(nets=without("lubricant", "gear.lubricant"))


@broken
def part_without_connection() -> Assembly:
    """a second room that nothing touches"""
    return gearbox({"hall": ("Room", {})})


@broken
def nothing_given() -> Assembly:
    """neither speed nor torque is given"""
    return gearbox({"motor": ("ShaftEnd", {})})


@broken
def no_room() -> Assembly:
    """the heat of a seal ends in conductors: no storage, no room"""
    seal = ("LipSeal", dict(count=1.0, inner_share=0.5, d_sh=0.14, c_sh=73.4))
    parts = {"motor": SOUND["motor"], "seal": seal, "film": SOUND["film"]}
    made = tuple(PARTS[kind](name, **values) for name, (kind, values) in parts.items())
    nets = (("motor.flange", "seal.shaft"), ("seal.inner", "film.a"), ("seal.outer", "film.b"))
    return Assembly("gearbox", "", made, nets)


@broken
def two_speeds() -> Assembly:
    """speeds given at both ends of a rigid shaft line"""
    return gearbox({"fan": ("ShaftEnd", dict(given=("w",)))})


@broken
def speed_and_torques() -> Assembly:
    """speed and torque given at one end, torque at the other"""
    return gearbox({"motor": ("ShaftEnd", dict(given=("w", "tau"))), "fan": ("ShaftEnd", dict(given=("tau",)))})


@broken
def two_rooms() -> Assembly:
    """two rooms at one place"""
    return gearbox({"hall": ("Room", {})}, {"floor": ("foot.b", "room.floor", "hall.floor")})


@broken
def inertia_at_given_speed() -> Assembly:
    """an inertia on a shaft whose speed is given (index 2)"""
    return gearbox({"rotor": ("Inertia", dict(J=0.1))}, {"wheel": (*NETS["wheel"], "rotor.flange")})


@broken
def capacity_in_the_room() -> Assembly:
    """a body in direct contact with the room"""
    return gearbox(nets={"outside": (*NETS["outside"], "foot.b", "room.floor"), "floor": ()})


@broken
def held_shaft() -> Assembly:
    """a shaft of given speed is held"""
    return gearbox({"mount": ("FixedFlange", {})}, {"wheel": (*NETS["wheel"], "mount.flange")})


ROLLERS = BEARING | dict(B=0.04, K_L=0.7)
NO_FLANGES = {k: v for k, v in ROLLERS.items() if k not in ("C_0", "R_2", "S_1", "F_a_0")} | dict(flanges="one ring")
TAPERED = {k: v for k, v in ROLLERS.items() if k != "C_0"} | dict(Y=1.6)


@broken
def no_bearing_locates() -> Assembly:
    """a cylindrical roller bearing without flanges takes the axial force"""
    return gearbox({"bearing_a": ("CylindricalRollerBearing", NO_FLANGES)})


@broken
def one_tapered_bearing() -> Assembly:
    """a tapered roller bearing with nothing set against it"""
    return gearbox({"bearing_a": ("TaperedRollerBearing", TAPERED)})


@broken
def thrust_bearing_under_a_gear() -> Assembly:
    """a thrust bearing alone at one end of a shaft with a gear"""
    values = {key: value for key, value in BEARING.items() if key not in ("F_r_0", "R_2", "S_2", "C_0")}
    return gearbox({"bearing_a": ("ThrustBallBearing", values)})


def set_against(arrangement: str, ends: str = "ab") -> Assembly:
    """Tapered roller bearings face to face or back to back, their thrusts connected in an order."""
    support = SOUND["support"][1] | dict(arrangement=arrangement)
    parts = {f"bearing_{k}": ("TaperedRollerBearing", TAPERED) for k in "ab"}
    parts["support"] = ("ShaftSupport", {k: v for k, v in support.items() if k != "axial_share_a"})
    thrusts = [(f"support.thrust_{k}", f"bearing_{end}.thrust") for k, end in zip("ab", ends, strict=True)]
    return gearbox(parts, dict(zip(("thrust_a", "thrust_b"), thrusts, strict=True)))


@broken
def thrusts_that_point_the_same_way() -> Assembly:
    """the thrust of one bearing is told as that of both"""
    return set_against("face-to-face", "bb")


def twice_geared(z_1: float, z_2: float) -> Assembly:
    """Two gear pairs between the same shafts."""
    parts = {"motor": ("ShaftEnd", dict(given=("tau",))), "rotor": ("Inertia", dict(J=0.1))}
    parts |= {"second": ("HelicalGearPair", GEAR | dict(z_1=z_1, z_2=z_2))}
    nets = {"pinion": (*NETS["pinion"], "rotor.flange", "second.pinion"), "wheel": (*NETS["wheel"], "second.wheel")}
    nets |= {"inside": (*NETS["inside"], "second.gears"), "lubricant": (*NETS["lubricant"], "second.lubricant")}
    return gearbox(parts, nets)


@broken
def loop_of_gears() -> Assembly:
    """two gear pairs of different ratio between the same shafts"""
    return twice_geared(35.0, 73.0)


@broken
def parallel_gears() -> Assembly:
    """two gear pairs of the same ratio between the same shafts"""
    return twice_geared(36.0, 72.0)


@broken
def shared_port() -> Assembly:
    """one port in two nets: oil and wall would be one body"""
    return gearbox(nets={"outside": (*NETS["outside"], "bearing_a.inner")})


@broken
def starts_apart() -> Assembly:
    """two bodies in one net that start at different temperatures"""
    parts = {"wall": ("HeatCapacity", dict(C=5000.0, T=320.0)), "cover": ("HeatCapacity", dict(C=900.0, T=300.0))}
    return gearbox(parts, {"outside": (*NETS["outside"], "cover.heat")})


@broken
def doubled_name() -> Assembly:
    """two parts of one name"""
    sound = gearbox()
    return Assembly("gearbox", "", (*sound.parts, PARTS["HeatCapacity"]("wall", C=1.0)), sound.connections)


@broken
def wrong_kinds() -> Assembly:
    """a heat port on a shaft"""
    return gearbox(nets={"wheel": ("gear.wheel", "fan.flange", "room.floor")})


@broken
def one_port() -> Assembly:
    """a connection of one port"""
    return gearbox(nets={"air": ("room.air",)})


@broken
def unknown_port() -> Assembly:
    """a misspelt port"""
    return gearbox(nets={"force": ("gear.forces", "support.mesh")})


class Empty(Component):
    shaft = Flange()


class Brake(Component):
    """A brake of one's own, whose torque each slip below spoils in another way."""

    shaft = Flange()
    heat = HeatPort()

    tau_max = Parameter("N.m", "largest torque", default=5.0)
    P_loss = Output("W", "friction power")

    def torque(self) -> Any:
        return self.tau_max

    def equations(self) -> Iterator[Equation]:
        yield equation("friction power", self.P_loss, self.shaft.tau * self.shaft.w)
        yield equation("becomes heat", self.heat.Q_flow, -self.P_loss)
        yield equation("brakes", self.shaft.tau, self.torque())


def with_brake(torque: Callable[[Brake], Any] | None) -> Assembly:
    brake = Empty if torque is None else type("Brake", (Brake,), {"torque": torque, "__doc__": "Spoilt."})
    nets = {"wheel": (*NETS["wheel"], "brake.shaft")}
    return gearbox({"brake": brake}, nets if torque is None else nets | {"inside": (*NETS["inside"], "brake.heat")})


@broken
def no_equations() -> Assembly:
    """a part of one's own without equations"""
    return with_brake(None)


@broken
def decides_on_a_symbol() -> Assembly:
    """`if` on a speed in the equations of a part"""
    return with_brake(lambda self: self.tau_max if self.shaft.w > 0 else -self.tau_max)


@broken
def undeclared_name() -> Assembly:
    """a name that the part does not declare"""
    return with_brake(lambda self: self.tau_mx)


@broken
def wrong_shape() -> Assembly:
    """a side of three numbers"""
    return with_brake(lambda self: [self.tau_max, 0.0, 0.0])


@broken
def wrong_sizes() -> Assembly:
    """columns of different lengths in one equation"""
    return with_brake(lambda self: ca.vertcat(self.tau_max, 0.0) + ca.vertcat(self.tau_max, 0.0, 0.0))


@broken
def column_for_a_number() -> Assembly:
    """a column where a number belongs"""
    return with_brake(lambda self: ca.vertcat(self.tau_max, 0.0))


@broken
def strange_symbol() -> Assembly:
    """a symbol that no part declares"""
    return with_brake(lambda self: self.tau_max * ca.SX.sym("mood"))


@broken
def function_of_numbers() -> Assembly:
    """a function for numbers on a symbol"""
    return with_brake(lambda self: self.tau_max * math.sqrt(self.shaft.w**2 + 1))
