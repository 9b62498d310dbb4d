from __future__ import annotations

import json
import math

import pytest
from gearheat.model.errors import DataError
from gearheat.tools.bench import replays, scale
from gearheat.tools.bench.bench import _imports, _integration
from gearheat.tools.bench.uncertainty import measure


def test_the_fmu_is_ten_times_faster_than_scipy_at_no_larger_error():
    found = _integration("planetary", "1,16,26")
    assert found["tests"] == 3
    assert found["fmu_error_K"] < 1e-3
    assert found["ratio"] >= 10, found


def test_what_the_help_imports_is_seen():
    assert _imports("typer")
    assert not _imports("casadi")


def test_standard_deviations_stand_beside_draws():
    """Five standard errors of the draws are allowed, and 3 % of what is not linear and left out."""
    found = json.loads(json.dumps(measure("cycloidal_areas", 300, ["mixture"])))
    assert found["failed"] == 0 and len(found["outputs"]) >= 2
    for told in found["outputs"]:
        assert 0.02 < told["standard_error"] < 0.08, told
        assert abs(told["worst_difference"]) < 5 * told["standard_error"] + 0.03, told
        assert told["fmu_sd"] > 0 < told["drawn_sd"]
    assert 3 < found["cost"]["mixture_rhs"] / found["cost"]["plain_rhs"] < 7


def test_too_few_draws_are_refused(gearheat):
    answer = gearheat("bench", "cycloidal_areas", "--uncertainty", "--draws", 2)
    assert answer.code == 2 and "--draws 2" in answer.err and "at least 10" in answer.err


def test_time_and_memory_of_what_grows_are_those_of_processes(tmp_path, monkeypatch):
    monkeypatch.setitem(scale.TABLES, "scale", [{**scale.TABLES["scale"][0], "sizes": [5, 100]}])
    (job,) = scale.measure()["jobs"]
    small, large = job["runs"]
    assert all(run["s"] > 0.1 and 0.03 < run["GiB"] < 2 for run in (small, large))
    assert job["exponents"]["s"] == pytest.approx(math.log(large["s"] / small["s"]) / math.log(20), abs=0.01)
    assert [row[:2] for row in scale.rows_of({"jobs": [job]})] == [(job["what"], 5), (job["what"], 100)]
    with pytest.raises(DataError, match=r"steady given\.toml.*no such file"):
        scale._run(["steady", "given.toml"], tmp_path)


@pytest.mark.parametrize("made", ["duty", "wind"])
def test_what_a_command_reads_has_the_size_that_is_asked(tmp_path, made):
    scale.MADE[made](tmp_path, 30)
    assert len((tmp_path / "given.csv").read_text().splitlines()) == 31


def test_alarms_agree_where_the_diagnosis_alarms_in_that_window_with_that_name():
    causes, other = [{"id": "cooling.cooler", "probability": 0.31}], [{"id": "losses.churning", "probability": 0.4}]
    alarm = {"to": "2016-03-24T22:00:00Z", "before": "2016-03-23T04:20:00Z", "over": "", "causes": causes}
    at, quiet = {"alarm": True, "causes": causes}, {"alarm": False, "causes": []}
    alarms = [
        alarm | {"batch": at, "batch_before": quiet},
        alarm | {"batch": at | {"causes": other}, "batch_before": quiet},
        alarm | {"batch": at, "batch_before": at},
    ]
    year = {"case": "R80711 in 2014", "samples": 26298, "windows": 105, "s": 210.0, "last_s": 3.0, "alarms": alarms}
    found = replays.summed([year, year | {"case": "R80711 in 2016"}])
    assert (found["alarms"], found["agree"], found["false_alarms"]) == (6, 2, 3)
    assert found["healthy_years"] == pytest.approx(0.5, rel=1e-3)
    assert found["core_share"] == pytest.approx(200 * 420 / (2 * 26298 * 600))
    rows = replays.rows_of(found)
    assert [row[4].split("; ")[1] for row in rows[:3]] == [
        "the diagnosis " + w for w in ("agrees", "differs", "differs")
    ]
    assert dict(replays.sums_of(found))["false alarms a machine and year"] == "6.0"
