"""Causes for logs: what may differ between machines of one type, from season to season, and since a date.

Each knob changes one parameter or one instrument by a number z. Over logs a cause is a knob that has moved: in all of
the log, from a date on, or as a drift.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ....model.machines.roles import Roles
from ....model.parts.grey import GreyLoss
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Row, Size, Theta, Values
from .entries import TABLE
from .forms import FROM_THEN, ONE_PLACE, PLACE, Course, since
from .sensors import KINDS, NAMES

#: Bounds of a move, as multiples of what is usual.
FARTHEST = 10.0


@dataclass(frozen=True)
class Knob:
    """Something that may differ between machines and years: its value z changes paths or sensors.

    Args:
        name: in words
        cause: identifier of the cause that it is where it has moved; "" of what differs only
        doc: what has happened then
        unit: of z; "1" for the logarithm of a factor
        usual: size of the cause that is usual [unit], of powers in the table as a share of the typical loss
        sd: standard deviation between machines of one type; in the same way
        season: standard deviation between seasons of one machine, where it is known [unit]
        scaled: parameters multiplied by exp(exponent z): path -> exponent
        shifted: parameters to which z is added [SI]
        sensor, gain: a sensor that shows z too much; with `gain` exp(z) times what is there
    """

    name: str
    cause: str
    doc: str
    unit: str = "1"
    usual: float = 0.3
    sd: float = 0.3
    season: float = 0.0
    scaled: Mapping[str, float] = field(default_factory=dict)
    shifted: tuple[str, ...] = ()
    sensor: str = ""
    gain: bool = False

    @property
    def paths(self) -> tuple[str, ...]:
        """Parameters it changes."""
        return (*self.scaled, *self.shifted)


#: How a knob moves over the logs.
WHENS = (
    Course("", 0.5, (), lambda theta, row: 1.0),
    Course("from one date on", 0.4, (PLACE,), since),
    Course("drifting", 0.1, (), lambda theta, row: row.order),
)


def moves(found: Sequence[Knob]) -> tuple[Cause, ...]:
    """Knobs that have moved, as causes: forms for one or all knobs of a cause, and for each course of its move."""
    causes = dict.fromkeys(knob.cause for knob in found if knob.cause)
    return tuple(_cause([knob for knob in found if knob.cause == cause]) for cause in causes)


def _cause(own: Sequence[Knob]) -> Cause:
    first = own[0]
    name, doc = ("ln_factor", "logarithm of the factor") if first.unit == "1" else ("shift", "change")
    ways: list[tuple[Sequence[Knob], float]] = [([knob], 1 / len(own)) for knob in own]
    if len(own) > 1 and first.scaled:  # one of them, or all; errors of several instruments have nothing in common
        ways = [(own, 1 - ONE_PLACE), *((one, ONE_PLACE * share) for one, share in ways)]
    forms = [_moved(moving, when, name, when.share * share) for moving, share in ways for when in WHENS]
    size = Size(name, first.unit, doc, first.usual, -FARTHEST * first.usual, FARTHEST * first.usual)
    kind, said = KINDS.get(first.cause.split(".")[1]), TABLE.get(first.cause, {})
    exposes = said.get("exposes") or (kind.calibrate if kind else "")
    like = TABLE["classes"].get(said.get("like", ""), "")
    return Cause(first.cause, first.doc, size, tuple(forms), acts_on="time", exposes=exposes, like=like)


def _moved(own: Sequence[Knob], when: Course, size: str, weight: float) -> Form:
    def values(theta: Theta, row: Row) -> Values:
        return {knob.name: theta[size] * when.at(theta, row) for knob in own}

    name = ", ".join(filter(None, (own[0].name if len(own) == 1 else "all of them", when.words)))
    return Form(name, weight, when.shapes, values=values, regime=FROM_THEN if when.shapes else {})


def knobs(roles: Roles, sensors: Sequence[Sensor], loss: float) -> tuple[Knob, ...]:
    """All knobs that a machine and the sensors of its log have; powers only where a typical loss [W] is known."""
    found = (k for row in TABLE["knobs"]["rows"] for k in _parts(roles, **row) if k.unit != "W" or loss > 0)
    parts = (replace(k, usual=loss * k.usual, sd=loss * k.sd) if k.unit == "W" else k for k in found)
    return (*_teeth(roles), *parts, *_sensors(sensors))


def _teeth(roles: Roles) -> Iterator[Knob]:
    types, mesh = roles.spec.types, "losses.mesh_friction"
    for name in roles.having("teeth"):
        told = [("friction", mesh, "More or less friction.", roles.scaled(name))]
        if issubclass(types[roles.spec.part(name).type], GreyLoss):
            told = [("loss without load", "losses.churning", "More or less loss without load.", (f"{name}.a",))]
            told.append(("loss of load", mesh, "More or less loss with load.", (f"{name}.b",)))
        for what, cause, doc, paths in told:
            yield Knob(f"{name}: {what}", cause, doc, scaled=dict.fromkeys(paths, 1.0))


def _parts(
    roles: Roles, *, what: str, cause: str, role: str = "", group: str = "", keys: Sequence[str] = (), **said: Any
) -> Iterator[Knob]:
    """Knobs of all parts of a role, of a group but for jets, or of those that declare a cause of their own.

    Args:
        roles: of the machine
        what: differs, in words
        cause: that it is where it has moved
        role, group: whose parts
        keys: parameters that are shifted where there is a unit, else multiplied; without, what the part is scaled by
        said: what else the table says
    """
    if role or group:
        names = roles.having(role) if role else [n for n in getattr(roles, group) if n not in roles.having("jet")]
        found = {name: dict.fromkeys(roles.scaled(name), 1.0) for name in names}
    else:
        found = roles.failing(cause)
    for name, paths in found.items():
        own = tuple(f"{name}.{key}" for key in keys)
        ways = {"shifted": own} if "unit" in said else {"scaled": dict.fromkeys(own, 1.0) or paths}
        yield Knob(f"{name}: {what}", cause, **ways, **said)


def _sensors(sensors: Sequence[Sensor]) -> Iterator[Knob]:
    for s in sensors:
        kind = KINDS.get(s.kind)
        if kind and kind.unit == "K":
            id = "" if s.checked else f"sensor.{s.kind}.offset"
            doc = f"The {kind.words} reads too high or too low."
            yield Knob(f"{s.name}: offset", NAMES.get(id, id), doc, "K", 2.0, 0.7, s.offset_sd / 2, sensor=s.name)
        elif kind:
            doc, (usual, sd) = f"The {kind.words} is wrong by a share of what it shows.", TABLE["gains"][s.kind]
            id = "" if s.checked else f"sensor.{s.kind}.gain"
            yield Knob(f"{s.name}: gain", id, doc, "1", usual, sd, sensor=s.name, gain=True)
            if s.kind == "torque" and s.offset_sd:
                yield Knob(f"{s.name}: zero error", "", "", s.unit, s.offset_sd, s.offset_sd, sensor=s.name)
