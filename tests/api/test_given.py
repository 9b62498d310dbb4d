"""What Python may give: values, times, ranges and tables in any sensible form, and words for all others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.model.run import simulate as transient
from gearheat.scenarios.frames import card_file, path_of, rows_told
from gearheat.scenarios.measured.card import read_card
from gearheat.tools.export.fmu import choices_of

HEAD = "time [h],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n"


@pytest.fixture(scope="module")
def rig() -> gh.Rig:
    return gh.load("planetary")


@pytest.fixture(scope="module")
def day(tmp_path_factory: pytest.TempPathFactory) -> Path:
    (path := tmp_path_factory.mktemp("duty") / "day.csv").write_text(f"{HEAD}0,150,2000,20\n24,150,2000,22\n")
    return path


@pytest.mark.parametrize(("every", "rows"), [(None, 1441), ("10 min", 145), (3600, 25)])
def test_how_often_a_run_has_a_row(rig: gh.Rig, day: Path, every: object, rows: int) -> None:
    assert len(gh.simulate(rig, day, every=every)) == rows


def test_a_year_has_fewer_rows_and_says_so(
    rig: gh.Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (path := tmp_path / "year.csv").write_text(f"{HEAD}0,150,2000,20\n8760,150,2000,22\n")
    assert len(gh.simulate(rig, path).time) == 17521
    assert "a row every 30 min" in capsys.readouterr().err
    monkeypatch.setattr(transient, "memory", lambda: 1e9)
    with pytest.raises(gh.GearheatError, match=r"5\.26e\+05 rows, which take about 4\.\d+ GB.*there are 1 GB"):
        gh.simulate(rig, path, every="1 min")
    with pytest.raises(gh.GearheatError, match="above 0"):
        gh.simulate(rig, path, every=0)


def test_how_a_run_begins(rig: gh.Rig, day: Path) -> None:
    rest = gh.steady(rig, {"carrier.w": "150 rpm", "carrier.tau": "2000 N.m", "room.T": "20 degC"})
    run = gh.simulate(rig, day, {"start": "steady"}, every=3600)
    assert run["oil.T"][0] == pytest.approx(rest["oil.T"], abs=1e-6)
    cold = gh.simulate(rig, day, {"start": "room", "oil.T": "60 degC"}, every=3600)
    assert cold["oil.T"][0] == 293.15
    with pytest.raises(gh.GearheatError, match=r'start = "warm".*given, room, steady'):
        gh.simulate(rig, day, {"start": "warm"})


def test_what_a_rig_is_filled_with_is_kept_and_followed(tmp_path: Path) -> None:
    made = gh.new("conveyor", stages="helical", ratio=4.0, power="30 kW", speed="1480 rpm", oil="ISO VG 320 mineral")
    saved = gh.load(made.save(tmp_path / "saved.toml"))
    assert saved.scenario.entries == made.scenario.entries and saved.scenario.references == made.scenario.references
    other = "ISO VG 320 PAG"
    again = gh.load(saved.with_({"oil": other}).save(tmp_path / "again.toml"))
    assert again["oil.alpha_T"] == again["oil_gears_1.alpha_T"] == -0.00073 != saved["oil_gears_1.alpha_T"]
    assert again.scenario.entries["oil"] == {"oil": other}
    (oils,) = (c for c in choices_of(saved.scenario) if c.name == "oil.oil")
    (item,) = (i for i in oils.items if i.name == other)
    assert item.values["oil_gears_1.alpha_T"] == -0.00073


def test_a_bath_is_filled_with_oils_alone(tmp_path: Path) -> None:
    made = gh.new("conveyor", stages="helical", ratio=4.0, power="30 kW", speed="1480 rpm").scenario
    plain = replace(made, entries={}, references={})  # as a file has it that was written value by value
    for scenario in (made, plain):
        assert scenario.filled_with("oil") == ("oil",) and not scenario.filled_with("wall")[1:]
        assert "MINR" in scenario.alternatives("oil") and "bearing grease" not in scenario.alternatives("oil")
        assert [c.name for c in choices_of(scenario)] == ["start", "oil.oil"]
        with pytest.raises(gh.GearheatError, match='unknown oil "steel"'):
            gh.steady(gh.Rig(scenario), {"oil": "steel"})


@pytest.mark.parametrize(
    ("vary", "options", "rows"),
    [
        ({"carrier.tau": [500, 900.0, 2700]}, {}, [[500], [900], [2700]]),
        (
            {"carrier.tau": np.array([900, 500]), "room.T": (280, 300, 2)},
            {},
            [[900, 280], [900, 300], [500, 280], [500, 300]],
        ),
        ({"carrier.tau": ["0.5 kN.m"], "room.T": ("280 K", "300 K")}, {"grid": 2}, [[500, 280], [500, 300]]),
        (["carrier.tau=500,900 N.m"], {}, [[500], [900]]),
        ({"carrier.tau": "500..900 N.m"}, {"grid": (2,)}, [[500], [900]]),
    ],
)
def test_what_a_sweep_varies(rig: gh.Rig, vary: object, options: dict, rows: list) -> None:
    found = gh.sweep(rig, vary, output="oil.T", **options)
    assert found.plan.values.tolist() == rows and list(found.summary.as_dict(None)["outputs"]) == ["oil.T"]


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ({"carrier.tau": [500, 500]}, "there twice"),
        ({"carrier.tau": (500,)}, "is no range"),
        ({"carrier.tau": [None]}, "is no value"),
        ({"carrier.tau": []}, "is no range"),
        ({"carrier.tau": (500, 900)}, "--grid"),
    ],
)
def test_what_no_sweep_varies(rig: gh.Rig, vary: object, words: str) -> None:
    with pytest.raises(gh.GearheatError, match=words):
        gh.sweep(rig, vary, output="oil.T")


@pytest.mark.parametrize("table", [None, {"time": 1}, 3])
def test_what_is_no_table(rig: gh.Rig, table: object) -> None:
    with pytest.raises(gh.GearheatError, match="is no table"):
        gh.simulate(rig, table)
    with pytest.raises(gh.GearheatError, match=r"is no table|no data are given"):
        gh.diagnose(table, rig)


def test_frames_of_pandas_with_times(rig: gh.Rig) -> None:
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({"carrier.w [rpm]": 150.0, "carrier.tau [N.m]": 2000.0, "room.T [degC]": [20.0, 21.0, 22.0]})
    moments = pd.date_range("2024-03-01", periods=3, freq="h")
    wanted = gh.simulate(rig, frame.set_index(pd.Index([0.0, 3600.0, 7200.0], name="time [s]")))["oil.T"]
    index = [moments, moments - moments[0], moments.tz_localize("UTC"), moments.rename("stamp")]
    frames = [*(frame.set_index(one) for one in index), frame.assign(time=moments)[["time", *frame.columns]]]
    for one in frames:
        np.testing.assert_array_equal(gh.simulate(rig, one)["oil.T"], wanted)
    with pytest.raises(gh.GearheatError, match=r"Name its index 'time \[s\]'"):
        gh.simulate(rig, frame.set_index(pd.Index([0.0, 3600.0, 7200.0])))
    with pytest.raises(gh.GearheatError, match="row 2 of the DataFrame: time goes back"):
        gh.simulate(rig, frame.set_index(moments[[0, 2, 1]]))


def test_frames_of_pandas_in_the_place_of_files() -> None:
    pd = pytest.importorskip("pandas")
    folder = Path(gh.load("planetary").scenario.path).parent
    frame, card = pd.read_csv(folder / "measured.csv", comment="#"), folder / "card.json"
    losses = gh.losses("planetary", data=frame, card=card)
    assert losses.found["rows"] == gh.losses("planetary", data=folder / "measured.csv", card=card).found["rows"]
    assert not gh.card("planetary", frame).problems
    assert (
        path_of(frame.set_index(pd.date_range("2024-03-01", periods=len(frame), freq="h")))
        .read_text()
        .startswith(f"time,{','.join(frame.columns)}\n2024-03-01T00:00:00,")
    )


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda rig: gh.steady(rig, {"room.T": None}), r"room\.T = None is no value"),
        (lambda rig: gh.steady(rig, {"room.T": np.array([298.15])}), r"room\.T = array.* is no value"),
        (lambda rig: gh.steady(rig, 3), "3 gives no name a value"),
        (lambda rig: gh.map(rig, speed=np.linspace(1, 15, 3)), "--speed: .* is no range"),
        (lambda rig: gh.rating(rig, "oil.T=95 degC", grid=2.5), "--grid: 2.5 is no grid"),
        (lambda rig: gh.calibrate(rig, ["cooling.A"], bounds={"cooling.A": (2, 1)}), "must lie below"),
        (lambda rig: gh.calibrate(rig, ["cooling.A"], bounds={"cooling.A": 1}), "is no range"),
        (lambda rig: gh.design(rig, {"cooling.A": ("1 m2", "0.1 m2")}, {"oil.T": 350}), "must lie below"),
        (lambda rig: gh.design(rig, {"cooling.A": (0.1, 0.2)}, {"oil.T": "60 degC"}), r"NAME=LOW\.\.HIGH"),
        (lambda rig: gh.steady(rig, {"carrier.tau": "8,572 N.m"}), r'thousands\. Write "8572 N\.m" or "8\.572 N\.m"'),
        (lambda rig: gh.steady(rig, {"carrier.tau": "1,234,567 N.m"}), r'Write "1234567 N\.m"'),
        (lambda rig: gh.steady(rig, {"carrier.tau": "1.450,5 N.m"}), r'Write "1450\.5 N\.m"'),
        (lambda rig: gh.steady(rig, {"carrier.tau": "1,450.5 N.m"}), r'Write "1450\.5 N\.m"'),
        (lambda rig: gh.export(rig, "x.fmu", platform=["host", 3]), "platform: 3 is no text"),
    ],
)
def test_what_python_may_not_give(rig: gh.Rig, ask: Callable[[gh.Rig], object], words: str) -> None:
    with pytest.raises(gh.GearheatError, match=words):
        ask(rig)


def test_ranges_limits_and_bounds_in_any_form() -> None:
    by_text = gh.map("helical_two_stage", speed="30..60 rad/s", torque="-600..-60 N.m", grid="2x2")
    by_numbers = gh.map("helical_two_stage", speed=(30, 60), torque=(-600, -60), grid=(2, 2))
    assert all((by_text.columns[name] == column).all() for name, column in by_numbers.columns.items())
    assert len(by_text) == 4 and "oil.T" in by_text and "oil.X" not in by_text
    np.testing.assert_allclose(by_text["oil.T"], by_text.columns["oil.T"] + 273.15)
    np.testing.assert_allclose(by_text["input.w"], [30, 30, 60, 60])
    limits = ("oil.T=95 degC", "oil.T<95 degC")
    one, other = (gh.rating("helical_two_stage", one, room=(280, 300), grid=(2, 2)) for one in limits)
    assert one.as_dict() == other.as_dict()
    for free in ({"cooling.A": (0.1, 2.0)}, ["cooling.A=0.1..2 m2"], "cooling.A"):
        assert gh.design("planetary", free, [("oil.T", 353.15)])["oil.T"] == pytest.approx(353.15)


def test_the_limit_that_does_not_hold_is_named(rig: gh.Rig) -> None:
    aims = (
        ["oil.T=80 degC", "gear_set.T<60 degC"]
        if "gear_set.T" in gh.steady(rig)
        else ["oil.T=80 degC", "wall.T<60 degC"]
    )
    with pytest.raises(
        gh.GearheatError, match=r"cooling\.A = .* gives oil\.T = 80 degC; there .*, which is not < 60 degC"
    ):
        gh.design(rig, "cooling.A", aims)


def test_a_sweep_over_entries_of_a_catalogue(rig: gh.Rig) -> None:
    names = ["MINR", "PAOR"]
    rows = gh.sweep(rig, {"oil": names, "carrier.tau": [900, 2500]}, output="oil.T")
    assert [column.name for column in rows.plan.columns[:2]] == ["row", "oil"]
    wanted = [gh.steady(rig, {"oil": name, "carrier.tau": tau})["oil.T"] for name in names for tau in (900, 2500)]
    assert rows.rows[:, 0] == pytest.approx(wanted)
    with pytest.raises(gh.GearheatError, match='unknown oil "steel"'):
        gh.sweep(rig, {"oil": ["MINR", "steel"]}, output="oil.T")


def test_a_card_of_python_stands_for_a_file() -> None:
    keys = {"columns": {"T_oil": "Sumpf"}}
    made = card_file(keys)
    assert made is not None and read_card(made).columns == keys["columns"]
    written = card_file(gh.card("helical_two_stage"))
    assert written is not None and read_card(written) == read_card(card_file(gh.card("helical_two_stage")))
    with pytest.raises(DataError, match="is no card"):
        card_file(3)


def test_many_rows_of_a_frame_are_told_by_its_own_count() -> None:
    with pytest.raises(DataError, match=r"^rows 3 to 23 of the DataFrame, 21 of them"), rows_told():
        raise DataError("DataFrame.csv lines 5 to 25, 21 of them: no number.")
