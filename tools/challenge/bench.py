"""Runs a sheet: makes the cases, asks the diagnosis, scores; over several processes, going on where it stopped."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...model.errors import DataError
from .answers import THREADS, Answer, Diagnoser, ask_command, read_answer
from .case import make_case
from .scoring import Outcome, score

ROOT = Path(__file__).resolve().parents[2]

#: What the cases follow from, and what the answers follow from besides them.
CASE_SOURCES = ("model", "scenarios", "tools/challenge")
ANSWER_SOURCES = ("fmu", "tools")


@dataclass(frozen=True)
class Task:
    """One case to make, ask about and score."""

    sheet: str
    seed: int
    k: int
    folder: Path
    kind: str | None
    case_stamp: str
    answer_stamp: str
    diagnose: Diagnoser


def fingerprint(*folders: str) -> str:
    """A number for all sources in some folders of the project."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".py", ".toml", ".c", ".h") and path.is_file():
                digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def run_sheet(
    sheet: str,
    seed: int,
    n: int,
    out: Path,
    *,
    jobs: int = 0,
    kind: str | None = None,
    diagnose: Diagnoser = ask_command,
    progress: Callable[[int, Outcome], None] = lambda done, outcome: None,
) -> list[Outcome]:
    """Outcomes of cases 0 ... n - 1.

    Args:
        sheet: "own" or "foreign"
        seed: of the challenge
        n: number of cases
        out: folder; cases and answers that it holds already are used if the sources are still the same
        jobs: processes with one thread each, for which `diagnose` must be a function of a module; 0 for this one
        kind: only this kind of case; drawn per case if left out
        diagnose: what is asked
        progress: called after each case with how many are done and the outcome
    """
    case_stamp = f"{fingerprint(*CASE_SOURCES)} {kind}"
    name = f"{diagnose.__module__}.{getattr(diagnose, '__qualname__', type(diagnose).__name__)}"
    answer_stamp = f"{case_stamp} {name} {fingerprint(*ANSWER_SOURCES)}"
    tasks = [Task(sheet, seed, k, out / f"{k:04d}", kind, case_stamp, answer_stamp, diagnose) for k in range(n)]
    outcomes = []
    for outcome in _results(tasks, jobs):
        outcomes.append(outcome)
        progress(len(outcomes), outcome)
    return sorted(outcomes, key=lambda o: o.case)


def _results(tasks: list[Task], jobs: int) -> Iterable[Outcome]:
    if jobs < 1:
        yield from map(solve, tasks)
        return
    with _one_thread(), ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        futures = [pool.submit(solve, task) for task in tasks]
        try:
            yield from (future.result() for future in as_completed(futures))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that start meanwhile do their linear algebra in one thread each: several at once are faster so."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def solve(task: Task) -> Outcome:
    """Make a case unless it is there, ask unless it is answered, and score."""
    truth = _truth(task)
    done = task.folder / "answer" / "DONE.json"
    state = _read(done)
    if state.get("stamp") != task.answer_stamp:
        state = _ask(task)
        done.write_text(json.dumps(state) + "\n", encoding="utf-8")
    answer: Answer | None = None
    problem = str(state["problem"])
    if not problem:
        try:
            predictions = task.folder / state["predictions"] if state["predictions"] else None
            answer = read_answer(task.folder / state["result"], predictions)
        except DataError as error:
            problem = str(error)
    return score(truth, answer, float(state["seconds"]), problem)


def _truth(task: Task) -> dict[str, Any]:
    stamp = task.folder / "STAMP"
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != task.case_stamp:
        stamp.unlink(missing_ok=True)
        case = task.folder / "case"
        for old in case.glob("*") if case.is_dir() else ():
            old.unlink()
        make_case(task.sheet, task.seed, task.k, task.folder, kind=task.kind)
        stamp.write_text(task.case_stamp, encoding="utf-8")
    return _read(task.folder / "TRUTH.json")


def _ask(task: Task) -> dict[str, Any]:
    """Ask, and note how long it took and what went wrong."""
    place = task.folder / "answer"
    place.mkdir(exist_ok=True)
    for old in place.glob("*"):
        old.unlink()
    state: dict[str, Any] = {"stamp": task.answer_stamp, "problem": "", "result": "", "predictions": ""}
    began = time.perf_counter()
    try:
        result, predictions = task.diagnose(task.folder / "case")
        state["result"] = os.path.relpath(result, task.folder)
        state["predictions"] = os.path.relpath(predictions, task.folder) if predictions else ""
    except Exception as error:  # whatever goes wrong in a diagnosis is an answer that is missing
        state["problem"] = f"{type(error).__name__}: {error}"
    state["seconds"] = round(time.perf_counter() - began, 3)
    return state


def _read(path: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found
