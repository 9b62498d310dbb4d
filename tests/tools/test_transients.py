from __future__ import annotations

import csv

import numpy as np
import pytest
from gearheat.model.run.schedule import Schedule
from gearheat.model.run.simulate import simulate
from gearheat.tools.solve.simulate import compiled
from pages import problems_of
from small_parts import gear

DUTY = """time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]
0,150,2000,20
60,150,2000,22
60,0,0,22
65,0,0,22
65,150,-2000,22
95,150,-2000,24
"""


def columns(path):
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


@pytest.fixture(scope="module")
def duty(tmp_path_factory):
    path = tmp_path_factory.mktemp("duty") / "duty.csv"
    path.write_text(DUTY)
    return path


def test_simulate_starts_at_the_room_and_shows_both_sides_of_a_jump(gearheat, duty, tmp_path):
    out = tmp_path / "out.csv"
    found = gearheat("simulate", "planetary", "--duty", duty, "-o", out, "--set", "wall.T=30 degC", "--json", "-").json
    table = columns(out)
    assert table["oil.T [degC]"][0] == pytest.approx(20.0)
    assert table["wall.T [degC]"][0] == pytest.approx(30.0)
    assert table["time [s]"].count(3600.0) == 2
    jump = table["time [s]"].index(3600.0)
    assert table["carrier.w [rpm]"][jump : jump + 2] == pytest.approx([150.0, 0.0])
    assert table["oil.T [degC]"][-1] == pytest.approx(found["final"]["oil.T"], rel=1e-8)
    assert found["energy_residual"] < 1e-6
    assert found["rows"] == len(table["time [s]"])


def test_the_fmu_gives_what_the_model_gives(gearheat, duty, tmp_path):
    fmu, simulated, played = (tmp_path / name for name in ("rig.fmu", "simulated.csv", "played.csv"))
    settings = ("--set", "cooling.A=0.7 m2")
    assert gearheat("export", "--platform", "host", "planetary", "-o", fmu, *settings).code == 0
    pages = tmp_path / "simulated.html", tmp_path / "played.html"
    said = [
        gearheat("simulate", "planetary", "--duty", duty, "-o", simulated, "--plot", pages[0], *settings),
        gearheat("play", fmu, "--duty", duty, "-o", played, "--plot", pages[1]),
    ]
    assert [answer.code for answer in said] == [0, 0]
    summaries = [answer.out.splitlines()[1] for answer in said]
    assert summaries[0].startswith("over the duty: mean loss ") and " at the end " in summaries[0]
    assert summaries[0] == summaries[1]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert problems_of(text) == [] and '"oil.T"' in text
    ours, theirs = columns(simulated), columns(played)
    assert ours["time [s]"] == theirs["time [s]"]
    for name in ("oil.T [degC]", "wall.T [degC]", "surface.T [degC]"):
        assert theirs[name] == pytest.approx(ours[name], abs=1e-3)
    assert theirs["efficiency.P_loss [W]"] == pytest.approx(ours["efficiency.P_loss [W]"], abs=1e-2)


def test_the_mean_loss_over_a_duty_is_that_of_all_its_rows(gearheat, tmp_path):
    duty = tmp_path / "duty.csv"
    rows = [f"{10 * k},150,{2500 if k % 30 < 10 else 300},20" for k in range(181)]
    duty.write_text("time [s],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n" + "\n".join(rows))
    out = tmp_path / "out.csv"
    fine, coarse = (
        gearheat("simulate", "planetary", "--duty", duty, "-o", out, "--every", every) for every in ("10 s", "5 min")
    )
    assert fine.out.splitlines()[1] == coarse.out.splitlines()[1]
    assert columns(out)["time [s]"] == pytest.approx(np.arange(0.0, 1801.0, 300.0))


def test_both_start_at_the_room_of_the_duty(gearheat, tmp_path):
    fmu, duty, out = tmp_path / "rig.fmu", tmp_path / "duty.csv", tmp_path / "out.csv"
    duty.write_text("Time (min),carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n0,100,1500,35\n10,100,1500,35\n")
    assert gearheat("export", "--platform", "host", "planetary", "-o", fmu).code == 0
    first = []
    for command in (("simulate", "planetary"), ("play", fmu)):
        assert gearheat(*command, "--duty", duty, "-o", out).code == 0
        first.append([columns(out)[name][0] for name in ("oil.T [degC]", "wall.T [degC]")])
    assert first[0] == pytest.approx([35.0, 35.0])
    assert first[1] == pytest.approx(first[0])
    assert gearheat("play", fmu, "--duty", duty, "-o", out, "--set", "oil.T=50 degC").code == 0
    assert [columns(out)[name][0] for name in ("oil.T [degC]", "wall.T [degC]")] == pytest.approx([50.0, 35.0])
    duty.write_text("Zeit (min),carrier.w [rpm]\n0,100\n10,100\n")
    for command, where in ((("simulate", "planetary"), "at the operating point"), (("play", fmu), "in the FMU")):
        answer = gearheat(*command, "--duty", duty, "-o", out)
        assert f"not in the duty, so constant as {where}: carrier.tau = 2500 N.m" in answer.out
        assert "not in the duty" not in gearheat(*command, "--duty", duty, "-o", out, "--set", "carrier.tau=9 N.m").out


