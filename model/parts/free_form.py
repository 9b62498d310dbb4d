"""Parts that causes add to a machine: a loss or heat source of a general form, and a conductance beside another.

They describe what a gearbox may have beyond its model, not the physics of a part. All of them are neutral at zero size,
and all their exponents and thresholds are parameters, so one flat model holds every hypothesis about what is missing.
`EXTRA_PARTS` holds their types, for rigs that have them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import casadi as ca

from ..core.component import Component, Equation, equation
from ..core.declare import Output, Parameter
from ..laws.smooth import Num, smooth_abs, smooth_sign
from .ports import Flange, HeatPort, Lubricant, ShaftReading
from .thermal import HeatPath

#: How gradually thin films set in: logarithm of speed times viscosity.
FILM_STEP = 0.3
#: Parts of the reference speed: below the first a brake fades.
W_REST = 3e-4
#: Below the second a power that falls with the speed no longer does so.
W_SLOW = 0.07
#: Below the third cooling no longer changes with speed.
W_STILL = 0.2
#: Rounding of the torque's magnitude.
TAU_REST = 3e-4
#: Of the direction of power, as parts of their references.
P_REST = 1e-4


class ExtraHeat(Component):
    """A power from outside that follows speed and load of a shaft that is read, by exponents and in a regime.

    .. math:: P = P_{ref} (|w|/w_{ref})^a (|\\tau|/\\tau_{ref})^c

    `forward` and `backward` weigh it where the shaft that is read drives and is driven. Each threshold has a side:
    +1 acts above it, -1 below.
    """

    oil = HeatPort()
    inner = HeatPort()
    outer = HeatPort()
    reading = ShaftReading()

    P_ref = Parameter("W", "power at the reference point", nominal=10.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=10.0, above=0.0)
    tau_ref = Parameter("N.m", "reference torque", nominal=1000.0, above=0.0)
    a = Parameter("1", "exponent of the speed; a negative one is bounded near standstill", at_least=-3.0)
    c = Parameter("1", "exponent of the torque")
    forward = Parameter("1", "weight where the read shaft drives")
    backward = Parameter("1", "weight where it is driven")
    w_on = Parameter("rad/s", "threshold of the speed", nominal=10.0)
    w_side = Parameter("1", "side of the speed threshold")
    w_width = Parameter("rad/s", "how gradually it sets in with speed", nominal=1.0, above=0.0)
    tau_on = Parameter("N.m", "threshold of the torque", nominal=1000.0)
    tau_side = Parameter("1", "side of the torque threshold")
    tau_width = Parameter("N.m", "how gradually it sets in with torque", nominal=100.0, above=0.0)
    T_on = Parameter("K", "threshold of the oil's temperature", nominal=10.0)
    T_side = Parameter("1", "side of the temperature threshold")
    T_width = Parameter("K (difference)", "how gradually it sets in with temperature", nominal=1.0, above=0.0)
    oil_share = Parameter("1", "share of the heat that goes into the oil")
    inner_share = Parameter("1", "share that the inner body has of the rest")
    P = Output("W", "power", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """The power heats oil and bodies."""
        yield equation("power", self.P, self.power())
        yield from self.heats()

    def supplied_power(self) -> Iterable[Num]:
        """All of it comes from outside."""
        return (self.P,)

    def heats(self) -> Iterator[Equation]:
        """Where the power goes."""
        rest = (1 - self.oil_share) * self.P
        yield equation("heat to the oil", self.oil.Q_flow, -self.oil_share * self.P)
        yield equation("heat to the inner body", self.inner.Q_flow, -self.inner_share * rest)
        yield equation("heat to the outer body", self.outer.Q_flow, -(1 - self.inner_share) * rest)

    def power(self) -> Num:
        """By the form, where it acts [W]."""
        return self.P_ref * ca.exp(self.logarithm()) * self.regime()

    def speed(self, rest: float = W_REST) -> Num:
        """Logarithm of the speed over the reference, rounded below a share of it."""
        return ca.log(smooth_abs(self.reading.w / self.w_ref, rest))

    def logarithm(self) -> Num:
        """Of the form: one exponential instead of several powers."""
        speed = ca.fmax(self.a, 0.0) * self.speed() + ca.fmin(self.a, 0.0) * self.speed(W_SLOW)
        return speed + self.c * ca.log(smooth_abs(self.reading.tau / self.tau_ref, TAU_REST))

    def regime(self) -> Num:
        """Where it acts, from 0 to 1, times the weight of the direction."""
        w, tau = smooth_abs(self.reading.w, W_REST * self.w_ref), smooth_abs(self.reading.tau, TAU_REST * self.tau_ref)
        return (
            by_direction(self.reading, self.w_ref * self.tau_ref, self.forward, self.backward)
            * step(self.w_side * (w - self.w_on) / self.w_width)
            * step(self.tau_side * (tau - self.tau_on) / self.tau_width)
            * step(self.T_side * (self.oil.T - self.T_on) / self.T_width)
        )


class ExtraDryLoss(ExtraHeat):
    """The same power out of a shaft: it brakes.

    The form follows the shaft that is read, whatever the shaft that is braked turns at, so that the power at the
    reference is the same wherever it acts.
    """

    shaft = Flange(must_meet=True)

    def equations(self) -> Iterator[Equation]:
        """The power brakes the shaft; it heats oil and bodies."""
        w = self.shaft.w
        yield equation("torque", self.shaft.tau, self.power() * w / (w**2 + (W_REST * self.w_ref) ** 2))
        yield equation("power", self.P, self.shaft.tau * w)
        yield from self.heats()

    def supplied_power(self) -> Iterable[Num]:
        """None: it comes from the shaft."""
        return ()


class ExtraLoss(ExtraDryLoss):
    """The same with a factor (nu/nu_ref)^b of the viscosity; what needs thin films acts below `film_on`."""

    lubricant = Lubricant()

    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)
    b = Parameter("1", "exponent of the viscosity")
    film_on = Parameter("m2/s2", "speed times viscosity below which films are thin", nominal=1e-3, above=0.0)

    def viscosity(self) -> Num:
        """Logarithm of the viscosity over the reference."""
        return ca.log(self.lubricant.nu / self.nu_ref)

    def logarithm(self) -> Num:
        """With the viscosity."""
        return super().logarithm() + self.b * self.viscosity()

    def regime(self) -> Num:
        """With thin films."""
        film = self.speed() + self.viscosity() + ca.log(self.w_ref * self.nu_ref)
        return super().regime() * step((ca.log(self.film_on) - film) / FILM_STEP)


class ExtraHabit(ExtraLoss):
    """A loss that is none where `k` is 1, and changes sign there: power times the logarithm of k."""

    k = Parameter("1", "1 for none", above=0.0, default=1.0)

    def power(self) -> Num:
        """With the factor."""
        return super().power() * ca.log(self.k)


class ExtraConductor(HeatPath):
    """A conductance beside another: it follows powers of the temperature difference and of a shaft's speed.

    `forward` and `backward` weigh it where the shaft drives and is driven. A threshold of the temperature at a has a
    side: +1 acts above it, -1 below.
    """

    reading = ShaftReading()

    G_ref = Parameter("W/K", "conductance at the reference difference")
    dT_ref = Parameter("K (difference)", "reference difference", nominal=10.0, above=0.0)
    e = Parameter("1", "exponent of the difference in the conductance", above=-1.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=10.0, above=0.0)
    tau_ref = Parameter("N.m", "reference torque", nominal=1000.0, above=0.0)
    c = Parameter("1", "exponent of the speed")
    forward = Parameter("1", "weight where the read shaft drives")
    backward = Parameter("1", "weight where it is driven")
    T_on = Parameter("K", "threshold of the temperature at a", nominal=10.0)
    T_side = Parameter("1", "side of the temperature threshold")
    T_width = Parameter("K (difference)", "how gradually it sets in with temperature", nominal=1.0, above=0.0)
    Q_flow = Output("W", "heat flow rate from a to b", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b."""
        dT = self.a.T - self.b.T
        form = self.e * ca.log(smooth_abs(dT, 0.1) / self.dT_ref)
        speed = self.c * ca.log(smooth_abs(self.reading.w / self.w_ref, W_STILL))
        weight = by_direction(self.reading, self.w_ref * self.tau_ref, self.forward, self.backward)
        weight *= step(self.T_side * (self.a.T - self.T_on) / self.T_width)
        yield equation("conduction", self.Q_flow, self.G_ref * dT * ca.exp(form + speed) * weight)
        yield from super().equations()


