"""A load without a sign, and signed torques, on machines of one to four stages."""

from __future__ import annotations

import re

import gearheat as gh
import numpy as np
import pytest
from gearheat.fmu.export import export
from gearheat.model.errors import GearheatError, ScenarioError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import read_card
from gearheat.scenarios.measured.nominal import drive_by, model_values
from gearheat.scenarios.measured.read import read_campaign

COUNTS = (1, 2, 3, 4)


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """The file of a machine of so many stages; made once."""
    folder = tmp_path_factory.mktemp("loads")

    def of(count):
        if not (path := folder / f"of{count}.toml").exists():
            stages = ",".join(["spur"] * count)
            gh.new(path.stem, stages=stages, ratio=2.5**count, power="2 kW", speed="1450 rpm", out=path)
        return path

    return of


@pytest.mark.parametrize("count", COUNTS)
def test_power_flows_as_the_rig_means_it_with_a_load_and_with_the_right_sign(rig, count):
    usual = gh.steady(rig(count))
    assert list(usual.power()) == ["input", "output"] and not usual.backward
    assert usual.title.endswith("kW out at output") and usual["input.P"] == pytest.approx(2000, rel=0.02)
    assert re.fullmatch(r"bearing (SKF|NU) .+ at input", usual.called("input_bearing_a"))
    assert usual.called("output_seal") == "seal at output"
    torque = usual["output.tau"]
    assert np.sign(torque) == (-1) ** (count + 1)
    for sign, backward in ((1, False), (-1, True)):
        signed = gh.steady(rig(count), {"output.tau": sign * torque})
        assert signed.backward == backward
        assert (signed["oil.T"] == pytest.approx(usual["oil.T"], rel=1e-9)) == (not backward)
    turned = gh.steady(rig(count), {"input.w": -usual["input.w"]})
    assert not turned.backward and turned["output.tau"] == pytest.approx(-torque)
    driven = gh.steady(rig(count), {"drives": "output"})
    assert list(driven.power()) == ["output", "input"] and not driven.backward
    assert driven["output.tau"] == pytest.approx(-torque)


def test_what_is_far_from_the_rig_file_is_told(rig, gearheat):
    answer = gearheat("steady", rig(1), "--set", "input.w=14800 rpm")
    assert answer.code == 0
    assert "input.w = 14800 rpm is 10.2 times that of the rig file, 1450 rpm. Check its digits" in answer.err


def test_a_load_holds_against_either_rotation_over_time(rig, gearheat, tmp_path):
    duty, out = tmp_path / "duty.csv", tmp_path / "run.csv"
    rows = ["time [min],input.w [rpm],output.load [N.m]", "0,1450,30", "10,1450,30", "20,-1450,30", "30,-1450,30"]
    duty.write_text("\n".join(rows))
    run = gh.simulate(rig(1), duty)
    assert run["input.P"].min() > -1e-3 and run["output.P"].max() < 1e-3  # it stands still once
    assert set(np.sign(run["output.tau"])) == {-1.0, 0.0, 1.0} and run.as_dict()["backward"] == 0
    duty.write_text("\n".join(rows).replace("load", "tau").replace(",30", ",-30"))
    answer = gearheat("simulate", rig(1), "--duty", duty, "-o", out)
    assert answer.code == 0 and "rows: power flows the other way" in answer.err


@pytest.mark.parametrize("count", COUNTS)
def test_runs_and_fmus_take_loads_and_signed_torques_alike(rig, count, tmp_path):
    scenario = load(rig(count))
    point = gh.steady(scenario)
    begun = {f"{body}.T": point[f"{body}.T"] for body in ("oil", "wall", "gears", "shafts", "surface")}
    room, oils = {key: value for key, value in scenario.operating_point.items() if key.startswith("room")}, []
    for key, driven in (("load", scenario), ("tau", scenario.driven_by_torques())):
        torque = abs(point["output.tau"]) if key == "load" else point["output.tau"]
        duty, fmu = tmp_path / f"{key}.csv", tmp_path / f"{key}.fmu"
        duty.write_text(f"time [min],input.w [rpm],output.{key} [N.m]\n0,1450,{torque}\n60,1450,{torque}\n")
        export(driven.spec.flat(), fmu, start=room | {f"output.{key}": torque})
        for run in (gh.simulate(scenario, duty, set=begun), gh.play(fmu, duty, set=begun)):
            assert run["output.tau"] == pytest.approx(point["output.tau"])
            assert run["input.P"][-1] > -run["output.P"][-1] > 0.9 * run["input.P"][-1]
            oils.append(run["oil.T"][-1])
    assert oils == pytest.approx([point["oil.T"]] * 4, abs=1e-3)


@pytest.mark.parametrize("count", COUNTS)
def test_a_diagnosis_takes_loads_and_signed_torques_of_a_table_alike(rig, count, tmp_path):
    scenario = load(rig(count))
    (card := tmp_path / "card.toml").write_text("")
    point = gh.steady(scenario)
    found, oils = [], []
    for sign in (1, -1):
        (path := tmp_path / f"{sign}.csv").write_text(
            "n_input_rpm,T_output_Nm,T_oil_C,T_wall_C,T_amb_C\n"
            + "".join(
                f"1450,{sign * share * abs(point['output.tau']):.3f},{point.to('oil.T', 'degC') - 1 / share:.1f},"
                f"{point.to('wall.T', 'degC') - 1 / share:.1f},20\n"
                for share in (1.0, 0.8)
            )
        )
        campaign = read_campaign(path, scenario, read_card(card))
        found.append(model_values(campaign)["output.tau"])
        driven = drive_by(scenario, campaign.sensors)
        oils.append(gh.steady(driven, {"output.tau": found[-1][0]})["oil.T"])
    assert driven.operating_point["output.tau"] == pytest.approx(point["output.tau"])
    assert found[0] == pytest.approx(found[1])
    assert found[0][0] == pytest.approx(point["output.tau"], rel=1e-3)
    assert oils == pytest.approx([point["oil.T"]] * 2, abs=0.01)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"output.load": "-300 N.m"}, "output.load .* must be at least 0 N.m"),
        ({"drives": "outptu"}, '"outptu" is no shaft end. Did you mean "output"'),
        (
            {"output.load": "300 N.m", "output.tau": "300 N.m"},
            "output.tau and output.load are given, but one",
        ),
    ],
)
def test_loads_that_cannot_be(rig, settings, words):
    with pytest.raises(GearheatError, match=words):
        gh.steady(rig(1), settings)


def test_a_file_that_names_no_end_is_told(rig, tmp_path):
    text = rig(1).read_text("utf-8").replace('drives = "input"', 'drives = "inptu"')
    (path := tmp_path / "bad.toml").write_text(text)
    with pytest.raises(ScenarioError, match=r'drives = "inptu" is no shaft end. Did you mean "input"'):
        load(path)


def test_it_is_written_as_it_was_read(rig, tmp_path):
    gh.load(rig(1)).save(path := tmp_path / "again.toml")
    again = load(path)
    assert (again.drives, again.given) == ("input", load(rig(1)).given)
