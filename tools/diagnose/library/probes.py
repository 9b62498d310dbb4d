"""Probes that stand where they should not, or are exchanged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Num, Row, Theta, Values
from .entries import entry
from .forms import Context

THERMOMETERS = ("oil_temp", "wall_temp", "ambient")
#: Excess over a body is smaller than over the room: a probe that is drawn to a body loses this much more of it.
BODY = 3.0

#: (size and shapes, row, the value the instrument should show) -> error of the reading over the size.
Error = Callable[[Theta, Row, Num], Num]


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


def one_of(sensor: Sensor, own: Sequence[Sensor]) -> str:
    """Name of a form for one of several instruments, "" for the only one."""
    return sensor.name if len(own) > 1 else ""


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
        yield known.with_forms(Form(one_of(s, read), 1 / len(read), shapes, shown=drawn(s)) for s in read)


def heated(at: Context, own: Sequence[Sensor]) -> Iterator[Cause]:
    """Room probes in the warm air of the machine."""
    known = entry("sensor.ambient.heated", at)
    forms = [(s, wrong(s, "bias", lambda theta, row, value: at.by_rise(row, theta, "e"))) for s in own]
    yield known.with_forms(
        replace(form, name=one_of(s, own), weight=1 / len(own), shapes=known.shapes) for s, form in forms
    )


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
