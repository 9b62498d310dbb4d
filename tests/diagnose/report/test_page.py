"""The page: one file that needs no net, the same bytes for the same findings."""

import json
import math
import re
from html import unescape
from pathlib import Path

import pytest
from fabricated_findings import KINDS, clean, explained, spoiled
from gearheat.tools.diagnose.answer.evidence import DataQuality, NuisanceOff, Rows
from gearheat.tools.diagnose.api import Diagnosis
from gearheat.tools.diagnose.report.page import _bars, render
from pages import problems_of, words_that_collide


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_renders_and_needs_no_net(kind: str) -> None:
    page = render(KINDS[kind]())
    assert page.startswith("<!doctype html>")
    assert not re.search(r'(src|href)="(?!#)', page), "nothing is loaded"
    assert problems_of(page) == []
    assert not re.search(r"\bNone\b|\bnan\b|\{\{|\d[eE]-\d\d", _text(page))


def _text(page: str) -> str:
    """What a reader sees."""
    return re.sub(r"<[^>]*>", " ", re.sub(r"<(script|style|svg).*?</\1>", "", page, flags=re.DOTALL))


def test_the_same_findings_give_the_same_bytes() -> None:
    assert render(explained()) == render(explained())


def test_the_order_of_the_page() -> None:
    text = _text(render(spoiled()))
    order = (
        *("One cause explains", "What to do now", "How big", "How sure", "What it cannot be", "Row 17 (line 18"),
        *("Repeated points in running order", "The causes", "on readings left out", "What to measure next"),
        "Cannot be told apart",
    )
    places = [text.find(words) for words in order]
    assert -1 not in places
    assert places == sorted(places)


def test_a_value_that_the_verdict_tells_is_not_denied_below() -> None:
    off = NuisanceOff(name="mesh friction", z=3.2, factor=1.38, paths=("gear_set.k_mu",))
    text = _text(render(clean(data_quality=DataQuality(nuisances=(off,)))))
    assert "only with values far from those of its file: mesh friction" in text
    assert "No gross reading" in text and "no value of the rig" not in text


@pytest.mark.parametrize("kind", KINDS)
def test_each_cause_has_one_bar(kind: str) -> None:
    names = [bar["name"] for bar in _bars(KINDS[kind]())]
    assert len(set(names)) == len(names)


def test_a_picture_a_cause_and_the_readings_behind_it() -> None:
    page = render(explained())
    assert page.count("<svg") == 2, "one picture of the cause, one overview"
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])  # type: ignore[index]
    assert set(data["channels"]) == {"T_oil", "loss"}
    assert data["quantities"]["w"]["unit"] == "rpm"
    assert data["channels"]["T_oil"]["left"]["with the causes"][3] == pytest.approx(0.4 * math.sin(15), abs=1e-3)
    assert "uPlot" in page
    assert "MIT License" in page


def test_the_leading_cause_is_a_picture_of_its_own(tmp_path: Path) -> None:
    found = Diagnosis(**dict(explained()))
    assert found.says.verdict and found.says.do
    for shown in (" ".join(repr(found).split()), " ".join(unescape(found._repr_html_()).split())):
        assert found.says.verdict in shown and found.says.do in shown
    drawn = found.drawing()
    assert drawn is not None and drawn.title == found.says.verdict and not words_that_collide(drawn.figure)
    assert Diagnosis(**dict(clean())).save_picture(tmp_path / "none.svg") is None and not list(tmp_path.iterdir())


def test_without_readings_there_is_no_plot() -> None:
    page = render(clean(rows=Rows()))
    assert "uPlot" not in page
    assert "<svg" not in page


def test_what_a_file_is_called_is_no_html() -> None:
    about = explained().about.model_copy(update={"data": "<script>alert(1)</script>.csv"})
    page = render(explained(about=about))
    assert "<script>alert" not in page
