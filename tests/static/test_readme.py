"""README and pages: all blocks that can be run are run, links lead somewhere, tables are what the code says."""

import importlib
import re
import shlex
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import typer
from broken_assemblies import BROKEN
from for_each import thin
from gearheat.fmu.description import description
from gearheat.fmu.equations import equations
from gearheat.fmu.variables import table
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import StructureError
from gearheat.tools.cli.app import app
from gearheat.tools.docs.blocks import PAGES, SHOWN, Reader, blocks, missing, pages, read, same
from small_parts import rc

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
EVERY = [README, ROOT / "CONTRIBUTING.md", *pages()]
PROGRAM = typer.main.get_command(app)
#: Pages that a newcomer begins with: always run. Of the others some are, unless all tests are.
FIRST = [README, *(PAGES / "tutorials" / f"own_gearbox{of}.md" for of in ("", "_python"))]


def name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", [*FIRST, *thin(page for page in EVERY if page not in FIRST)], ids=name)
def test_the_blocks_run_in_their_order(page: Path, tmp_path: Path) -> None:
    assert not Reader(PROGRAM, tmp_path).problems(page)
    kept = [PAGES / picture.name for picture in tmp_path.glob("*.svg") if (PAGES / picture.name).exists()]
    for picture in kept:
        assert picture_numbers(tmp_path / picture.name) == pytest.approx(picture_numbers(picture), abs=1.0)


def picture_numbers(path: Path) -> list[float]:
    """Numbers of a picture in points, without its identifiers."""
    text = re.sub(r'"[^"]*#[^"]*"|id="[^"]*"', "", path.read_text(encoding="utf-8"))
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text)]


@pytest.mark.parametrize("page", EVERY, ids=name)
def test_links_and_languages(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    known = {"sh", "console", "python", "csv", "toml", "diff", "c"} | SHOWN
    assert {block.language for block in blocks(text)} <= known
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    links = [link for link in re.findall(r"\]\(([^)\s]+)\)", prose) if not link.startswith(("http", "#"))]
    dead = [link for link in links if not (page.parent / link.partition("#")[0]).exists()]
    assert not [link for link in dead if "/generated/" not in f"/{link}"]


def test_the_readme_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 150


def test_from_nothing_to_a_diagnosis_takes_25_commands_and_60_lines() -> None:
    tutorial = blocks((PAGES / "tutorials" / "own_gearbox.md").read_text(encoding="utf-8"))
    commands = [command for block in tutorial if block.language in ("sh", "console") for command in block.commands()]
    assert len(commands) <= 25
    written = [
        line for block in tutorial if block.language == "diff" for line in re.findall(r"^\+.*", block.text, re.M)
    ]
    card = next(block for block in tutorial if block.file == "card.toml")
    assert 0 < len(written) + len(card.text.splitlines()) <= 60


def test_two_name_plates_and_a_table_take_15_commands() -> None:
    page = blocks((PAGES / "tutorials" / "first_hour.md").read_text(encoding="utf-8"))
    commands = [command for block in page if block.language in ("sh", "console") for command in block.commands()]
    assert len(commands) <= 15 and not [block for block in page if block.language == "diff"]
    named = {words[1] for words, _ in commands}
    assert named == {"new", "steady", "losses", "map", "rating", "export", "diagnose"}


def test_the_blocks_that_install_name_commands_that_exist() -> None:
    installs = [block for block in blocks(README.read_text(encoding="utf-8")) if block.installs]
    assert len(installs) == 2
    for block in installs:
        for program, arguments in re.findall(r"\.venv/bin/(gearheat|python) (.*)", block.text):
            if program == "gearheat":
                read(PROGRAM, shlex.split(arguments))
            else:
                assert importlib.util.find_spec(shlex.split(arguments)[1]) is not None


class TestReader:
    """A page that is not true is found."""

    def problems(self, folder: Path, text: str) -> list[str]:
        page, place = folder / "page.md", folder / "place"
        page.write_text(text, encoding="utf-8")
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        return Reader(PROGRAM, place).problems(page)

    def test_a_wrong_option(self) -> None:
        with pytest.raises(Exception, match="No such option"):
            read(PROGRAM, ["bench", "--quick"])

    def test_a_command_that_fails_and_one_that_prints_something_else(self, tmp_path: Path) -> None:
        (failed,) = self.problems(tmp_path, "# A\n\n```sh\ngearheat steady planetry\n```\n")
        assert failed.startswith("page.md line 3: gearheat steady planetry ends with 2") and "planetary" in failed
        (other,) = self.problems(tmp_path, "```console\n$ gearheat --version\ngearheat 9.9\n```\n")
        assert "does not print 'gearheat 9.9'" in other

    def test_an_edit_of_what_is_not_there(self, tmp_path: Path) -> None:
        text = "```toml a.toml\na = 1\n```\n\n```diff a.toml\n-a = {}\n+a = 3\n```\n"
        assert not self.problems(tmp_path, text.format(1))
        assert (tmp_path / "place" / "a.toml").read_text(encoding="utf-8") == "a = 3\n"
        (problem,) = self.problems(tmp_path, text.format(2))
        assert "0 times, not once" in problem

    def test_lines_are_the_same_to_their_last_digit(self) -> None:
        assert same("oil.T  36.14 degC", " oil.T 36.15   degC ")
        assert not same("oil.T  36.14 degC", "oil.T 36.16 degC")
        assert not same("oil.T  36.14 degC", "wall.T 36.14 degC")
        assert same("oil.T  36.1 ...", "oil.T 36.1 degC temperature")
        assert not same("12 tests", "13 tests")

    def test_lines_stand_in_their_order(self) -> None:
        assert not list(missing(["a 1", "b 2"], "a 1\nc\nb 2\n"))
        assert list(missing(["b 2", "a 1"], "a 1\nb 2\n")) == ["a 1"]


def test_the_capability_table_is_what_an_fmu_declares() -> None:
    flat = rc(R=1.0, C=1.0)
    root = ET.fromstring(description(flat, equations(flat), table(flat), ""))
    declared: dict[str, str] = {}
    for interface in ("ModelExchange", "CoSimulation"):
        declared |= root.find(interface).attrib
    del declared["modelIdentifier"]
    page = (PAGES / "howto" / "fmu.md").read_text(encoding="utf-8")
    section = page.partition("## What it declares, and has")[2].partition("\n## ")[0]
    assert dict(re.findall(r"^\| `(\w+)` \| (\w+) \|", section, flags=re.MULTILINE)) == declared


def test_the_table_of_broken_assemblies_is_what_the_program_says() -> None:
    page = (PAGES / "howto" / "assemblies.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+?) \| (.+) \|$", page, flags=re.MULTILINE)[1:]
    slips = {make.__doc__: make for make in BROKEN}
    assert len(rows) >= 12
    for what, says in rows:
        with pytest.raises(StructureError) as caught:
            flatten(slips[what]())
        assert " ".join(str(caught.value).split()) == says
