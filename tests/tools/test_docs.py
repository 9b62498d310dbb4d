"""The command `docs`: the web site builds without a warning, and holds what the code declares."""

import csv
import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from browser import CHROMIUM, Browser
from gearheat.model.laws import rolling
from gearheat.model.parts import PARTS
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.docs import reference
from gearheat.tools.docs.blocks import PAGES

#: Pages that are opened at three widths where a browser is.
SHOWN = (
    "index",
    "tutorials/own_gearbox",
    "theory/laws",
    "generated/commands",
    "generated/parts/PlanetarySet",
    "howto/fmu",
)


def test_the_site_builds_and_has_a_page_for_every_part(gearheat, tmp_path: Path) -> None:
    pytest.importorskip("myst_parser")
    answer = gearheat("docs", "-o", tmp_path / "site")
    assert answer.code == 0, answer.err
    pages = {page.stem for page in (tmp_path / "site" / "generated" / "parts").glob("*.html")}
    assert pages >= set(PARTS)
    commands = (tmp_path / "site" / "generated" / "commands.html").read_text(encoding="utf-8")
    assert "--power-flow" in commands
    tutorial = (tmp_path / "site" / "tutorials" / "own_gearbox.html").read_text(encoding="utf-8")
    assert '<span class="caption-text">card.toml</span>' in tutorial
    assert "building with Sphinx" in answer.err and "--run quick" in answer.err
    laws = (tmp_path / "site" / "theory" / "laws.html").read_text(encoding="utf-8")
    assert laws.count("<math") > 50 and "mathjax" not in laws.lower()
    python = (tmp_path / "site" / "generated" / "api" / "index.html").read_text(encoding="utf-8")
    assert "steady" in python and "diagnose" in python
    for page in (tmp_path / "site").rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert 'name="viewport"' in text and "/narrow.css" in text, f"{page.name} may be wider than its screen"

    for width in (360, 800, 1400) if CHROMIUM and find_spec("websockets") else ():
        with Browser(tmp_path / f"profile{width}") as browser:
            size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
            browser.call("Emulation.setDeviceMetricsOverride", **size)
            for name in SHOWN:
                browser.open((tmp_path / "site" / f"{name}.html").as_uri())
                browser.wait(f"document.readyState === 'complete' && location.href.endsWith('{name}.html')")
                assert browser.js("document.documentElement.scrollWidth") <= width, f"{name} runs over {width} px"


def test_a_docstring_becomes_a_formula_and_a_list() -> None:
    law = rolling.shear_heating
    assert "```{math}\n\\phi_{ish} = \\frac" in reference.docstring(law)
    assert "- `d_m`: mean diameter, (d + D)/2 \\[m\\]\n" in reference.arguments(law)
    assert reference.words("a|b <c> `d|e`") == "a\\|b \\<c> `d\\|e`"


def test_every_law_stands_once_among_the_equations() -> None:
    text = reference.fill_blocks((PAGES / "theory" / "laws.md").read_text(encoding="utf-8"))
    named = re.findall(r"^\*\*\[(\w+)\]\(\.\./generated/laws/(\w+)\.md#", text, re.MULTILINE)
    assert sorted(named) == sorted(
        (law.__name__, name) for name in reference.law_modules() for law in reference.laws_of(name)
    )
    assert text.count("```{math}") >= len(named)
    assert "{laws}" not in text


def test_the_limits_tell_ranges_evidence_and_the_readings_there_are() -> None:
    page = reference.fill_blocks((PAGES / "trust" / "limits.md").read_text(encoding="utf-8"))
    assert "| [friction_schlenk](" in page
    assert re.search(r"^\| \[Friction of contact seals\]\(\S+\) \| 3 \| 1 \| \d+ \| \d+ \|$", page, re.MULTILINE)
    with (RIGS / "planetary" / "measured.csv").open(encoding="utf-8") as file:
        readings = list(csv.DictReader(file))
    told = re.findall(r"`(\w+)` (\S+) to (\S+) ", " ".join(page.split()))
    assert len(told) == 4
    for column, *ends in told:
        values = [float(row[column]) for row in readings]
        assert [float(end) for end in ends] == [round(min(values)), round(max(values))], column
