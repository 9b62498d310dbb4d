"""All of the README that can be run is run, in its order and in one folder; its table says what an FMU declares."""

import importlib
import re
import shlex
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import typer
from broken_assemblies import BROKEN
from gearheat.fmu.description import description
from gearheat.fmu.equations import equations
from gearheat.fmu.variables import table
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import StructureError
from gearheat.tools.cli import app
from small_parts import rc
from typer.testing import CliRunner

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*) *(.*?)\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)

#: Commands that work for minutes: only their options are read here, their own tests run them.
LONG = {"bench", "calibrate", "challenge", "diagnose"}

#: Languages of blocks that need a program this project does not install, or that are pictures.
NOT_RUN = {"matlab", "text", ""}


def commands(block: str) -> list[list[str]]:
    """The arguments of every command of a shell block, lines that go on joined."""
    lines = block.replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def installs(block: str) -> bool:
    """Whether a block makes its own environment: the continuous integration runs it as a whole."""
    return "-m venv" in block


def read(arguments: list[str]) -> None:
    """Read the options of a command without running it. Raises for wrong ones."""
    group = typer.main.get_command(app)
    group.commands[arguments[0]].make_context(arguments[0], list(arguments[1:]))


def test_every_block_is_of_a_kind_that_is_known() -> None:
    assert {language for language, _, _ in BLOCKS} <= {"sh", "python", "csv"} | NOT_RUN
    assert sum(language == "python" for language, _, _ in BLOCKS) >= 2


def test_the_blocks_run_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")  # paths as in a checkout
    names: dict[str, object] = {}
    for language, title, block in BLOCKS:
        if language == "csv":
            (tmp_path / title).write_text(block, encoding="utf-8")
        elif language == "python":
            exec(compile(block, "README.md", "exec"), names)
        elif language == "sh" and not installs(block):
            for program, *arguments in commands(block):
                assert program == "gearheat", program
                if arguments[0] in LONG:
                    read(arguments)
                    continue
                result = CliRunner().invoke(app, arguments)
                assert result.exit_code == 0, (arguments, result.stderr)
    made = {path.name for path in tmp_path.rglob("*")}
    assert {"warmup.csv", "played.csv", "planetary.ssv", "MINR.ssv", "planetary_ref.opt", "cooled.fmu"} <= made


def test_the_blocks_that_install_name_commands_that_exist() -> None:
    blocks = [block for language, _, block in BLOCKS if language == "sh" and installs(block)]
    assert len(blocks) == 2
    for block in blocks:
        for program, arguments in re.findall(r"\.venv/bin/(gearheat|python) (.*)", block):
            if program == "gearheat":
                read(shlex.split(arguments))
            else:
                assert importlib.util.find_spec(shlex.split(arguments)[1]) is not None


def test_a_wrong_option_would_be_found() -> None:
    with pytest.raises(Exception, match="No such option"):
        read(["bench", "--quick"])


def test_the_capability_table_is_what_an_fmu_declares() -> None:
    flat = rc(R=1.0, C=1.0)
    root = ET.fromstring(description(flat, equations(flat), table(flat), ""))
    declared: dict[str, str] = {}
    for interface in ("ModelExchange", "CoSimulation"):
        declared |= root.find(interface).attrib
    del declared["modelIdentifier"]
    section = README.partition("### What it declares, and has")[2].partition("\n### ")[0]
    assert dict(re.findall(r"^\| `(\w+)` \| (\w+) \|", section, flags=re.MULTILINE)) == declared


def test_the_table_of_broken_assemblies_is_what_the_program_says() -> None:
    section = README.partition("## When an assembly does not work")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| (.+) \|$", section, flags=re.MULTILINE)[1:]
    slips = {make.__doc__: make for make in BROKEN}
    assert len(rows) >= 12
    for what, says in rows:
        with pytest.raises(StructureError) as caught:
            flatten(slips[what]())
        assert " ".join(str(caught.value).split()) == says
