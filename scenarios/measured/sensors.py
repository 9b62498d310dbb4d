"""The sensors of a campaign: what the rig file and the card declare, completed by rule from what each reads.

Beside them a table may have columns of context: which test a reading belongs to, when and how it was taken.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ...model.core.declare import Parameter, State, list_declared
from ...model.core.flat import Quantity
from ...model.errors import DataError, Problems, suggestion
from ...model.files import tables
from ...model.parts import PARTS
from ...model.parts.lubrication import OilBath
from ...model.parts.shaft import ShaftEnd
from ...model.parts.thermal import Room
from ...model.units import spell_unit, text, to_si
from ..csv_table import Table, is_of, split_unit
from ..nuisances import DEFAULT_SD
from ..scenario import Instrument, Scenario
from ..values import deviation
from .card import Card
from .nominal import Nominal
from .table import Sensor

_TABLES = tables("scenarios.measured", "sensors.toml")
#: Columns that a table may have beside its sensors: name -> what it says, as a cell is read, its SI unit, and the least
#: and largest number in the unit of its name.
CONTEXT: Mapping[str, tuple[str, Literal["number", "count", "text"], str, float, float]] = _TABLES["context"]
#: Columns that a log may have beside its sensors.
LOGGED: Mapping[str, str] = _TABLES["logged"]
#: Words of the trade in the names of columns, in small letters, by the kind of sensor.
WORDS: Mapping[str, Sequence[str]] = _TABLES["words"]
#: First words of rows in which programs sum up those above.
SUMMARIES = frozenset(_TABLES["summaries"])
#: Directions as tables write them.
DIRECTIONS = (1, 2, -1, 0)
#: Scatter from reading to reading and fixed tolerance: in K, or relative to the value at the operating point.
ACCURACY: Mapping[str, tuple[float, float]] = _TABLES["accuracy"]
#: SI unit of what a kind of sensor reads.
SI: Mapping[str, str] = _TABLES["units"]
#: Kind of a sensor that reads no temperature, by the SI unit of what it reads.
KINDS: Mapping[str, str] = {
    "N.m": "torque",
    "rad/s": "speed",
    "W": "power",
    "A": "current",
    "m3/s": "flow",
    "m/s": "air_speed",
}
#: Beginning of a sensor's name, and the unit of its column, by the last word of the path it reads.
NAMES: Mapping[str, tuple[str, str]] = {
    "w": ("n", "rpm"),
    "tau": ("T", "Nm"),
    "T": ("T", "C"),
    "P": ("P", "W"),
    "eta": ("eta", "pct"),
    "i_q": ("I", "A"),
}


@dataclass(frozen=True)
class Cells:
    """A table, and the column of the file for each column of the context that it has."""

    table: Table
    context: Mapping[str, str]

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(self.table.lines)

    def texts(self, name: str) -> list[str]:
        """A context column of text, "" where there is none."""
        column = self.context.get(name)
        return [""] * self.n if column is None else [str(cell) for cell in self.table.columns[column]]

    def numbers(self, name: str) -> np.ndarray:
        """A context column of numbers (n,) in its own unit, NaN where there is none."""
        column = self.context.get(name)
        return np.full(self.n, np.nan) if column is None else floats(self.table.columns[column])


def floats(cells: Sequence[Any]) -> np.ndarray:
    """Cells as numbers (n,), NaN where one is wrong or empty."""
    return np.array([np.nan if cell is None else cell for cell in cells], dtype=float)


def contradictions(cells: Cells) -> list[str]:
    """Rows that belong to no test, or contradict another of theirs: another oil, or an earlier order."""
    problems: list[str] = []
    before: dict[str, tuple[int, str, float]] = {}
    if "test" not in cells.context:
        return problems
    rows = zip(cells.texts("test"), cells.texts("oil"), cells.numbers("order"), strict=True)
    for row, (test, oil, order) in enumerate(rows):
        if not test or test.rstrip(".:").casefold() in SUMMARIES:
            problems.append(
                f'{cells.table.place(row)}: {cells.context["test"]} = "{test}" is no test. Write which one the reading'
                " belongs to, or take out a row that sums up others."
            )
            continue
        first, oil_before, order_before = before.setdefault(test, (row, oil, order))
        place, line = cells.table.place(row), cells.table.lines[first]
        if oil != oil_before:
            problems.append(f"{place}: test {test} has oil {oil_before} in line {line}, here {oil}. Mend one of them.")
        if order < order_before:
            problems.append(
                f"{place}: order goes back within test {test} ({order:g} after {order_before:g}). Sort its rows."
            )
        before[test] = (first, oil_before, order)
    return problems


def order_warnings(cells: Cells) -> list[str]:
    """The first row that does not stand in running order."""
    order = cells.numbers("order")
    return [
        f"{cells.table.place(row)}: order goes back ({order[row]:g} after {order[row - 1]:g})."
        " Tests are taken in this order."
        for row in range(1, cells.n)
        if order[row] < order[row - 1]
    ][:1]


def sensors_of(scenario: Scenario, card: Card) -> tuple[Sensor, ...]:
    """All sensors that a table of the rig may have.

    Args:
        scenario: the rig
        card: columns, accuracies and sensors of the campaign

    Raises:
        DataError: all problems of the card's sensors
    """
    return _Sensors(scenario, card).complete()


class _Sensors:
    """Completes the sensors of one rig and card, collecting problems; nothing of it outlives the call."""

    def __init__(self, scenario: Scenario, card: Card) -> None:
        self.scenario, self.card = scenario, card
        self.known: Mapping[str, Quantity] = scenario.readable()
        self.nominal = Nominal(scenario)
        self.problems = Problems()
        self.found = {i.name: i for i in scenario.instruments or default_instruments(scenario)}
        self.driven, self.checked = set[str](), set[str]()

    def complete(self) -> tuple[Sensor, ...]:
        """The card's keys over the rig's, and what is left out by rule."""
        for key, table in self.card.sensors.items():
            self._declare(key, table.model_dump(exclude_unset=True))
        for key, column in self.card.columns.items():
            if key not in (*CONTEXT, *LOGGED):
                self._rename(key, column)
        for key, channel in self.card.channels.items():
            if (name := self._name(key)) is not None:
                self._accuracy(f"channels.{key}", name, channel.model_dump(include={"repeat_sd", "offset_sd"}))
                if channel.checked:
                    self.checked.add(name)
            else:
                self._refuse(f"channels.{key}", key)
        self._priors()
        self._drive()
        self._ways()
        sensors = [self._completed(instrument) for instrument in self.found.values()] if not self.problems else []
        self.problems.check(DataError)
        return tuple(sensors)

    def _priors(self) -> None:
        """Refuse prior standard deviations of what the rig does not have."""
        types = {**PARTS, **{cls.__name__: cls for cls in self.scenario.types.values()}}
        known = {f"{kind}.{key}" for kind, cls in types.items() for key in list_declared(cls, Parameter)}
        known |= {*DEFAULT_SD, *self.scenario.settable()}
        self.problems += [
            f'{self.card.name} prior_sd: there is no parameter "{name}".{suggestion(name, known)}'
            for name in self.card.prior_sd
            if name not in known
        ]

    def _drive(self) -> None:
        """What drives the model: what the card gives at the shaft ends, else the rig's protocol or drive."""
        named = [i.reads for i in self.found.values() if i.role == "given"]
        self.problems += [
            f'{self.card.name}: several sensors of {path} are given. Give all but one of them the role "read".'
            for path in dict.fromkeys(named)
            if named.count(path) > 1
        ]
        protocol = self.scenario.protocol
        inputs = self.scenario.inputs()
        self.problems += [
            f'{self.card.name} sensors.{i.name}: {i.reads} is no input, and cannot be given. Give it the role "read".'
            for i in self.found.values()
            if i.role == "given" and i.reads not in inputs
        ]
        usual = self.scenario.driven_by(protocol.inputs if protocol else ()).driven_by_torques()
        driven = usual.driven_by(named)
        self.driven = driven.driven_paths()
        shafts = self.scenario.shaft_paths()
        if len(self.driven & shafts) != len(usual.driven_paths() & shafts) or not shafts & set(named) <= self.driven:
            self.problems.append(
                f"{self.card.name}: {', '.join(named)} cannot all be given: {self.scenario.name} is driven by"
                f" {len(usual.driven_paths() & shafts)} of the speeds and torques of its shaft ends."
                ' Give some of them the role "read".'
            )

    def _ways(self) -> None:
        """Refuse sensors that are read of what drives the model, signs of what has none, and kinds of another unit."""
        given = {i.reads for i in self.found.values() if i.reads in self.driven and i.role != "read"}
        for i in self.found.values():
            if i.kind and SI[i.kind] != self.known[i.reads].unit:
                self.problems.append(
                    f'{self.card.name} sensors.{i.name}: kind = "{i.kind}", but {i.reads} is in'
                    f" {self.known[i.reads].unit}. Mend one of them."
                )
            if i.role == "read" and i.reads in self.driven - given and self.known[i.reads].unit in ("rad/s", "N.m"):
                self.problems.append(
                    f'{self.card.name} sensors.{i.name}: {i.reads} drives the model. Give it the role "given", or have'
                    " another speed or torque given in its place."
                )
            if i.signs not in (None, (1.0, 1.0)) and self.known[i.reads].unit == "K":
                self.problems.append(f"{self.card.name} sensors.{i.name}: a temperature has no signs. Take them out.")

    def _name(self, key: str) -> str | None:
        """The sensor that a key of the card means: its name, its column, or the path that it alone reads."""
        if key in self.found:
            return key
        by_column = [i.name for i in self.found.values() if key == i.column]
        by_path = [i.name for i in self.found.values() if i.reads == key]
        return next(iter(by_column), by_path[0] if len(by_path) == 1 else None)

    def _refuse(self, place: str, key: str) -> None:
        names = [*self.found, *self.known]
        close = suggestion(key, names) or f" Sensors: {', '.join(self.found)}."
        self.problems.append(f'{self.card.name} {place}: there is no sensor "{key}".{close}')

    def _declare(self, key: str, table: Mapping[str, object]) -> None:
        name = self._name(key)
        reads = str(table.get("reads", ""))
        if reads not in self.known and (reads or name is None):
            close = suggestion(reads, self.known) or f" Sensors: {', '.join(self.found)}."
            self.problems.append(f'{self.card.name} sensors.{key}: there is no "{reads}" to read.{close}')
            return
        if name is None:
            name = split_unit(key)[0]
            self.found[name] = Instrument(name, key, str(table["reads"]))
        changed = {k: v for k, v in table.items() if k not in ("repeat_sd", "offset_sd") and v is not None}
        if "signs" in changed:
            changed |= {"signs": tuple(table["signs"]), "magnitude": True}  # type: ignore[arg-type]
        self.found[name] = replace(self.found[name], **changed)  # type: ignore[arg-type]
        self._accuracy(f"sensors.{key}", name, table)

    def _rename(self, key: str, column: str) -> None:
        name = self._name(key)
        if name is None and key in self.known:  # a sensor of its own for a path of the model
            made = instrument_of(key)
            name = made.name if made.name not in self.found else key.replace(".", "_")
            self.found[name] = replace(made, name=name)
        if name is None:
            self._refuse(f"columns.{key}", key)
            return
        old = self.found[name]
        unit = old.unit or split_unit(old.column)[1]  # a column without a unit has that of the one it replaces
        own = split_unit(column)[1]
        self.found[name] = replace(old, column=column, unit=own or unit)

    def _accuracy(self, place: str, name: str, table: Mapping[str, object]) -> None:
        instrument = self.found[name]
        for key in ("repeat_sd", "offset_sd"):
            if table.get(key) is None:
                continue
            with self.problems:
                value = self._spread(str(table[key]), instrument, f"{self.card.name} {place}.{key}")
                if value < 0:
                    self.problems.append(f"{self.card.name} {place}.{key} = {table[key]} is below zero.")
                self.found[name] = replace(self.found[name], **{key: value})  # type: ignore[arg-type]

    def _spread(self, written: str, instrument: Instrument, where: str) -> float:
        """A standard deviation in SI: with its own unit, or in that of the column."""
        si = self.known[instrument.reads].unit
        try:
            number = float(written)
        except ValueError:
            return deviation(where, written, si)
        unit = self._unit(instrument)
        unit = "K" if unit in ("degC", "") and si == "K" else unit
        return deviation(where, f"{number!r} {unit}".strip(), si)

    def _unit(self, instrument: Instrument) -> str:
        return spell_unit(self.card.units.get(instrument.column, instrument.unit or split_unit(instrument.column)[1]))

    def _completed(self, instrument: Instrument) -> Sensor:
        kind, unit = instrument.kind or self._kind(instrument), self._unit(instrument)
        repeat, offset = self._default_accuracy(instrument, "power" if of_power(kind, unit) else kind)
        return Sensor(
            name=instrument.name,
            column=instrument.column,
            reads=instrument.reads,
            kind=kind,
            role=instrument.role or ("given" if self._drives(instrument) else "read"),
            unit=unit,
            repeat_sd=instrument.repeat_sd if instrument.repeat_sd is not None else repeat,
            offset_sd=instrument.offset_sd if instrument.offset_sd is not None else offset,
            checked=instrument.name in self.checked,
            signs=self._signs(instrument, kind),
        )

    def _drives(self, instrument: Instrument) -> bool:
        """Whether it is the one of its path that is given; further ones are compared with what that says."""
        same = [i for i in self.found.values() if i.reads == instrument.reads and i.role != "read"]
        return instrument.reads in self.driven and min(same, key=lambda i: i.role != "given") is instrument

    def _kind(self, instrument: Instrument) -> str:
        """What a sensor is, by what it reads."""
        unit, part = self.known[instrument.reads].unit, instrument.reads.partition(".")[0]
        if unit == "K":
            cls = self.scenario.types[part]
            return "oil_temp" if issubclass(cls, OilBath) else "ambient" if issubclass(cls, Room) else "wall_temp"
        if unit not in KINDS:
            self.problems.append(
                f"{self.card.name} sensors.{instrument.name}: {instrument.reads} is in {unit}, which no kind of sensor"
                " reads. Read a temperature, a torque, a speed, a power, a heat flow, a current, a flow of oil or water"
                " or the speed of the air."
            )
        heat = unit == "W" and instrument.reads.rpartition(".")[2].startswith("Q_flow")
        return "heat" if heat else KINDS.get(unit, "")

    def _default_accuracy(self, instrument: Instrument, kind: str) -> tuple[float, float]:
        if None not in (instrument.repeat_sd, instrument.offset_sd) or kind not in ACCURACY:
            return 0.0, 0.0
        repeat, offset = ACCURACY[kind]
        if kind.endswith("_temp") or kind == "ambient":
            return repeat, offset
        quantity = self.known[instrument.reads]
        value = abs(self.nominal.value(instrument.reads))
        full = value if value > 0 else quantity.nominal
        return _round(repeat * full, quantity.unit), _round(offset * full, quantity.unit)

    def _signs(self, instrument: Instrument, kind: str) -> tuple[float, float]:
        """Sign of the model's value where the column holds magnitudes: loads turn round with the direction."""
        driven = self.scenario.protocol.inputs.get(instrument.reads) if self.scenario.protocol else None
        if instrument.signs is not None:
            return instrument.signs
        if not instrument.magnitude and driven is not None:
            return driven.sign[0], driven.sign[1]
        if not instrument.magnitude:
            return 1.0, 1.0
        sign = -1.0 if self.nominal.value(instrument.reads) < 0 else 1.0
        return sign, -sign if kind in ("torque", "current") else sign


