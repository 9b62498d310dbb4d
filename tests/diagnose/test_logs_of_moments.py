"""Logs of some days, read at moments, while load and speed step in between: what a laboratory logs."""

from __future__ import annotations

import csv
from datetime import datetime, timedelta
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest

#: Days of a log, its step [s], and when the one in question begins; the healthy one is a week before.
DAYS, STEP, BEGIN = 6, 600.0, datetime(2025, 3, 10)
#: Speed [rpm] and load [N.m] of the name plate.
PLATE = (2950.0, 309.6)
HEAD = ["time_utc", "n_input_rpm", "T_output_Nm", "T_oil_C", "T_wall_C", "T_amb_C"]


@pytest.fixture(scope="module")
def rig(tmp_path_factory) -> Path:
    """A unit whose oil is 70 K over the room, with a time constant of less than an hour."""
    path = tmp_path_factory.mktemp("rig") / "pump.toml"
    gh.new("pump", stages="spur", ratio=2.1, power="45 kW", speed="2950 rpm", out=path)
    return path


def log(rig: Path, name: str, seed: int, begin: datetime, share: float = 1.0, since: float = 0.0) -> Path:
    """A log with a share of the housing's surfaces from a day on: at night, when both are at rest."""
    rng, steps = np.random.default_rng(seed), []
    for day in range(DAYS):
        hours = np.cumsum([0.0, 6.0, *rng.uniform(2.0, 4.0, 4)])
        parts = [(0.02, 0.02), *zip(rng.choice([0.5, 0.75, 1.0], 4), rng.choice([0.3, 0.5, 0.7, 1.0], 4), strict=True)]
        ends = [*hours[1:], 24.0]
        for h, end, (speed, load) in zip(hours, ends, [*parts, (0.02, 0.02)], strict=True):
            steps += [(86400 * day + 3600 * at, speed * PLATE[0], load * PLATE[1], 20.0) for at in (h, end)]
    duty = rig.with_name(f"{name}_duty.csv")
    with duty.open("w", newline="") as file:
        csv.writer(file).writerows([["time [s]", "input.w [rpm]", "output.load [N.m]", "room.T [degC]"], *steps])
    time = np.arange(0.0, DAYS * 86400.0, STEP)
    flat = gh.load(rig).scenario.spec.flat()
    paths = ("cooling.A", "cooling.A_fins")
    runs = [gh.simulate(rig, duty, set={p: s * flat.quantity(p).start for p in paths}) for s in (1.0, share)]
    changed = time >= 86400.0 * since
    columns = [np.where(changed, *(np.interp(time, r.time, r[p]) for r in runs[::-1])) for p in ("oil.T", "wall.T")]
    place = np.searchsorted([t for t, *_ in steps], time, side="right") - 1
    given = np.array(steps)[place, 1:3] * (1 + 5e-4 * rng.standard_normal((len(time), 2)))
    read = np.array(columns).T - 273.15 + rng.normal(0.0, 0.3, (len(time), 2))
    stamps = [(begin + timedelta(seconds=float(t))).isoformat() for t in time]
    path = rig.with_name(f"{name}.csv")
    with path.open("w", newline="") as file:
        rows = ([s, *np.round(g, 3), *np.round(r, 2), 20.0] for s, g, r in zip(stamps, given, read, strict=True))
        csv.writer(file).writerows([HEAD, *rows])
    return path


@pytest.fixture(scope="module")
def healthy(rig) -> Path:
    return log(rig, "healthy", 1, BEGIN - timedelta(days=7))


@pytest.mark.parametrize("seed", [2, 3])
def test_sound_ones_raise_no_alarm(rig, seed: int) -> None:
    """Each beside a healthy log of its own: what is by chance in a healthy log is in all answers beside it."""
    own = log(rig, f"healthy{seed}", seed, BEGIN - timedelta(days=7))
    found = gh.diagnose(None, rig, logs=log(rig, f"sound{seed}", seed + 20, BEGIN), reference_logs=own, quick=True)
    assert found.verdict == "consistent" and found.test.p_any > 0.05


@pytest.mark.parametrize(("since", "compared"), [(3.0, False), (3.0, True), (0.0, True)])
def test_a_housing_that_cools_less_is_told(rig, healthy, since: float, compared: bool) -> None:
    """From a day on, and all of the time beside healthy days of the same season."""
    dirty = log(rig, "dirty", 21, BEGIN, 0.75, since)
    found = gh.diagnose(None, rig, logs=dirty, reference_logs=healthy if compared else None, quick=True)
    assert found.verdict == "explained" or not compared
    assert found.answers[0].causes[0][0] == "cooling.air"
    low, high = np.exp(found.cause("cooling.air").parameters[0].ci95)
    assert low < 0.8 and high > 0.7
