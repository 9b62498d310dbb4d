"""Runs cases: makes them, asks the diagnosis, scores; several at a time, going on where it stopped."""

from __future__ import annotations

import hashlib
import json
import threading
import time
import tomllib
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from gearheat.model.errors import DataError

from . import practice
from .answers import Answer, Diagnoser, ask_command, read_answer
from .scoring import Outcome, score
from .sheets import MAKERS

ROOT = Path(__file__).resolve().parents[2]

#: Folders that the cases follow from.
CASE_SOURCES = ("model", "scenarios", "tests/challenge")
#: Folders that the answers follow from besides them.
ANSWER_SOURCES = ("fmu", "tools")

#: Rules of the inference that it can do without, one at a time: what each is, and the constants that turn it off.
RULES: Mapping[str, Any] = tomllib.loads((Path(__file__).parent / "rules.toml").read_text(encoding="utf-8"))
#: Cases are made one at a time: simulators keep buffers.
_MAKING = threading.Lock()


@dataclass(frozen=True)
class Task:
    """One case.

    Args:
        sheet: that it belongs to
        k, seed, kind: of a case to make
        folder: for its files and answers
        given: the folder of a case that is there already
        stamps: of what the case and the answer follow from
        off: rule of the inference that is off, none if empty
    """

    sheet: str
    k: int
    seed: int
    kind: str | None
    folder: Path
    given: Path | None
    stamps: tuple[str, str]
    diagnose: Diagnoser
    off: str = ""


def tasks(
    sheet: str,
    n: int,
    seed: int,
    out: Path,
    *,
    kind: str | None = None,
    given: Path | None = None,
    diagnose: Diagnoser = ask_command,
    off: str = "",
) -> list[Task]:
    """The cases 0 ... n - 1 of a sheet, or the first n in the folder `given`; answered without a rule of `RULES`."""
    case_stamp = f"{fingerprint(*CASE_SOURCES)} {sheet} {seed} {kind}"
    stamps = case_stamp, f"{case_stamp} {diagnose.__module__} {fingerprint(*ANSWER_SOURCES)}"
    if off:
        diagnose = partial(ask_command, off=RULES[off]["set"])
    if given is not None:
        folders = practice.folders(given)[:n]
        return [Task(sheet, k, seed, None, out / p.name, p, stamps, diagnose, off) for k, p in enumerate(folders)]
    return [Task(sheet, k, seed, kind, out / f"{k:04d}", None, stamps, diagnose, off) for k in range(n)]


def fingerprint(*folders: str) -> str:
    """A number for all sources in some folders of the project."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".py", ".toml") and path.is_file():
                digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def run(todo: list[Task], jobs: int, progress: Callable[[int, Outcome], None] = lambda k, o: None) -> list[Outcome]:
    """Outcomes in the order of the cases; `jobs` diagnoses at a time, each a process of its own."""
    with ThreadPoolExecutor(max(jobs, 1)) as pool:
        futures = [pool.submit(solve, task) for task in todo]
        try:
            for done, future in enumerate(as_completed(futures), 1):
                progress(done, future.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [future.result() for future in futures]


def solve(task: Task) -> Outcome:
    """Make a case unless it is there, ask unless it is answered, and score."""
    if task.given:
        truth, case = practice.truth(task.given), practice.files(task.given)
    else:
        truth, case = _make(task), practice.files(task.folder / "case", made=True)
    place = task.folder / f"answer {task.off}".strip()
    state = _read(place / "DONE.json")
    if state.get("stamp") != task.stamps[1]:
        state = _ask(task, rig_of(truth), case, place)
        (place / "DONE.json").write_text(json.dumps(state) + "\n", encoding="utf-8")
    answer: Answer | None = None
    problem = str(state["problem"])
    if not problem:
        try:
            answer = read_answer(place)
        except DataError as error:
            problem = str(error)
    return score({**truth, "sheet": task.sheet}, answer, float(state["seconds"]), problem)


def rig_of(truth: Mapping[str, Any]) -> str:
    """Name of the rig of a case."""
    return str(truth.get("rig", {}).get("name", "planetary"))


def _make(task: Task) -> dict[str, Any]:
    """The truth of a case, which is made unless it is there."""
    stamp = task.folder / "STAMP"
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != task.stamps[0]:
        stamp.unlink(missing_ok=True)
        with _MAKING:
            MAKERS[task.sheet](task.seed, task.k, task.folder, kind=task.kind)
        stamp.write_text(task.stamps[0], encoding="utf-8")
    return _read(task.folder / "TRUTH.json")


def _ask(task: Task, rig: str, case: Mapping[str, Path], place: Path) -> dict[str, Any]:
    """Ask, and note the processor time (of the clock, where the diagnosis does not state it) and what went wrong."""
    place.mkdir(parents=True, exist_ok=True)
    for old in place.glob("*"):
        old.unlink()
    problem, began, noted = "", time.perf_counter(), place / "SECONDS"
    try:
        task.diagnose(rig, case, place)
    except Exception as error:  # whatever goes wrong in a diagnosis is an answer that is missing
        problem = f"{type(error).__name__}: {error}"
    seconds = float(noted.read_text()) if noted.exists() else time.perf_counter() - began
    return {"stamp": task.stamps[1], "problem": problem, "seconds": round(seconds, 3)}


def _read(path: Path) -> dict[str, Any]:
    """A JSON object; an empty one where there is none."""
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}
