"""Instruments that do not show what is: one set of errors for every kind, and probes in the wrong place.

An error is a size times a factor of the row: constant, in proportion to the reading, on one side of a speed, a load or
the probe's own temperature, by direction, from a test on, moving steadily; or it is drawn anew with each mounting, or
wanders from test to test. What drives the machine was truly the reading less the error, what is compared shows the true
value plus the error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Mostly, Num, Row, Shape, Size, Theta, Values
from .entries import TABLE, entry
from .forms import COURSES, FROM_THEN, LEAST_SPAN, PLACE, Context, Course, Regime, since

THERMOMETERS = ("oil_temp", "wall_temp", "ambient")
#: Excess over a body is smaller than over the room: a probe that is drawn to a body loses this much more of it.
BODY = 3.0
#: Share of the offsets that show on one side of a speed, a load or what is read only, each.
ONE_SIDE = 0.025
#: Share of the errors of magnitudes that turn with the direction.
TURNED = 0.3

#: (size and shapes, row, the value the instrument should show) -> error of the reading over the size.
Error = Callable[[Theta, Row, Num], Num]


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


KINDS: Mapping[str, Kind] = {name: Kind(**said) for name, said in TABLE["kinds"].items()}
#: Stable identifiers that are not named as the others.
NAMES = {"sensor.ambient.offset": "sensor.ambient.bias", "sensor.torque.since": "sensor.torque.step"}


@dataclass(frozen=True)
class Mode:
    """One way to err: its factor on the size, its shapes, and what else a form says.

    `turns`: a column of magnitudes may hold the error of the signed value, too, which turns with the direction.
    """

    name: str
    weight: float
    factor: Error
    shapes: tuple[Shape, ...] = ()
    spread: str = ""
    regime: Mapping[str, str] | None = None
    turns: bool = False


def ways(mode: Mode, sensor: Sensor) -> tuple[Mode, ...]:
    """The mode, and of a column of magnitudes the same error in the signed value, which turns with the direction."""
    if not mode.turns or sensor.signs[0] == sensor.signs[1]:
        return (mode,)
    signed = replace(mode, factor=lambda theta, row, value: row.direction * mode.factor(theta, row, value))
    name = ", ".join(filter(None, (mode.name, "opposite signs")))
    return replace(mode, weight=(1 - TURNED) * mode.weight), replace(signed, name=name, weight=TURNED * mode.weight)


def causes(at: Context) -> Iterator[Cause]:
    """All errors of all kinds of instruments that there are; one that was checked may still be in the wrong place."""
    for name in dict.fromkeys(s.kind for s in at.sensors if s.kind in KINDS):
        own = [s for s in at.sensors if s.kind == name]
        doubtful = [s for s in own if not s.checked]
        if doubtful:
            yield from _Instruments(name, doubtful, at).causes()
        if name == "oil_temp":
            yield from position(at, own)
        if doubtful and name == "ambient":
            yield from heated(at, doubtful)
        yield from swapped(at, doubtful)


def wrong(sensor: Sensor, size: str, error: Error) -> Form:
    """A form in which one instrument errs: what it shows is wrong, or what drove the machine; a size by its name."""
    if sensor.role == "given":

        def truth(theta: Theta, row: Row) -> Values:
            reading = row.sensors[sensor.name]
            return {sensor.name: reading - theta[size] * error(theta, row, reading)}

        return Form(truth=truth)

    def shown(theta: Theta, row: Row, true: Values) -> Values:
        return {sensor.name: true[sensor.name] + theta[size] * error(theta, row, true[sensor.name])}

    return Form(shown=shown)


def one_of(form: Form, sensor: Sensor, own: Sequence[Sensor]) -> Form:
    """The form of one of several instruments, which share its weight; named after the instrument, but the only one."""
    name = ", ".join(filter(None, (sensor.name if len(own) > 1 else "", form.name)))
    return replace(form, name=name, weight=form.weight / len(own))


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
        return Size("error", kind.unit, doc, sd, -high if signed else 0.0, high)

    def _form(self, sensor: Sensor, mode: Mode, size: str) -> Form:
        """One mode of one instrument of the kind."""
        scale = 1.0 if size == "gain" else self.scale[sensor.name]
        form = wrong(sensor, size, lambda theta, row, value: scale * mode.factor(theta, row, value))
        form = replace(form, name=mode.name, weight=mode.weight, shapes=mode.shapes, spread=mode.spread)
        return one_of(replace(form, regime=mode.regime or {}, scale=scale), sensor, self.own)

    def cause(self, key: str, modes: Sequence[Mode], size: Size | None = None, acts_on: str = "") -> Cause:
        """A cause of this kind.

        Args:
            key: end of its identifier, and of its name in the table
            modes: its forms
            size, acts_on: where they are not those of the table
        """
        said, id = TABLE[f"sensor.*.{key}"], f"sensor.{self.name}.{key}"
        size = size or self.size(**said["size"])
        pairs = [(sensor, way) for sensor in self.own for mode in modes for way in ways(mode, sensor)]
        return Cause(
            NAMES.get(id, id),
            said["doc"].format(self.kind.words),
            size,
            tuple(self._form(sensor, way, size.name) for sensor, way in pairs),
            said.get("exposes", self.kind.calibrate),
            acts_on=acts_on or said.get("acts_on", ""),
            common=said.get("common", 1.0),
        )

    def causes(self) -> Iterator[Cause]:
        """All of them."""
        known, both_ways = self.at.ranges.known, self.at.both_ways
        sides = sided(self.at, self.own if self.kind.unit == "K" else ())
        yield self.cause("offset", [Mode("", 1 - ONE_SIDE * len(sides), _one), *sides])
        yield self.gain()
        if both_ways:
            yield self.cause("by_direction", DIRECTIONS)
        if "order" in known:
            yield self.cause("drift", DRIFTS)
            modes = [SINCE, *(replace(m, regime=FROM_THEN) for m in DIRECTED if both_ways)]
            total = sum(m.weight for m in modes)
            yield self.cause("since", [replace(m, weight=m.weight / total) for m in modes])
            yield self.cause("random_walk", WANDERING)
            if hanging := [s for s in self.own if s.role == "read" and f"still: {s.name}" in known]:
                yield self.frozen(hanging)
        if "mounting" in known:
            yield self.cause("mounting", [Mode("", 1.0, _one, spread="mounting", turns=True)])

    def gain(self) -> Cause:
        """In proportion to the reading; a thermometer's from a fixed point."""
        most, mode = self.kind.gain_most, Mode("", 1.0, lambda theta, row, value: value)
        if self.kind.unit == "K":
            fixed = Shape("fixed", "K", "temperature at which it reads right", 273.15, 303.15)
            mode = Mode("", 1.0, lambda theta, row, value: value - theta["fixed"], (fixed,))
        size = Size("gain", "1", "relative error of the reading", self.kind.gain, -most, most)
        return self.cause("gain", [mode], size, self.own[0].name)

    def frozen(self, read: Sequence[Sensor]) -> Cause:
        """A reading that no longer moves; what it keeps showing is a magnitude with its sign."""
        forms = []
        for s in read:
            low, high = (bound.get(s.name, 0.0) for bound in (self.at.ranges.low, self.at.ranges.high))
            held = Shape("held", self.kind.unit, "what it keeps showing", min(low, high - 1e-6), high)

            def hung(theta: Theta, row: Row, value: Num, name: str = s.name) -> Num:
                return since(theta, row) * (theta["held"] * (1 - 2 * (row.sensors[name] < 0)) - value)

            forms.append(replace(one_of(wrong(s, "share", hung), s, read), shapes=(PLACE, held), regime=FROM_THEN))
        known = entry("sensor.*.frozen", self.at)
        doc = known.cause.doc.format(self.kind.words)
        return known.with_forms(forms, id=f"sensor.{self.name}.frozen", doc=doc)


