"""What commands print, on screens of 80 and 120 columns, beside the files in `snapshots`.

After a change that is meant, `SNAPSHOTS=write python -m pytest tests/tools/test_snapshots.py` writes them anew.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import fabricated_findings
import pytest
from fabricated_answers import ANSWERS
from gearheat import Errors
from gearheat.tools.cli.measured import print_errors
from gearheat.tools.cli.rigs import schema as gearheat_schema
from gearheat.tools.compare.errors import compare, rivals
from gearheat.tools.diagnose.report.screen import text
from gearheat.tools.show import console
from gearheat.tools.show.console import cell, table

FOLDER = Path(__file__).parent / "snapshots"
WIDTHS = (80, 120)
DUTY = "time [min],room.T [degC]\n0,20\n60,20\n"
RANGES = ("--speed", "900..1450 rpm", "--torque", "-600..-300 N.m", "--grid", "2x2")
#: Name of the file -> command.
COMMANDS: dict[str, tuple[str, ...]] = {
    "list": ("list",),
    "parts": ("parts",),
    "parts_type": ("parts", "LipSeal"),
    "show": ("show", "harmonic_printed"),
    "show_all": ("show", "harmonic_printed", "--all"),
    "show_errata": ("show", "harmonic_printed", "--errata"),
    "new": ("new", "mine", "--stages", "helical,helical", "--ratio", "12.56", "--power", "7.5 kW",
                  "--speed", "1450 rpm"),
    "steady": ("steady", "helical_two_stage"),
    "steady_all": ("steady", "harmonic", "--all"),
    "steady_outside": ("steady", "cycloidal"),
    "design": ("design", "helical_two_stage", "--free", "cooling.A", "--target", "oil.T=45 degC"),
    "design_limit": ("design", "planetary", "--free", "cooling.A", "--free", "foot.G",
                                 "--target", "oil.T<75 degC"),
    "design_among": ("design", "helical_two_stage", "--target", "oil.T<39.5 degC",
                                 "--among", "oil=ISO VG 220 mineral,ISO VG 220 PAO,MINR"),
    "simulate": ("simulate", "helical_two_stage", "--duty", "duty.csv", "-o", "out.csv"),
    "rating": ("rating", "helical_two_stage", "--limit", "oil.T=80 degC", "--grid", "2x2"),
    "teeth": ("teeth", "helical_two_stage"),
    "map": ("map", "helical_two_stage", "-o", "map.csv", *RANGES),
    "sweep": ("sweep", "helical_two_stage", "--vary", "room.T=10..30 degC", "--grid", "3", "-o", "out.csv",
                      "--output", "oil.T,efficiency.eta,stage_1.P_loss"),
    "card": ("card", "fzg_four_square"),
    "losses": ("losses", "helical_two_stage", "--temperature", "model"),
    "losses_method": ("losses", "helical_two_stage", "--method", "iso14179-1"),
    "verify": ("verify", "fzg_four_square"),
}  # fmt: skip
#: What is round-off or depends on the machine, and what stands in its place.
MASKED = ((r"(closed within )\S+", r"\1~0"), (r"( after )[\d.]+ s$", r"\1~ s"))


@pytest.fixture
def at_both(monkeypatch):
    """Prints an answer at both widths, beside the files of a name."""
    numbers: list[float] = []

    def noted(value: Any) -> str:
        numbers.extend([value] if isinstance(value, float) else [])
        return cell(value)

    def show(name: str, human: Callable[[], None]) -> None:
        monkeypatch.setattr(console, "cell", noted)
        for width in WIDTHS:
            monkeypatch.setenv("COLUMNS", str(width))
            with redirect_stdout(io.StringIO()) as printed:
                human()
            agrees(FOLDER / f"{name}_{width}.txt", printed.getvalue())
        fragile = [v for v in numbers if v == v and not same_elsewhere(v)]
        assert not fragile, f"another machine may print these otherwise: {fragile}"

    return show


def agrees(path: Path, text: str) -> None:
    """Compare with a file, or write it."""
    for pattern, instead in MASKED:
        text = re.sub(pattern, instead, text, flags=re.MULTILINE)
    text = "\n".join(line.rstrip() for line in text.splitlines()) + "\n"
    assert "…" not in text
    if os.environ.get("SNAPSHOTS") == "write":
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text, "if this is meant: SNAPSHOTS=write, see above"


def same_elsewhere(value: float) -> bool:
    """Whether a number is printed alike where its last digits differ: a given one always, round-off of zero never."""
    given = float(f"{value:.6g}") == value
    return given or (abs(value) > 1e-12 and cell(value * (1 - 1e-8)) == cell(value * (1 + 1e-8)))


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_print_what_they_did(gearheat, at_both, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    Path("duty.csv").write_text(DUTY, encoding="utf-8")
    answered = []
    monkeypatch.setattr(console, "answer", lambda payload, to, human: answered.append(human))
    done = gearheat(*COMMANDS[name])
    assert done.code == 0, done.err
    at_both(name, answered[0])


@pytest.mark.parametrize("name", ANSWERS)
def test_costly_commands_print_a_made_up_result_as_they_did(at_both, name):
    at_both(name, ANSWERS[name])


def test_schema_says_what_to_do_with_it(at_both, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    at_both("schema", lambda: gearheat_schema(out=Path("rig.json")))


def test_a_comparison_prints_what_it_did(at_both, rows):
    errors = Errors({}, compare(rows), rivals(rows, ["n_carrier_rpm", "T_carrier_Nm"]))
    at_both("compare", lambda: print_errors(errors))


@pytest.mark.parametrize("kind", ["clean", "explained", "ambiguous", "unexplained"])
def test_a_diagnosis_prints_what_it_did(at_both, kind):
    found = getattr(fabricated_findings, kind)()
    at_both(f"diagnose_{kind}", lambda: print(text(found, everything=True, width=console.screen_width()), end=""))


def test_one_row_of_many_numbers_goes_on_below(at_both):
    numbers = [(1000.0 + i) / 7 for i in range(30)]
    at_both("wide", lambda: table("Wide", ["name", *(f"number_{i}" for i in range(30))], [["a", *numbers]]))
