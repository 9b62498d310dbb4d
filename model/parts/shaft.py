"""Shafts: where speed and torque are given or read, inertia, fixed ends and loads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import ClassVar

from ..core.component import SOUND, Component, Equation, Faults, equation
from ..core.declare import Choice, Given, Input, Output, Parameter, State
from ..laws.smooth import Num, friction_sign, smooth_abs
from .ports import Flange, ShaftReading

#: Speed below which the loss torque of the gearbox fades [rad/s]: far below any speed that is read.
W_REST = 1e-5

#: Largest speed difference that counts as round-off of a closed loop [rad/s].
SLIP = 1e-6

#: What a larger one means.
OPEN_LOOP = (
    "the loop does not close: its halves turn at {w_a} and {w_b}. "
    "The product of the ratios round the loop must be 1: check the tooth counts of its gears."
)


class ShaftEnd(Component):
    """A shaft that leaves the gearbox. What `given` names ("w", "tau", "load") is an input, the rest follows.

    A load has no sign: it is taken against the rotation, in either direction, or given with it where the end `drives`.
    """

    role: ClassVar[str] = "shaft_end"

    flange = Flange(must_meet=True)
    reading = ShaftReading()

    given = Choice((), "which of w, tau and load are given from outside", default=())
    drives = Choice((), "whether power enters here where the load is given", default=False)
    w = Given("rad/s", "angular velocity", nominal=10.0)
    tau = Given("N.m", "torque into the gearbox", nominal=100.0)
    load = Given("N.m", "load, a torque without a sign", nominal=100.0, at_least=0.0)
    P = Output("W", "power into the gearbox", nominal=1000.0)

    def has(self, name: str) -> bool:
        """There is a load where it is given."""
        return name != "load" or name in self.choices["given"]

    def equations(self) -> Iterator[Equation]:
        """What enters here enters the flange's net."""
        yield equation("speed of the shaft", self.flange.w, self.w)
        yield equation("torque into the gearbox", self.flange.tau, -self.tau)
        if "load" in self.given:
            along = self.load * friction_sign(self.w)
            yield equation("load along or against the rotation", self.tau, along if self.drives else -along)
        yield equation("power", self.P, self.w * self.tau)
        yield equation("speed read", self.reading.w, self.w)
        yield equation("torque read", self.reading.tau, self.tau)

    def supplied_power(self) -> Iterable[Num]:
        """The shaft's power."""
        return (self.P,)


class FixedFlange(Component):
    """A shaft or ring held by the housing."""

    faults: ClassVar[Faults] = SOUND

    flange = Flange()

    def equations(self) -> Iterator[Equation]:
        """It does not turn, whatever the torque."""
        yield equation("held", self.flange.w, 0.0)


class FanLoad(Component):
    """A load whose torque grows with the square of the speed; its power leaves the model."""

    faults: ClassVar[Faults] = SOUND

    flange = Flange()

    k = Parameter("N.m.s2", "torque at 1 rad/s", at_least=0.0)
    P = Output("W", "power taken", nominal=1000.0)

    def equations(self) -> Iterator[Equation]:
        """Brakes in both directions."""
        w = self.flange.w
        yield equation("load torque", self.flange.tau, self.k * w * smooth_abs(w))
        yield equation("power", self.P, self.flange.tau * w)

    def supplied_power(self) -> Iterable[Num]:
        """What the load takes, counted as supply."""
        return (-self.P,)


class Inertia(Component):
    """Rotating mass, reduced to its shaft; left out (`dynamic` false) where the speed is prescribed."""

    faults: ClassVar[Faults] = SOUND

    flange = Flange()

    dynamic = Choice((True, False), "whether the speed is a state", default=True)
    w = State("rad/s", "angular velocity", nominal=10.0)
    J = Parameter("kg.m2", "moment of inertia", above=0.0)

    def has(self, name: str) -> bool:
        """Speed and inertia count where the inertia is dynamic."""
        return name not in ("w", "J") or bool(self.choices["dynamic"])

    def equations(self) -> Iterator[Equation]:
        """Torque accelerates, or passes by."""
        if not self.dynamic:
            yield equation("no inertia", self.flange.tau, 0.0)
            return
        yield equation("one speed", self.flange.w, self.w)
        yield equation("acceleration", self.J * self.der("w"), self.flange.tau)

    def stored_energy(self) -> Num:
        """Kinetic energy [J]."""
        return self.J * self.w**2 / 2 if self.dynamic else 0.0


