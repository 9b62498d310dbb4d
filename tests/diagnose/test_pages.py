"""The pages are true: one's own gearbox works as it stands there, and the measured campaign says what is printed."""

import csv
import json
import re
import shutil
from functools import partial

import pytest
from challenge.cases import make_case
from challenge.model_rig import draw_steady
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.cli.app import app
from gearheat.tools.docs.blocks import PAGES
from typer.testing import CliRunner

PAGE = (PAGES / "tutorials" / "diagnosis.md").read_text("utf-8")


def block(language: str) -> str:
    """The page's example in a language."""
    (found,) = re.findall(rf"^```{language}[^\n]*\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return found


def test_the_page_for_ones_own_gearbox(tmp_path, monkeypatch) -> None:
    sheet = partial(draw_steady, machine="helical_two_stage")
    make_case(sheet, 3, 7, 0, tmp_path / "made", kind="single", cause="losses.churning", apart=False)
    with (tmp_path / "made" / "case" / "DATA.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    head, *examples = block("csv").splitlines()
    columns = head.split(",")
    with (tmp_path / "points.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, columns, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows[:20])
    assert all(len(line.split(",")) == len(columns) for line in examples)
    (tmp_path / "card.toml").write_text(block("toml"), "utf-8")
    shutil.copytree(RIGS / "helical_two_stage", tmp_path / "gearbox")
    monkeypatch.chdir(tmp_path)
    words = block("sh").split()
    assert words.pop(0) == "gearheat"
    run = CliRunner().invoke(app, words)
    assert run.exit_code == 0, run.output
    assert "churning" in (tmp_path / "diagnosis.html").read_text("utf-8")


SCHEMES = {
    "some of the tests": "leave-out-tests",
    "one speed": "leave-one-speed",
    "one load": "leave-one-load",
    "one oil": "leave-one-oil",
}


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory):
    """The measured campaign of the planetary rig, diagnosed, and the page's section about it."""
    out = tmp_path_factory.mktemp("campaign") / "found.json"
    files = [str(RIGS / "planetary" / name) for name in ("measured.csv", "card.json")]
    run = CliRunner().invoke(app, ["diagnose", files[0], "--rig", "planetary", "--card", files[1], "--json", str(out)])
    assert run.exit_code == 0, run.output
    page = (PAGES / "trust" / "diagnosis.md").read_text("utf-8")
    return json.loads(out.read_text("utf-8")), page.partition("## The measured campaign\n")[2]


def test_the_gain_of_the_measured_campaign_is_what_the_page_prints(campaign) -> None:
    found, section = campaign
    gains = {(g["scheme"], g["channel"]): g for g in (found["gain"], *found["gain_grouped"])}
    lines = [line.strip("|").split("|") for line in section.splitlines() if re.match(r"\| (some|one) ", line)]
    assert len(lines) == 8
    for left_out, channel, before, after, both, rival in ([cell.strip() for cell in line] for line in lines):
        gain = gains[SCHEMES[left_out], channel]
        told = [gain[side][key] for key in ("without", "with") for side in ("before", "after")]
        printed = [float(v) for v in (before, after, *both.split(", "), rival)]
        assert [*told, gain["rivals"]["linear in the given sensors"]] == pytest.approx(printed, abs=0.02), left_out


def test_the_channels_of_the_measured_campaign_say_what_the_page_prints(campaign) -> None:
    found, section = campaign
    views = {v["channel"]: v for v in found["views"]}
    lines = re.findall(r"^\| (T_\w+), [^|]* \| ([\d.]+) \| (.*) \|$", section, re.MULTILINE)
    assert {channel for channel, _, _ in lines} == set(views)
    for channel, p, answers in lines:
        view = views[channel]
        assert view["p"] == pytest.approx(float(p), abs=0.02)
        alone = {c["id"]: c["probability"] for c in view["causes"]}
        for id, percent in re.findall(r"([\w.]+) (\d+) %", answers):
            assert alone[id] == pytest.approx(float(percent) / 100, abs=0.02)
    best = found["answers"][0]
    assert best["causes"] == [["losses.seal_drag"], ["sensor.torque.random_walk"]]
    assert best["probability"] == pytest.approx(0.62, abs=0.02)
    assert found["test"]["p_adequacy"] == pytest.approx(1e-6, rel=0.01)
    assert all(["losses.seal_drag"] in answer["causes"] for answer in found["answers"])
