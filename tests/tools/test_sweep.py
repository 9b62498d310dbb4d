"""Sweeps: what is sampled, that rows are those of single runs, interruption, clusters, and bad input."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from gearheat.model.errors import DataError, ScenarioError
from gearheat.tools.solve import cluster, sampling, sweep, sweep_plan, sweep_rows
from gearheat.tools.solve.sampling import Axis
from gearheat.tools.solve.sweep_rows import Store

VARY = ("--vary", "carrier.tau=500..2700 N.m", "--vary", "room.T=10..35 degC")
KEPT = ("--output", "oil.T,efficiency.eta")


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(rows: list[dict[str, str]], name: str) -> np.ndarray:
    return np.array([float(row[name]) for row in rows])


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_plan, "BLOCKS", {"steady": 16, "warmup": 4})


# --- samples ------------------------------------------------------------------------------------------------------

AXES = (Axis("a", "uniform", -2.0, 4.0), Axis("b", "normal", 10.0, 2.0))


def test_a_latin_hypercube_has_one_row_in_every_slice() -> None:
    values = sampling.draw_sample(AXES, 200, "lhs", seed=3)
    assert sorted(np.floor((values[:, 0] + 2.0) / 6.0 * 200).astype(int)) == list(range(200))
    assert values[:, 1].mean() == pytest.approx(10.0, abs=0.02)
    assert values[:, 1].std() == pytest.approx(2.0, rel=0.02)
    assert np.abs(np.corrcoef(values.T)[0, 1]) < 0.2


@pytest.mark.parametrize("method", ["lhs", "monte-carlo"])
def test_the_seed_decides_the_sample(method: str) -> None:
    first = sampling.draw_sample(AXES, 50, method, seed=0)
    assert first.tobytes() == sampling.draw_sample(AXES, 50, method, seed=0).tobytes()
    assert (first != sampling.draw_sample(AXES, 50, method, seed=1)).any()
    assert np.isfinite(first).all()


def test_chance_covers_the_range() -> None:
    values = sampling.draw_sample(AXES, 5000, "monte-carlo", seed=0)[:, 0]
    assert -2.0 <= values.min() < -1.98
    assert 3.98 < values.max() <= 4.0
    assert values.mean() == pytest.approx(1.0, abs=0.1)


def test_a_grid_goes_from_end_to_end_and_the_last_axis_runs_fastest() -> None:
    values = sampling.lay_grid((AXES[0], Axis("c", "uniform", 0.0, 1.0)), "3 x 2")
    assert values.tolist() == [[-2, 0], [-2, 1], [1, 0], [1, 1], [4, 0], [4, 1]]
    middles = sampling.lay_grid((AXES[1],), "2")[:, 0]
    assert middles == pytest.approx([10 - 2 * 0.6744897501960817, 10 + 2 * 0.6744897501960817])


def test_ranges_are_read_with_units() -> None:
    written = sampling.read(["a=-2..0.5", "t = 10 degC..300 K", "u~normal(20, 5) degC", "v=.5..1e3 N.m"])
    assert [(w.name, w.kind, w.first, w.second) for w in written] == [
        ("a", "uniform", "-2", "0.5"),
        ("t", "uniform", "10 degC", "300 K"),
        ("u", "normal", "20 degC", "5 degC"),
        ("v", "uniform", ".5 N.m", "1e3 N.m"),
    ]


# --- rows ---------------------------------------------------------------------------------------------------------


def test_rows_are_those_of_the_command_steady(gearheat, tmp_path) -> None:
    out = tmp_path / "rows.csv"
    answer = gearheat("sweep", "planetary", *VARY, "--grid", "3x2", "-o", out, "--json", "-")
    found = answer.json
    assert (found["schema"], found["rows"], found["status"]) == ("gearheat.sweep/1", 6, {"ok": 6})
    assert found["varied"]["room.T"] == {"kind": "uniform", "low": 10.0, "high": 35.0, "unit": "degC"}
    assert found["energy_residual"] < 1e-9
    rows = table(out)
    assert [row["row"] for row in rows] == ["1", "2", "3", "4", "5", "6"]
    assert column(rows, "room.T [degC]") == pytest.approx([10, 35] * 3)
    for row in (rows[0], rows[3]):
        tau, room = row["carrier.tau [N.m]"], row["room.T [degC]"]
        single = gearheat(
            "steady", "planetary", "--json", "-", "--set", f"carrier.tau={tau} N.m", "--set", f"room.T={room} degC"
        ).json
        for name, value in single["values"].items():
            if name not in single["inputs"]:
                title = f"{name} [{single['units'][name]}]"
                assert float(row[title]) == pytest.approx(value, rel=2e-8, abs=1e-8), name
    oil = column(rows, "oil.T [degC]")
    assert found["outputs"]["oil.T"]["high"] == pytest.approx(oil.max())
    assert found["outputs"]["oil.T"]["mean"] == pytest.approx(oil.mean())


@pytest.mark.parametrize("how", [(), ("--kind", "warmup", "--duration", "1 min")])
def test_a_sweep_names_the_laws_outside_their_range(gearheat, tmp_path, how) -> None:
    """The row that has most of them is told with its laws."""
    vary = ("--vary", "room.T=20..149 degC", "--grid", "3", *KEPT)
    answer = gearheat("sweep", "planetary", *vary, *how, "-o", tmp_path / "hot.csv", "--json", tmp_path / "hot.json")
    told = json.loads((tmp_path / "hot.json").read_text("utf-8"))["outside"]
    assert told["row"] == 3 and "kinematic_viscosity" in {o["law"] for o in told["laws"]}
    assert "most of all row 3:" in answer.out and "outside its range: oil: kinematic_viscosity" in answer.out


def test_a_shaft_end_that_is_varied_is_driven(gearheat, tmp_path) -> None:
    out = tmp_path / "rows.csv"
    gearheat("sweep", "planetary", "--vary", "sun.w=400..1000 rpm", "--grid", "3", "--output", "carrier.w", "-o", out)
    assert column(table(out), "carrier.w [rpm]") == pytest.approx([100, 175, 250])


def test_the_same_sweep_gives_the_same_bytes_on_any_number_of_threads(gearheat, tmp_path) -> None:
    outs = [tmp_path / f"{k}.csv" for k in range(3)]
    for out, threads in zip(outs, (1, 2, 3), strict=True):
        answer = gearheat("sweep", "planetary", *VARY, "--sample", "100", "-o", out, "--jobs", threads)
        assert answer.code == 0
        assert answer.err == ""
    assert outs[0].read_bytes() == outs[1].read_bytes() == outs[2].read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["0.csv", "1.csv", "2.csv"]


def test_parquet_holds_what_csv_holds(gearheat, tmp_path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    for name in ("a.csv", "a.parquet", "b.parquet"):
        assert gearheat("sweep", "planetary", *VARY, *KEPT, "--sample", "20", "-o", tmp_path / name).code == 0
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    held, rows = parquet.read_table(tmp_path / "a.parquet").to_pydict(), table(tmp_path / "a.csv")
    assert list(held) == list(rows[0])
    assert held["row"] == list(range(1, 21))
    assert held["status"] == ["ok"] * 20
    assert held["oil.T [degC]"] == pytest.approx(column(rows, "oil.T [degC]"), rel=1e-8)


def test_rows_that_make_no_sense_stay_empty_and_are_counted(gearheat, tmp_path) -> None:
    out = tmp_path / "rows.csv"
    vary = ("--vary", "cooling.A~normal(0.2, 0.2) m2")
    answer = gearheat("sweep", "planetary", *vary, *KEPT, "--sample", "40", "-o", out, "--json", tmp_path / "s.json")
    assert answer.code == 0
    rows = table(out)
    for row in rows:
        assert row["status"] == ("ok" if float(row["cooling.A [m2]"]) > 0 else "out_of_range")
        assert (row["oil.T [degC]"] == "") == (row["status"] != "ok")
    wrong = sum(row["status"] != "ok" for row in rows)
    assert 0 < wrong < 20
    assert f"rows without a result: out_of_range {wrong}" in answer.out
    assert json.loads((tmp_path / "s.json").read_text())["status"] == {"ok": 40 - wrong, "out_of_range": wrong}


DUTY = "time [min],carrier.w [rpm]\n0,100\n60,100\n60,200\n120,250\n"


def test_warm_ups_follow_the_duty_from_the_temperature_of_the_room(gearheat, tmp_path) -> None:
    (tmp_path / "duty.csv").write_text(DUTY)
    out = tmp_path / "rows.csv"
    options = ("--kind", "warmup", "--duty", tmp_path / "duty.csv", "--every", "30 min", "--grid", "2x2", "-o", out)
    assert gearheat("sweep", "planetary", *VARY, *options).code == 0
    rows = table(out)
    assert column(rows, "time [s]").tolist() == [0, 1800, 3600, 5400, 7200] * 4
    first = column(rows[::5], "oil.T [degC]")
    assert first == pytest.approx(column(rows[::5], "room.T [degC]"))
    assert (column(rows, "energy_residual [1]") < 1e-6).all()
    for k in (0, 3):
        tau, room = rows[5 * k]["carrier.tau [N.m]"], rows[5 * k]["room.T [degC]"]
        gearheat(
            "simulate", "planetary", "--duty", tmp_path / "duty.csv", "-o", tmp_path / "single.csv",
            "--set", f"carrier.tau={tau} N.m", "--set", f"room.T={room} degC",
        )  # fmt: skip
        single = {float(row["time [s]"]): row for row in table(tmp_path / "single.csv")}
        for row in rows[5 * k : 5 * k + 5]:
            alone = single[float(row["time [s]"])]
            for title in ("oil.T [degC]", "wall.T [degC]"):
                assert float(row[title]) == pytest.approx(float(alone[title]), abs=2e-4)


def test_a_warm_up_of_given_length_shows_its_end(gearheat, tmp_path) -> None:
    out = tmp_path / "rows.csv"
    options = ("--kind", "warmup", "--duration", "330 min", "--vary", "oil.T=20..40 degC", "--grid", "5", "-o", out)
    answer = gearheat("sweep", "planetary", *options, *KEPT, "--json", "-")
    assert answer.json["status"] == {"ok": 5}
    rows = table(out)
    assert column(rows, "time [s]").tolist() == [19800.0] * 5
    assert np.ptp(column(rows, "oil.T [degC]")) < 1.0  # where it started is forgotten


# --- interruption -------------------------------------------------------------------------------------------------

KILLED = """
import os, signal, sys
from gearheat.tools.solve import sweep_plan, sweep_rows
from gearheat.tools.cli.app import app