def test_an_fmu_takes_a_torque_with_its_sign_where_it_is_exported_so(gearheat, tmp_path):
    fmu, duty, out = tmp_path / "rig.fmu", tmp_path / "duty.csv", tmp_path / "out.csv"
    duty.write_text("time [min],input.w [rpm],output.tau [N.m]\n0,1450,-590\n5,1450,-590\n5,-1450,-590\n9,-1450,-590\n")
    export = ("export", "--platform", "host", "helical_two_stage", "-o", fmu, "--set")
    assert gearheat(*export, "output.load=590 N.m").code == 0
    refused = gearheat("play", fmu, "--duty", duty, "-o", out)
    assert refused.code == 2
    assert 'exported with --set "output.tau=... N.m"' in refused.err
    assert gearheat(*export, "output.tau=-590 N.m").code == 0
    assert gearheat("play", fmu, "--duty", duty, "-o", out).code == 0
    power = columns(out)["output.P [W]"]
    assert power[0] < 0 < power[-1]  # it lifts, and lowers


def test_a_load_of_a_duty_that_is_far_above_the_usual_is_told(gearheat, tmp_path):
    fmu, duty, out = tmp_path / "rig.fmu", tmp_path / "duty.csv", tmp_path / "out.csv"
    duty.write_text("time [min],carrier.w [rpm],carrier.tau [N.m]\n0,100,1500\n5,100,15000\n10,100,1500\n")
    assert gearheat("export", "--platform", "host", "planetary", "-o", fmu).code == 0
    for command, where in (("simulate", "planetary"), "the rig file"), (("play", fmu), "the FMU"):
        told = gearheat(*command, "--duty", duty, "-o", out).err
        assert f"duty.csv, row 2: carrier.tau = 15000 N.m is 6 times that of {where}, 2500 N.m. Check" in told
    duty.write_text("time [min],output.load [N.m]\n0,5900\n5,590\n")  # the rig file gives the torque of that end
    told = gearheat("simulate", "helical_two_stage", "--duty", duty, "-o", out).err
    assert "duty.csv, row 1: output.load = 5900 N.m is 10 times that of the rig file, -590 N.m." in told


def test_parameters_and_states_of_an_fmu_can_be_set(gearheat, duty, tmp_path):
    fmu, out = tmp_path / "rig.fmu", tmp_path / "played.csv"
    assert gearheat("export", "--platform", "host", "planetary", "-o", fmu).code == 0
    small = gearheat("play", fmu, "--duty", duty, "-o", out, "--json", "-", "--set", "cooling.A=0.3 m2").json
    large = gearheat("play", fmu, "--duty", duty, "-o", out, "--json", "-", "--set", "oil.T=20 degC").json
    assert small["final"]["oil.T"] > large["final"]["oil.T"] + 1
    assert columns(out)["oil.T [degC]"][0] == pytest.approx(20.0)
    answer = gearheat("play", fmu, "--duty", duty, "-o", out, "--set", "cooling.AA=1 m2", "--set", "foot.G=1 m2")
    assert answer.code == 2
    assert "cooling.A" in answer.err and "foot.G" in answer.err


@pytest.mark.parametrize(
    ("options", "inputs"),
    [
        ((), {"carrier.w", "carrier.tau"}),
        (("--drive", "sun"), {"sun.w", "sun.tau"}),
        (("--drive", "sun", "--given", "torque"), {"sun.tau", "carrier.tau"}),
        (("--set", "sun.w=1000 rpm"), {"sun.w", "carrier.tau"}),
    ],
)
def test_inputs_of_an_fmu_follow_from_what_is_given(gearheat, tmp_path, options, inputs):
    found = gearheat(
        "export", "--platform", "host", "planetary", "-o", tmp_path / "rig.fmu", *options, "--json", "-"
    ).json
    assert {name for name in found["inputs"] if name.endswith((".w", ".tau"))} == inputs
    assert {"room.T", "room.air_speed", "oil.Q_flow_external"} <= set(found["inputs"])


def test_a_duty_says_how_the_rig_is_driven(gearheat, duty, tmp_path):
    text = duty.read_text().replace("carrier.w", "sun.w").replace("150,", "600,")
    (tmp_path / "sun.csv").write_text(text)
    ours = gearheat("simulate", "planetary", "--duty", duty, "-o", tmp_path / "a.csv", "--json", "-").json
    theirs = gearheat(
        "simulate", "planetary", "--duty", tmp_path / "sun.csv", "-o", tmp_path / "b.csv", "--json", "-"
    ).json
    assert theirs["final"]["carrier.w"] == pytest.approx(150.0)
    assert theirs["final"]["oil.T"] == pytest.approx(ours["final"]["oil.T"], abs=1e-4)


def test_a_long_duty_through_compiled_code_is_that_of_idas():
    flat = gear()
    time = 60 * np.repeat(np.arange(30.0), 2)[1:-1]
    given = np.random.default_rng(0).uniform(-100.0, 100.0, (2, len(time)))
    schedule = Schedule(time, dict(zip(("drive.w", "load.tau"), given, strict=True)))
    exact, fast = simulate(flat, schedule), simulate(flat, schedule, through=compiled(flat, schedule))
    assert (fast.index == exact.index).all()
    for name, column in exact.columns.items():
        assert fast.columns[name] == pytest.approx(column, rel=1e-6, abs=1e-4), name
    assert fast.laws == exact.laws and fast.audit.residual < 1e-6
