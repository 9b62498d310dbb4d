"""The tutorial in Python: at most 60 lines, and the numbers of the commands to the last digit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import gearheat as gh
import pytest
from gearheat.tools.cli.app import app
from gearheat.tools.docs.blocks import PAGES, blocks
from typer.testing import CliRunner

PAGE = PAGES / "tutorials" / "own_gearbox_python.md"
MOST_LINES = 60


def asked(*arguments: object) -> dict[str, Any]:
    """The JSON object of a command."""
    done = CliRunner().invoke(app, [*map(str, arguments), "--json", "-"])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def mine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mine") / "mine.toml"
    gh.new("mine", stages="bevel,helical", ratio=20, power="5.5 kW", speed="1450 rpm", out=path)
    return path


def test_it_takes_at_most_60_lines() -> None:
    code = [b.text for b in blocks(PAGE.read_text(encoding="utf-8")) if b.language == "python"]
    assert 0 < len([line for text in code for line in text.splitlines() if line.strip()]) <= MOST_LINES


def test_the_numbers_are_those_of_the_commands(mine: Path) -> None:
    said = json.loads(json.dumps(gh.steady(mine, {"room.T": "30 degC"}).as_dict()))
    assert said == asked("steady", mine, "--set", "room.T=30 degC")
    assert gh.losses(mine).as_dict()["rows"] == asked("losses", mine)["rows"]
    powers = gh.rating(mine, "oil.T=80 degC", grid="2x2").as_dict()
    assert powers == asked("rating", mine, "--limit", "oil.T=80 degC", "--grid", "2x2")
    large = gh.design(mine, ["cooling.A"], {"oil.T": "35 degC"}).as_dict()
    found = asked("design", mine, "--free", "cooling.A", "--target", "oil.T=35 degC")
    assert large["free"] == found["free"] and large["values"] == found["values"]


def test_a_map_and_a_warm_up_are_those_of_the_commands(mine: Path, tmp_path: Path) -> None:
    (duty := tmp_path / "duty.csv").write_text("time [min],room.T [degC]\n0,5\n60,5\n", encoding="utf-8")
    gh.map(mine, grid="2x2").save(tmp_path / "map.csv")
    asked("map", mine, "-o", tmp_path / "other.csv", "--grid", "2x2")
    assert (tmp_path / "map.csv").read_bytes() == (tmp_path / "other.csv").read_bytes()
    gh.simulate(mine, duty).save(tmp_path / "run.csv")
    asked("simulate", mine, "--duty", duty, "-o", tmp_path / "other_run.csv")
    assert (tmp_path / "run.csv").read_bytes() == (tmp_path / "other_run.csv").read_bytes()