sweep_plan.BLOCKS["steady"] = 16
solve, calls = sweep_rows.Job.rows, []

def rows(self, values, threads=0):
    if len(calls) == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    calls.append(1)
    return solve(self, values, threads)

sweep_rows.Job.rows = rows
app(sys.argv[1:])
"""


@pytest.mark.skipif(os.name == "nt", reason="no SIGKILL")
def test_a_killed_sweep_goes_on_where_it_was(gearheat, tmp_path, monkeypatch) -> None:
    whole, out = tmp_path / "whole.csv", tmp_path / "out.csv"
    arguments = ["sweep", "planetary", *VARY, *KEPT, "--sample", "100"]
    assert gearheat(*arguments, "-o", whole).code == 0
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, *arguments, "-o", str(out)], capture_output=True, check=False
    )
    assert killed.returncode == -signal.SIGKILL, killed.stderr.decode()
    assert not out.exists()
    kept = tmp_path / "out.csv.part"
    with kept.open("ab") as file:  # and the disk was full in the middle of the next block
        file.write(kept.read_bytes()[-100:])
    solved, solve = [], sweep_rows.Job.rows

    def counted(job, values, threads=0):
        solved.append(len(values))
        return solve(job, values, threads)

    monkeypatch.setattr(sweep_rows.Job, "rows", counted)
    answer = gearheat(*arguments, "-o", out)
    assert answer.code == 0
    assert "64 of 100 rows were finished before" in answer.err
    assert solved == [16, 16, 4]
    assert out.read_bytes() == whole.read_bytes()
    assert not kept.exists()


def test_ctrl_c_keeps_the_finished_rows(gearheat, tmp_path, monkeypatch) -> None:
    solve, calls = sweep_rows.Job.rows, []

    def interrupted(job, values, threads=0):
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return solve(job, values, threads)

    monkeypatch.setattr(sweep_rows.Job, "rows", interrupted)
    arguments = ("sweep", "planetary", *VARY, *KEPT, "--sample", "50", "-o", tmp_path / "out.csv")
    answer = gearheat(*arguments)
    assert answer.code == 130
    assert "goes on from there" in answer.err
    assert "32 of 50 rows were finished before" in gearheat(*arguments).err
    assert len(calls) == 5


def test_rows_of_another_sweep_are_not_taken(gearheat, tmp_path, monkeypatch) -> None:
    out = tmp_path / "out.csv"
    with monkeypatch.context() as patch:
        patch.setattr(sweep, "write_table", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        assert gearheat("sweep", "planetary", *VARY, *KEPT, "--sample", "20", "-o", out).code == 130
    answer = gearheat("sweep", "planetary", *VARY, *KEPT, "--sample", "20", "-o", out, "--set", "cooling.A=0.7 m2")
    assert answer.code == 0
    assert "belong to another sweep" in answer.err
    gearheat(
        "sweep", "planetary", *VARY, *KEPT, "--sample", "20", "-o", tmp_path / "b.csv", "--set", "cooling.A=0.7 m2"
    )
    assert out.read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_a_table_of_another_kind_is_not_replaced(gearheat, tmp_path) -> None:
    out, rest = tmp_path / "duty.csv", ("--grid", "2", *KEPT)
    out.write_text(duty := "time [min],carrier.w [rpm]\n0,100\n60,100\n")
    answer = gearheat("sweep", "planetary", "--vary", "room.T=10..35 degC", *rest, "-o", out)
    assert answer.code == 2
    assert "with other columns than this sweep. Move it away" in answer.err
    assert [path.read_text() for path in tmp_path.iterdir()] == [duty]
    out.write_text("")
    for high in (30, 35):  # an empty file holds nothing, and a sweep of the same columns may be run anew
        assert gearheat("sweep", "planetary", "--vary", f"room.T=10..{high} degC", *rest, "-o", out).code == 0
    assert column(table(out), "room.T [degC]") == pytest.approx([10.0, 35.0])


def test_a_work_file_keeps_whole_blocks(tmp_path) -> None:
    path = tmp_path / "x.part"
    blocks = [np.arange(6.0).reshape(3, 2), np.array([[np.nan, -0.0]])]
    with Store(path, "key", 2) as store:
        for k, block in enumerate(blocks):
            store.put(7 * k, block)
    whole = path.read_bytes()
    for cut in (1, 30, len(whole) - 30):
        path.write_bytes(whole[:-cut])
        with Store(path, "key", 2) as store:
            assert sorted(store.places) == ([0] if cut < 50 else [])
    damaged = bytearray(whole)
    damaged[-1] ^= 1
    path.write_bytes(damaged)
    with Store(path, "key", 2) as store:
        assert list(store.places) == [0]
        store.put(7, blocks[1])
    with Store(path, "key", 2) as store:
        assert all(store.get(7 * k).tobytes() == block.tobytes() for k, block in enumerate(blocks))
    path.write_bytes(b"somebody's notes")
    with pytest.raises(DataError, match="is no work file"):
        Store(path, "key", 2)
    assert path.read_bytes() == b"somebody's notes"


def test_two_sweeps_do_not_write_to_one_file(tmp_path) -> None:
    pytest.importorskip("fcntl", reason="this system has no file locks")
    with Store(tmp_path / "x.part", "key", 2), pytest.raises(DataError, match="another sweep is writing"):
        Store(tmp_path / "x.part", "key", 2)


# --- cluster ------------------------------------------------------------------------------------------------------


def test_a_cluster_gives_the_same_rows(gearheat, tmp_path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install gearheat[dask]")
    arguments = ("sweep", "planetary", *VARY, *KEPT, "--sample", "100")
    assert gearheat(*arguments, "-o", tmp_path / "local.csv").code == 0
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "worker_dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster:
        answer = gearheat(*arguments, "-o", tmp_path / "cluster.csv", "--scheduler", cluster.scheduler_address)
    assert answer.code == 0, answer.err
    assert (tmp_path / "cluster.csv").read_bytes() == (tmp_path / "local.csv").read_bytes()


class Slow:
    """Rows that take some time, in place of a job."""

    def rows(self, values: np.ndarray, threads: int) -> np.ndarray:
        time.sleep(0.2)
        return values + os.getpid()


def test_a_cluster_goes_on_when_its_worker_dies(capsys, monkeypatch) -> None:
    """The only worker, in the middle of its rows; the next one has nothing of what that had."""
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install gearheat[dask]")
    monkeypatch.setattr(cluster, "LOOK", 0.05)
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None, "worker_dashboard_address": None}
    with distributed.LocalCluster(**options) as there:
        blocks = ((k, np.array([float(k)])) for k in range(12))
        processes = set()
        for number, values in cluster.run_on_cluster(Slow(), blocks, there.scheduler_address):
            processes.add(process := int(values[0]) - number)
            if number == 2:
                os.kill(process, signal.SIGKILL)
    assert len(processes) == 2
    told = capsys.readouterr().err
    assert "has gone: others solve its rows again" in told and "no worker is left" in told


def test_a_cluster_that_is_not_there(gearheat, tmp_path, monkeypatch) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed: pip install gearheat[dask]")
    monkeypatch.setattr(cluster, "PATIENCE", 0.3)
    arguments = ("sweep", "planetary", *VARY, *KEPT, "--sample", "10", "-o", tmp_path / "out.csv")
    answer = gearheat(*arguments, "--scheduler", "tcp://127.0.0.1:9")
    assert answer.code == 2
    assert "no answer" in answer.err
    assert "dask scheduler" in answer.err


@pytest.mark.parametrize(
    ("module", "options", "remedy"),
    [
        ("distributed", ("-o", "out.csv", "--scheduler", "tcp://x:1"), "gearheat[dask]"),
        ("pyarrow", ("-o", "out.parquet"), "gearheat[parquet]"),
    ],
)
def test_a_missing_package_is_named_with_its_remedy(gearheat, tmp_path, monkeypatch, module, options, remedy) -> None:
    monkeypatch.chdir(tmp_path)
    for name in [n for n in sys.modules if n.partition(".")[0] == module]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, module, None)
    answer = gearheat("sweep", "planetary", *VARY, "--sample", "10", *options)
    assert answer.code == 2
    assert f'pip install "{remedy}"' in answer.err


# --- bad input ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--vary", "room.T=1..2"), ("has no unit",)),
        (("--vary", "room.T=35..10 degC", "--vary", "cooling.A~normal(1, 0) m2"), ("is not below", "not above 0")),
        (("--vary", "room.T=-300..10 degC"), ("out of range",)),
        (("--vary", "rom.T=10..20 degC"), ('Did you mean "room.T"',)),
        (("--vary", "oil.T=10..20 degC"), ("is a state",)),
        (("--vary", "room.T=10..20 degC", "--set", "room.T=20 degC"), ("is set as well",)),
        (("--vary", "room.T=10..20 degC", "--vary", "room.T=1..2 K"), ("varied twice",)),
        (("--vary", "room.T"), ("is no range",)),
        (("--vary", "room.T=10..20 degC", "--output", "oil.t"), ('Did you mean "oil.T"',)),
        (("--vary", "room.T=10..20 degC", "--duration", "1 h"), ("belongs to a warm-up",)),
        (("--vary", "room.T=10..20 degC", "--kind", "warmup"), ("--duration",)),
        (("--vary", "room.T=10..20 degC", "--kind", "warmup", "--duration", "0 s"), ("not above 0",)),
        (("--vary", "room.T=10..20 degC", "--kind", "warmup", "--duration", "1 h", "--every", "1 m"), ("1 m",)),
        (("--vary", "room.T=10..20 degC", "--sample", "0"), ("0 rows",)),
        (("--vary", "room.T=10..20 degC", "--seed", "-1"), ("negative",)),
        (("--vary", "room.T=10..20 degC", "--grid", "2"), ("either",)),
    ],
)
def test_bad_input_ends_with_a_remedy(gearheat, tmp_path, options, words) -> None:
    sample = () if "--sample" in options else ("--sample", "10")
    answer = gearheat("sweep", "planetary", *options, *sample, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert answer.out == ""
    for word in words:
        assert word in answer.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("grid", ["2", "2x0", "2xx3", "axb", "", "99999x99999"])
def test_bad_grids(gearheat, tmp_path, grid) -> None:
    answer = gearheat("sweep", "planetary", *VARY, "--grid", grid, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert "--grid" in answer.err


def test_all_problems_of_the_options_come_at_once(gearheat, tmp_path) -> None:
    answer = gearheat(
        "sweep", "planetary", "--vary", "x", "--set", "cooling.A=1", "--duty", tmp_path / "no.csv",
        "-o", tmp_path / "out.txt",
    )  # fmt: skip
    assert answer.code == 2
    for word in ("is no range", "cooling.A", ".parquet", "--sample", "--duty"):
        assert word in answer.err


def test_a_file_that_cannot_be_written_is_found_before_the_work(gearheat, tmp_path) -> None:
    answer = gearheat("sweep", "planetary", *VARY, "--sample", "10", "-o", tmp_path / "no" / "out.csv")
    assert answer.code == 2
    assert "cannot be written" in answer.err


def test_a_duty_and_a_range_for_the_same_input(gearheat, tmp_path) -> None:
    (tmp_path / "duty.csv").write_text(DUTY)
    options = ("--kind", "warmup", "--duty", tmp_path / "duty.csv", "--sample", "2", "-o", tmp_path / "out.csv")
    answer = gearheat("sweep", "planetary", "--vary", "carrier.w=100..200 rpm", *options)
    assert answer.code == 2
    assert "given by the duty" in answer.err


def test_seeds_below_zero() -> None:
    with pytest.raises(ScenarioError):
        sampling.draw_sample(AXES, 3, "lhs", seed=-1)
