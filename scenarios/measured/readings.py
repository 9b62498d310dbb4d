"""Readings as rows: measured tables and simulated results brought into one shape."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ...model.parts.shaft import Efficiency
from ...model.units import from_si
from ..csv_table import Column, Table, parse, raise_all
from ..scenario import Scenario
from .nominal import efficiency, shaft_powers
from .sensors import SI
from .study import Measured
from .table import Sensor

#: Columns of a row that a machine with two shafts has, and the outputs of its efficiency that they show.
LOSSES: Mapping[str, str] = {"loss_Nm": "tau_loss", "P_loss_W": "P_loss", "efficiency": "eta"}
#: Ending of the columns of a kind of sensor, by the SI unit of what it reads.
ENDINGS: Mapping[str, str] = {"K": "C", "rad/s": "rpm", "N.m": "Nm", "W": "W"}
#: Column of the first room of a row.
ROOM = "T_amb_C"
#: Given values nearer than this part of the largest are the same set point.
NEAR = 0.02
#: What a row repeats of the set points of a table, by the kind of the sensor: its column, if there is one.
SET_POINTS: Mapping[str, str] = {"speed": "n_set_rpm", "torque": "T_set_Nm"}


def column_of(sensor: Sensor) -> str:
    """Column of a row that a sensor has, whatever it is called in the user's table."""
    return f"{sensor.name}_{ENDINGS[SI[sensor.kind]]}"


def sources(scenario: Scenario, warm: Sequence[Sensor] = ()) -> dict[str, str]:
    """Columns of a simulated row -> path in the model: temperatures, loss and efficiency.

    Args:
        scenario: the rig
        warm: the thermometers of its campaign; those of the rig file if there are none
    """
    driven = set(scenario.inputs())
    found = {column_of(s): s.reads for s in warm} or {
        f"{i.name}_C": i.reads for i in scenario.instruments if i.reads.endswith(".T") and i.reads not in driven
    }
    parts = scenario.spec.of_type(Efficiency.__name__)
    return found | {c: f"{parts[0]}.{key}" for c, key in LOSSES.items() if parts}


def convert_results(scenario: Scenario, paths: Mapping[str, str], values: Mapping[str, float]) -> dict[str, float]:
    """The simulated columns of a row, from model values in SI.

    Args:
        scenario: the rig
        paths: column -> path
        values: path -> value
    """
    units = {"C": "K", "rpm": "rad/s"}
    row = {c: from_si(values[path], units.get(c.rpartition("_")[2], "1")) for c, path in paths.items()}
    return row | {column: sum(values[p] for p in summed) for column, summed in scenario.losses.items()}


def measured_losses(study: Measured) -> dict[str, np.ndarray]:
    """Columns of measured losses (n,), from all shafts' powers, as in `LOSSES`: the torque is that at the first shaft.

    There are none where a torque or all speeds are missing.
    """
    powers = shaft_powers(study.campaign, study.nominal)
    if powers is None or not (parts := study.scenario.spec.of_type(Efficiency.__name__)):
        return {}
    nets = [net for net in study.scenario.spec.connections if f"{parts[0]}.a" in net]
    first = next((end for end in powers if any(f"{end}.reading" in net for net in nets)), None)
    if first is None:
        return {}
    given = next(s for s in study.campaign.sensors if s.kind == "speed")
    ratio = study.nominal.ratios[first] / study.nominal.ratios[given.reads.partition(".")[0]]
    w = np.abs(study.campaign.values[given.name] * ratio)
    P = np.asarray(sum(powers.values()))
    return {"loss_Nm": P / np.where(w > 0, w, np.nan), "P_loss_W": P, "efficiency": efficiency(powers)}


def measured_rows(study: Measured) -> list[dict[str, Any]]:
    """The measured columns of every row, with the suffix `_meas`, and what the reading belongs to."""
    c, lost, points = study.campaign, measured_losses(study), set_points(study)
    rows: list[dict[str, Any]] = []
    for k in range(c.n):
        read = {column_of(s): _convert(s, c.values[s.name][k]) for s in study.warm}
        read |= {name: float(values[k]) for name, values in lost.items()}
        row: dict[str, Any] = {ROOM: _convert(study.rooms[0], c.values[study.rooms[0].name][k])} if study.rooms else {}
        row |= {f"{name}_meas": value for name, value in read.items()}
        row |= {"grid": c.mounting[c.test[k]] or None} | {name: values[k] for name, values in points.items()}
        rows.append(row | {column_of(s): _convert(s, c.values[s.name][k]) for s in drives(study)})
    return rows