def position(at: Context, own: Sequence[Sensor]) -> Iterator[Cause]:
    """Oil probes that see something between the oil and the room, or the oil and a body."""
    room = next((s for s in at.sensors if s.kind == "ambient"), None)
    wall = next((s for s in at.sensors if s.kind == "wall_temp" and s.role == "read"), None)
    read, known = [s for s in own if s.role == "read"], entry("sensor.oil_temp.position", at)
    needs = {"a": at.first("speed"), "body": room and wall}

    def drawn(probe: Sensor) -> Callable[[Theta, Row, Values], Values]:
        def shown(theta: Theta, row: Row, true: Values) -> Values:
            oil, body, left = true[probe.name], theta.get("body", float(room is None)), 0.0
            if room is not None:
                left += (1 - body) * (oil - (row.sensors if room.role == "given" else true)[room.name])
            if wall is not None:
                left += BODY * body * (oil - true[wall.name])
            return {probe.name: oil - theta["share"] * at.by_speed(row, theta, "a") * left}

        return shown

    if read and (room or wall):
        shapes = tuple(shape for shape in known.shapes if needs[shape.name])
        yield known.with_forms(one_of(Form(shapes=shapes, shown=drawn(s)), s, read) for s in read)


def heated(at: Context, own: Sequence[Sensor]) -> Iterator[Cause]:
    """Room probes in the warm air of the machine."""
    known = entry("sensor.ambient.heated", at)
    forms = [(s, wrong(s, "bias", lambda theta, row, value: at.by_rise(row, theta, "e"))) for s in own]
    yield known.with_forms(replace(one_of(form, s, own), shapes=known.shapes) for s, form in forms)


