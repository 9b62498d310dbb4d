"""Logged courses of tests: one row per sample, checked against the campaign they belong to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...scenarios.csv_table import Column, Table, parse, raise_all
from ...scenarios.measured import Campaign

#: Columns of a table of samples. A sample of the stop has direction 0, or that of the half before or after it.
SAMPLES = (
    Column("test", "number of the test", "count", at_least=0),
    Column("time_s", "time since the start of the test", at_least=0),
    Column("direction", "direction (1 = multiplier, 2 = reducer, 0 = stopped)", "count", options=(0, 1, 2)),
    Column("n_carrier_rpm", "carrier speed", at_least=0),
    Column("T_carrier_Nm", "magnitude of the carrier torque", at_least=0),
    Column("T_oil_C", "oil temperature", above=-273.15),
    Column("T_wall_C", "wall temperature", above=-273.15),
    Column("T_amb_C", "room temperature", above=-273.15),
    Column("T_oil2_C", "oil temperature at a second place", required=False, above=-273.15),
    Column("T_sun_Nm", "magnitude of the sun torque", required=False, at_least=0),
)


@dataclass(frozen=True)
class Series:
    """Samples of a campaign's tests: test -> column -> values (n samples) in the units of the columns' names."""

    name: str
    tests: Mapping[int, Mapping[str, np.ndarray]]
    warnings: tuple[str, ...] = ()

    @property
    def samples(self) -> int:
        """Number of samples of all tests."""
        return sum(len(columns["time_s"]) for columns in self.tests.values())


def read_series(path: Path, campaign: Campaign | None) -> Series:
    """The samples in a table.

    Args:
        path: CSV file
        campaign: the readings whose tests were logged; None where they could not be read

    Raises:
        DataError: everything wrong with the table at once, by line
    """
    table, problems = parse(path, SAMPLES)
    problems += _backward(table)
    warnings = list(table.warnings)
    if campaign is not None:
        known = {reading.test for reading in campaign.readings}
        logged = {test for test in table.columns.get("test", ()) if test is not None}
        if foreign := sorted(logged - known):
            numbers = ", ".join(map(str, foreign[:8]))
            problems.append(f"{path.name}: {campaign.name} has no test {numbers}. Give the series of its own tests.")
        if left := len(known - logged):
            warnings.append(f"{path.name}: {left} of {len(known)} tests were not logged.")
    raise_all(problems, path.name)
    columns = {name: np.array(values) for name, values in table.columns.items()}
    tests = {}
    for test in np.unique(columns["test"]):
        mine = columns["test"] == test
        tests[int(test)] = {name: values[mine] for name, values in columns.items() if name != "test"}
    return Series(path.name, tests, tuple(warnings))


def _backward(table: Table) -> list[str]:
    """The first sample of each test that was taken before the one above it."""
    problems: list[str] = []
    last: dict[int, float] = {}
    told: set[int] = set()
    for row, (test, time) in enumerate(zip(*(table.columns.get(n, ()) for n in ("test", "time_s")), strict=False)):
        if test is None or time is None:
            continue
        if time < last.get(test, -1.0) and test not in told:
            told.add(test)
            problems.append(f"{table.place(row)}: time goes back in test {test} ({time:g} s after {last[test]:g} s).")
        last[test] = time
    return problems
