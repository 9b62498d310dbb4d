"""The page for a gearbox of one's own is true: its card, its table's head and its command work as they stand."""

import csv
import re
import shutil
from pathlib import Path

from diagnose.hidden.benches import HELICAL
from diagnose.hidden.cases import HIDDEN
from diagnose.hidden.maker import make
from gearheat.scenarios.load import RIGS
from gearheat.tools.cli import app
from typer.testing import CliRunner

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "tools" / "diagnose" / "README.md").read_text("utf-8")


def block(language: str) -> str:
    """The page's example in a language."""
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return found


def test_the_page_for_ones_own_gearbox(tmp_path, monkeypatch) -> None:
    case = make(HELICAL, [HIDDEN["helical"]["churning"]], 7, tmp_path / "made")
    with case.data.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    head, *examples = block("csv").splitlines()
    columns = head.split(",")
    with (tmp_path / "points.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, columns, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)
    assert all(len(line.split(",")) == len(columns) for line in examples)
    (tmp_path / "card.toml").write_text(block("toml"), "utf-8")
    shutil.copytree(RIGS / "helical_two_stage", tmp_path / "gearbox")
    monkeypatch.chdir(tmp_path)
    words = block("sh").split()
    assert words.pop(0) == "gearheat"
    run = CliRunner().invoke(app, words)
    assert run.exit_code == 0, run.output
    assert "churning" in (tmp_path / "diagnosis.html").read_text("utf-8")