def _slip() -> Output:
    """Speed difference of two shafts that the rest of a closed loop couples: zero where the ratios fit."""
    doc = "speed of a over that of b; zero where the ratios of the closed loop fit"
    return Output("rad/s", doc, nominal=1e-3, at_least=-SLIP, at_most=SLIP, refusal=OPEN_LOOP)


class LoadingClutch(Component):
    """Closes a mechanical loop and twists it: the torque it passes is given, its speed the loop's.

    The gears of a closed loop fix the speeds of both halves, so the clutch adds no equation for them: that the halves
    turn alike is checked. In a back-to-back rig it carries the load torque while a motor covers the losses; of two
    parallel paths it says what one of them carries.
    """

    role: ClassVar[str] = "clutch"

    a = Flange()
    b = Flange()
    reading = ShaftReading()

    tau = Input("N.m", "torque passed from a to b; positive power flows from a to b where both turn forwards", 100.0)
    slip = _slip()
    w_a = Output("rad/s", "angular velocity of half a", nominal=10.0)
    w_b = Output("rad/s", "angular velocity of half b", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """What enters one half leaves the other."""
        yield equation("torque of half a", self.a.tau, self.tau)
        yield equation("torque of half b", self.b.tau, -self.tau)
        yield equation("speed of half a", self.w_a, self.a.w)
        yield equation("speed of half b", self.w_b, self.b.w)
        yield equation("slip", self.slip, self.w_a - self.w_b)
        yield equation("speed read", self.reading.w, self.w_a)
        yield equation("torque read", self.reading.tau, self.tau)


class TurningFrame(Component):
    """A shaft as a turning carrier sees it: `relative` turns with the shaft less the carrier.

    Parts that sit on the carrier meet at `relative`: a gear pair whose wheels the carrier takes along, the bearings
    of its shafts. No power is lost: the carrier holds against the torque that the shaft brings.
    """

    faults: ClassVar[Faults] = SOUND
    axes: ClassVar[str] = "same"

    shaft = Flange()
    carrier = Flange()
    relative = Flange()

    def equations(self) -> Iterator[Equation]:
        """One torque, a difference of speeds."""
        yield equation("speed against the carrier", self.relative.w, self.shaft.w - self.carrier.w)
        yield equation("torque passes", self.relative.tau, -self.shaft.tau)
        yield equation("the carrier holds against it", self.carrier.tau, -self.shaft.tau)


class TorqueSplit(Component):
    """Where power splits into two parallel paths: a carries a given share of the torque, b the rest.

    Two rigid paths between the same shafts are statically indeterminate: the stiffness of the paths decides the
    share, and this model has none. The paths fix the speed of b, so that it turns with the others is checked.
    """

    faults: ClassVar[Faults] = SOUND

    flange = Flange()
    a = Flange()
    b = Flange()

    share = Parameter("1", "share of the torque that a carries", at_least=0.0, at_most=1.0)
    slip = _slip()
    w_a = Output("rad/s", "angular velocity of branch a", nominal=10.0)
    w_b = Output("rad/s", "angular velocity of branch b", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """One speed, two shares."""
        yield equation("one speed", self.a.w, self.flange.w)
        yield equation("share of a", self.a.tau, -self.share * self.flange.tau)
        yield equation("share of b", self.b.tau, -(1 - self.share) * self.flange.tau)
        yield equation("speed of branch a", self.w_a, self.a.w)
        yield equation("speed of branch b", self.w_b, self.b.w)
        yield equation("slip", self.slip, self.w_a - self.w_b)


class Efficiency(Component):
    """Efficiency and loss of the gearbox between two shaft ends, whichever drives.

    The loss torque follows from the powers, so no ratio has to agree with that of the gears.
    """

    faults: ClassVar[Faults] = SOUND

    a = ShaftReading()
    b = ShaftReading()

    P_width = Parameter("W", "power below which the efficiency is blurred", default=1e-3, above=0.0)
    P_loss = Output("W", "power in less power out", nominal=100.0)
    tau_loss = Output("N.m", "loss torque, on the side of a", nominal=10.0)
    eta = Output("1", "efficiency")

    def equations(self) -> Iterator[Equation]:
        """The larger of the two powers is the one that drives."""
        P_a, P_b = self.a.w * self.a.tau, self.b.w * self.b.tau
        P_in = sum(smooth_abs(P, self.P_width) for P in (P_a, P_b, self.P_loss)) / 2
        yield equation("loss", self.P_loss, P_a + P_b)
        yield equation("loss torque", self.tau_loss, self.P_loss * self.a.w / (self.a.w**2 + W_REST**2))
        yield equation("efficiency", self.eta, 1 - self.P_loss / P_in)
