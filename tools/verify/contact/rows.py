"""Rows of the verification table, and the pieces of work that give them.

Results are kept in files, so that an interrupted verification goes on where it stopped.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from ....model.errors import SolveError
from ...show.console import as_json, folder, note, write

#: What a piece of work gives: "rows" of the table, and whatever the figures draw.
Found = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """One piece of work that is kept once it is done.

    Args:
        item: heading of its rows
        name: its name among those of the item
        work: computes it
        quick: whether it belongs to the quick subset
    """

    item: str
    name: str
    work: Callable[[], Found]
    quick: bool = False

    @property
    def key(self) -> str:
        """A name for its file."""
        return "".join(c if c.isalnum() else "-" for c in f"{self.item} {self.name}".lower())


def row(case: str, quantity: str, reference: float, ours: float, rel: float, load_error: float = 0.0) -> Found:
    """One row of the table.

    Args:
        case: what was solved
        quantity: what is compared
        reference: what it is compared with
        ours: what the solver gives
        rel: largest accepted distance over the reference; 0 where it is only reported
        load_error: load missing over the load
    """
    deviation = ours / reference - 1
    verdict = "reported" if rel == 0 else "within" if abs(deviation) <= rel else "outside"
    return {
        "case": case,
        "quantity": quantity,
        "reference": reference,
        "ours": ours,
        "deviation": deviation,
        "tolerance": rel,
        "verdict": verdict,
        "load_error": load_error,
    }


def bound(
    case: str,
    quantity: str,
    ours: float,
    *,
    least: float | None = None,
    most: float | None = None,
    judged: bool = True,
) -> Found:
    """One row of the table whose reference is a bound.

    Args:
        case: what was solved
        quantity: what is measured
        ours: its value
        least: the bound below it
        most: the bound above it
        judged: whether it has to hold; else it is only reported
    """
    limit = least if least is not None else most
    assert limit is not None
    held = (least is None or ours >= least) and (most is None or ours <= most)
    found = row(case, quantity, limit, ours, 0.0)
    sign = ">=" if least is not None else "<="
    return {**found, "tolerance": sign, "verdict": "reported" if not judged else "within" if held else "outside"}


def fingerprint(job: Job) -> str:
    """What a result depends on, as a short text: another solver, reference or piece of work makes a kept one void."""
    solver = files("gearheat.model.contact")
    kept = [*solver.iterdir(), *solver.joinpath("reference").iterdir()]
    module = getattr(job.work, "func", job.work).__module__.rpartition(".")[2]
    kept += [files("gearheat.tools.verify.contact").joinpath(f"{name}.py") for name in ("cases", "rows", module)]
    state = hashlib.sha256()
    for entry in sorted(kept, key=lambda e: e.name):
        if entry.name.endswith((".py", ".toml")):
            state.update(entry.read_bytes())
    return state.hexdigest()[:16]


def run(jobs: Sequence[Job], out: Path) -> list[tuple[Job, Found]]:
    """All results, those that are kept not computed again; progress on stderr.

    Args:
        jobs: what to do
        out: folder of the results
    """
    place, found = folder(out / "work"), []
    for i, job in enumerate(jobs):
        path, made_by = place / f"{job.key}.json", fingerprint(job)
        kept = _read_kept(path, made_by)
        if kept is None:
            note(f"[{i + 1}/{len(jobs)}] {job.item}: {job.name}")
            kept = json.loads(as_json(_result(job)))
            write(path, as_json({"made_by": made_by, "found": kept}))
        found.append((job, kept))
    return found


def _result(job: Job) -> Found:
    """What a piece of work gives; a contact without a solution is a row of its own."""
    try:
        return job.work()
    except SolveError as error:
        note(f"error: {error}")
        return {"rows": [bound(job.name, "solutions found", 0.0, least=1.0)]}


def _read_kept(path: Path, made_by: str) -> Found | None:
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return held["found"] if held.get("made_by") == made_by else None
