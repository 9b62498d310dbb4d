"""Which column of a table is which sensor, where no card says it: by words of the trade, units and signs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...model.errors import DataError, Problems, suggestion
from ...model.files import tables
from ...model.parts.shaft import ShaftEnd
from ..csv_cells import numbers
from ..csv_table import bare_name, is_of, read_cells, scale, split_unit
from ..scenario import Scenario
from .card import Card, CardSensor
from .nominal import Nominal
from .sensors import CONTEXT, SI, WORDS, default_instruments, sensors_of
from .table import Sensor

_TABLES = tables("scenarios.measured", "sensors.toml")
ENDS: Mapping[str, Sequence[str]] = _TABLES["ends"]
#: Words of what sits in a housing and is none: "Lagergehäuse", "bearing housing".
SEATS: Sequence[str] = _TABLES["seats"]["words"]
OTHER: Mapping[str, Sequence[str]] = _TABLES["other"]
#: Units of columns without one, by the SI unit of what they hold.
USUAL: Mapping[str, str] = {"K": "degC", "rad/s": "rpm", "N.m": "N.m", "W": "W", "A": "A", "1": "1"}
#: Mark of a column that is named as a sensor's.
SAME = 100
#: Mark of a column that has the name of a sensor's part.
PART = 8
#: Mark of a column that has a word of a sensor's kind.
KIND = 4
#: Mark of a column that has a word of a sensor's end.
END = 2
#: A torque that is so many times that of the operating point, or so small a part, rather is one of another shaft.
FAR = 5.0
#: Letters of a word that must stand alone.
SHORT = 3
#: Share of the largest reading that noise at rest stays within.
REST = 0.05


@dataclass(frozen=True)
class Known:
    """What a user says of a table.

    Args:
        columns: sensor, path or column of the context -> column of the table, "" where it has none
        units: column -> its unit
        magnitudes: sensor -> whether its column holds magnitudes
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    magnitudes: Mapping[str, bool] = field(default_factory=dict)


def guess_card(path: Path, scenario: Scenario, said: Known) -> Card:
    """A card with the columns of a table, their units, and which of them hold magnitudes.

    Args:
        path: CSV file
        scenario: the rig
        said: what is known

    Raises:
        DataError: the table cannot be read at all, or a known name means no sensor or column
    """
    header, rows = read_cells(path)
    cells = {name: [row[k] for _, row in rows] for k, name in enumerate(header)}
    columns = said.columns
    problems = Problems(
        f'{path.name}: there is no column "{column}".{suggestion(column, header, bare_name)}'
        for column in (*columns.values(), *said.units)
        if column and column not in header
    )
    problems.check(DataError)
    known = {name: column for name, column in columns.items() if column}
    known |= _context({name: column for name, column in cells.items() if name not in known.values()}, columns)
    wanted = wanted_sensors(scenario)
    nominal = Nominal(scenario)

    def is_far(column: str, sensor: Sensor) -> bool:
        """Whether a torque is far from the operating point's, which tells one end from the other."""
        if sensor.kind != "torque":
            return False
        read = numbers([cell for cell in cells[column] if cell])
        if read is None or not read.any():
            return False
        factor = scale(said.units.get(column) or split_unit(column)[1] or USUAL["N.m"], "N.m", name=column)[0]
        return bool(abs(np.log(factor * np.abs(read).max() / abs(nominal.value(sensor.reads)))) > np.log(FAR))

    _match(known, wanted, header, scenario, is_far)
    if any(s.kind == "torque" and s.role == "given" and name not in known for name, s in wanted.items()):
        powers = [h for h in header if is_of(said.units.get(h, split_unit(h)[1]), "W")]
        _match(known, _by_power(wanted, scenario), powers, scenario, is_far)
    known = {name: column for name, column in known.items() if columns.get(name) != ""}
    units = _units(known, wanted) | dict(said.units)
    card = Card(columns=known, units=units, sensors=_driving(known, wanted), name=path.name)
    return _turned(card, scenario, cells, said.magnitudes)


def wanted_sensors(scenario: Scenario) -> dict[str, Sensor]:
    """Sensors by their names, and by their paths those that the rig does not declare.

    Args:
        scenario: the rig
    """
    declared = {s.name: s for s in sensors_of(scenario, Card())}
    read = {s.reads for s in declared.values()}
    more = Card(columns={i.reads: i.column for i in default_instruments(scenario) if i.reads not in read})
    return declared | {s.reads: s for s in sensors_of(scenario, more) if s.reads in more.columns}


def _context(cells: Mapping[str, Sequence[str]], columns: Mapping[str, str]) -> dict[str, str]:
    """Columns of the context by whole words; an oil has a name, a point a number, and what has none names a test."""
    stems = {h: split_unit(h)[0].casefold() for h in cells}
    found = {}
    for name in (n for n in CONTEXT if n not in columns):
        words = (name.casefold(), split_unit(name)[0].casefold(), *OTHER.get(name, ()))
        meant = [h for h, stem in stems.items() if stem in words or h.casefold() in words]
        if meant and not (name == "oil" and numbers(cells[meant[0]]) is not None):
            found[name] = meant[0]
    if "point" in found and numbers(cells[found["point"]]) is None:
        column = found.pop("point")
        found |= {} if "test" in {*found, *columns} else {"test": column}
    return found


