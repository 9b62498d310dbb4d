"""`gearheat map` and `gearheat rating`."""

from __future__ import annotations

import csv

import pytest


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def test_a_map_holds_steady_states(gearheat, tmp_path):
    out, plot = tmp_path / "map.csv", tmp_path / "map.svg"
    ranges = ("--speed", "100..200 rpm", "--torque", "1000..2000 N.m", "--grid", "2x3")
    found = gearheat("map", "planetary", "-o", out, *ranges, "--plot", plot, "--json", "-").json
    assert (found["rows"], found["without_result"]) == (6, 0)
    rows = rows_of(out)
    last = gearheat(
        "steady", "planetary", "--set", "carrier.w=200 rpm", "--set", "carrier.tau=2000 N.m", "--json", "-"
    ).json["values"]
    for name, unit in (("oil.T", "degC"), ("efficiency.P_loss", "W"), ("efficiency.eta", "1")):
        assert rows[-1][f"{name} [{unit}]"] == pytest.approx(last[name], rel=1e-5)
    assert plot.read_text().startswith("<svg")
    before = plot.read_bytes()
    gearheat("map", "planetary", "-o", out, *ranges, "--plot", plot)
    assert plot.read_bytes() == before


def test_a_map_needs_no_option(gearheat, tmp_path):
    found = gearheat(
        "map", "harmonic", "-o", tmp_path / "map.csv", "--grid", "2x2", "--plot", tmp_path / "a.png", "--json", "-"
    )
    assert found.code == 0, found.err
    assert found.json["without_result"] == 0
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"


def test_a_rating_keeps_the_limit(gearheat, tmp_path):
    out = tmp_path / "rating.csv"
    options = ("--limit", "oil.T=80 degC", "--room", "10..30 degC", "--speed", "700..1400 rpm", "--grid", "2x2")
    found = gearheat("rating", "helical_two_stage", *options, "-o", out, "--json", "-").json
    rows = rows_of(out)
    for row, told in zip(rows, found["rows"], strict=True):
        assert row == pytest.approx(told, rel=1e-6)
    powers = [row["power [kW]"] for row in found["rows"]]
    assert powers[0] < powers[1] and powers[2] < powers[3]  # more at more speed
    assert powers[2] < powers[0] and powers[3] < powers[1]  # less in a warmer room
    row = found["rows"][3]
    point = [f"room.T={row['room.T [degC]']} degC", f"input.w={row['input.w [rpm]']} rpm"]
    settings = [x for p in (*point, f"output.tau={row['output.tau [N.m]']} N.m") for x in ("--set", p)]
    there = gearheat("steady", "helical_two_stage", *settings, "--json", "-").json["values"]
    assert there["oil.T"] == pytest.approx(80.0, abs=0.01)
    assert abs(there["output.P"]) / 1000 == pytest.approx(row["power [kW]"], rel=1e-4)


def test_a_point_of_a_catalogue_is_rated_and_is_among_the_usual_ones(gearheat, tmp_path):
    def powers(*options):
        answer = gearheat("rating", "helical_two_stage", "--limit", "oil.T=80 degC", *options, "--json", "-")
        return {
            (row["room.T [degC]"], round(row["input.w [rpm]"], 3)): row["power [kW]"] for row in answer.json["rows"]
        }

    point = powers("--room", "20 degC", "--speed", "1450 rpm")
    usual = powers("--room", "20 degC")
    assert list(point) == [(20.0, 1450.0)]
    assert usual[20.0, 1450.0] == pytest.approx(point[20.0, 1450.0], rel=1e-5)
    assert len(usual) == 6
    out = tmp_path / "map.csv"
    gearheat("map", "helical_two_stage", "--speed", "1450 rpm", "--grid", "1x3", "-o", out)
    assert [row["input.w [rpm]"] for row in rows_of(out)] == [1450.0] * 3


@pytest.mark.parametrize(
    ("option", "given", "told"),
    [
        ("--room", "900 degC", '--room room.T = "900 degC" is out of range'),
        ("--room", "20", 'Write "20 degC"'),
        ("--speed", "20 degC", "--speed input.w"),
        ("--speed", "900..300 rpm", "--speed 900 rpm..300 rpm"),
    ],
)
def test_what_is_wrong_with_a_range_names_its_option(gearheat, option, given, told):
    answer = gearheat("rating", "helical_two_stage", "--limit", "oil.T=80 degC", option, given)
    assert answer.code == 2
    assert told in answer.err
    assert "--vary" not in answer.err


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (("rating", "--limit", "nonsense=95 degC", "--limit", "oil.T=95 degC"), "Rate for one at a time"),
        (("rating", "--limit", "oil.T=80 degC", "--grid", "1x1", "--grid", "2x2"), "--grid is given 2 times"),
        (("map", "--speed", "100..200 rpm", "--speed", "200..300 rpm"), "--speed is given 2 times"),
    ],
)
def test_an_option_with_one_value_is_refused_a_second_time(gearheat, command, told):
    answer = gearheat(command[0], "helical_two_stage", *command[1:])
    assert answer.code == 2
    assert told in answer.err


def test_what_cannot_be_mapped_or_rated_is_said(gearheat, tmp_path):
    answer = gearheat("map", "fzg_four_square", "-o", tmp_path / "map.csv")
    assert answer.code == 2
    assert "no torque is given" in answer.err
    answer = gearheat("rating", "helical_two_stage", "--limit", "oil.T=10 degC", "--grid", "1x1")
    assert answer.code == 2
    assert "20 degC" in answer.err
    answer = gearheat(
        "map", "helical_two_stage", "--torque", "-1e6..-9e5 N.m", "--grid", "2x2", "-o", tmp_path / "m.csv"
    )
    assert answer.code == 2
    assert "none of 4 points has a steady state" in answer.err
    assert not (tmp_path / "m.csv").exists()
