"""Whatever brakes a shaft: its power becomes heat in the two bodies it rubs between."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Component, Equation, equation
from ..core.declare import Output, Parameter
from ..laws.smooth import Num, friction_sign
from .ports import Flange, HeatPort


class Friction(Component):
    """Base of bearings, seals and churning: a torque against the rotation, its heat shared by two bodies."""

    scale: ClassVar[tuple[str, ...]] = ("k_loss",)

    shaft = Flange(must_meet=True)
    inner = HeatPort()
    outer = HeatPort()

    count = Parameter("1", "number of equal pieces", above=0.0, whole=True)
    k_loss = Parameter("1", "factor on the friction torque, 1 for the law as it is", default=1.0, at_least=0.0)
    inner_share = Parameter("1", "share of the heat that goes to the inner body", at_least=0.0, at_most=1.0)
    tau_loss = Output("N.m", "friction torque of all pieces", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss = Output("W", "friction power of all pieces", nominal=100.0, at_least=0.0)

    def torque(self) -> Num:
        """Friction torque of one piece [N.m], not negative."""
        raise AttributeError(f"{type(self).__name__} has no friction torque")

    def equations(self) -> Iterator[Equation]:
        """All friction becomes heat."""
        w = self.shaft.w
        yield equation("friction torque", self.tau_loss, self.count * self.k_loss * self.torque())
        yield equation("friction opposes rotation", self.shaft.tau, self.tau_loss * friction_sign(w))
        yield equation("friction power", self.P_loss, self.shaft.tau * w)
        yield equation("heat to the inner body", self.inner.Q_flow, -self.inner_share * self.P_loss)
        yield equation("heat to the outer body", self.outer.Q_flow, -(1 - self.inner_share) * self.P_loss)