def _match(
    known: dict[str, str],
    wanted: Mapping[str, Sensor],
    header: Sequence[str],
    scenario: Scenario,
    is_far: Callable[[str, Sensor], bool],
) -> None:
    """Adds to what is known the columns that fit the wanted sensors, the best ones first."""
    marks = [
        ((mark, not is_far(column, sensor), -place), name, column)
        for place, (name, sensor) in enumerate(wanted.items())
        for column in header
        if name not in known and column not in known.values()
        if (mark := _mark(column, sensor, scenario, wanted)) > 0
    ]
    for _, name, column in sorted(marks, key=lambda mark: mark[0], reverse=True):
        if name not in known and column not in known.values():
            known[name] = column


def _by_power(wanted: Mapping[str, Sensor], scenario: Scenario) -> dict[str, Sensor]:
    """Torques whose place a power may take: first where power enters, whose name plate says it."""
    found = {n: replace(s, kind="power", role="given") for n, s in wanted.items() if s.kind == "torque"}
    ends = {n: _end(scenario, s.reads.partition(".")[0]) for n, s in found.items()}
    return {n: found[n] for n in sorted(found, key=lambda n: ends[n] != "input")}


def _mark(column: str, sensor: Sensor, scenario: Scenario, wanted: Mapping[str, Sensor]) -> int:
    """How well a column fits a sensor, 0 where it does not."""
    stem, unit = split_unit(column)
    if column == sensor.column or stem == split_unit(sensor.column)[0]:
        return SAME
    if unit and not _fits(unit, sensor):
        return 0
    low, part = stem.casefold(), sensor.reads.partition(".")[0]
    kind = _speaks(low, sensor.kind)
    if sensor.kind == "wall_temp":  # of all bodies only the housing is called so
        own = f"{sensor.name} {part}".casefold()
        kind = kind and _speaks(own, sensor.kind) and not any(word in low and word not in own for word in SEATS)
    mark = KIND * kind + PART * (part in low)
    if part in scenario.spec.of_type(ShaftEnd.__name__):
        words_alone = set(re.findall(r"[^\W\d_]+|\d+", re.sub(r"\sin\s\S+$", "", low)))  # "torque in Nm"
        said = {
            end for end, words in ENDS.items() if any(w in low if len(w) > SHORT else w in words_alone for w in words)
        }
        if not (kind or unit) or (said and _end(scenario, part) not in said):
            return 0
        mark += END if said else 0
    alone = sum(other.kind == sensor.kind for other in wanted.values()) == 1
    return mark + (1 if unit and (mark or sensor.role == "given" or alone) and SI[sensor.kind] != "K" else 0)


def _speaks(low: str, kind: str) -> bool:
    """Whether a name in small letters has a word of a kind of sensor."""
    return any(word in low for word in WORDS.get(kind, ()))


def _fits(unit: str, sensor: Sensor) -> bool:
    return is_of(unit, SI[sensor.kind])


def _end(scenario: Scenario, part: str) -> str:
    """Whether power enters at a shaft end at the operating point."""
    if scenario.drives:
        return "input" if part == scenario.drives else "output"
    nominal = Nominal(scenario)
    return "input" if nominal.value(f"{part}.w") * nominal.value(f"{part}.tau") > 0 else "output"


def _units(known: Mapping[str, str], wanted: Mapping[str, Sensor]) -> dict[str, str]:
    """Units of columns whose names have none."""
    bare = {name: column for name, column in known.items() if name in wanted and not split_unit(column)[1]}
    return {column: USUAL[SI[wanted[name].kind]] for name, column in bare.items() if SI[wanted[name].kind] in USUAL}


def _driving(known: Mapping[str, str], wanted: Mapping[str, Sensor]) -> dict[str, CardSensor]:
    """Sensors of other shaft ends that are given in the place of those that usually are and have no column."""
    shafts = {name: sensor for name, sensor in wanted.items() if sensor.kind in ("speed", "torque")}
    lacking = [s.kind for name, s in shafts.items() if s.role == "given" and name not in known]
    others = {s.kind: s for name, s in shafts.items() if s.role == "read" and name in known}
    given = {s.name: {"reads": s.reads, "role": "given"} for kind, s in others.items() if kind in lacking}
    return {name: CardSensor.model_validate(keys) for name, keys in given.items()}


def _turned(card: Card, scenario: Scenario, cells: Mapping[str, Sequence[str]], said: Mapping[str, bool]) -> Card:
    """The card with what columns hold: magnitudes as said, or where no cell is below zero and the model is.

    What noise at rest shows below zero is none.
    """
    nominal, found = Nominal(scenario), dict(card.sensors)
    for sensor in sensors_of(scenario, card):
        column = numbers([cell for cell in cells.get(sensor.column, ()) if cell])
        signed, magnitude = sensor.signs == (1.0, 1.0), said.get(sensor.name)
        if magnitude is None and column is not None and len(column) and SI[sensor.kind] != "K":
            above = bool(column.min() >= -REST * column.max())
            magnitude = above if above == signed and (not above or nominal.value(sensor.reads) < 0) else None
        if magnitude is not None:
            signs = {} if magnitude else {"signs": [1.0, 1.0]}
            own = found[sensor.name].model_dump(exclude_unset=True) if sensor.name in found else {}
            keys = {**own, "reads": sensor.reads, "magnitude": magnitude, **signs}
            found[sensor.name] = CardSensor.model_validate(keys)
    return card.model_copy(update={"sensors": found})
