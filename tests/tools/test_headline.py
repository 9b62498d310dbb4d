"""The figures of the page on the planetary rig and the promises of the main job, over all 36 tests."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from gearheat.fmu.export import export
from gearheat.fmu.play import Player
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.study import read_study
from gearheat.tools.compare.campaign import runs_of
from gearheat.tools.docs.blocks import PAGES
from gearheat.tools.solve.settings import flat_of


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The main job, as a user runs it."""
    command = [sys.executable, "-m", "gearheat.tools.cli", "run", "planetary", "--json", "-"]
    command += ["--out", str(tmp_path_factory.mktemp("run"))]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


@pytest.fixture(scope="module")
def rig():
    study = read_study(load("planetary"))
    assert study is not None
    return study, flat_of(study.scenario)


def test_all_72_readings_conserve_energy(result: dict) -> None:
    assert len(result["rows"]) == 72
    assert result["energy_residual_max"] < 1e-6


def test_the_table_of_the_page_is_what_the_main_job_prints(result: dict) -> None:
    page = (PAGES / "trust" / "planetary.md").read_text(encoding="utf-8")
    found = dict(re.findall(r"^\| ([^|]+?) +\| ([\d. |]+) \|$", page, flags=re.MULTILINE))
    channels = ("T_oil_K", "T_wall_K", "loss_Nm")

    def printed(name: str) -> list[float]:
        return [float(cell) for cell in found[name].split("|")]

    expected = {
        "simulation, all 72 readings": result["rmse"]["overall"],
        "simulation, PAOR-16": result["rmse"]["PAOR-16"],
        "noise floor": result["noise_floor"],
        "constant alpha*A, left-out tests": result["rivals"]["constant_alphaA"]["leave_one_test_out"],
        "linear, left-out tests": result["rivals"]["linear"]["leave_one_test_out"],
    }
    for name, values in expected.items():
        assert printed(name) == [pytest.approx(values[c], abs=0.0051) for c in channels], name


def test_after_240_minutes_the_oil_is_where_the_steady_solve_says(result: dict, rig) -> None:
    """Every first half, at the readings' own speed, torque, room and oil."""
    study, flat = rig
    rows = {(row["test"], row["direction"]): row for row in result["rows"]}
    for test in range(study.campaign.n_tests):
        first = int(np.flatnonzero(study.campaign.test == test)[0])
        values = {path: v for path, v in (study.oil(test) | study.given(first)).items() if path in flat.index}
        row = rows[study.campaign.numbers[test], 1]
        assert steady(flat, values)["oil.T"][0] - 273.15 == pytest.approx(row["T_oil_C"], abs=0.05)


@pytest.mark.parametrize("step", [1.0, 10.0, 60.0])
def test_the_fmu_plays_what_simulate_computes(rig, step: float, tmp_path: Path) -> None:
    """A whole test with its stop, every communication point, all states."""
    study, flat = rig
    (run,) = runs_of(study.scenario, flat, study, "16")
    start = {q.name: run.start[q.name] for q in flat.states}
    times = np.arange(0.0, run.schedule.stop + 0.5 * step, step)
    reference = simulate(flat, run.schedule, start=start, times=times, tolerance=1e-9)
    names = [q.name for q in flat.states]
    inputs = {name: (run.schedule.time, v) for name, v in run.schedule.values.items()}
    with Player(export(flat, tmp_path / "rig.fmu")) as player:
        played = player.run(inputs, run.schedule.stop, step, start=start, record=names, output_times=list(times))
    for name in names:
        assert np.abs(played[name] - reference[name]).max() < 1e-3
