"""A fan on a shaft that blows over the housing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, equation
from ..core.declare import Output, Parameter
from ..laws.convection import V_WIDTH
from ..laws.smooth import smooth_abs
from .ports import AirPort, Flange


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
