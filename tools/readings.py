"""Readings as rows: measured tables and simulated results brought into one shape, and the command `compare`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..model.errors import DataError
from ..model.units import from_si
from ..scenarios.csv_table import Column, Table, parse, raise_all
from ..scenarios.measured import SUFFIXES, Campaign, Reading, read_measured
from ..scenarios.scenario import Scenario
from . import summary
from .compare import CHANNELS, compare
from .console import answer, note
from .rivals import rivals

#: Speed ratio of the machine whose sun and carrier torque stand in a table of steady readings.
RATIO = 4.0

#: Columns of a row that every machine has, and where they are read.
READ_FROM: Mapping[str, str] = {
    "loss_Nm": "efficiency.tau_loss",
    "P_loss_W": "efficiency.P_loss",
    "efficiency": "efficiency.eta",
}

#: What a row repeats of the measured table.
CONTEXT = ("grid", "n_set_rpm", "T_set_Nm", "n_carrier_rpm", "T_carrier_Nm")


def sources(scenario: Scenario) -> dict[str, str]:
    """Columns of a simulated row -> path in the model: the rig's temperature sensors, loss and efficiency."""
    driven = set(scenario.inputs())
    sensors = {c: p for c, p in scenario.sensors.items() if c.endswith("_C") and p not in driven}
    return sensors | {c: p for c, p in READ_FROM.items() if p.partition(".")[0] in _parts(scenario)}


def simulated(scenario: Scenario, values: Mapping[str, float]) -> dict[str, float]:
    """The simulated columns of a row, from model values in SI."""
    row = {column: in_column(column, values[path]) for column, path in sources(scenario).items()}
    return row | {column: sum(values[p] for p in paths) for column, paths in scenario.losses.items()}


def measured(reading: Reading) -> dict[str, Any]:
    """The measured columns of a row, with the suffix `_meas`, and what the reading belongs to.

    The loss torque is that on the carrier's side: T_carrier - ratio T_sun where the carrier drives, its negative else.
    """
    values = reading.values
    tau, n = values["T_carrier_Nm"], values["n_carrier_rpm"]
    carried = RATIO * values["T_sun_Nm"]
    loss = tau - carried if reading.direction == 1 else carried - tau
    read = {c.column: values[c.column] for c in CHANNELS if c.column in values}
    read |= {
        "loss_Nm": loss,
        "P_loss_W": loss * n * math.pi / 30,
        "efficiency": carried / tau if reading.direction == 1 else tau / carried,
    }
    about = {name: values.get(name, reading.texts.get(name)) for name in CONTEXT}
    return {"T_amb_C": values["T_amb_C"], **{f"{name}_meas": value for name, value in read.items()}, **about}


def row(reading: Reading, result: Mapping[str, Any]) -> dict[str, Any]:
    """One row: which reading it is, what was simulated, what was measured."""
    name = {"point": reading.point, "test": reading.test, "direction": reading.direction, "oil": reading.oil}
    return {**name, **result, **measured(reading)}


def in_column(column: str, value: float) -> float:
    """A value in SI, in the unit that the column's name ends in."""
    for suffix, (_, unit) in SUFFIXES.items():
        if column.endswith(suffix):
            return from_si(value, unit)
    return value


def _parts(scenario: Scenario) -> set[str]:
    return {part.name for part in scenario.spec.parts}


KEYS = (
    Column("point", "number of the reading", "count", required=False),
    Column("test", "number of the test", "count", required=False),
    Column("direction", "direction", "count", required=False, options=(1, 2)),
)
NAMES = dict.fromkeys((*(c.column for c in CHANNELS), *READ_FROM))
VALUES = tuple(Column(name, "simulated value", required=False) for name in NAMES)


def read_result(path: Path) -> Table:
    """A table of simulated readings.

    Raises:
        DataError: everything wrong with it at once
    """
    table, problems = parse(path, (*KEYS, *VALUES))
    if "point" not in table.columns and not {"test", "direction"} <= table.columns.keys():
        problems.append(f'{path.name} line 1: rows have no name. Add the column "point", or "test" and "direction".')
    if not any(c.column in table.columns for c in CHANNELS):
        names = ", ".join(c.column for c in CHANNELS)
        problems.append(f"{path.name} line 1: there is nothing to compare. Add at least one of: {names}.")
    raise_all(problems, path.name)
    return table


def joined(table: Table, campaign: Campaign) -> list[dict[str, Any]]:
    """Rows of the readings that both tables have, in the order of the measured one.

    Raises:
        DataError: readings that are there twice or not measured
    """
    keys = ("point",) if "point" in table.columns else ("test", "direction")
    known = {tuple(getattr(r, key) for key in keys): r for r in campaign.readings}
    found: dict[tuple[Any, ...], dict[str, Any]] = {}
    problems = []
    for i in range(len(table.lines)):
        key = tuple(table.columns[name][i] for name in keys)
        what = ", ".join(f"{name} {value}" for name, value in zip(keys, key, strict=True))
        if key not in known:
            problems.append(f"{table.place(i)}: {campaign.name} has no reading with {what}. Take the row out.")
        elif key in found:
            problems.append(f"{table.place(i)}: {what} is there twice. Keep one.")
        found[key] = {c.name: table.columns[c.name][i] for c in VALUES if c.name in table.columns}
    raise_all(problems, table.name)
    return [row(reading, found[key]) for key, reading in known.items() if key in found]


def command(result: Path, data: Path, json: str | None) -> None:
    """Compare a table of simulated readings with a measured one."""
    simulated_table, campaign = read_result(result), read_measured(data)
    rows: Sequence[dict[str, Any]] = joined(simulated_table, campaign)
    for warning in campaign.warnings:
        note(f"warning: {warning}")
    if not rows:
        raise DataError(f"{result.name} and {campaign.name} have no reading in common.")
    comparison, scores = compare(rows), rivals(rows)
    found = {"schema": "gearheat.compare/1", "result": result.name, "data": campaign.name, "rows": rows}
    answer({**found, **summary.as_dict(comparison, scores)}, json, lambda: summary.show(comparison, scores))
