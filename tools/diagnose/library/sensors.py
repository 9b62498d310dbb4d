"""Instruments that do not show what is: one set of errors for every kind of probe and transducer.

An error is a size times a factor of the row: constant, in proportion to the reading, on one side of a speed, a load or
the probe's own temperature, by direction, from a test on, moving steadily; or it is drawn anew with each mounting, or
wanders from test to test. What drives the machine was truly the reading less the error, what is compared shows the true
value plus the error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ....model.parts.free_form import step
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Mostly, Num, Row, Shape, Size, Theta
from .forms import COURSES, FROM_THEN, PLACE, USUAL, WIDTH, Context, Course, since
from .probes import heated, lag, one_of, position, swapped, wrong

#: Share of the offsets that show on one side of a speed, a load or what is read only, each.
ONE_SIDE = 0.025
#: A probe's reading that varies by less has no sides [K].
LEAST_SPAN = 5.0
#: Share of the errors of magnitudes that turn with the direction.
TURNED = 0.3


@dataclass(frozen=True)
class Kind:
    """A kind of instrument.

    Args:
        words: what it is
        unit: of its errors
        tolerance: how many of the card's fixed tolerances an error usually is
        share, most: share of the typical reading (of the oil's rise, for thermometers) that an error usually is at
            least, and at most
        gain, gain_most: the same for an error of the gain
        least: what an error usually is at least, whatever is typical [unit]
        calibrate: what shows its offset and gain
    """

    words: str
    unit: str
    tolerance: float
    share: float
    most: float
    gain: float
    gain_most: float
    least: float
    calibrate: str


BATH = "all probes in one bath at two temperatures; readings at rest in a room of constant temperature"
TARE = "a tare with the shafts uncoupled; a calibration with a lever arm; points at small load"
REPEAT = "the first point repeated at the end; a check of the zero before each test"
KINDS: Mapping[str, Kind] = {
    "oil_temp": Kind("oil probe", "K", 4.0, 0.03, 0.4, 0.03, 0.3, 1.0, BATH),
    "wall_temp": Kind("probe on a body", "K", 4.0, 0.03, 0.4, 0.03, 0.3, 1.0, BATH),
    "ambient": Kind("room probe", "K", 5.0, 0.035, 0.4, 0.03, 0.3, 1.0, BATH),
    "torque": Kind("torque transducer", "N.m", 2.0, 0.003, 0.1, 0.01, 0.2, 1e-9, TARE),
    "speed": Kind("speed reading", "rad/s", 2.0, 0.01, 0.1, 0.04, 0.15, 1e-9, "a stroboscope"),
    "current": Kind("current reading", "A", 2.0, 0.005, 0.05, 0.01, 0.1, 1e-9, "a clamp meter; its zero at rest"),
    "power": Kind("power meter", "W", 2.0, 0.005, 0.05, 0.01, 0.1, 1e-9, "a second power meter"),
}
#: Stable identifiers that are not named as the others.
NAMES = {"sensor.ambient.offset": "sensor.ambient.bias", "sensor.torque.since": "sensor.torque.step"}


@dataclass(frozen=True)
class Mode:
    """One way to err: factor on the size by (theta, row, true value), its shapes, and what else a form says.

    `turns`: a column of magnitudes may hold the error of the signed value, too, which turns with the direction.
    """

    name: str
    weight: float
    factor: Callable[[Theta, Row, Num], Num]
    shapes: tuple[Shape, ...] = ()
    spread: str = ""
    regime: Mapping[str, str] | None = None
    turns: bool = False


def turned(mode: Mode) -> Mode:
    """The same error in the signed value of what a column shows as a magnitude."""
    name = ", ".join(filter(None, (mode.name, "opposite signs")))
    return replace(
        mode,
        name=name,
        weight=TURNED * mode.weight,
        factor=lambda theta, row, value: row.direction * mode.factor(theta, row, value),
    )


def causes(at: Context) -> Iterator[Cause]:
    """All errors of all kinds of instruments that there are.

    Args:
        at: machine, data and instruments
    """
    for name in dict.fromkeys(s.kind for s in at.sensors if s.kind in KINDS):
        own = [s for s in at.sensors if s.kind == name]
        yield from _Instruments(name, own, at).causes()
        if name == "oil_temp":
            yield from position(at, own)
        if name == "ambient":
            yield from heated(at, own)
        yield from swapped(at, own)
        yield from lag(at, own)


class _Instruments:
    """All errors of one kind of instrument."""

    def __init__(self, name: str, own: Sequence[Sensor], at: Context) -> None:
        self.name, self.own, self.at, self.kind = name, own, at, KINDS[name]
        typical = {s.name: at.ranges.mid.get(s.name, 0.0) for s in own}
        most = max(typical.values())
        #: Errors of several transducers of a kind are in proportion to what they read.
        self.scale = {s.name: 1.0 if self.kind.unit == "K" or not most else typical[s.name] / most for s in own}
        self.typical = at.ranges.rise if self.kind.unit == "K" else most

    def size(self, doc: str, share: float = 1.0, signed: bool = True) -> Size:
        """An error in the unit of the reading.

        Args:
            doc: in words
            share: of what it usually is
            signed: whether it may be negative; no standard deviation is
        """
        offset, kind = max(s.offset_sd / max(self.scale[s.name], 0.1) for s in self.own), self.kind
        sd = share * max(kind.tolerance * offset, kind.share * self.typical, kind.least)
        high = max(kind.most * self.typical, 8 * sd)
        larger = "" if len(set(self.scale.values())) == 1 else ", of the one that reads most, others in proportion"
        return Size("error", kind.unit, doc + larger, sd, -high if signed else 0.0, high)

    def forms(self, modes: Sequence[Mode], size: str = "error") -> tuple[Form, ...]:
        """Each mode of each instrument of the kind; instruments share the weight."""
        found = []
        for sensor in self.own:
            for mode in modes:
                if mode.turns and sensor.signs[0] != sensor.signs[1]:
                    found += [self._form(sensor, replace(mode, weight=(1 - TURNED) * mode.weight), size)]
                    found += [self._form(sensor, turned(mode), size)]
                else:
                    found.append(self._form(sensor, mode, size))
        return tuple(found)

    def _form(self, sensor: Sensor, mode: Mode, size: str) -> Form:
        scale = 1.0 if size == "gain" else self.scale[sensor.name]
        form = wrong(sensor, size, lambda theta, row, value: scale * mode.factor(theta, row, value))
        name = ", ".join(filter(None, (sensor.name if len(self.own) > 1 else "", mode.name)))
        weight, regime = mode.weight / len(self.own), mode.regime or {}
        return replace(form, name=name, weight=weight, shapes=mode.shapes, spread=mode.spread, regime=regime)

    def cause(
        self,
        key: str,
        doc: str,
        size: Size,
        modes: Sequence[Mode],
        exposes: str,
        acts_on: str = "",
    ) -> Cause:
        """A cause of this kind: `key` ends its identifier, `modes` are its forms, the others those of `Cause`.

        One that is no constant error is met half as often.
        """
        common = 1.0 if key in CONSTANT else 0.5
        known = f"sensor.{self.name}.{key}"
        forms = self.forms(modes, size.name)
        return Cause(NAMES.get(known, known), doc, size, forms, exposes, acts_on=acts_on, common=common)

    def causes(self) -> Iterator[Cause]:
        """All of them."""
        words, known = self.kind.words, self.at.ranges.known
        sides = [*one_side(self.at), *(warm_or_cold(self.at, self.own) if self.kind.unit == "K" else [])]
        general = Mode("", 1 - ONE_SIDE * len(sides), _one)
        doc = f"Offset: the {words} reads too high or too low."
        yield self.cause("offset", doc, self.size("reading less truth"), [general, *sides], self.kind.calibrate)
        yield self.gain()
        if self.at.both_ways:
            doc = f"The {words} errs with the direction of the power flow."
            yield self.cause("by_direction", doc, self.size("reading less truth"), DIRECTIONS, HALVES)
        if "order" in known:
            yield from self.over_time()
        if "mounting" in known:
            doc, size = f"The {words} errs anew with each mounting or filling.", "standard deviation of the errors"
            mode = Mode("", 1.0, _one, spread="mounting", turns=True)
            yield self.cause("mounting", doc, self.size(size, signed=False), [mode], MOUNTINGS, "order")

    def gain(self) -> Cause:
        """In proportion to the reading; a thermometer's from a fixed point."""
        words, most = self.kind.words, self.kind.gain_most
        mode = Mode("", 1.0, lambda theta, row, value: value)
        if self.kind.unit == "K":
            fixed = Shape("fixed", "K", "temperature at which it reads right", 273.15, 303.15)
            mode = Mode("", 1.0, lambda theta, row, value: value - theta["fixed"], (fixed,))
        size = Size("gain", "1", "relative error of the reading", self.kind.gain, -most, most)
        return self.cause("gain", f"Gain of the {words}.", size, [mode], self.kind.calibrate, self.own[0].name)

    def over_time(self) -> Iterator[Cause]:
        """What changes with the running order."""
        words = self.kind.words
        size = self.size("error at the last test less that at the first", 1.3)
        yield self.cause(
            "drift", f"Zero of the {words} that moves steadily over the campaign.", size, DRIFTS, REPEAT, "order"
        )
        size = self.size("error after the change less that before", 1.3)
        modes = [SINCE, *(replace(m, regime=FROM_THEN) for m in DIRECTED if self.at.both_ways)]
        total = sum(m.weight for m in modes)
        modes = [replace(m, weight=m.weight / total) for m in modes]
        yield self.cause("since", f"The {words} is wrong from one test on.", size, modes, REPEAT, "order")
        size = self.size("standard deviation of a step", 0.5, signed=False)
        mode = Mode("", 1.0, _one, spread="walk", turns=True)
        doc = f"The error of the {words} wanders from test to test."
        yield self.cause("random_walk", doc, size, [mode], REPEAT, "order")
        if hanging := [s for s in self.own if s.role == "read" and f"still: {s.name}" in self.at.ranges.known]:
            yield self.frozen(hanging)

    def frozen(self, read: Sequence[Sensor]) -> Cause:
        """A reading that no longer moves."""
        ranges = self.at.ranges
        forms = []
        for s in read:
            low, high = (bound.get(s.name, 0.0) for bound in (ranges.low, ranges.high))
            held = Shape("held", self.kind.unit, "what it keeps showing", min(low, high - 1e-6), high)
            form = wrong(s, "share", lambda theta, row, value: since(theta, row) * (theta["held"] - value))
            forms.append(
                replace(form, name=one_of(s, read), weight=1 / len(read), shapes=(PLACE, held), regime=FROM_THEN)
            )
        size = Size("share", "1", "1 where it does not follow at all", 0.6, 0.0, 1.0)
        doc = f"The {self.kind.words} hangs: from one test on it shows the same whatever happens."
        return Cause(f"sensor.{self.name}.frozen", doc, size, tuple(forms), REPEAT, acts_on="order", common=0.2)


def one_side(at: Context) -> list[Mode]:
    """Errors above or below a speed or load that an instrument shows.

    Args:
        at: what they are made for
    """
    modes = []
    for quantity, word in (("speed", "speed"), ("torque", "load")):
        other = at.first(quantity)
        if other and at.ranges.varies(other):
            modes += _sides(word, KINDS[quantity].unit, at.ranges.low[other], at.ranges.high[other], other)
    return modes


def warm_or_cold(at: Context, own: Sequence[Sensor]) -> list[Mode]:
    """Errors of probes above or below a temperature of what they measure.

    Args:
        at: what they are made for
        own: the probes of one kind
    """
    low, high = (f(bound.get(s.name, 0.0) for s in own) for f, bound in ((min, at.ranges.low), (max, at.ranges.high)))
    return _sides("temperature", "K", low, high) if high - low > LEAST_SPAN else []


def _sides(word: str, unit: str, low: float, high: float, other: str = "") -> list[Mode]:
    """Both sides of what another sensor shows, or of the value itself."""
    threshold, width = Shape("threshold", unit, f"threshold of the {word}", low, high), USUAL * (high - low)

    def mode(side: float, name: str) -> Mode:
        def factor(theta: Theta, row: Row, value: Num) -> Num:
            seen = row.sensors[other] if other else value
            return step(side * (seen - theta["threshold"]) / (width * theta["width"]))

        told = {"quantity": f"{word} {name}", "shape": "threshold"}
        return Mode(f"{name} a {word}", ONE_SIDE, factor, (threshold, WIDTH), regime=told)

    return [mode(1.0, "above"), mode(-1.0, "below")]


def _one(theta: Theta, row: Row, value: Num) -> Num:
    """The same in every row."""
    return 1.0


def _changed(theta: Theta, row: Row, value: Num) -> Num:
    """By a change at one test, of which part lies before it."""
    return since(theta, row) - theta["zero"]


ZERO = Mostly("zero", "1", "where the reading is right: 0 before the change, 1 after", 0.0, 1.0)
SINCE = Mode("", 0.7, _changed, (PLACE, ZERO), regime=FROM_THEN, turns=True)
#: The same in one direction of the power flow only.
DIRECTED = (
    Mode("driving only", 0.15, lambda t, row, value: _changed(t, row, value) * (1 + row.direction) / 2, (PLACE, ZERO)),
    Mode("driven only", 0.15, lambda t, row, value: _changed(t, row, value) * (1 - row.direction) / 2, (PLACE, ZERO)),
)
DIRECTIONS = (
    Mode("opposite signs", 0.4, lambda theta, row, value: row.direction),
    Mode("driving only", 0.3, lambda theta, row, value: (1 + row.direction) / 2),
    Mode("driven only", 0.3, lambda theta, row, value: (1 - row.direction) / 2),
)
ADJUSTED = Mostly("zero", "1", "where the reading is right: 0 at the first test, 1 at the last", 0.0, 1.0)


def _drifting(course: Course) -> Mode:
    """An error that follows a course over the running order."""
    shapes = (*course.shapes, ADJUSTED)
    return Mode(course.words, course.share, lambda t, row, value: course.at(t, row) - t["zero"], shapes, turns=True)


DRIFTS = tuple(_drifting(course) for course in COURSES)
#: Errors of an instrument that are met as a rule.
CONSTANT = ("offset", "gain")
HALVES = "the halves of a test in reversed order"
MOUNTINGS = "the same point in two mountings or with two fillings"
