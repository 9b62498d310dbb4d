"""`show`: a short answer first, everything with --all, and no word lost on a narrow screen."""

from __future__ import annotations

from pathlib import Path

import pytest
from gearheat.tools.show.notes import print_stacked

MINE = ("--stages", "bevel,helical", "--ratio", "20", "--power", "5.5 kW", "--speed", "1450 rpm")


@pytest.fixture
def mine(gearheat, tmp_path: Path, monkeypatch) -> Path:
    """A rig of one's own, on a screen of 80 columns."""
    monkeypatch.setenv("COLUMNS", "80")
    path = tmp_path / "mine.toml"
    assert gearheat("new", "mine", *MINE, "-o", path).code == 0
    return path


def words(text: str) -> str:
    return " ".join(text.split())


def test_the_short_answer_is_short(gearheat, mine: Path) -> None:
    answer = gearheat("show", mine)
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    assert len(lines) < 110 and max(map(len, lines)) <= 80
    for told in ("BevelGearPair", "input.w", "States: oil.T, gears.T", "efficiency.P_loss", "T_oil_C", "cooling.A"):
        assert told in answer.out
    assert "326 parameters, 36 choices, 88 outputs, 68 laws with --all" in answer.out
    assert "middle_bearing_a.K_Z" not in answer.out


def test_everything_keeps_every_meaning_and_source(gearheat, mine: Path) -> None:
    found = gearheat("show", mine, "--json", "-").json
    printed = gearheat("show", mine, "--all").out
    assert max(map(len, printed.splitlines())) <= 80
    assert "left out for want of room" not in printed
    told = words(printed)
    for line in (*found["parameters"], *found["inputs"]):
        assert line["name"] in told and words(line["doc"]) in told and words(line["source"]) in told
    for law in found["laws"]:
        assert words(law["where"]) in told and words(law["source"]) in told


def test_the_effects_are_those_of_steady_states(gearheat, mine: Path) -> None:
    """A hundredth more and less of the area, ten times."""
    (line,) = [li.split() for li in gearheat("show", mine).out.splitlines() if li.split()[:1] == ["cooling.A"]]
    name, value, unit, *printed = line
    states = [
        gearheat("steady", mine, "--set", f"{name}={float(value) * f} {unit}", "--json", "-").json["values"]
        for f in (1.01, 0.99)
    ]
    expected = [5 * (states[0][key] - states[1][key]) for key in ("oil.T", "efficiency.P_loss")]
    assert [float(p) for p in printed] == pytest.approx(expected, rel=2e-3)


def test_sentences_stand_beside_or_under_their_row(monkeypatch, capsys) -> None:
    rows = [["a_long_name.of_a_part", 1.5, "mm", "what it means in words", "where it is from"]]
    head = ("name", "value", "unit", "doc", "source")
    printed = {}
    for width in (30, 60, 120):
        monkeypatch.setenv("COLUMNS", str(width))
        print_stacked("Values", head, rows, 2)
        printed[width] = capsys.readouterr().out
        assert max(map(len, printed[width].splitlines())) <= width
        assert all(word in words(printed[width]) for word in ("what it means in words", "where it is from", "1.5"))
    assert "doc" in printed[120] and "doc" not in printed[60]
    assert "a_long_name.of_a_part   " in printed[60] and "a_long_name.of_a_part\n" in printed[30]