class HeatMove(HeatPath):
    """Takes a share of the power that two shafts bring in more than they take out, from one body to another."""

    first = ShaftReading()

    share = Parameter("1", "share of the loss that is moved from a to b")
    Q_flow = Output("W", "heat flow rate from a to b", nominal=10.0)

    def loss(self) -> Num:
        """What the shafts lose [W]."""
        return self.first.w * self.first.tau

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b."""
        yield equation("heat moved", self.Q_flow, self.share * self.loss())
        yield from super().equations()


class HeatMoveOfTwo(HeatMove):
    """The same where power passes from one shaft to another."""

    second = ShaftReading()

    def loss(self) -> Num:
        """What both shafts lose [W]."""
        return super().loss() + self.second.w * self.second.tau


def by_direction(reading: ShaftReading, P_ref: Num, forward: Num, backward: Num) -> Num:
    """One weight where the shaft drives, another where it is driven.

    Args:
        reading: of the shaft
        P_ref: its power at the reference [W]
        forward, backward: the weights
    """
    direction = smooth_sign(reading.w * reading.tau / P_ref, P_REST)
    return forward * (1 + direction) / 2 + backward * (1 - direction) / 2


def step(x: Num) -> Num:
    """0 far below, 1 far above zero."""
    return (1 + ca.tanh(x)) / 2


#: The added types by name, as `gearheat.model.parts.PARTS` holds those of the physics.
EXTRA_PARTS: dict[str, type[Component]] = {
    part.__name__: part
    for part in (ExtraHeat, ExtraDryLoss, ExtraLoss, ExtraHabit, ExtraConductor, HeatMove, HeatMoveOfTwo)
}
