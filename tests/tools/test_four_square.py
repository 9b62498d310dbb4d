"""Every command on a rig whose power loop is closed: it has no output shaft, no efficiency and no measured data."""

import fmpy
import pytest
from fmpy.validation import validate_fmu
from gearheat.fmu.play import play
from gearheat.model.errors import FmuError

RIG = "fzg_four_square"


def test_list_and_show_name_it(gearheat):
    assert RIG in gearheat("list").out
    shown = gearheat("show", RIG)
    assert shown.code == 0
    assert "LoadingClutch" in shown.out and "Arana2019" in shown.out


def test_steady_and_losses_agree(gearheat):
    steady = gearheat("steady", RIG, "--set", "clutch.tau=302 N.m", "--json", "-").json["values"]
    (row,) = gearheat("losses", RIG, "--set", "clutch.tau=302 N.m", "--json", "-").json["rows"]
    assert row["P_total_W"] == pytest.approx(row["P_mesh_W"] + row["P_crb_W"] + row["P_seal_W"], rel=1e-9)
    assert row["T_loss_Nm"] == pytest.approx(steady["motor.tau"], rel=1e-9)


def test_sweep_gives_loss_torque_over_speed_and_load(gearheat, tmp_path):
    vary = ("--vary", "motor.w=66.7..2333.3 rpm", "--vary", "clutch.tau=94.1..302 N.m", "--grid", "4x3")
    found = gearheat("sweep", RIG, *vary, "--out", tmp_path / "losses.csv", "--json", "-").json
    assert found["status"] == {"ok": 12}
    assert abs(found["outputs"]["clutch.slip"]["high"]) < 1e-9


def test_design_finds_the_twist_for_a_loss_torque(gearheat):
    answer = gearheat("design", RIG, "--free", "clutch.tau", "--target", "motor.tau=8 N.m", "--json", "-")
    assert answer.code == 0, answer.err
    assert 183.0 < answer.json["free"]["clutch.tau"] < 302.0


@pytest.mark.parametrize("given", ["speed", "torque"])
def test_its_fmu_validates(gearheat, tmp_path, given):
    path = tmp_path / "four_square.fmu"
    assert gearheat("export", "--platform", "host", RIG, "--out", path, "--given", given).code == 0
    assert validate_fmu(str(path)) == []


def test_its_fmu_comes_to_the_steady_state(gearheat, tmp_path):
    path = tmp_path / "four_square.fmu"
    gearheat("export", "--platform", "host", RIG, "--out", path)
    steady = gearheat("steady", RIG, "--json", "-").json["values"]
    end = fmpy.simulate_fmu(
        str(path), stop_time=36000.0, output_interval=600.0, output=["motor.tau", "oil.T", "clutch.slip"]
    )[-1]
    assert end["motor.tau"] == pytest.approx(steady["motor.tau"], rel=1e-6)
    assert end["oil.T"] == pytest.approx(steady["oil.T"] + 273.15, abs=1e-4)
    assert end["clutch.slip"] == 0.0


def test_what_needs_measured_data_says_so(gearheat):
    answer = gearheat("calibrate", RIG, "--grid", "a", "--free", "cooling.A")
    assert answer.code == 2
    assert "--data FILE" in answer.err


def test_ratios_that_do_not_fit_are_refused(gearheat):
    answer = gearheat("steady", RIG, "--set", "slave_gears.z_1=15", "--set", "slave_gears.z_2=25")
    assert answer.code == 2
    assert "clutch: the loop does not close" in answer.err and "Traceback" not in answer.err


def test_its_fmu_refuses_ratios_that_do_not_fit(gearheat, tmp_path):
    path = tmp_path / "four_square.fmu"
    gearheat("export", "--platform", "host", RIG, "--out", path)
    other = {"slave_gears.z_1": 15.0, "slave_gears.z_2": 25.0}
    with pytest.raises(FmuError, match=r"clutch\.slip"):
        play(path, {}, stop=1.0, step=1.0, start=other)
