"""Small parts for the tests of the core and of the runs: circuits, bodies that conduct and radiate, shafts that rub.

They know nothing of gearboxes and use none of the project's parts, so what is tested is the machinery.
"""

from collections.abc import Iterator
from typing import Any

import casadi as ca
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.declare import Flow, Input, Output, Parameter, Port, Potential, State, Variable
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.sources import law

SIGMA = 5.670374419e-8


def model(*parts: Component, nets: list[tuple[str, ...]]) -> FlatModel:
    """The flat model of some parts and nets."""
    return flatten(Assembly("bench", "", parts, tuple(nets)))


# --- circuits ---------------------------------------------------------------------------------------------------


class Pin(Port):
    v = Potential("V", "voltage")
    i = Flow("A", "current")

    def power(self) -> Any:
        return self.v * self.i


class TwoPins(Component):
    a = Pin()
    b = Pin()

    v = Variable("V", "voltage from a to b")
    i = Variable("A", "current through, from a to b")

    def equations(self) -> Iterator[Equation]:
        yield equation("voltage", self.v, self.a.v - self.b.v)
        yield equation("enters at a", self.a.i, self.i)
        yield equation("leaves at b", self.b.i, -self.i)


class Resistor(TwoPins):
    R = Parameter("Ohm", "resistance", above=0.0)
    P = Output("W", "heat")

    def equations(self) -> Iterator[Equation]:
        yield from super().equations()
        yield equation("Ohm", self.v, self.R * self.i)
        yield equation("heat", self.P, self.v * self.i)

    def supplied_power(self) -> Any:
        return (-self.P,)


class Capacitor(TwoPins):
    C = Parameter("F", "capacitance", above=0.0)
    u = State("V", "voltage")

    def equations(self) -> Iterator[Equation]:
        yield from super().equations()
        yield equation("plates", self.v, self.u)
        yield equation("charge", self.C * self.der("u"), self.i)

    def stored_energy(self) -> Any:
        return self.C * self.u**2 / 2


class Inductor(TwoPins):
    L = Parameter("H", "inductance", above=0.0)
    j = State("A", "current")

    def equations(self) -> Iterator[Equation]:
        yield from super().equations()
        yield equation("winding", self.i, self.j)
        yield equation("induction", self.L * self.der("j"), self.v)

    def stored_energy(self) -> Any:
        return self.L * self.j**2 / 2


class Battery(TwoPins):
    V = Input("V", "voltage of a over b")

    def equations(self) -> Iterator[Equation]:
        yield from super().equations()
        yield equation("voltage held", self.v, self.V)

    def supplied_power(self) -> Any:
        return (-self.V * self.i,)


class Ground(Component):
    pin = Pin()

    def equations(self) -> Iterator[Equation]:
        yield equation("zero", self.pin.v, 0.0)


# --- heat -------------------------------------------------------------------------------------------------------


class Heat(Port):
    T = Potential("K", "temperature", nominal=300.0)
    Q_flow = Flow("W", "heat flow rate", nominal=100.0)

    def power(self) -> Any:
        return self.Q_flow


class Body(Component):
    heat = Heat()

    T = State("K", "temperature", nominal=10.0, start=300.0, above=0.0, at_most=2000.0)
    C = Parameter("J/K", "heat capacity", above=0.0)
    Q = Input("W", "heat from outside")

    def equations(self) -> Iterator[Equation]:
        yield equation("one temperature", self.heat.T, self.T)
        yield equation("storage", self.C * self.der("T"), self.heat.Q_flow + self.Q)

    def stored_energy(self) -> Any:
        return self.C * (self.T - 273.15)

    def supplied_power(self) -> Any:
        return (self.Q,)


class TwoHeats(Component):
    a = Heat()
    b = Heat()

    Q_flow = Output("W", "heat flow rate from a to b")

    def flow(self) -> Any:
        raise AttributeError

    def equations(self) -> Iterator[Equation]:
        yield equation("flow", self.Q_flow, self.flow())
        yield equation("enters at a", self.a.Q_flow, self.Q_flow)
        yield equation("leaves at b", self.b.Q_flow, -self.Q_flow)


