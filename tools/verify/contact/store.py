"""Results of pieces of work, kept in files, so that an interrupted verification goes on where it stopped."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from ....model.errors import SolveError
from ...show.console import as_json, folder, note, write
from .rows import Found, Job, bound


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
