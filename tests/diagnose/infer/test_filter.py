"""Logs of ordinary gearboxes that the rig makes itself: how the filter is driven, where it begins, what it is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest
from gearheat.model.run.schedule import Schedule
from gearheat.model.run.simulate import simulate
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.logs import Log, read_log
from gearheat.scenarios.measured.nominal import drive_by
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.diagnose.infer.logs import filter_of, independent
from gearheat.tools.diagnose.model.logs import Passed
from gearheat.tools.diagnose.model.windows import windows

#: Samples, and time between them [s].
N, STEP = 720, 600.0


def record(path: Path, scenario: Scenario, seed: int, *only: str, thinner: float = 1.0) -> Path:
    """A log of a rig with some readings, all if none is named; the oil may be thinner than that of the rig."""
    sensors = [s for s in sensors_of(scenario, Card()) if s.role == "given" or not only or s.name in only]
    driven, rng = drive_by(scenario, sensors), np.random.default_rng(seed)
    if thinner != 1.0:
        oil = driven.spec.part("oil").values
        driven = driven.with_values({f"oil.{key}": float(oil[key]) / thinner for key in ("nu_40", "nu_100")})
    flat = driven.spec.flat()
    point = {path: value for path, value in driven.operating_point.items() if path in flat.index}
    corners = 12 * STEP * np.arange(N // 12 + 1)
    changes = {s.reads: rng.uniform(0.0, 1.0, len(corners)) for s in sensors if s.role == "given"}
    given = {
        name: point[name] - 5.0 + 10.0 * share if name.endswith(".T") else point[name] * (0.6 + 0.4 * share)
        for name, share in changes.items()
    }
    times = STEP * np.arange(N)
    rest = {name: value for name, value in point.items() if name not in given}
    found = simulate(flat, Schedule(corners, given), values=rest, times=times)
    columns = {"time_s": times}
    for s in sensors:
        true = found[s.reads] if s.reads in found.columns else np.interp(times, corners, given[s.reads])
        shown = s.signs[0] * true + s.repeat_sd * rng.standard_normal(N)
        columns[s.column] = {"degC": shown - 273.15, "rpm": shown * 30 / np.pi}.get(s.unit, shown)
    np.savetxt(path, np.array([*columns.values()]).T, "%.8g", ",", header=",".join(columns), comments="")
    return path


def read(path: Path, scenario: Scenario) -> Log:
    return read_log(path, scenario, Card())


def test_bodies_begin_at_what_thermometers_show(tmp_path: Path) -> None:
    """Two thermometers of one oil, and a torque that is none."""
    scenario = load("planetary")
    log = read(record(tmp_path / "log.csv", scenario, 1, "T_oil", "T_oil2", "T_sun"), scenario)
    own, knobs = filter_of(scenario, log)
    data = windows([log], own.given, own.read)
    begun, _ = own.start(data, np.zeros((len(data.read), len(own.read))))
    thermometers = data.read[:, 0, [own.read.index(name) for name in ("T_oil", "T_oil2")]]
    assert begun == pytest.approx(np.repeat(thermometers.mean(axis=1)[:, None], own.nx, axis=1), abs=1.5)
    error = own.run(data, np.zeros((len(data.read), len(knobs))), slopes=False).error
    assert np.nanmax(np.abs(error[:, :, 0])) < 3.0


def test_a_rig_with_a_load_is_driven_by_the_torque_of_the_log(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    gh.new("mine", stages="helical", ratio=3, power="5 kW", speed="1450 rpm", out=mine)
    scenario = load(mine)
    assert scenario.given["output"] == ("load",)
    now, past = (record(tmp_path / f"{seed}.csv", scenario, seed) for seed in (1, 2))
    assert "output.tau" in filter_of(scenario, read(now, scenario))[0].plant.u_place
    assert gh.diagnose(None, mine, logs=now, reference_logs=past, quick=True).verdict == "consistent"


def test_a_single_reading_that_many_bodies_move(tmp_path: Path) -> None:
    now, past = (record(tmp_path / f"{seed}.csv", load("actuator"), seed, "I_motor") for seed in (1, 2))
    assert gh.diagnose(None, "actuator", logs=now, reference_logs=past, quick=True).verdict == "consistent"


@pytest.mark.filterwarnings("error")
def test_thermometers_that_end(tmp_path: Path) -> None:
    """The last window has none."""
    path, ends = record(tmp_path / "now.csv", load("helical_two_stage"), 1), {"T_wall_C": 300, "T_oil_C": 470}
    head, *rows = [line.split(",") for line in path.read_text().splitlines()]
    for k, row in enumerate(rows):
        for name, end in ends.items():
            row[head.index(name)] = "" if k >= end else row[head.index(name)]
    path.write_text("".join(",".join(row) + "\n" for row in [head, *rows]))
    found = gh.diagnose(None, "helical_two_stage", logs=path, quick=True)
    assert found.verdict == "consistent"
    assert None in found.rows.channels["T_wall"].measured
    told = [event["event"] for event in gh.watch("helical_two_stage", path, once=True)]
    assert told.count("window") == 2 and "alarm" not in told


@pytest.mark.filterwarnings("error")
def test_errors_that_are_always_the_same_have_a_share() -> None:
    error = np.full((2, 36, 1), 50.0)
    none = np.zeros((2, 1))
    assert np.isfinite(independent(Passed(none, none[:, :, None], error, np.ones_like(error), error)))


def test_another_oil_is_named(tmp_path: Path) -> None:
    scenario = load("cycloidal")
    past = record(tmp_path / "past.csv", scenario, 1)
    now = record(tmp_path / "now.csv", scenario, 2, thinner=1.7)
    found = gh.diagnose(None, "cycloidal", logs=now, reference_logs=past, quick=True)
    assert found.answers[0].causes == (("losses.oil_viscosity",),)
    assert found.verdict == "explained"


@pytest.mark.filterwarnings("error")
def test_windows_shorter_than_the_memory_of_errors() -> None:
    error = np.random.default_rng(1).standard_normal((2, 36, 1))
    error[:, :18] = np.nan
    none = np.zeros((2, 1))
    passed = Passed(none, none[:, :, None], error, np.ones_like(error), error)
    assert 0.1 < independent(passed) <= 1.5
    assert independent(replace(passed, error=np.where(np.isfinite(error), 1e-3 * error, error))) > 0


def test_a_replay_of_a_log_of_some_hours(tmp_path: Path) -> None:
    """It tells errors as far ahead as the log is long enough for, and draws thermometers alone."""
    path = record(tmp_path / "log.csv", load("planetary"), 1)
    (short := tmp_path / "short.csv").write_text("\n".join(path.read_text().splitlines()[:60]) + "\n")
    first, second = gh.replay("planetary", path, logs=[short]).logs
    assert [len(log.ahead["rig"]["T_oil"]) for log in (first, second)] == [5, 2]
    assert set(second.shown) == {"T_oil", "T_oil2", "T_wall"} and "T_sun" in second.free["rig"]
