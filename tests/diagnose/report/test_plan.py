"""A plan: in one sentence, as a table, as a picture, and the command around it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from fabricated_findings import AIR, CHURNING, EMISSIVITY, OFFSET, WINDAGE
from gearheat.fmu.compiling import Progress
from gearheat.model.errors import DataError
from gearheat.tools.cli import app as cli
from gearheat.tools.diagnose import api, diagnosis
from gearheat.tools.diagnose.answer.findings import Isolability
from gearheat.tools.diagnose.answer.numbers import as_object
from gearheat.tools.diagnose.answer.plan import Outlook, Plan, Planned, PlannedCause, PlannedPair
from gearheat.tools.diagnose.report.plan import picture, sentence, text as printed
from gearheat.tools.diagnose.request import PlanInputs, unknown_causes
from gearheat.tools.show.drawing import png, svg
from typer.testing import CliRunner

PAIR = (AIR, EMISSIVITY)


def outlook(after: float, *names: str) -> Outlook:
    pair = Outlook.Pair(causes=PAIR, before=2.0, after=after)
    return Outlook(
        experiments=names, smallest=after, nearest=PAIR, gain=after - 2.0, separates=after >= 3, pairs=(pair,)
    )


def plan(verdict: str = "one", best: float = 3.6, **given: Any) -> Plan:
    """Air and emissivity, which a cold room tells apart."""
    cause = {"size": "ln_factor", "usual": 0.4, "visible": 4.0}
    full: dict[str, Any] = {
        "rig": "mine",
        "verdict": verdict,
        "causes": tuple(PlannedCause(id=c, exposes="blow at it" if c == AIR else "", **cause) for c in PAIR),
        "pairs": (PlannedPair(causes=PAIR, distance=2.0),),
        "now": outlook(2.0),
        "catalogue": (Planned(id="cold", what="some points at 5 degC"), Planned(id="fast", what="more speed")),
        "outlooks": (outlook(best, "cold"), outlook(2.01, "fast")),
        "together": (outlook(best, "cold"),),
        "isolability": (
            Isolability(cause=AIR, visible=4.1, nearest=EMISSIVITY, distance=2.0),
            Isolability(cause=OFFSET, visible=8.0, nearest=AIR, distance=6.0),
        ),
    }
    return Plan(**(full | given))


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (plan("apart", now=outlook(3.3)), "tells them apart as it is: 3.3 standard deviations"),
        (plan(), "Do cold, some points at 5 degC: from 2.0 to 3.6 standard deviations."),
        (
            plan("several", together=(outlook(2.8, "cold"), outlook(3.2, "cold", "fast"))),
            "but cold and fast together do",
        ),
        (plan("none", 2.4), "No experiment here tells them apart at 3 standard deviations. The best is some points"),
        (plan("same", now=None, outlooks=(), together=()), "they are one answer"),
        (plan(verdict=None), ""),
    ],
)
def test_the_answer_is_one_sentence(made: Plan, words: str) -> None:
    assert words in sentence(made)


def test_the_screen() -> None:
    said = printed(plan())
    assert "more speed" not in said, "what adds nothing is left out"
    assert "more speed" in printed(plan(), everything=True)
    assert "the campaign as it is" in said
    assert "What this design can tell" not in said


def test_a_table_of_all_causes_where_none_are_named() -> None:
    said = printed(plan(None, causes=(), pairs=(), now=None, outlooks=(), together=()))
    rows = [line.split() for line in said.splitlines() if line.strip().startswith((AIR, OFFSET))]
    assert [row[-1] for row in rows] == ["no", "yes"]


def test_classes_and_faint_causes_are_told() -> None:
    faint = PlannedCause(id=CHURNING, size="P_ref", usual=60.0, unit="W", visible=1.7, exposes="drain the oil")
    pairs = (PlannedPair(causes=(CHURNING, WINDAGE), distance=0.0, one_answer="powers of the speed"),)
    said = printed(plan(causes=(faint,), pairs=pairs))
    assert "churning of the oil and windage (powers of the speed). What would tell: churning of the oil: drain" in said
    assert "usual size (P_ref 60 W) would show at only 1.7" in said


def test_pictures_have_the_same_bytes_twice() -> None:
    assert svg(picture(plan())) == svg(picture(plan()))
    assert png(picture(plan())).startswith(b"\x89PNG")


def find(inputs: PlanInputs, progress: Progress) -> Plan:
    """A plan that needs no work."""
    return plan(rig=inputs.scenario.name)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "plan", find)
    out, file = tmp_path / "plan.svg", tmp_path / "plan.json"
    arguments = ["plan", "helical_two_stage", "--separate", ",".join(PAIR), "--out", str(out), "--json", str(file)]
    done = CliRunner().invoke(cli.app, arguments)
    assert done.exit_code == 0, done.output
    assert done.output.startswith("answer     Do cold")
    assert json.loads(file.read_text()) == as_object(plan(rig="helical_two_stage"))
    assert out.read_text().startswith("<svg")


def test_all_problems_at_once(tmp_path: Path) -> None:
    files = {"card": tmp_path / "no.toml", "json": str(tmp_path / "no" / "o.json"), "out": tmp_path / "picture.gif"}
    with pytest.raises(DataError) as caught:
        api.plan("nowhere", separate=(AIR, AIR), **files)
    told = "\n".join(caught.value.problems)
    for word in ("picture.gif", "there twice", "no.toml", "nowhere", "o.json"):
        assert word in told


def test_unknown_causes_are_met_with_what_was_meant() -> None:
    known = (AIR, EMISSIVITY, CHURNING)
    told = unknown_causes(("cooling.ari", "churning", AIR, "zzz"), known)
    assert len(told) == 3
    assert 'Did you mean "cooling.air"' in told[0]
    assert 'Did you mean "losses.churning"' in told[1]
    assert "Known: cooling.air" in told[2]


def test_one_unknown_cause_is_told_with_those_that_are_like_it() -> None:
    with pytest.raises(DataError) as caught:
        api.plan("planetary", separate=["seals"])
    assert caught.value.problems == (
        "--separate seals: there is nothing to tell it from. Name two causes or more.",
        '--separate: there is no cause "seals". Did you mean "losses.seal_drag"?',
    )
    done = CliRunner().invoke(cli.app, ["plan", "planetary", "--separate", "nix"])
    assert done.exit_code == 2 and 'there is no cause "nix". Known: losses.churning, ' in done.stderr
