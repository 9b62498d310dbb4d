"""The desk: its sheets in a browser, and nothing for those without its token; guesses of a table's columns."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import gearheat as gh
import pytest
from browser import CHROMIUM, Browser
from gearheat.model.errors import DataError
from gearheat.scenarios.given import scenario_of
from gearheat.scenarios.measured.study import read_study

NICEGUI = find_spec("nicegui") is not None
needs_nicegui = pytest.mark.skipif(not NICEGUI, reason="the desk needs NiceGUI: pip install gearheat[desk]")
#: What is seen of the page.
SAID = "document.body.innerText"
#: Moves a slider of the page in the sheet Map to its lower end.
SLIDE = """(() => {
  const page = document.querySelector("#map").contentDocument;
  const slider = page.querySelector('[id="f-carrier.tau"]').parentElement.querySelector("[type=range]");
  slider.value = slider.min;
  slider.dispatchEvent(new Event("input"));
})()"""
#: Name of the assumed value that matters most.
FIRST_ASSUMED = "document.querySelector('.assumed tbody td')?.innerText"
#: Says where the value that is changed is from.
SOURCE = """(() => {
  const field = document.querySelector(".source input");
  field.value = "drawing 4711";
  field.dispatchEvent(new Event("input", { bubbles: true }));
})()"""
TABLE = """Messpunkt;Drehzahl [1/min];Abtrieb [Nm];Antrieb [Nm];Ölsumpf [°C];Gehäuse [°C];Halle [°C];Bemerkung
1;600;150;12,4;22,24;22,49;19,4;a
2;600;350;28,6;25,54;25,16;19,8;
3;900;150;12,42;25,44;25,06;20,6;
4;900;580;47,28;34,06;32,99;21,4;
5;1200;350;28,62;33,12;32,2;22,2;
6;1450;580;47,25;42,58;41,19;23,8;b
"""


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("table") / "messung.csv"
    path.write_text(TABLE, encoding="utf-8")
    return path


def test_german_columns_are_guessed_with_units_and_signs(table: Path, tmp_path: Path) -> None:
    found = gh.card("helical_two_stage", table)
    assert not found.problems
    assert {column: found.reads[name] for name, column in found.columns.items() if "." in found.reads[name]} == {
        "Drehzahl [1/min]": "input.w",
        "Abtrieb [Nm]": "output.tau",
        "Antrieb [Nm]": "input.tau",
        "Ölsumpf [°C]": "oil.T",
        "Gehäuse [°C]": "wall.T",
        "Halle [°C]": "room.T",
    }
    assert found.columns["point"] == "Messpunkt"
    card = found.as_dict()
    assert card["units"]["Drehzahl [1/min]"] == "rpm"
    assert card["sensors"]["T_output"]["magnitude"] and not card["sensors"]["T_input"]["magnitude"]
    assert found.cells[1][3] == "12.4"
    said = gh.card("helical_two_stage", table, columns={"T_wall": ""}, magnitudes={"T_output": False})
    assert "T_wall" not in said.columns and "Gehäuse [°C]" not in said.columns.values()
    assert not said.as_dict()["sensors"]["T_output"]["magnitude"]
    with pytest.raises(DataError, match='no column "Gehause'):
        gh.card("helical_two_stage", table, columns={"T_wall": "Gehause [°C]"})


def test_readings_with_names_are_no_points(tmp_path: Path) -> None:
    named = TABLE.replace("Messpunkt", "Nr").replace("\n", "\nV", 6)
    (path := tmp_path / "feld.csv").write_text(named, encoding="utf-8")
    found = gh.card("helical_two_stage", path)
    assert not found.problems and found.columns["test"] == "Nr" and "point" not in found.columns


def test_what_drives_is_what_the_table_has(tmp_path: Path) -> None:
    rows = [f"{600 + 100 * k};{12 + k},4;{22 + 2 * k},2;19,4" for k in range(7)]
    (path := tmp_path / "feld.csv").write_text("\n".join(["n_an [1/min];M1 [Nm];Öl;Halle", *rows]), encoding="utf-8")
    found = gh.card("helical_two_stage", path)
    assert not found.problems
    assert found.columns["n_input"] == "n_an [1/min]" and found.columns["input.tau"] == "M1 [Nm]"
    assert found.columns["T_oil"] == "Öl" and "T_output" not in found.columns
    assert found.as_dict()["sensors"]["T_input"]["role"] == "given"


def test_a_power_drives_where_no_torque_does(tmp_path: Path) -> None:
    states = [gh.steady("helical_two_stage", set={"input.w": f"{600 + 100 * k} rpm"}) for k in range(6)]
    rows = [f"{600 + 100 * k};{s['input.P'] / 1e3:.4f};{s.to('oil.T', 'degC'):.3f};20" for k, s in enumerate(states)]
    (path := tmp_path / "feld.csv").write_text("\n".join(["Drehzahl [1/min];Leistung [kW];Öl;Halle", *rows]))
    card = gh.card("helical_two_stage", path)
    assert not card.problems and card.columns["input.tau"] == "Leistung [kW]"
    study = read_study(scenario_of("helical_two_stage"), path, card.save(tmp_path / "card.toml"))
    assert study
    assert [study.given(k)["input.tau"] for k in range(6)] == pytest.approx([s["input.tau"] for s in states], rel=1e-3)


def test_a_second_probe_of_the_housing_is_no_other_body(tmp_path: Path) -> None:
    head = "n1 [1/min];M2 [Nm];T_Öl_1 [°C];T_Geh_oben [°C];T_Geh_unten [°C];Raum [°C]"
    (path := tmp_path / "feld.csv").write_text("\n".join([head, "600;150;30;29;28;20"]), encoding="utf-8")
    found = gh.card("helical_two_stage", path)
    assert {column: found.reads[name] for name, column in found.columns.items() if "." in found.reads[name]} == {
        "n1 [1/min]": "input.w",
        "M2 [Nm]": "output.tau",
        "T_Öl_1 [°C]": "oil.T",
        "T_Geh_oben [°C]": "wall.T",
        "Raum [°C]": "room.T",
    }


def test_a_unit_behind_in_is_no_end_of_a_shaft(tmp_path: Path) -> None:
    head = "Speed in rpm;Torque in Nm;Oil temperature in degC;Room temperature in degC"
    (path := tmp_path / "feld.csv").write_text("\n".join([head, "600;150;30;20"]), encoding="utf-8")
    found = gh.card("helical_two_stage", path)
    assert found.columns["n_input"] == "Speed in rpm" and found.columns["T_output"] == "Torque in Nm"


@pytest.mark.parametrize("end", ["input", "output"])
def test_a_torque_of_no_shaft_is_of_the_one_whose_torques_are_that_large(tmp_path: Path, end: str) -> None:
    rig = tmp_path / "belt.toml"
    gh.new("belt", stages="helical,helical", ratio=20, power="30 kW", speed="1480 rpm", out=rig)
    usual = abs(gh.steady(rig)[f"{end}.tau"])
    rows = [f"1480;{share * usual:.1f};{40 + 20 * share:.1f};20" for share in (0.3, 0.6, 0.9)]
    (path := tmp_path / "feld.csv").write_text("\n".join(["speed;torque;T_oil;T_room", *rows]), encoding="utf-8")
    card = gh.card(rig, path)
    assert {card.reads[name] for name, column in card.columns.items() if column == "torque"} == {f"{end}.tau"}


def test_cells_below_zero_are_no_magnitudes(tmp_path: Path) -> None:
    rows = [f"{100 + 10 * k};-{300 + 20 * k};{50 + 2 * k};20" for k in range(7)]
    (path := tmp_path / "feld.csv").write_text(
        "\n".join(["n_carrier_rpm;T_sun_Nm;T_oil;T_amb", *rows]), encoding="utf-8"
    )
    card = gh.card("planetary", path).save(tmp_path / "card.toml")
    study = read_study(scenario_of("planetary"), path, card)
    assert study and study.campaign.values["T_sun"][0] == -300
    assert study.given(0)["sun.tau"] == -300


def test_noise_at_rest_is_below_zero_in_a_column_of_magnitudes(tmp_path: Path) -> None:
    rows = [f"{100 * (k > 0)};{(300 + 20 * k) if k else -2};{50 + 2 * k};20" for k in range(7)]
    (path := tmp_path / "feld.csv").write_text(
        "\n".join(["n_carrier_rpm;T_sun_Nm;T_oil;T_amb", *rows]), encoding="utf-8"
    )
    said = [gh.card("planetary", path, magnitudes=known).as_dict()["sensors"] for known in ({}, {"T_sun": True})]
    assert said[0]["T_sun"]["magnitude"] == said[1]["T_sun"]["magnitude"] is True


def test_a_torque_that_nothing_says_is_told(tmp_path: Path) -> None:
    rows = [f"{2000 + 100 * k};{50 + 2 * k};20" for k in range(7)]
    (path := tmp_path / "feld.csv").write_text("\n".join(["n_motor_rpm;T_oil;T_amb", *rows]), encoding="utf-8")
    study = read_study(scenario_of("drum_motor"), path, gh.card("drum_motor", path).save(tmp_path / "card.toml"))
    assert study
    said = "feld.csv: nothing says motor_shaft.tau, which drives the model: 7.371 N.m of the rig is taken in all rows."
    assert said in study.campaign.warnings


def test_steady_points_are_played_from_the_state_of_what_drives(tmp_path: Path) -> None:
    states = [gh.steady("helical_two_stage", set={"input.w": f"{600 + 100 * k} rpm"}) for k in range(6)]
    rows = [f"{600 + 100 * k},{s['input.tau']:.3f},{s.to('oil.T', 'degC'):.3f},20" for k, s in enumerate(states)]
    (path := tmp_path / "feld.csv").write_text("\n".join(["n_an [1/min],M1 [Nm],Öl,Halle", *rows]), encoding="utf-8")
    card = gh.card("helical_two_stage", path).save(tmp_path / "card.toml")
    fit = gh.calibrate("helical_two_stage", ["cooling.A"], data=path, card=card)
    assert fit.found["rmse_before_K"] < 0.01


def test_without_nicegui_the_command_says_which_extra_it_needs(gearheat, monkeypatch, tmp_path) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr("gearheat.tools.desk.find_spec", lambda name: None)
    answer = gearheat("desk", "-o", tmp_path / "desk")
    assert answer.code == 2
    assert 'pip install "gearheat[desk]"' in answer.err


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("desk")
    command = [sys.executable, "-m", "gearheat", "desk", "--no-browser", "-o", "desk"]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout
    yield process.stdout.readline().strip()
    process.terminate()
    process.communicate()


@needs_nicegui
def test_without_the_token_there_is_nothing(address: str) -> None:
    client = pytest.importorskip("websockets.sync.client")
    refused = pytest.importorskip("websockets.exceptions").InvalidStatus
    found = re.fullmatch(r"(http://127\.0\.0\.1:\d+)/([\w-]{32})/", address)
    assert found
    root, token = found.groups()
    with urlopen(address) as answer:
        assert b"gearheat" in answer.read()
    for path in (
        "/",
        f"/{token[:-1]}/",
        f"/{token[:-1]}x/",
        "/files/",
        "/_nicegui_ws/socket.io/",
        f"/x/{token}/",
        "/%2F",
    ):
        with pytest.raises(HTTPError) as error:
            urlopen(f"{root}/{path}")
        assert error.value.code == 403
    with pytest.raises(refused, match="403"):
        client.connect(root.replace("http", "ws") + "/_nicegui_ws/socket.io/?EIO=4&transport=websocket")
    with client.connect(address.replace("http", "ws") + "_nicegui_ws/socket.io/?EIO=4&transport=websocket") as socket:
        assert socket.recv(timeout=10).startswith("0")


def test_a_port_that_is_taken_is_refused(gearheat, tmp_path) -> None:  # type: ignore[no-untyped-def]
    pytest.importorskip("nicegui", reason="the desk needs NiceGUI: pip install gearheat[desk]")
    answer = gearheat("desk", "--port", "99999", "-o", tmp_path / "desk")
    assert answer.code == 2
    assert "--port 99999" in answer.err


@needs_nicegui
@pytest.mark.skipif(not CHROMIUM, reason="no browser")
def test_a_german_table_becomes_a_diagnosis_by_clicks_and_the_other_sheets_open(address: str, tmp_path: Path) -> None:
    with Browser(tmp_path / "profile") as browser:
        browser.open(address)
        browser.drop(".q-uploader", "kaputt.csv", "a;b\n1;2;3\n")
        browser.wait(f"{SAID}.includes('kaputt.csv line 2: 3 cells under 2 column names')")
        with urlopen(f"{address}files/kaputt.csv") as kept:
            assert kept.read() == b"a;b\n1;2;3\n"
        browser.drop(".q-uploader", "messung.csv", TABLE)
        browser.wait(f"{SAID}.includes('Gehäuse [°C]')")
        assert not browser.js("document.querySelectorAll('.problem').length")
        browser.click("Diagnose")
        browser.wait("document.querySelector('.verdict')", 500)
        browser.wait("document.querySelector('#report').contentDocument?.body?.innerText.includes('helical_two_stage')")
        browser.wait("document.querySelector('canvas, .nicegui-echart svg')")
        said = browser.js(SAID)
        assert "gearheat card helical_two_stage --data desk/messung.csv -o desk/messung.card.toml" in said
        assert "gearheat diagnose desk/messung.csv --rig helical_two_stage --card desk/messung.card.toml" in said
        browser.show("desk_data.png")
        browser.click("New")
        browser.click("Make")
        browser.wait(f"{SAID}.includes('Assumed values, those that matter most first')")
        browser.wait("document.querySelector('.drawing img')?.naturalWidth > 100")
        first = browser.js(FIRST_ASSUMED)
        browser.click("Write")
        browser.wait(f"{SAID}.includes('a value has a source')")
        browser.js(SOURCE)
        browser.click("Write")
        browser.wait(f"{FIRST_ASSUMED} !== {json.dumps(first)}")
        assert "gearheat.load('desk/mine.toml').with_(" in browser.js(SAID)
        browser.show("desk_new.png")
        browser.click("Rigs")
        browser.click("Compare")
        browser.wait(f"{SAID}.includes('Steady states at the operating points')")
        browser.show("desk_rigs.png")
        browser.click("Map")
        browser.click("Show")
        browser.wait("document.querySelector('#map')?.contentDocument?.body?.dataset.ready", 300)
        browser.js(SLIDE)
        browser.wait(f"{SAID}.includes(\"gearheat steady planetary --set 'carrier.tau=250 N.m'\")")
        browser.js("document.querySelector('#map').contentDocument.getElementById('fields').scrollIntoView()")
        browser.show("desk_map.png")


def test_a_bearing_housing_is_not_the_housing(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    head = "n1 [1/min];M2 [Nm];Sumpf [°C];Lagergehäuse Antrieb [°C];Gehäusewand [°C];Halle [°C]"
    table.write_text(head + "\n" + "1450;590;45,1;49,2;41,0;20,1\n" * 7, encoding="utf-8")
    assert gh.card("helical_two_stage", table).columns["T_wall"] == "Gehäusewand [°C]"
