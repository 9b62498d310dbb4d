"""Instruments that do not show what is: one set of errors for every kind of probe and transducer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..campaign.table import Sensor
from .cause import Cause, Form, Num, Ranges, Row, Shape, Size, Theta, Values
from .extra_parts import step
from .forms import GENERAL, USUAL, WIDTH
from .roles import Roles

#: How gradually something sets in with the running order, which goes from 0 to 1.
ORDER_STEP = 0.02
#: Kind -> name in words, share of the typical reading (of the rise, for thermometers) that an error usually has at
#: least, times the instrument's own tolerance, largest share; relative error of the gain, and its bound.
KINDS: Mapping[str, tuple[str, float, float, float, float, float]] = {
    "oil_temp": ("oil probe", 0.03, 4.0, 0.4, 0.03, 0.3),
    "wall_temp": ("probe on a body", 0.03, 4.0, 0.4, 0.03, 0.3),
    "ambient": ("room probe", 0.035, 5.0, 0.4, 0.03, 0.3),
    "torque": ("torque transducer", 0.0025, 2.0, 0.05, 0.003, 0.03),
    "speed": ("speed reading", 0.01, 2.0, 0.1, 0.04, 0.15),
    "power": ("power meter", 0.005, 2.0, 0.05, 0.01, 0.1),
}
#: Stable identifiers that are not named as the others.
NAMES = {"sensor.ambient.offset": "sensor.ambient.bias", "sensor.torque.since": "sensor.torque.step"}
THERMOMETERS = ("oil_temp", "wall_temp", "ambient")

#: (size and shapes, row, what the sensor shows or should show) -> error of the reading over the size.
Error = Callable[[Theta, Row, Num], Num]


def causes(roles: Roles, ranges: Ranges, sensors: Sequence[Sensor]) -> Iterator[Cause]:
    """All errors of all kinds of instruments that there are.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
    """
    for kind in dict.fromkeys(s.kind for s in sensors if s.kind in KINDS):
        yield from _Instruments(kind, [s for s in sensors if s.kind == kind], sensors, roles, ranges).causes()


@dataclass(frozen=True)
class _Mode:
    """One way of an instrument to err: a factor on the size, its shapes, and what else a form says."""

    name: str
    weight: float
    error: Error
    shapes: tuple[Shape, ...] = ()
    spread: str = ""
    regime: Mapping[str, str] | None = None


def wrong(sensor: Sensor, size: str, error: Error) -> Form:
    """A form in which one instrument errs: what it shows is wrong, or what drove the machine.

    Args:
        sensor: the instrument
        size: name of the cause's size
        error: of its reading, over the size
    """
    if sensor.role == "given":

        def truth(theta: Theta, row: Row) -> Values:
            reading = row.sensors[sensor.name]
            return {sensor.name: reading - theta[size] * error(theta, row, reading)}

        return Form(truth=truth)

    def shown(theta: Theta, row: Row, true: Values) -> Values:
        return {sensor.name: true[sensor.name] + theta[size] * error(theta, row, true[sensor.name])}

    return Form(shown=shown)


def sign(sensor: Sensor, row: Row) -> Num:
    """What the column of a magnitude does where the true value rises: +1 or -1 by direction."""
    forward, backward = sensor.signs
    return forward if forward == backward else forward * row.direction


class _Instruments:
    """All errors of one kind of instrument."""

    def __init__(
        self, kind: str, own: Sequence[Sensor], sensors: Sequence[Sensor], roles: Roles, ranges: Ranges
    ) -> None:
        self.kind, self.own, self.all, self.roles, self.ranges = kind, own, sensors, roles, ranges
        self.words, self.share, self.tolerances, self.most, self.gain, self.gain_most = KINDS[kind]
        self.both = any(s.signs[0] != s.signs[1] for s in sensors) or ranges.varies("direction")
        self.unit = {"torque": "N.m", "speed": "rad/s", "power": "W"}.get(kind, "K")

    def size(self, name: str, doc: str, share: float = 1.0, signed: bool = True) -> Size:
        """An error in the unit of the reading."""
        typical = self.ranges.rise if self.unit == "K" else max(self.ranges.mid.get(s.name, 0.0) for s in self.own)
        offset = max(s.offset_sd for s in self.own)
        typical = typical or offset / self.share
        sd = share * max(self.tolerances * offset, self.share * typical)
        high = max(self.most * typical, 8 * sd)
        return Size(name, self.unit, doc, sd, -high if signed else 0.0, high)

    def forms(self, size: str, modes: Sequence[_Mode]) -> tuple[Form, ...]:
        """Each mode for each instrument of the kind; several share the weight."""
        found = []
        for sensor in self.own:
            for mode in modes:
                name = ", ".join(part for part in (sensor.name if len(self.own) > 1 else "", mode.name) if part)

                def error(theta: Theta, row: Row, value: Num, s: Sensor = sensor, m: _Mode = mode) -> Num:
                    return sign(s, row) * m.error(theta, row, value)

                form = wrong(sensor, size, error)
                weight = mode.weight / len(self.own)
                regime = mode.regime or {}
                found.append(
                    replace(form, name=name, weight=weight, shapes=mode.shapes, spread=mode.spread, regime=regime)
                )
        return tuple(found)

    def one_side(self) -> list[_Mode]:
        """Errors above or below a speed or load that an instrument shows."""
        modes = []
        for quantity, word in (("speed", "speed"), ("torque", "load")):
            other = next((s for s in self.all if s.kind == quantity and s.role == "given"), None)
            if other is None or not self.ranges.varies(other.name):
                continue
            low, high = self.ranges.low[other.name], self.ranges.high[other.name]
            threshold = Shape("threshold", "rad/s" if word == "speed" else "N.m", f"threshold of the {word}", low, high)
            for side in (1.0, -1.0):

                def error(theta: Theta, row: Row, value: Num, o: Sensor = other, s: float = side) -> Num:
                    width = USUAL * (self.ranges.high[o.name] - self.ranges.low[o.name]) * theta["width"]
                    return step(s * (row.sensors[o.name] - theta["threshold"]) / width)

                name = "above" if side > 0 else "below"
                told = {"quantity": f"{word} {name}", "shape": "threshold"}
                modes.append(_Mode(f"{name} a {word}", 1.0, error, (threshold, WIDTH), regime=told))
        share = (1 - GENERAL) / max(len(modes), 1)
        return [replace(mode, weight=share) for mode in modes]

    def causes(self) -> Iterator[Cause]:
        """Offset, gain, and errors that change with the running order, the direction and the mounting."""
        sides = self.one_side()
        general = _Mode("", GENERAL if sides else 1.0, lambda theta, row, value: 1.0)
        zero = f"the {self.words} reads too high or too low"
        yield self._cause(
            "offset", f"Offset: {zero}.", "reading less truth", [general, *sides], exposes=CALIBRATE[self.unit]
        )
        yield self._gain()
        yield from self._over_time()
        if self.both:
            yield self._by_direction()

    def _cause(
        self,
        key: str,
        doc: str,
        size: str,
        modes: Sequence[_Mode],
        *,
        share: float = 1.0,
        signed: bool = True,
        exposes: str = "",
        acts_on: str = "",
    ) -> Cause:
        known = f"sensor.{self.kind}.{key}"
        return Cause(
            id=NAMES.get(known, known),
            doc=doc,
            size=self.size("error", size, share, signed),
            forms=self.forms("error", modes),
            exposes=exposes,
            acts_on=acts_on,
        )

    def _gain(self) -> Cause:
        """In proportion to the reading; a thermometer's from a fixed point."""
        if self.unit == "K":
            shapes: tuple[Shape, ...] = (Shape("fixed", "K", "temperature at which it reads right", 273.15, 303.15),)
            mode = _Mode("", 1.0, lambda theta, row, value: value - theta["fixed"], shapes)
            doc = f"Gain of the {self.words}."
        else:
            mode = _Mode("", 1.0, lambda theta, row, value: value)
            doc = f"Gain of the {self.words}: it is wrong by a share of what it reads."
        size = Size("gain", "1", "relative error of the reading", self.gain, -self.gain_most, self.gain_most)
        forms = tuple(
            replace(
                wrong(s, "gain", mode.error),
                name=s.name if len(self.own) > 1 else "",
                weight=1 / len(self.own),
                shapes=mode.shapes,
            )
            for s in self.own
        )
        return Cause(f"sensor.{self.kind}.gain", doc, size, forms, CALIBRATE[self.unit], acts_on=self.own[0].name)

    def _over_time(self) -> Iterator[Cause]:
        """What changes from test to test."""
        power = Shape("power", "1", "exponent of the running order", 0.5, 2.0, 1.0, 0.3)
        zero = Shape("zero", "1", "where the reading is right: 0 before the change, 1 after", 0.0, 1.0)
        moves = _Mode(
            "", 1.0, lambda theta, row, value: (row.order + 1e-9) ** theta["power"] - theta["zero"], (power, zero)
        )
        yield self._cause(
            "drift",
            f"Zero of the {self.words} that moves steadily over the campaign.",
            "zero at the last test less zero at the first",
            [moves],
            share=1.3,
            exposes=REPEAT,
            acts_on="order",
        )
        place = Shape("threshold", "1", "where in the running order: 0 first test, 1 last", 0.0, 1.0)
        told = {"quantity": "order above", "shape": "threshold"}
        jump = _Mode(
            "",
            0.7 if self.both else 1.0,
            lambda theta, row, value: since(theta, row) - theta["zero"],
            (place, zero),
            regime=told,
        )
        modes = [jump]
        for side, name in ((1, "driving"), (-1, "driven")) if self.both else ():

            def error(theta: Theta, row: Row, value: Num, s: int = side) -> Num:
                return (since(theta, row) - theta["zero"]) * (1 + s * row.direction) / 2

            modes.append(_Mode(f"{name} only", 0.15, error, (place, zero), regime=told))
        yield self._cause(
            "since",
            f"The {self.words} is wrong from one test on.",
            "error after the change less that before",
            modes,
            share=1.3,
            exposes=REPEAT,
            acts_on="order",
        )
        same = _Mode("", 1.0, lambda theta, row, value: 1.0)
        yield self._cause(
            "mounting",
            f"The {self.words} errs anew with each mounting or filling.",
            "standard deviation of the errors",
            [replace(same, spread="mounting")],
            signed=False,
            exposes="the same point in two mountings",
            acts_on="order",
        )
        yield self._cause(
            "random_walk",
            f"The error of the {self.words} wanders from test to test.",
            "standard deviation of a step",
            [replace(same, spread="walk")],
            share=0.5,
            signed=False,
            exposes=REPEAT,
            acts_on="order",
        )

    def _by_direction(self) -> Cause:
        """An error that changes with the direction of the power flow."""
        modes = [
            _Mode("opposite signs", 0.4, lambda theta, row, value: row.direction),
            _Mode("driving only", 0.3, lambda theta, row, value: (1 + row.direction) / 2),
            _Mode("driven only", 0.3, lambda theta, row, value: (1 - row.direction) / 2),
        ]
        return self._cause(
            "by_direction",
            f"The {self.words} errs with the direction of the power flow.",
            "reading less truth",
            modes,
            exposes="the halves of a test in reversed order",
            acts_on="direction",
        )


def since(theta: Theta, row: Row) -> Num:
    """0 before and 1 after a place in the running order."""
    return step((row.order - theta["threshold"]) / ORDER_STEP)


REPEAT = "the first point repeated at the end; a check of the zero before each test"
CALIBRATE = {
    "K": "all probes in one bath at two temperatures; readings at rest in a room of constant temperature",
    "N.m": "a tare with the shafts uncoupled; a calibration with a lever arm; points at small load",
    "rad/s": "a stroboscope",
    "W": "a second power meter",
}
