"""Grey boxes: losses, oil flows and coolers of machines whose geometry is not known, with parameters to calibrate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Choice, Output, Parameter, State
from ..laws.smooth import Num, smooth_abs
from .friction import Friction
from .ports import COLDEST, HOTTEST, HeatPort, Lubricant, Opening, ShaftReading
from .relations import require
from .thermal import Conductor

#: Width of the torque [N.m] over which the corner of its magnitude is rounded.
TAU_WIDTH = 1.0


class GreyLoss(Friction):
    """A loss a n + b P: one share follows speed and viscosity, the other is a share of the power passed on."""

    reading = ShaftReading(must_meet=True)
    lubricant = Lubricant()

    a = Parameter("W", "loss without load at the reference speed and viscosity", nominal=1000.0, at_least=0.0)
    b = Parameter("1", "share of the power at the read shaft that is lost", nominal=0.01, at_least=0.0)
    m = Parameter("1", "exponent of the speed in the loss without load", above=0.0, at_most=3.0)
    e = Parameter("1", "exponent of the viscosity in the loss without load", at_least=0.0, at_most=1.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=100.0, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)

    def torque(self) -> Num:
        """Both shares, as torques."""
        speed = smooth_abs(self.shaft.w, 0.01 * self.w_ref) / self.w_ref
        idle = self.a / self.w_ref * speed ** (self.m - 1) * (self.lubricant.nu / self.nu_ref) ** self.e
        return idle + self.b * smooth_abs(self.reading.tau, TAU_WIDTH)


class GreyTeeth(GreyLoss):
    """Losses of all meshes and of what they stir."""

    role: ClassVar[str] = "teeth"


class GreyBearing(GreyLoss):
    """Losses of a bearing."""

    role: ClassVar[str] = "bearing"


class FlowConductor(Conductor):
    """Oil that a pump on a shaft moves between two places: its capacity flow, which cold oil throttles."""

    scale: ClassVar[tuple[str, ...]] = ("G_rest", "G_ref")

    reading = ShaftReading(must_meet=True)
    lubricant = Lubricant()

    G_rest = Parameter("W/K", "conductance at rest", at_least=0.0)
    G_ref = Parameter("W/K", "what the reference speed adds to it", nominal=1000.0, at_least=0.0)
    e = Parameter("1", "exponent of the viscosity by which the added conductance falls", at_least=0.0, at_most=1.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=100.0, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)

    def conductance(self) -> Num:
        """In proportion to the speed."""
        speed = smooth_abs(self.reading.w, 0.01 * self.w_ref) / self.w_ref
        return self.G_rest + self.G_ref * speed * (self.lubricant.nu / self.nu_ref) ** -self.e


class Thermostat(Component):
    """Opens a cooler where what it senses is warm: fully above T_open, not at all below T_close.

    As a relay it stays as it is between the two: its threshold is a state, which falls to T_close when it opens and
    rises to T_open when it closes. Such a machine may have no steady state, as it switches for ever; otherwise the
    opening rises smoothly between the two, which is what a relay does in the mean.
    """

    role: ClassVar[str] = "switch"

    sensed = HeatPort()
    opening = Opening()

    relay = Choice((True, False), "whether it switches, with a threshold of its own", default=False)
    T_switch = State("K", "threshold that is in force", nominal=10.0, at_least=COLDEST, at_most=HOTTEST, start=333.15)
    T_open = Parameter("K", "temperature above which it is open", nominal=10.0, above=0.0)
    T_close = Parameter("K", "temperature below which it is closed", nominal=10.0, above=0.0)
    T_width = Parameter("K (difference)", "how gradually a relay switches", nominal=1.0, above=0.0)
    t_switch = Parameter("s", "time in which a relay's threshold changes", nominal=100.0, above=0.0)

    def has(self, name: str) -> bool:
        """A relay has a threshold of its own, and times."""
        return bool(self.choices["relay"]) or name not in ("T_switch", "T_width", "t_switch")

    def relations(self) -> Iterator[Related]:
        """It opens above where it closes."""
        yield require(self, "T_open is above T_close", self.T_open - self.T_close, 0.01)

    def equations(self) -> Iterator[Equation]:
        """A rounded relay with hysteresis, or a smooth rise."""
        share, span, T = self.opening.share, self.T_open - self.T_close, self.sensed.T
        yield equation("it is sensed, not heated", self.sensed.Q_flow, 0.0)
        if not self.relay:
            yield equation("opening", share, (1 + ca.tanh(4 * (T - self.T_close) / span - 2)) / 2)
            return
        yield equation("opening", share, (1 + ca.tanh((T - self.T_switch) / self.T_width)) / 2)
        threshold = self.T_open - span * share
        yield equation("threshold in force", self.t_switch * self.der("T_switch"), threshold - self.T_switch)


class Cooler(Conductor):
    """A cooler whose fan or valve a thermostat opens; its fan runs only where the read shaft turns."""

    role: ClassVar[str] = "cooler"
    scale: ClassVar[tuple[str, ...]] = ("G_open",)

    opening = Opening()
    reading = ShaftReading(must_meet=True)

    G_closed = Parameter("W/K", "conductance while closed", at_least=0.0)
    G_open = Parameter("W/K", "what opening adds to it", nominal=1000.0, at_least=0.0)
    w_on = Parameter("rad/s", "speed above which it works", nominal=10.0, above=0.0)
    share = Output("1", "how far it is open")

    def conductance(self) -> Num:
        """Between closed and open."""
        turning = self.reading.w**2 / (self.reading.w**2 + self.w_on**2)
        return self.G_closed + self.G_open * self.opening.share * turning

    def equations(self) -> Iterator[Equation]:
        """A conductor that shows how far it is open."""
        yield from super().equations()
        yield equation("opening", self.share, self.opening.share)


class OilJet(Component):
    """Oil from a line that cools a body and runs off into the sump: the body feels the line, the sump gets the heat."""

    role: ClassVar[str] = "jet"
    scale: ClassVar[tuple[str, ...]] = ("G_ref",)

    body = HeatPort()
    line = HeatPort()
    sump = HeatPort()
    reading = ShaftReading(must_meet=True)
    lubricant = Lubricant()

    G_ref = Parameter("W/K", "capacity flow of the jet at the reference speed", nominal=100.0, at_least=0.0)
    e = Parameter("1", "exponent of the viscosity by which it falls", at_least=0.0, at_most=1.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=100.0, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)
    Q_flow = Output("W", "heat flow rate from the body to the sump", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """What leaves the body arrives in the sump."""
        speed = smooth_abs(self.reading.w, 0.01 * self.w_ref) / self.w_ref
        G = self.G_ref * speed * (self.lubricant.nu / self.nu_ref) ** -self.e
        yield equation("heat taken", self.Q_flow, G * (self.body.T - self.line.T))
        yield equation("leaves the body", self.body.Q_flow, self.Q_flow)
        yield equation("arrives in the sump", self.sump.Q_flow, -self.Q_flow)
        yield equation("the line is sensed", self.line.Q_flow, 0.0)
