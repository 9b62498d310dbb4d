"""Measured tables of any rig, made of its own steady states with a little noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path

import numpy as np
from gearheat.model.units import from_si
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.nominal import Nominal, drive_by
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.scenario import Scenario

#: Speeds and loads of a made table, as parts of the operating point.
PARTS = ((0.4, 0.7, 1.0), (0.5, 1.0))


def made(scenario: Scenario, directions: Iterable[int] = (0,), seed: int = 0) -> dict[str, list[float]]:
    """Columns of a table of steady readings: column of the rig -> values in the unit of its name."""
    rng = np.random.default_rng(seed)
    sensors = sensors_of(scenario, Card())
    nominal, usual = Nominal(drive_by(scenario, sensors)), Nominal(scenario)
    columns: dict[str, list[float]] = {s.column: [] for s in sensors}
    for k, (speed, load_) in enumerate(product(*PARTS)):
        for direction in directions:
            turned = -1.0 if direction == 2 else 1.0
            parts = {"speed": speed, "torque": load_ * turned}
            given = {s.reads: parts.get(s.kind, 1.0) * usual.value(s.reads) for s in sensors if s.role == "given"}
            given |= {s.reads: usual.value(s.reads) + 0.7 * k for s in sensors if s.kind == "ambient"}
            state = nominal.at(given)
            assert state is not None
            for s in sensors:
                unit = {"torque": "N.m", "speed": "rad/s"}.get(s.kind, "K")
                value = given.get(s.reads, state[s.reads] + s.repeat_sd * rng.standard_normal())
                columns[s.column].append(round(from_si(value * s.sign(np.array(turned)), unit), 3))
    return columns


def written(path: Path, columns: Mapping[str, Iterable[object]], sep: str = ",") -> Path:
    rows = zip(*columns.values(), strict=True)
    path.write_text("\n".join([sep.join(columns), *(sep.join(map(str, row)) for row in rows)]) + "\n", encoding="utf-8")
    return path
