"""The main job on a few tests, end to end: export, play, compare, report; and what an interruption leaves."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time

import pytest
from browser import WIDTHS
from fabricated_findings import explained
from gearheat.tools.diagnose.report.page import render
from pages import problems_of

TESTS = "1,13,17,22"
KEYS = ["point", "test", "direction", "oil", "T_oil_C", "T_wall_C", "T_amb_C", "loss_Nm", "P_loss_W", "efficiency"]
MEASURED = {"T_oil_C_meas", "T_oil2_C_meas", "T_wall_C_meas", "loss_Nm_meas", "P_loss_W_meas", "efficiency_meas"}


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    out = tmp_path_factory.mktemp("run") / "out"
    scratch = tmp_path_factory.mktemp("scratch")
    command = [sys.executable, "-m", "gearheat.tools.cli", "run", "planetary", "--out", str(out), "--tests", TESTS]
    command += ["--jobs", "2", "--json", "-"]
    environment = {**os.environ, "TMPDIR": str(scratch)}
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert not list(scratch.iterdir()), "a temporary file was left"
    return out, json.loads(done.stdout), done.stderr


def test_rows_are_simulated_and_measured(ran):
    _, found, _ = ran
    assert found["schema"] == "gearheat.run/1" and found["rig"] == "planetary"
    assert [row["test"] for row in found["rows"]] == [1, 1, 13, 13, 17, 17, 22, 22]
    for row in found["rows"]:
        assert list(row)[: len(KEYS)] == KEYS
        assert row.keys() >= MEASURED
    first, second = found["rows"][:2]
    assert first["T_oil_C_meas"] == 43.26 and first["T_amb_C"] == 25.18
    assert first["loss_Nm_meas"] == pytest.approx(1549.5 - 4 * 383.0)
    assert second["loss_Nm_meas"] == pytest.approx(4 * 395.9 - 1549.5)
    assert first["efficiency_meas"] == pytest.approx(4 * 383.0 / 1549.5)
    assert second["efficiency_meas"] == pytest.approx(1549.5 / (4 * 395.9))
    assert 25 < first["T_oil_C"] < 70 and 0.97 < first["efficiency"] < 1


def test_simulated_losses_agree_with_each_other(ran):
    for row in ran[1]["rows"]:
        w = row["n_carrier_rpm"] * 3.141592653589793 / 30
        assert row["P_loss_W"] == pytest.approx(row["loss_Nm"] * w, rel=1e-6)
        assert row["P_loss_W"] == pytest.approx(row["P_total_W"], rel=1e-9)


def test_errors_noise_floor_and_rivals_are_given_per_channel(ran):
    found = ran[1]
    channels = {"T_oil_K", "T_oil2_K", "T_wall_K", "loss_Nm"}
    assert set(found["rmse"]) == {"overall", "PAOR-16", "PAOR-5", "MINR-5"}
    assert set(found["rmse"]["overall"]) == channels
    assert found["noise_floor"]["repeated"] == [[13, 17]]
    assert channels <= found["noise_floor"].keys()
    for rival in ("constant_alphaA", "linear"):
        assert set(found["rivals"][rival]["leave_one_test_out"]) == channels


def test_energy_is_conserved(ran):
    assert 0 <= ran[1]["energy_residual_max"] < 1e-6


def test_the_end_of_the_first_half_is_the_steady_state(ran, gearheat):
    row = ran[1]["rows"][0]
    steady = gearheat(
        "steady", "planetary", "--json", "-",
        "--set", "carrier.w=102.6 rpm", "--set", "carrier.tau=1549.5 N.m", "--set", "room.T=25.18 degC",
    ).json  # fmt: skip
    assert row["T_oil_C"] == pytest.approx(steady["values"]["oil.T"], abs=0.05)


def test_files_hold_the_same_numbers(ran):
    out, found, _ = ran
    assert json.loads((out / "result.json").read_text()) == found
    rows = list(csv.DictReader((out / "rows.csv").read_text().splitlines()))
    assert [float(r["T_oil_C"]) for r in rows] == pytest.approx([r["T_oil_C"] for r in found["rows"]])
    assert (out / found["fmu"]).is_file()
    assert (out / "tests" / "test-13.csv").read_text().startswith("time [s],oil.T [degC]")


def test_the_report_is_one_file_that_needs_no_other(ran):
    page = (ran[0] / "report.html").read_text()
    assert problems_of(page) == []
    for words in ("How close", "noise floor", "Warm-up", "Where the power goes", "Laws", "Parameters", "SKF"):
        assert words in page
    assert page.count("<svg") == 5
    assert "<link" not in page and 'src="' not in page
    assert "The simulation is this close to 8 readings" in page and "It is worst for the" in page
    assert "gearheat diagnose TABLE --rig planetary names the causes" in page and "not built yet" in page
    assert page.index("noise floor") < page.index("Regressions on the readings")
    assert "test 13, PAOR" in page and page.count("<figcaption>") == 5


def test_reports_and_pictures_stay_within_their_screens(browser, ran, gearheat, tmp_path):
    made = {"map": ("-o", tmp_path / "map.csv", "--grid", "3x3"), "steady": (), "show": ()}
    for command, more in made.items():
        gearheat(command, "helical_two_stage", *more, "--plot", tmp_path / f"{command}.html")
    (tmp_path / "diagnosis.html").write_text(render(explained()), encoding="utf-8")
    pages = [ran[0] / "report.html", *sorted(tmp_path.glob("*.html"))]
    assert len(pages) == 5
    assert [fault for page in pages for width in WIDTHS for fault in browser.faults(page, width)] == []


def test_compare_reads_the_rows_back(ran, gearheat, rig):
    out, found, _ = ran
    again = gearheat("compare", out / "rows.csv", rig.folder / "measured.csv", "--rig", "planetary", "--json", "-").json
    assert again["rmse"]["overall"] == pytest.approx(found["rmse"]["overall"], rel=1e-6)
    known = {key: pytest.approx(value, rel=1e-6) for key, value in found["noise_floor"].items() if key != "repeated"}
    assert again["noise_floor"] == {**known, "repeated": found["noise_floor"]["repeated"]}


def test_a_second_run_plays_nothing_again_and_gives_the_same_bytes(ran, gearheat):
    out, _, _ = ran
    files = [out / "result.json", out / "report.html", out / "rows.csv", out / "planetary.fmu"]
    before = [(f.read_bytes()) for f in files]
    stamps = {f: f.stat().st_mtime_ns for f in (out / "tests").iterdir()}
    answer = gearheat("run", "planetary", "--out", out, "--tests", TESTS, "--jobs", "1")
    assert answer.code == 0
    assert "4 of 4 tests were finished before" in answer.err
    assert [f.read_bytes() for f in files] == before
    assert {f: f.stat().st_mtime_ns for f in (out / "tests").iterdir()} == stamps


def test_other_values_are_played_again(ran, gearheat, tmp_path):
    shutil.copytree(ran[0], tmp_path / "out")
    arguments = ("run", "planetary", "--out", tmp_path / "out", "--tests", "1", "--jobs", "1", "--json", "-")
    answer = gearheat(*arguments, "--set", "cooling.A=2 m2")
    assert "finished before" not in answer.err
    assert answer.json["rows"][0]["T_oil_C"] < ran[1]["rows"][0]["T_oil_C"] - 1


def test_an_interrupted_run_leaves_finished_tests_and_goes_on(tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, "-m", "gearheat.tools.cli", "run", "planetary", "--out", str(out), "--tests", "1-6"]
    command += ["--jobs", "1", "--step", "3 s"]  # slow enough to be met half-way
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs of a shell may be told to ignore it
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    signal.signal(signal.SIGINT, before)
    assert process.stderr is not None
    deadline = time.monotonic() + 60
    for line in process.stderr:
        if "played test" in line or time.monotonic() > deadline:
            break
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    done = sorted((out / "tests").glob("test-*.json"))
    assert 1 <= len(done) < 6
    assert not [f for f in out.rglob(".*")], "a half-written file was left"
    assert json.loads(done[0].read_text())["readings"][0]["oil.T"] > 300
    again = subprocess.run(command, capture_output=True, text=True, check=True)
    assert f"{len(done)} of 6 tests were finished before" in again.stderr
    assert len(list((out / "tests").glob("test-*.json"))) == 6


@pytest.mark.parametrize("rig", ["helical_two_stage", "fzg_four_square"])
def test_a_rig_without_measured_data_runs_too(gearheat, tmp_path, rig):
    found = gearheat("run", rig, "--out", tmp_path / "out", "--jobs", "1", "--json", "-").json
    assert len(found["rows"]) == 1 and found["rmse"] == {}
    assert found["energy_residual_max"] < 1e-6
    assert "How close" not in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize(
    "wrong", [("--tests", "99"), ("--set", "oil.TT=3 degC"), ("--data", "no.csv"), ("--step", "x")]
)
def test_a_refused_run_leaves_no_folder(gearheat, tmp_path, wrong):
    answer = gearheat("run", "planetary", "--out", tmp_path / "new" / "out", "--jobs", "1", *wrong)
    assert answer.code == 2
    assert not list(tmp_path.iterdir())
