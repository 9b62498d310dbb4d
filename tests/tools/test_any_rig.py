"""Commands that read measured tables, on a rig that was never measured, with column names of the user."""

from __future__ import annotations

import csv

import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.readings import measured_rows
from gearheat.scenarios.measured.study import read_study
from made_tables import made, written

RIG = "helical_two_stage"
CARD = """
[columns]
T_output = "Abtrieb"
"input.tau" = "M_an [Nm]"
[sensors.T_output]
magnitude = true
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("measured")
    columns = made(load(RIG))
    torque = columns.pop("T_output_Nm")
    columns |= {"Abtrieb": [-v for v in torque], "M_an [Nm]": [round(-1.02 * v / 12.5591, 4) for v in torque]}
    card = folder / "card.toml"
    card.write_text(CARD)
    return written(folder / "data.csv", columns), card


def test_loss_and_efficiency_follow_from_the_rigs_own_ratio(files):
    study = read_study(load(RIG), *files)
    assert study is not None
    for row in measured_rows(study):
        w, ratio = row["n_input_rpm"] * 3.141592653589793 / 30, 77 / 20 * 62 / 19
        into = 1.02 * row["T_output_Nm"] / 12.5591
        assert row["loss_Nm_meas"] == pytest.approx(into - row["T_output_Nm"] / ratio, rel=1e-3)
        assert row["P_loss_W_meas"] == pytest.approx(row["loss_Nm_meas"] * w)
        assert row["efficiency_meas"] == pytest.approx(1 / 1.02, rel=1e-3)
        assert (row["n_set_rpm"], row["T_set_Nm"]) == (row["n_input_rpm"], row["T_output_Nm"])


def test_without_a_torque_no_loss_is_shown(tmp_path):
    study = read_study(load(RIG), written(tmp_path / "data.csv", made(load(RIG))))
    assert study is not None
    assert all("loss_Nm_meas" not in row and "T_oil_C_meas" in row for row in measured_rows(study))


def test_losses_at_the_readings(gearheat, files):
    data, card = files
    found = gearheat("losses", RIG, "--data", data, "--card", card, "--json", "-").json
    assert len(found["rows"]) == 6
    for row in found["rows"]:
        assert row["P_total_W"] == pytest.approx(sum(v for k, v in row.items() if k in PARTS), rel=1e-6)
        assert 5 < row["alphaA_W_K"] < 15


PARTS = ("P_mesh_W", "P_dgb_W", "P_seal_W", "P_churn_W")


def test_a_run_over_steady_states_reaches_them_and_compare_reads_it_back(gearheat, files, tmp_path):
    data, card = files
    options = ("--data", data, "--card", card)
    arguments = ("--tests", "1,6", "--jobs", "1", "--out", tmp_path / "out", "--json", "-")
    found = gearheat("run", RIG, *options, *arguments).json
    assert [row["test"] for row in found["rows"]] == [1, 6]
    for row in found["rows"]:
        assert abs(row["T_oil_C"] - row["T_oil_C_meas"]) < 1.5 and abs(row["T_wall_C"] - row["T_wall_C_meas"]) < 1.5
    assert set(found["rmse"]["overall"]) == {"T_oil_K", "T_wall_K", "loss_Nm"}
    again = gearheat("compare", tmp_path / "out" / "rows.csv", data, "--rig", RIG, "--card", card, "--json", "-").json
    for key, value in found["rmse"]["overall"].items():
        assert again["rmse"]["overall"][key] == pytest.approx(value, rel=1e-6)
    rows = list(csv.DictReader((tmp_path / "out" / "rows.csv").open()))
    assert {"T_oil_C_meas", "n_input_rpm", "n_set_rpm"} <= set(rows[0])


def test_calibration_needs_neither_grid_nor_campaign_in_the_rig_file(gearheat, files):
    data, card = files
    found = gearheat("calibrate", RIG, "--data", data, "--card", card, "--free", "foot.G", "--json", "-").json
    assert found["readings"] == 6 and found["rmse_after_K"] <= found["rmse_before_K"] < 1.0
    nothing = gearheat("calibrate", RIG, "--free", "foot.G")
    assert nothing.code == 2 and "Give them as --data FILE" in nothing.err


@pytest.mark.parametrize("rows", [1, 4])
def test_steady_states_are_fitted_with_what_made_them_however_many_a_test_has(gearheat, tmp_path, rows):
    table, card = tmp_path / "points.csv", tmp_path / "card.toml"
    vary = [
        x for v in ("input.w=700..1450 rpm", "output.tau=-590..-200 N.m", "room.T=15..25 degC") for x in ("--vary", v)
    ]
    options = ("--grid", "2x2x2", "--set", "foot.G=5 W/K", "--output", "oil.T", "-o", table)
    assert gearheat("sweep", RIG, *vary, *options).code == 0
    lines = table.read_text().splitlines()
    numbered = [f"{line},{'test' if k == 0 else (k - 1) // rows + 1}" for k, line in enumerate(lines)]
    table.write_text("\n".join(numbered) + "\n")
    columns = {
        "n_input": "input.w [rpm]",
        "T_output": "output.tau [N.m]",
        "T_oil": "oil.T [degC]",
        "T_amb": "room.T [degC]",
    }
    card.write_text("[columns]\n" + "".join(f'{key} = "{name}"\n' for key, name in columns.items()))
    measured = ("--data", table, "--card", card)
    found = gearheat("calibrate", RIG, *measured, "--free", "foot.G", "--json", "-").json
    assert found["free"]["foot.G"]["value"] == pytest.approx(5.0, rel=1e-4)
    assert found["rmse_after_K"] < 1e-3 < found["rmse_before_K"]
    options = ("--set", "foot.G=5 W/K", "--jobs", 1, "--out", tmp_path / "out", "--json", "-")
    assert gearheat("run", RIG, *measured, *options).json["rmse"]["overall"]["T_oil_K"] < 1e-3


def test_card_command(gearheat, tmp_path):
    path = tmp_path / "card.toml"
    assert gearheat("card", RIG, "-o", path).code == 0
    assert 'T_oil = "T_oil_C"' in path.read_text()
    assert gearheat("card", RIG, "--json", "-").json["channels"]["T_oil"] == {
        "repeat_sd": "0.35 K",
        "offset_sd": "0.3 K",
        "checked": False,
    }
    assert gearheat("card", "helicl").code == 2
