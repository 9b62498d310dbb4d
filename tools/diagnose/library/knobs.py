"""Causes for logs: what may differ between machines of one type, from season to season, and since a date.

Each knob changes one parameter or one instrument by a number z. Over logs a cause is a knob that has moved: in all of
the log, from a date on, or as a drift.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ....model.machines.roles import Roles
from ....model.parts.grey import GreyLoss
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Row, Size, Theta, Values
from .forms import FROM_THEN, PLACE, Course, since

#: Bounds of a move, as multiples of what is usual.
FARTHEST = 10.0


@dataclass(frozen=True)
class Knob:
    """Something that may differ between machines and years: its value z changes paths or sensors.

    Args:
        name: in words
        cause: identifier of the cause that it is where it has moved
        doc: what has happened then
        unit: of z; "1" for the logarithm of a factor
        usual: size of the cause that is usual [unit]
        sd: standard deviation between machines of one type [unit]
        scaled: parameters multiplied by exp(exponent z): path -> exponent
        shifted: parameters to which z times the factor is added [SI]: path -> factor
        sensor: a sensor that shows z too much; with `gain` exp(z) times what is there
        gain: see above
    """

    name: str
    cause: str
    doc: str
    unit: str = "1"
    usual: float = 0.3
    sd: float = 0.3
    scaled: Mapping[str, float] = field(default_factory=dict)
    shifted: Mapping[str, float] = field(default_factory=dict)
    sensor: str = ""
    gain: bool = False

    @property
    def paths(self) -> tuple[str, ...]:
        """Parameters it changes."""
        return (*self.scaled, *self.shifted)


#: Cause of a sensor's error by the sensor's kind, and in words.
OFFSETS = {
    "oil_temp": ("sensor.oil_temp.offset", "The oil probe reads too high or too low."),
    "wall_temp": ("sensor.wall_temp.offset", "The probe on a body reads too high or too low."),
    "ambient": ("sensor.ambient.bias", "The room probe reads too high or too low."),
}
GAINS = {
    "torque": ("sensor.torque.gain", "The torque reading is wrong by a share of itself.", 0.03, 0.02),
    "speed": ("sensor.speed.gain", "The speed reading is wrong by a share of itself.", 0.02, 0.003),
    "power": ("sensor.power.gain", "The power reading is wrong by a share of itself.", 0.03, 0.02),
}
#: Causes that parts declare with parameters of their own, and in words.
FLOWS = {
    "cooling.fan": "A fan moves less or more air.",
    "cooling.oil_flow": "Less or more oil circulates: a pump, a filter or a nozzle.",
}


#: How a knob moves over the logs.
WHENS = (
    Course("", 0.5, (), lambda theta, row: 1.0),
    Course("from one date on", 0.4, (PLACE,), since),
    Course("drifting", 0.1, (), lambda theta, row: row.order),
)


def moves(found: Sequence[Knob]) -> tuple[Cause, ...]:
    """Knobs that have moved, as causes: a form for each knob of a cause, and for each course of its move.

    Args:
        found: the knobs
    """
    groups: dict[str, list[Knob]] = {}
    for knob in found:
        groups.setdefault(knob.cause, []).append(knob)
    return tuple(_cause(own) for own in groups.values())


def _cause(own: Sequence[Knob]) -> Cause:
    first = own[0]
    name, doc = ("ln_factor", "logarithm of the factor") if first.unit == "1" else ("shift", "change")
    most = FARTHEST * first.usual
    forms = [_moved(knob, when, name, when.share / len(own)) for knob in own for when in WHENS]
    size = Size(name, first.unit, doc, first.usual, -most, most)
    return Cause(first.cause, first.doc, size, tuple(forms), acts_on="time")


def _moved(knob: Knob, when: Course, size: str, weight: float) -> Form:
    def values(theta: Theta, row: Row) -> Values:
        return {knob.name: theta[size] * when.at(theta, row)}

    name = ", ".join(filter(None, (knob.name, when.words)))
    return Form(name, weight, when.shapes, values=values, regime=FROM_THEN if when.shapes else {})


def knobs(roles: Roles, sensors: Sequence[Sensor]) -> tuple[Knob, ...]:
    """All knobs that the machine and its sensors have.

    Args:
        roles: of the machine
        sensors: of the log
    """
    return (*_losses(roles), *_cooling(roles), *_bodies(roles), *_sensors(sensors))


def _losses(roles: Roles) -> Iterator[Knob]:
    types = roles.spec.types
    for name in roles.having("teeth"):
        if issubclass(types[roles.spec.part(name).type], GreyLoss):
            yield _factor(
                f"{name}: loss without load", "losses.churning", "More or less loss without load.", f"{name}.a"
            )
            yield _factor(f"{name}: loss of load", "losses.mesh_friction", "More or less loss with load.", f"{name}.b")
        else:
            yield _factor(f"{name}: friction", "losses.mesh_friction", "More or less friction.", *roles.scaled(name))
    kinds = {"bearing": "losses.bearing_preload", "seal": "losses.seal_drag", "churning": "losses.churning"}
    for role, cause in kinds.items():
        for name in roles.having(role):
            yield _factor(f"{name}: loss", cause, f"A {role} that loses more or less.", *roles.scaled(name))


def _factor(name: str, cause: str, doc: str, *paths: str, usual: float = 0.3, sd: float = 0.3) -> Knob:
    return Knob(name, cause, doc, usual=usual, sd=sd, scaled=dict.fromkeys(paths, 1.0))


def _cooling(roles: Roles) -> Iterator[Knob]:
    for name in roles.having("cooler"):
        doc = "The cooler takes less heat: dirt on its air side or its oil side, a weak fan."
        yield _factor(f"{name}: conductance", "cooling.cooler", doc, *roles.scaled(name), sd=0.2)
    for name in roles.having("switch"):
        paths = {f"{name}.T_open": 1.0, f"{name}.T_close": 1.0}
        doc = "The thermostat opens at another temperature."
        yield Knob(f"{name}: set point", "cooling.thermostat", doc, "K", 3.0, 1.0, shifted=paths)
    for cause, doc in FLOWS.items():
        for name, paths in roles.failing(cause).items():
            yield Knob(f"{name}: flow", cause, doc, usual=0.5, sd=0.2, scaled=paths)
    jets = roles.having("jet")
    for name in jets:
        yield _factor(f"{name}: oil flow", "cooling.oil_wall", "Less or more oil reaches a body.", *roles.scaled(name))
    families = {
        "cooling.air": (roles.surfaces, "The air takes more or less heat."),
        "cooling.foundation": (roles.foundation, "More or less heat flows to what the machine stands in."),
        "cooling.oil_wall": (roles.oil_side, "Another heat transfer or flow between the oil and what it meets."),
        "cooling.contact": (roles.contacts, "Another conductance between bodies."),
    }
    for cause, (names, doc) in families.items():
        for name in (n for n in names if n not in jets):
            yield _factor(f"{name}: conductance", cause, doc, *roles.scaled(name), usual=0.4)


def _bodies(roles: Roles) -> Iterator[Knob]:
    for name in roles.having("bath"):
        yield _factor(
            f"{name}: level", "losses.oil_level", "More or less oil.", *roles.scaled(name), sd=0.1, usual=0.25
        )
    for name in roles.having("body"):
        doc = "A heat capacity that is not the model's."
        yield _factor(f"{name}: heat capacity", "thermal.mass", doc, *roles.scaled(name))


def _sensors(sensors: Sequence[Sensor]) -> Iterator[Knob]:
    for s in sensors:
        if s.kind in OFFSETS:
            cause, doc = OFFSETS[s.kind]
            yield Knob(f"{s.name}: offset", cause, doc, "K", 2.0, 0.7, sensor=s.name)
        elif s.kind in GAINS and s.role == "given":
            cause, doc, usual, sd = GAINS[s.kind]
            yield Knob(f"{s.name}: gain", cause, doc, "1", usual, sd, sensor=s.name, gain=True)