def drives(study: Measured) -> tuple[Sensor, ...]:
    """Given speeds and torques."""
    return tuple(s for s in study.campaign.given if s.kind in ("speed", "torque"))


def set_points(study: Measured) -> dict[str, list[float]]:
    """Set speed and set torque of every row: the table's own columns, else what was held, rounded to few values."""
    found: dict[str, list[float]] = {}
    for kind, column in SET_POINTS.items():
        given = [s for s in drives(study) if s.kind == kind]
        if column in study.campaign.others:
            found[column] = [float(cell or math.nan) for cell in study.campaign.others[column]]
        elif given:
            found[column] = _levels([abs(_convert(given[0], v)) for v in study.campaign.values[given[0].name]])
    return found


def _levels(values: Sequence[float]) -> list[float]:
    """Values as the middles of the groups they form."""
    order = np.argsort(values)
    ranked = np.asarray(values)[order]
    group = np.cumsum(np.append(0, np.diff(ranked) > NEAR * max(abs(ranked[-1]), 1e-9)))
    middle = np.array([float(f"{ranked[group == g].mean():.4g}") for g in range(group[-1] + 1)])
    found = np.empty(len(values))
    found[order] = middle[group]
    return [float(v) for v in found]


def table_columns(study: Measured) -> list[dict[str, float]]:
    """The number columns of the measured table for each row, by the names they have there."""
    c = study.campaign
    columns = {s.column: [_convert(s, value) for value in c.values[s.name]] for s in c.sensors}
    for name, cells in c.others.items():
        with suppress(ValueError):
            columns[name] = [float(cell) for cell in cells]
    return [{name: values[k] for name, values in columns.items()} for k in range(c.n)]


def _convert(sensor: Sensor, value: float) -> float:
    """A value in the unit of its column."""
    return round(from_si(float(value), SI[sensor.kind]), 9)


def about(study: Measured, row: int) -> dict[str, Any]:
    """Point, test, direction and oil of a row.

    Args:
        study: the rig and its readings
        row: of the table, from 0
    """
    c = study.campaign
    test = int(c.test[row])
    direction = 2 if c.direction[row] < 0 else 1
    return {"point": int(c.points[row]), "test": c.numbers[test], "direction": direction, "oil": c.oil[test]}


def read_result(path: Path, study: Measured) -> Table:
    """A table of simulated readings.

    Args:
        path: CSV file
        study: what was measured, whose columns it may have

    Raises:
        DataError: everything wrong with it at once
    """
    names = dict.fromkeys((*(column_of(s) for s in study.warm), *LOSSES))
    keys = (
        Column("point", "number of the reading", "count", required=False),
        Column("test", "number of the test", "count", required=False),
        Column("direction", "direction", "count", required=False, options=(1, 2)),
    )
    table, problems = parse(path, (*keys, *(Column(name, "simulated value", required=False) for name in names)))
    if "point" not in table.columns and not {"test", "direction"} <= table.columns.keys():
        problems.append(f'{path.name} line 1: rows have no name. Add the column "point", or "test" and "direction".')
    if not names.keys() & table.columns.keys():
        text = ", ".join(names)
        problems.append(f"{path.name} line 1: there is nothing to compare. Add at least one of: {text}.")
    raise_all(problems, path.name)
    return table


def join_readings(table: Table, study: Measured) -> list[dict[str, Any]]:
    """Rows of the readings that both tables have, in the order of the measured one.

    Args:
        table: simulated readings
        study: the rig and its measured readings

    Raises:
        DataError: readings that are there twice or not measured
    """
    keys = ("point",) if "point" in table.columns else ("test", "direction")
    rows = {row: about(study, row) for row in study.read_rows}
    known = {tuple(name[key] for key in keys): row for row, name in rows.items()}
    values = [name for name in table.columns if name not in ("point", "test", "direction")]
    found: dict[tuple[Any, ...], dict[str, Any]] = {}
    problems = []
    for i in range(len(table.lines)):
        key = tuple(table.columns[name][i] for name in keys)
        what = ", ".join(f"{name} {value}" for name, value in zip(keys, key, strict=True))
        if key not in known:
            problems.append(f"{table.place(i)}: {study.campaign.name} has no reading with {what}. Take the row out.")
        elif key in found:
            problems.append(f"{table.place(i)}: {what} is there twice. Keep one.")
        found[key] = {name: table.columns[name][i] for name in values}
    raise_all(problems, table.name)
    read = measured_rows(study)
    return [{**rows[row], **found[key], **read[row]} for key, row in known.items() if key in found]
