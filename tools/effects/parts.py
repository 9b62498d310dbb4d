"""Fit terms: a loss or heat source of a general form, and a conductance beside another.

They describe what a gearbox may have beyond its model, not the physics of a part. All of them are neutral at zero size,
and all their exponents and thresholds are parameters, so one flat model holds every hypothesis about what is missing.
`FIT_PARTS` holds their types, for rigs that have them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import casadi as ca

from ...model.core.component import Component, Equation, equation
from ...model.core.declare import Output, Parameter
from ...model.laws.smooth import Num, smooth_abs, smooth_sign
from ...model.parts.ports import Flange, HeatPort, Lubricant, ShaftReading

#: How gradually thin films set in: logarithm of speed times viscosity.
FILM_STEP = 0.3
#: Speed below which a brake fades [rad/s].
W_REST = 5e-3
#: Rounding of the torque's magnitude [N.m].
TAU_REST = 0.6
#: A power that falls with the speed no longer does so below about that [rad/s].
W_SLOW = 1.5
#: Speed below which cooling no longer changes with speed [rad/s].
W_STILL = 4.0


class ExtraLoss(Component):
    """A power that follows speed, viscosity and load by exponents, in a regime, and brakes the shaft.

    .. math:: P = P_{ref} (|w|/w_{ref})^a (\\nu/\\nu_{ref})^b (|\\tau|/\\tau_{ref})^c

    `forward` and `backward` weigh it where the read shaft drives and is driven. Each threshold has a side: +1 acts
    above it, -1 below. What needs thin films acts where speed times viscosity is below `film_on`.
    """

    shaft = Flange(must_meet=True)
    body = HeatPort()
    oil = HeatPort()
    lubricant = Lubricant()
    reading = ShaftReading()

    P_ref = Parameter("W", "power at the reference point", nominal=10.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=10.0, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)
    tau_ref = Parameter("N.m", "reference torque", nominal=1000.0, above=0.0)
    a = Parameter("1", "exponent of the speed; a negative one is bounded near standstill", at_least=-3.0)
    b = Parameter("1", "exponent of the viscosity")
    c = Parameter("1", "exponent of the torque", at_least=0.0)
    forward = Parameter("1", "weight where the read shaft drives")
    backward = Parameter("1", "weight where it is driven")
    w_on = Parameter("rad/s", "threshold of the speed", nominal=10.0)
    w_side = Parameter("1", "side of the speed threshold")
    w_width = Parameter("rad/s", "how gradually it sets in with speed", nominal=1.0, above=0.0)
    tau_on = Parameter("N.m", "threshold of the torque", nominal=1000.0)
    tau_side = Parameter("1", "side of the torque threshold")
    tau_width = Parameter("N.m", "how gradually it sets in with torque", nominal=100.0, above=0.0)
    T_on = Parameter("K", "threshold of the lubricant's temperature", nominal=10.0)
    T_side = Parameter("1", "side of the temperature threshold")
    T_width = Parameter("K (difference)", "how gradually it sets in with temperature", nominal=1.0, above=0.0)
    film_on = Parameter("m2/s2", "speed times viscosity below which films are thin", nominal=1e-3, above=0.0)
    oil_share = Parameter("1", "share of the heat that goes into the oil")
    P = Output("W", "power", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """The power brakes the shaft; it heats oil and body."""
        w, power = self.shaft.w, self.P_ref * self._form() * self._regime()
        yield equation("torque", self.shaft.tau, power * w / (w**2 + W_REST**2))
        yield equation("power", self.P, self.shaft.tau * w)
        yield equation("heat to the oil", self.oil.Q_flow, -self.oil_share * self.P)
        yield equation("heat to the body", self.body.Q_flow, -(1 - self.oil_share) * self.P)

    def _form(self) -> Num:
        speed, slow = (ca.log(smooth_abs(self.shaft.w, rest) / self.w_ref) for rest in (W_REST, W_SLOW))
        speed = ca.fmax(self.a, 0.0) * speed + ca.fmin(self.a, 0.0) * slow
        load = smooth_abs(self.reading.tau, TAU_REST) / self.tau_ref
        # one exponential instead of three powers; parts that share a shaft and an oil share the logarithms
        return ca.exp(speed + self.b * ca.log(self.lubricant.nu / self.nu_ref) + self.c * ca.log(load))

    def _regime(self) -> Num:
        weight = _by_direction(self.reading, self.forward, self.backward)
        speed = _step(self.w_side * (smooth_abs(self.shaft.w, 1e-2) - self.w_on) / self.w_width)
        load = _step(self.tau_side * (smooth_abs(self.reading.tau, 1.0) - self.tau_on) / self.tau_width)
        warmth = _step(self.T_side * (self.lubricant.T - self.T_on) / self.T_width)
        film = _step((ca.log(self.film_on) - ca.log(smooth_abs(self.shaft.w, W_REST) * self.lubricant.nu)) / FILM_STEP)
        return weight * speed * load * warmth * film


class ExtraHeat(ExtraLoss):
    """A power of the same form that comes from outside and heats, besides oil and body, a wall and what is inside."""

    wall = HeatPort()
    inside = HeatPort()

    wall_share = Parameter("1", "share that the wall has of the heat which is not the oil's")
    inside_share = Parameter("1", "share that the inside has of what is left for it and the body")

    def equations(self) -> Iterator[Equation]:
        """The power heats oil, wall, inside and body; no shaft feels it."""
        rest = (1 - self.oil_share) * self.P
        other = (1 - self.wall_share) * rest
        yield equation("torque", self.shaft.tau, 0.0)
        yield equation("power", self.P, self.P_ref * self._form() * self._regime())
        yield equation("heat to the oil", self.oil.Q_flow, -self.oil_share * self.P)
        yield equation("heat to the wall", self.wall.Q_flow, -self.wall_share * rest)
        yield equation("heat to the inside", self.inside.Q_flow, -self.inside_share * other)
        yield equation("heat to the body", self.body.Q_flow, -(1 - self.inside_share) * other)

    def supplied_power(self) -> Iterable[Num]:
        """All of it comes from outside."""
        return (self.P,)


class ExtraConductor(Component):
    """A conductance beside another: it follows powers of the temperature difference and of a shaft's speed.

    `forward` and `backward` weigh it where the shaft drives and is driven. A threshold of the temperature at a has a
    side: +1 acts above it, -1 below.
    """

    a = HeatPort()
    b = HeatPort()
    reading = ShaftReading()

    G_ref = Parameter("W/K", "conductance at the reference difference")
    dT_ref = Parameter("K (difference)", "reference difference", nominal=10.0, above=0.0)
    e = Parameter("1", "exponent of the difference in the conductance", above=-1.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=10.0, above=0.0)
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
        speed = self.c * ca.log(smooth_abs(self.reading.w, W_STILL) / self.w_ref)
        weight = _by_direction(self.reading, self.forward, self.backward)
        weight *= _step(self.T_side * (self.a.T - self.T_on) / self.T_width)
        flow = self.G_ref * dT * ca.exp(form + speed) * weight
        yield equation("conduction", self.Q_flow, flow)
        yield equation("enters at a", self.a.Q_flow, self.Q_flow)
        yield equation("leaves at b", self.b.Q_flow, -self.Q_flow)


def _by_direction(reading: ShaftReading, forward: Num, backward: Num) -> Num:
    """One weight where the shaft drives, another where it is driven."""
    direction = smooth_sign(reading.w * reading.tau, 1.0)
    return forward * (1 + direction) / 2 + backward * (1 - direction) / 2


def _step(x: Num) -> Num:
    """0 far below, 1 far above zero."""
    return (1 + ca.tanh(x)) / 2


#: The types of fit terms by name, as `gearheat.model.parts.PARTS` holds those of the physics.
FIT_PARTS: dict[str, type[Component]] = {part.__name__: part for part in (ExtraHeat, ExtraLoss, ExtraConductor)}
