"""Electric motors, by what they lose on the way to the shaft, and fans on a shaft that blow over the housing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, equation
from ..core.declare import Output, Parameter
from ..laws.convection import V_WIDTH
from ..laws.drum import motor_loss
from ..laws.smooth import Num, smooth_abs
from .ports import AirPort, Flange, HeatPort, ShaftReading


class Motor(Component):
    """Losses of an electric motor whose rotor is a shaft end: they come from the supply, beside the shaft's power.

    Speed and torque are read at the shaft end, whichever of them is given there. At the rated point the efficiency is
    `eta`; elsewhere it follows from a loss of the speed, which heats the stator, and one of the torque, which heats
    the windings. A motor that is driven (a loaded belt that runs down) feeds back what is left.
    """

    role: ClassVar[str] = "motor"

    shaft = ShaftReading(must_meet=True)
    windings = HeatPort()
    stator = HeatPort()

    P_N = Parameter("W", "rated power of the shaft", nominal=1000.0, above=0.0)
    w_N = Parameter("rad/s", "rated speed", nominal=100.0, above=0.0)
    eta = Parameter("1", "efficiency at the rated point", above=0.0, below=1.0)
    speed_share = Parameter("1", "share of the rated loss that depends on the speed alone", at_least=0.0, at_most=1.0)
    speed_exponent = Parameter("1", "exponent of the speed in that loss", above=0.0, at_most=3.0)
    P_electric = Output("W", "power from the supply; negative: fed back", nominal=1000.0)
    P_loss = Output("W", "loss of the motor", nominal=100.0, at_least=0.0)
    P_loss_stator = Output("W", "loss of the speed: iron, fan, friction", nominal=100.0, at_least=0.0)
    P_loss_windings = Output("W", "loss of the load: copper", nominal=100.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        """The supply gives what the shaft takes and what is lost."""
        w, tau = self.shaft.w, self.shaft.tau
        rated = (self.P_N, self.w_N, self.eta, self.speed_share, self.speed_exponent)
        stator, windings = motor_loss(w, tau, *rated)
        yield equation("loss of the speed", self.P_loss_stator, stator)
        yield equation("loss of the load", self.P_loss_windings, windings)
        yield equation("loss", self.P_loss, self.P_loss_stator + self.P_loss_windings)
        yield equation("power from the supply", self.P_electric, w * tau + self.P_loss)
        yield equation("loss of the speed heats the stator", self.stator.Q_flow, -self.P_loss_stator)
        yield equation("loss of the load heats the windings", self.windings.Q_flow, -self.P_loss_windings)

    def supplied_power(self) -> Iterable[Num]:
        """What the supply gives beside the power of the shaft."""
        return (self.P_loss,)


class ShaftFan(Component):
    """A fan on a shaft: it moves the air that cools a surface, in proportion to its speed, and heats the room.

    It stands between the room and the surface's cooling. By the affinity laws of fans the speed of the air grows with
    that of the shaft, the torque with its square; a draught of the room adds as at right angles.
    """

    role: ClassVar[str] = "fan"

    shaft = Flange(must_meet=True)
    room = AirPort("the air of the room, from which it draws")
    air = AirPort("the air over the surface that it cools")

    k_v = Parameter("m", "speed of the air over the surface at 1 rad/s, in m/s", nominal=0.02, at_least=0.0)
    k = Parameter("N.m.s2", "torque at 1 rad/s", nominal=1e-5, at_least=0.0)
    v = Output("m/s", "speed of the air over the surface", nominal=1.0)
    P_loss = Output("W", "power of the fan", nominal=10.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        """The air is moved, its heat passed on with the fan's own."""
        w = self.shaft.w
        yield equation("torque", self.shaft.tau, self.k * w * smooth_abs(w))
        yield equation("power", self.P_loss, self.shaft.tau * w)
        moved = ca.sqrt(self.room.v**2 + (self.k_v * w) ** 2 + V_WIDTH**2)
        yield equation("speed of the air", self.v, moved)
        yield equation("speed told", self.air.v, self.v)
        yield equation("temperature told", self.air.T, self.room.T)
        yield equation("pressure told", self.air.p, self.room.p)
        yield equation("radiant temperature told", self.air.T_radiant, self.room.T_radiant)
        yield equation("heat passes on", self.room.Q_flow, -self.air.Q_flow - self.P_loss)
