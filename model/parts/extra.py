"""What a gearbox may have beyond its model: a loss or heat source of a general form, and a conductance beside another.

All of them are neutral at zero size, and all their exponents and thresholds are parameters, so one flat model holds
every hypothesis about what is missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import casadi as ca

from ..core.component import Component, Equation, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.smooth import Num, smooth_abs, smooth_sign
from .ports import Flange, HeatPort, Lubricant, ShaftReading

#: Rounding of thresholds: speed [rad/s], torque [N.m], logarithm of speed times viscosity.
W_STEP, TAU_STEP, FILM_STEP = 0.5, 60.0, 0.3
#: Speed below which a brake fades [rad/s].
W_REST = 5e-3
#: Speed below which cooling no longer changes with speed [rad/s].
W_CALM = 4.0


class ExtraLoss(Component):
    """A power that follows speed, viscosity and load by exponents, in a regime; a brake or, not `braking`, a heater.

    .. math:: P = P_{ref} (|w|/w_{ref})^a (\\nu/\\nu_{ref})^b (|\\tau|/\\tau_{ref})^c

    `forward` and `backward` weigh it where the read shaft drives and is driven. Each threshold has a side: +1 acts
    above it, -1 below. What needs thin films acts where speed times viscosity is below `film_on`.
    """

    shaft = Flange()
    body = HeatPort()
    oil = HeatPort()
    lubricant = Lubricant()
    reading = ShaftReading()

    braking = Choice((True, False), "whether the power is taken from the shaft, or comes from outside", default=True)
    P_ref = Parameter("W", "power at the reference point", nominal=10.0)
    w_ref = Parameter("rad/s", "reference speed", nominal=10.0, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)
    tau_ref = Parameter("N.m", "reference torque", nominal=1000.0, above=0.0)
    a = Parameter("1", "exponent of the speed", at_least=0.0)
    b = Parameter("1", "exponent of the viscosity")
    c = Parameter("1", "exponent of the torque", at_least=0.0)
    forward = Parameter("1", "weight where the read shaft drives")
    backward = Parameter("1", "weight where it is driven")
    w_on = Parameter("rad/s", "threshold of the speed", nominal=10.0)
    w_side = Parameter("1", "side of the speed threshold")
    tau_on = Parameter("N.m", "threshold of the torque", nominal=1000.0)
    tau_side = Parameter("1", "side of the torque threshold")
    T_on = Parameter("K", "threshold of the lubricant's temperature", nominal=10.0)
    T_side = Parameter("1", "side of the temperature threshold")
    T_width = Parameter("K (difference)", "how gradually it sets in with temperature", nominal=1.0, above=0.0)
    film_on = Parameter("m2/s2", "speed times viscosity below which films are thin", nominal=1e-3, above=0.0)
    oil_share = Parameter("1", "share of the heat that goes into the oil")
    P = Output("W", "power", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """The power brakes the shaft or comes from outside; it heats oil and body."""
        w, power = self.shaft.w, self.P_ref * self._form() * self._regime()
        yield equation("torque", self.shaft.tau, power * w / (w**2 + W_REST**2) if self.braking else 0.0)
        yield equation("power", self.P, self.shaft.tau * w if self.braking else power)
        yield equation("heat to the oil", self.oil.Q_flow, -self.oil_share * self.P)
        yield equation("heat to the body", self.body.Q_flow, -(1 - self.oil_share) * self.P)

    def _form(self) -> Num:
        speed = smooth_abs(self.shaft.w, W_REST) / self.w_ref
        load = smooth_abs(self.reading.tau, 1e-2 * TAU_STEP) / self.tau_ref
        # one exponential instead of three powers; parts that share a shaft and an oil share the logarithms
        return ca.exp(self.a * ca.log(speed) + self.b * ca.log(self.lubricant.nu / self.nu_ref) + self.c * ca.log(load))

    def _regime(self) -> Num:
        weight = _by_direction(self.reading, self.forward, self.backward)
        speed = _step(self.w_side * (smooth_abs(self.shaft.w, 1e-2) - self.w_on) / W_STEP)
        load = _step(self.tau_side * (smooth_abs(self.reading.tau, 1.0) - self.tau_on) / TAU_STEP)
        warmth = _step(self.T_side * (self.lubricant.T - self.T_on) / self.T_width)
        film = _step((ca.log(self.film_on) - ca.log(smooth_abs(self.shaft.w, W_REST) * self.lubricant.nu)) / FILM_STEP)
        return weight * speed * load * warmth * film

    def supplied_power(self) -> Iterable[Num]:
        """A heater's power comes from outside."""
        return () if self.braking else (self.P,)


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
        speed = self.c * ca.log(smooth_abs(self.reading.w, W_CALM) / self.w_ref)
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
