"""`python -m tests.challenge`: hides faults, has them diagnosed, and scores the answers.

To be run in a checkout. An interrupted run with a folder (`-o`) goes on where it stopped.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import typer
from gearheat.model.errors import ScenarioError, suggestion
from gearheat.tools.show import console

from .bench import RULES, run, tasks
from .hide import KINDS
from .machines import KINDS as OF_MACHINES
from .names import names
from .printing import show
from .scoring import Outcome, report
from .sheets import MAKERS, POOLED, SHEETS

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
@console.guard
def challenge(
    sheet: Annotated[
        Literal["own", "foreign", "textbook", "machines", "plates", "rigs", "logs", "lone_logs", "practice", "all"],
        typer.Option(
            help="own: the planetary rig as the model has it; foreign: another simulator, with a healthy reference; "
            "textbook: a frozen third one with rough readings; machines: units of `gearheat new` by random name "
            "plates; plates: such units of which no more is known; rigs: steady points of other shipped rigs; logs: "
            "units of machines in operation beside a healthy log; lone_logs: without; practice: the campaigns of "
            "--practice; all: own, foreign, textbook, machines and practice, pooled."
        ),
    ],
    n: Annotated[int, typer.Option("--n", help="Number of cases of each sheet.")] = 150,
    seed: Annotated[int, typer.Option(help="The same seed hides the same.")] = 0,
    jobs: Annotated[int, typer.Option("-j", "--jobs", min=0, help="How many to run at once; 0 for one per core.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder for cases and answers; an interrupted run goes on from there."),
    ] = None,
    only: Annotated[str | None, typer.Option(help='One kind of cases, for example "clean".')] = None,
    practice: Annotated[
        Path | None, typer.Option(help="Folder of campaigns: data.csv, card.json and key.json in a folder each.")
    ] = None,
    off: Annotated[str, typer.Option(help="Rule of the inference that is turned off, of rules.toml.")] = "",
    json: Annotated[str | None, typer.Option(metavar="FILE", help="Write the result as JSON; - for stdout.")] = None,
) -> None:
    """Hide effects in simulated campaigns, have them diagnosed, and score the answers."""
    problems = []
    for name in POOLED if sheet == "all" else (sheet,):
        kinds = OF_MACHINES if name in MAKERS.keys() - SHEETS.keys() else KINDS
        if only and only not in kinds:
            problems.append(f'challenge: {name} has no "{only}".{suggestion(only, kinds)} Kinds: {", ".join(kinds)}.')
    if off and off not in RULES:
        problems.append(f'challenge: unknown rule "{off}".{suggestion(off, RULES)} Rules: {", ".join(RULES)}.')
    if n < 1:
        problems.append(f"challenge: --n {n}: ask for at least one case.")
    if sheet == "practice" and practice is None:
        problems.append("challenge: --sheet practice needs --practice FOLDER, a folder of campaigns with their keys.")
    if problems:
        raise ScenarioError(problems)
    console.writable(console.file_of(json))
    with _folder(out) as place:
        todo = []
        for name in POOLED if sheet == "all" else (sheet,):
            if name in MAKERS:
                todo += tasks(name, n, seed, place / f"{name}-{seed}", kind=only, off=off)
        if practice is not None and sheet in ("all", "practice"):
            todo += tasks("practice", n, seed, place / "practice", given=practice, off=off)

        def progress(done: int, o: Outcome) -> None:
            trouble = f": {o.problem}" if o.problem else ""
            console.note(f"{done}/{len(todo)}: {o.sheet} {o.case}, {o.seconds:.1f} s of processor time{trouble}")

        outcomes = run(todo, min(jobs or os.cpu_count() or 1, len(todo)), progress)
    result = report(outcomes, seed)
    console.answer(result, json, lambda: show(result))


@contextmanager
def _folder(out: Path | None) -> Iterator[Path]:
    """The folder that is given, or a temporary one."""
    if out is not None:
        yield console.folder(out)
        return
    with tempfile.TemporaryDirectory(prefix="gearheat-challenge-") as temporary:
        yield Path(temporary)


if __name__ == "__main__":
    if sys.argv[1:2] == ["names"]:
        sys.argv.pop(1)
        app = typer.Typer(add_completion=False, rich_markup_mode=None)
        app.command()(console.guard(names))
    app(prog_name="python -m tests.challenge")
