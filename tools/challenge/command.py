"""`gearheat challenge`: hides effects, asks the diagnosis without telling it, and prints how well it did."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...model.errors import ScenarioError
from .. import console
from .bench import run_sheet
from .scoring import Outcome, report


def command(
    sheet: str,
    n: int,
    seed: int,
    jobs: int = 0,
    out: Path | None = None,
    only: str | None = None,
    json: str | None = None,
) -> None:
    """Run a sheet and give its table.

    Args:
        sheet: "own" or "foreign"
        n: number of cases
        seed: of the challenge
        jobs: processes, 0 for one per core
        out: folder for cases and answers; a run that was interrupted goes on from there. A passing one if left out
        only: one kind of cases, e.g. "clean"
        json: where to write the report; - for stdout

    Raises:
        ScenarioError: an unknown sheet or kind, or no cases
    """
    from .case import check

    check(sheet, only, None)
    if n < 1:
        raise ScenarioError(f"challenge: --n {n}: ask for at least one case.")
    console.writable(console.file_of(json))
    workers = min(jobs or os.cpu_count() or 1, n)

    def progress(done: int, outcome: Outcome) -> None:
        trouble = f": {outcome.problem}" if outcome.problem else ""
        console.note(f"{done}/{n}: case {outcome.case} in {outcome.seconds:.1f} s{trouble}")

    with _folder(out, sheet, seed) as place:
        outcomes = run_sheet(sheet, seed, n, place, jobs=workers, kind=only, progress=progress)
    found = report(outcomes, sheet, seed)
    console.answer(found, json, lambda: show(found))


@contextmanager
def _folder(out: Path | None, sheet: str, seed: int) -> Iterator[Path]:
    if out is not None:
        yield console.folder(out / f"{sheet}-{seed}")
        return
    with tempfile.TemporaryDirectory(prefix="gearheat-challenge-") as passing:
        yield Path(passing)


def show(found: Mapping[str, Any]) -> None:
    """Print the report as tables."""
    kinds = ", ".join(f"{count} {kind}" for kind, count in found["kinds"].items())
    rows = [_row(m) for m in found["metrics"]]
    head = ("metric", "value", "95 % interval", "cases", "must", "", "ambitious", "")
    console.table(f"{found['sheet']} sheet, seed {found['seed']}: {found['n']} cases ({kinds})", head, rows)
    answers = [
        (truth if i == 0 else "", top, count)
        for truth, row in found["confusion"].items()
        for i, (top, count) in enumerate(sorted(row.items(), key=lambda item: (-item[1], item[0])))
    ]
    console.table("what was hidden, and the likeliest answer", ("hidden", "answer", "cases"), answers)
    loudness = [_loudness(r) for r in found["by_loudness"] if r["n"]]
    columns = ("signal-to-noise", "cases", "detected", "95 % interval", "exact name", "95 % interval")
    console.table("one cause, by how loud it is", columns, loudness)
    seconds = found["seconds"]
    if seconds["median"] is not None:
        print(f"time per case: median {seconds['median']:.1f} s, longest {seconds['longest']:.1f} s")
    if found["answered"] < found["n"]:
        print(f"{found['n'] - found['answered']} cases without an answer count as missed")


def _loudness(r: Mapping[str, Any]) -> tuple[str, ...]:
    low, high = r["snr"]
    span = f"{low:g} ... {high:g}" if high < 1e6 else f"above {low:g}"
    detected, exact = (f"{r[name] / r['n']:.2f}" for name in ("detected", "exact"))
    spans = [" ... ".join(f"{v:.2f}" for v in r[f"{name}_interval"]) for name in ("detected", "exact")]
    return span, str(r["n"]), detected, spans[0], exact, spans[1]


def _row(m: Mapping[str, Any]) -> tuple[str, ...]:
    def number(value: float) -> str:
        return f"{value:.2f}"

    def bar(value: float | None) -> str:
        return "" if value is None else f"{'<=' if m['at_most'] else '>='} {value:.2f}"

    def met(reached: bool | None) -> str:
        return "" if reached is None else "reached" if reached else "missed"

    value = "" if m["value"] is None else number(m["value"])
    interval = "" if m["interval"] is None else f"{number(m['interval'][0])} ... {number(m['interval'][1])}"
    bars = (bar(m["must"]), met(m["must_met"]), bar(m["ambitious"]), met(m["ambitious_met"]))
    return m["name"], value, interval, str(m["n"]), *bars
