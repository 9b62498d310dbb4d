"""What joins and holds shafts by friction or by spring: clutch, one-way clutch, brake, compliant shaft."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Component, Equation, Faults, equation
from ..core.declare import Input, Output, Parameter, State
from ..laws.smooth import Num, friction_sign, smooth_positive
from .friction import Friction
from .ports import Flange, HeatPort


class Coupling(Component):
    """Base of what passes a torque from shaft a to shaft b that may turn at another speed: slip becomes heat."""

    role: ClassVar[str] = "clutch"

    a = Flange(must_meet=True)
    b = Flange(must_meet=True)
    heat = HeatPort("the body that takes the heat of the slip")

    tau = Output("N.m", "torque passed from a to b", nominal=100.0)
    slip = Output("rad/s", "speed of a over that of b", nominal=10.0, guess=0.0)
    P_loss = Output("W", "power of the slip", nominal=100.0, at_least=0.0)

    def passed(self) -> Num:
        """Torque from a to b [N.m]."""
        raise AttributeError(f"{type(self).__name__} passes no torque")

    def dissipated(self) -> Num:
        """Power that becomes heat [W]: all that enters at a and does not leave at b."""
        return self.tau * self.slip

    def equations(self) -> Iterator[Equation]:
        """What enters one half leaves the other, the power of the slip as heat."""
        yield equation("slip", self.slip, self.a.w - self.b.w)
        yield equation("torque passed", self.tau, self.passed())
        yield equation("torque of half a", self.a.tau, self.tau)
        yield equation("torque of half b", self.b.tau, -self.tau)
        yield equation("power of the slip", self.P_loss, self.dissipated())
        yield equation("slip becomes heat", self.heat.Q_flow, -self.P_loss)


class FrictionClutch(Coupling):
    """Friction clutch: slips at its torque capacity and holds below it, with a creep below `w_hold`.

    Where it slips, both sides need a speed of their own: an Inertia, or a speed given.
    """

    tau_max = Input("N.m", "torque capacity; 0 where it is open", 100.0, at_least=0.0)
    w_hold = Parameter("rad/s", "slip at which the whole capacity is passed", default=0.01, above=0.0)

    def passed(self) -> Num:
        """Against the slip, up to the capacity."""
        return self.tau_max * friction_sign(self.slip, self.w_hold)


class OneWayClutch(Coupling):
    """One-way clutch: a drives b forwards; where b is faster, it overruns with a small drag."""

    faults: ClassVar[Faults] = {"losses.clutch_drag": {"tau_drag": 1.0}}

    tau_max = Parameter("N.m", "torque capacity of the locked clutch", nominal=100.0, above=0.0)
    tau_drag = Parameter("N.m", "drag torque while b overruns", at_least=0.0)
    w_hold = Parameter("rad/s", "slip at which the whole capacity is passed", default=0.01, above=0.0)

    def passed(self) -> Num:
        """Locked where a is the faster half, drag where b is."""
        share = friction_sign(self.slip, self.w_hold)
        return self.tau_drag * share + self.tau_max * smooth_positive(share, 0.01)


class Brake(Friction):
    """Brake between a shaft and the housing: its torque is given, and holds the shaft at rest."""

    role: ClassVar[str] = "brake"

    tau_max = Input("N.m", "braking torque of one brake; 0 where it is open", 100.0, at_least=0.0)

    def torque(self) -> Num:
        """The given one [N.m]."""
        return self.tau_max


class CompliantShaft(Coupling):
    """Elastic shaft or coupling: a spring between a and b, its damping heats the body."""

    phi = State("rad", "twist of a against b", nominal=1e-2)
    c = Parameter("N.m/rad", "torsional stiffness", nominal=1e4, above=0.0)
    d = Parameter("N.m.s/rad", "torsional damping", nominal=10.0, above=0.0)

    def passed(self) -> Num:
        """Spring and damper."""
        return self.c * self.phi + self.d * self.slip

    def dissipated(self) -> Num:
        """The damper's; the spring gives back what it takes."""
        return self.d * self.slip**2

    def equations(self) -> Iterator[Equation]:
        """The twist follows the slip."""
        yield from super().equations()
        yield equation("twist", self.der("phi"), self.slip)

    def stored_energy(self) -> Num:
        """Energy of the spring [J]."""
        return self.c * self.phi**2 / 2
