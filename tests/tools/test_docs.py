"""The command `docs`: the web site builds without a warning, and holds what the code declares."""

import csv
import re
from pathlib import Path

import pytest
from browser import WIDTHS, Browser
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
    "generated/gallery",
    "py-modindex",
)


@pytest.fixture(scope="module")
def site(gearheat, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Folder of the documentation, and what is told while it is built."""
    pytest.importorskip("myst_parser")
    folder = tmp_path_factory.mktemp("docs") / "site"
    answer = gearheat("docs", "-o", folder)
    assert answer.code == 0, answer.err
    return folder, answer.err


def test_the_site_has_a_page_for_every_part(site: tuple[Path, str]) -> None:
    folder, told = site
    pages = {page.stem for page in (folder / "generated" / "parts").glob("*.html")}
    assert pages >= set(PARTS)
    commands = (folder / "generated" / "commands.html").read_text(encoding="utf-8")
    assert "--power-flow" in commands
    tutorial = (folder / "tutorials" / "own_gearbox.html").read_text(encoding="utf-8")
    assert '<span class="caption-text">card.toml</span>' in tutorial
    assert "building with Sphinx" in told and "--run quick" in told
    laws = (folder / "theory" / "laws.html").read_text(encoding="utf-8")
    assert laws.count("<math") > 50 and "mathjax" not in laws.lower()
    python = (folder / "generated" / "api" / "index.html").read_text(encoding="utf-8")
    assert "steady" in python and "diagnose" in python
    for page in folder.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert 'name="viewport"' in text and "/narrow.css" in text, f"{page.name} may be wider than its screen"


def test_pages_stay_within_their_screens(site: tuple[Path, str], browser: Browser) -> None:
    assert [f for name in SHOWN for w in WIDTHS for f in browser.faults(site[0] / f"{name}.html", w)] == []


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