class Conductor(TwoHeats):
    G = Parameter("W/K", "conductance", at_least=0.0)

    def flow(self) -> Any:
        return self.G * (self.a.T - self.b.T)


@law(source="Example", where="eq. 1", valid="not too hot", ranges={"T": (250.0, 400.0)})
def radiated(T: Any, T_other: Any, A: Any) -> Any:
    """Heat flow rate by radiation [W]."""
    return SIGMA * A * (T**4 - T_other**4)


class Radiation(TwoHeats):
    A = Parameter("m2", "area", at_least=0.0)

    def flow(self) -> Any:
        return radiated(self.a.T, self.b.T, self.A)


class Heater(Component):
    """Heat from outside into a net."""

    heat = Heat()

    Q = Input("W", "heat flow rate")

    def equations(self) -> Iterator[Equation]:
        yield equation("heat held", self.heat.Q_flow, -self.Q)

    def supplied_power(self) -> Any:
        return (self.Q,)


class Thermometer(Component):
    """Reads a temperature, takes no heat."""

    heat = Heat()

    T = Output("K", "temperature read")

    def equations(self) -> Iterator[Equation]:
        yield equation("reading", self.T, self.heat.T)
        yield equation("takes no heat", self.heat.Q_flow, 0.0)


class Ambient(Component):
    heat = Heat()

    T = Input("K", "temperature", start=300.0, above=0.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("temperature held", self.heat.T, self.T)

    def supplied_power(self) -> Any:
        return (-self.heat.Q_flow,)


# --- shafts -----------------------------------------------------------------------------------------------------


class Shaft(Port):
    w = Potential("rad/s", "angular velocity", nominal=10.0)
    tau = Flow("N.m", "torque", nominal=10.0)

    def power(self) -> Any:
        return self.w * self.tau


class Flywheel(Component):
    shaft = Shaft()

    w = State("rad/s", "angular velocity", nominal=10.0)
    J = Parameter("kg.m2", "moment of inertia", above=0.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("one speed", self.shaft.w, self.w)
        yield equation("acceleration", self.J * self.der("w"), self.shaft.tau)

    def stored_energy(self) -> Any:
        return self.J * self.w**2 / 2


class Torque(Component):
    """A torque from outside."""

    shaft = Shaft()

    tau = Input("N.m", "torque on the shaft", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("torque held", self.shaft.tau, -self.tau)

    def supplied_power(self) -> Any:
        return (self.tau * self.shaft.w,)


class Speed(Component):
    """A speed from outside."""

    shaft = Shaft()

    w = Input("rad/s", "angular velocity", nominal=10.0)
    tau = Output("N.m", "torque it takes", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("speed held", self.shaft.w, self.w)
        yield equation("torque", self.tau, -self.shaft.tau)

    def supplied_power(self) -> Any:
        return (self.tau * self.w,)


class Friction(Component):
    """Dry and viscous friction that heats a body; the viscous part thins with its temperature."""

    shaft = Shaft()
    heat = Heat()

    tau_dry = Parameter("N.m", "dry friction", at_least=0.0)
    d_40 = Parameter("N.m.s", "viscous friction at 40 degC", at_least=0.0)
    thinning = Parameter("1/K", "relative fall of the viscous friction with temperature")
    P_loss = Output("W", "friction power")

    def equations(self) -> Iterator[Equation]:
        w, T = self.shaft.w, self.heat.T
        dry = self.tau_dry * w / ca.sqrt(w**2 + 1e-4)
        yield equation("opposes rotation", self.shaft.tau, dry + self.d_40 * w * ca.exp(-self.thinning * (T - 313.15)))
        yield equation("power", self.P_loss, self.shaft.tau * w)
        yield equation("becomes heat", self.heat.Q_flow, -self.P_loss)


class LossyGear(Component):
    """Two shafts with a loss that depends on the force it changes: an implicit block."""

    a = Shaft()
    b = Shaft()
    heat = Heat()

    ratio = Parameter("1", "speed of a over speed of b")
    mu = Parameter("1", "loss factor", at_least=0.0)
    tau_loss = Variable("N.m", "loss torque at a", guess=0.0, nominal=10.0)
    force = Variable("N.m", "mean torque carried", nominal=10.0)
    P_loss = Output("W", "loss power")

    def equations(self) -> Iterator[Equation]:
        direction = self.a.w / ca.sqrt(self.a.w**2 + 1e-4)
        load = ca.sqrt(self.force**2 + 1e-4)
        yield equation("one ratio", self.a.w, self.ratio * self.b.w)
        yield equation("balance", self.a.tau + self.b.tau / self.ratio, self.tau_loss * direction)
        yield equation("mean torque", self.force, (self.a.tau - self.b.tau / self.ratio) / 2)
        yield equation("loss", self.tau_loss, self.mu * load**0.8)
        yield equation("power", self.P_loss, self.tau_loss * direction * self.a.w)
        yield equation("becomes heat", self.heat.Q_flow, -self.P_loss)


# --- small machines -----------------------------------------------------------------------------------------------


def rc(R: float = 100.0, C: float = 1e-3) -> FlatModel:
    """A capacitor charged through a resistor."""
    nets = [("battery.a", "resistor.a"), ("resistor.b", "capacitor.a"), ("capacitor.b", "battery.b", "ground.pin")]
    return model(
        Battery("battery"), Resistor("resistor", R=R), Capacitor("capacitor", C=C), Ground("ground"), nets=nets
    )


def rl(R: float = 10.0, L: float = 2.0) -> FlatModel:
    """A current that builds up in a coil."""
    nets = [("battery.a", "resistor.a"), ("resistor.b", "coil.a"), ("coil.b", "battery.b", "ground.pin")]
    return model(Battery("battery"), Resistor("resistor", R=R), Inductor("coil", L=L), Ground("ground"), nets=nets)


def motor(tau_dry: float = 2.0, d_40: float = 0.1, thinning: float = 0.02, G: float = 5.0) -> FlatModel:
    """A motor of given torque that turns a flywheel against friction; the friction heats a body in a room."""
    parts = (
        Torque("drive"),
        Torque("load"),
        Flywheel("rotor", J=0.5),
        Friction("bearing", tau_dry=tau_dry, d_40=d_40, thinning=thinning),
        Body("body", C=500.0),
        Conductor("foot", G=G),
        Radiation("surface", A=0.3),
        Ambient("room"),
    )
    nets = [
        ("drive.shaft", "load.shaft", "rotor.shaft", "bearing.shaft"),
        ("body.heat", "bearing.heat", "foot.a", "surface.a"),
        ("room.heat", "foot.b", "surface.b"),
    ]
    return model(*parts, nets=nets)


def brake(tau_dry: float = 2.0, d_40: float = 0.1, thinning: float = 0.02, G: float = 5.0) -> FlatModel:
    """A shaft of given speed that rubs in a body; its heat goes to a room through a second body."""
    parts = (
        Speed("drive"),
        Friction("bearing", tau_dry=tau_dry, d_40=d_40, thinning=thinning),
        Body("oil", C=500.0),
        Body("wall", C=4000.0),
        Conductor("film", G=20.0),
        Conductor("foot", G=G),
        Radiation("surface", A=0.3),
        Ambient("room"),
    )
    nets = [
        ("drive.shaft", "bearing.shaft"),
        ("oil.heat", "bearing.heat", "film.a"),
        ("wall.heat", "film.b", "foot.a", "surface.a"),
        ("room.heat", "foot.b", "surface.b"),
    ]
    return model(*parts, nets=nets)


def gear(mu: float = 0.05) -> FlatModel:
    """A reducer with an implicit loss, driven at a given speed against a given torque, warming a body."""
    parts = (
        Speed("drive"),
        LossyGear("gear", ratio=3.0, mu=mu),
        Torque("load"),
        Body("body", C=800.0),
        Conductor("foot", G=4.0),
        Ambient("room"),
    )
    nets = [
        ("drive.shaft", "gear.a"),
        ("gear.b", "load.shaft"),
        ("gear.heat", "body.heat", "foot.a"),
        ("foot.b", "room.heat"),
    ]
    return model(*parts, nets=nets)