def swapped(at: Context, own: Sequence[Sensor]) -> Iterator[Cause]:
    """Thermometers of one kind that are exchanged with others."""
    warm = [s for s in at.sensors if s.kind in THERMOMETERS and s.role == "read"]
    pairs = [(a, b) for i, a in enumerate(warm) for b in warm[i + 1 :] if a in own and a.reads != b.reads]

    def exchanged(a: str, b: str) -> Callable[[Theta, Row, Values], Values]:
        def shown(theta: Theta, row: Row, true: Values) -> Values:
            moved = theta["share"] * (true[b] - true[a])
            return {a: true[a] + moved, b: true[b] - moved}

        return shown

    if pairs:
        yield entry("sensor.*.swapped", at).with_forms(
            (Form(f"{a.name} with {b.name}", 1 / len(pairs), shown=exchanged(a.name, b.name)) for a, b in pairs),
            id=f"sensor.{own[0].kind}.swapped",
        )


def sided(at: Context, probes: Sequence[Sensor]) -> list[Mode]:
    """Errors on one side of a speed or a load that another instrument shows, or of what probes of one kind read."""
    shown = [(q, at.first(kind)) for q, kind in (("w", "speed"), ("tau", "torque"))]
    limits = [Regime(q, above, s) for q, s in shown if s and at.ranges.varies(s) for above in (True, False)]
    low = min((at.ranges.low.get(s.name, 0.0) for s in probes), default=0.0)
    high = max((at.ranges.high.get(s.name, 0.0) for s in probes), default=0.0)
    if high - low > LEAST_SPAN:
        limits += [Regime("T", above, span=(low, high)) for above in (True, False)]

    def mode(limit: Regime) -> Mode:
        def factor(theta: Theta, row: Row, value: Num) -> Num:
            return limit.beyond(row.sensors[limit.sensor] if limit.sensor else value, theta, at.ranges)

        return Mode(limit.name, ONE_SIDE, factor, limit.shapes(at.ranges), regime=limit.told)

    return [mode(limit) for limit in limits]


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
WANDERING = (
    Mode("", 0.5, _one, spread="walk", turns=True),
    Mode("anew in each test", 0.5, _one, spread="test", turns=True),
)
ADJUSTED = Mostly("zero", "1", "where the reading is right: 0 at the first test, 1 at the last", 0.0, 1.0)


def _drifting(course: Course) -> Mode:
    """An error that follows a course over the running order."""
    shapes = (*course.shapes, ADJUSTED)
    return Mode(course.words, course.share, lambda t, row, value: course.at(t, row) - t["zero"], shapes, turns=True)


DRIFTS = tuple(_drifting(course) for course in COURSES)