def of_power(kind: str, unit: str) -> bool:
    """Whether a column gives a torque by the power of its shaft end.

    Args:
        kind: of its sensor
        unit: of the column
    """
    return kind == "torque" and is_of(unit, "W")


def si_of(sensor: Sensor) -> str:
    """SI unit of what a sensor's column holds."""
    return "W" if of_power(sensor.kind, sensor.unit) else SI[sensor.kind]


def _round(value: float, unit: str) -> float:
    """A value with two digits in the unit that a person reads."""
    return to_si(text(value, unit, 2), unit)


def instrument_of(path: str) -> Instrument:
    """A sensor of a path with a name by rule: "oil.T" is read by T_oil in the column T_oil_C."""
    part, _, key = path.rpartition(".")
    if key not in NAMES:
        name = path.replace(".", "_")
        return Instrument(name, name, path)
    letter, unit = NAMES[key]
    return Instrument(f"{letter}_{part}", f"{letter}_{part}_{unit}", path)


def default_instruments(scenario: Scenario) -> tuple[Instrument, ...]:
    """Sensors of a rig whose file declares none: its shaft ends, its oil, its bodies and its rooms."""
    paths, rooms = [], []
    for name, cls in scenario.types.items():
        if issubclass(cls, Room):
            rooms.append(f"{name}.T")
        if issubclass(cls, ShaftEnd):
            paths += [f"{name}.w", f"{name}.tau"]
        elif issubclass(cls, Room) or "T" in list_declared(cls, State):
            paths.append(f"{name}.T")
    return tuple(Instrument("T_amb", "T_amb_C", path) if rooms == [path] else instrument_of(path) for path in paths)
