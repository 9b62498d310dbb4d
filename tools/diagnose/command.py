"""The command `diagnose`: files in, findings out."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from ...model.errors import DataError, GearheatError
from ..console import answer, file_of, note, writable, write
from . import output
from .extension import extended_text
from .findings import Findings
from .inputs import Inputs, Request, read_inputs
from .memory import Memory, memory_of
from .predictions import Predictor, predictions_text
from .report import render

#: Inputs, alpha, seed and a listener for progress (stage, share done) -> what was found, and how to predict with it.
Infer = Callable[[Inputs, float, int, Callable[[str, float], None]], tuple[Findings, Predictor]]


#: Causes that may be looked for together.
MOST = 8


@dataclass(frozen=True)
class Outputs:
    """Where results go; None writes nothing, "-" as `json` is stdout."""

    predictions: Path | None = None
    json: str | None = None
    report: Path | None = None
    extended: Path | None = None

    def files(self) -> dict[str, Path]:
        """The files that are written, by the name of their option."""
        given = {"--predictions": self.predictions, "--json": file_of(self.json), "--report": self.report}
        given |= {"--extended": self.extended}
        return {name: path for name, path in given.items() if path is not None}


def command(request: Request, outputs: Outputs, alpha: float, seed: int, infer: Infer | None = None) -> None:
    """Read, infer, write.

    Args:
        request: the files to read
        outputs: the files to write
        alpha: accepted rate of false alarms
        seed: of everything drawn; the same seed gives the same bytes
        infer: the inference; the project's own if None

    Raises:
        GearheatError: all problems of files and options at once, before any work
    """
    inputs = _checked(request, outputs, alpha, seed)
    memory = memory_of(inputs.digest)
    progress = Progress(memory)
    try:
        findings, predictor = (infer or _inference())(replace(inputs, memory=memory), alpha, seed, progress)
    except KeyboardInterrupt:
        if memory.made or memory.reused:
            note("what was computed is kept: the same command goes on from there")
        raise
    _write(inputs, outputs, findings, predictor)
    note(f"done after {progress.seconds:.1f} s")
    answer(output.as_object(findings), outputs.json, lambda: output.show(findings))
    memory.forget()


def _inference() -> Infer:
    """The project's inference, imported when it is needed."""
    from .infer import infer

    return infer


def _checked(request: Request, outputs: Outputs, alpha: float, seed: int) -> Inputs:
    """The inputs, or all problems of files and options."""
    problems = _option_problems(request, outputs, alpha, seed)
    inputs = None
    try:
        inputs = read_inputs(request)
    except GearheatError as error:
        problems += error.problems
    try:
        writable(*outputs.files().values())
    except GearheatError as error:
        problems += error.problems
    if problems or inputs is None:
        raise DataError(problems)
    return inputs


def _option_problems(request: Request, outputs: Outputs, alpha: float, seed: int) -> list[str]:
    problems = []
    if not 0.0 < alpha < 1.0:
        problems.append(f"--alpha {alpha:g} is no rate of false alarms. Give a number between 0 and 1, such as 0.05.")
    if not 2 <= request.most <= MOST:
        problems.append(f"--causes {request.most}: how many causes may act together. Give 2 to {MOST}.")
    if request.repeatability not in ("card", "points"):
        problems.append(f'--repeatability "{request.repeatability}" is unknown. Give card or points.')
    if seed < 0:
        problems.append(f"--seed {seed} is below zero. Give 0 or more.")
    if request.predict is not None and outputs.predictions is None:
        problems.append("--predict needs a place for the result. Give --predictions FILE, too.")
    if outputs.predictions is not None and request.predict is None:
        problems.append("--predictions needs the points to predict. Give --predict FILE, too.")
    taken = {path.resolve(): name for name, path in request.files().items()}
    for name, path in outputs.files().items():
        if (other := taken.setdefault(path.resolve(), name)) != name:
            problems.append(f"{name} {path}: is the file of {other}, too. Give each its own.")
    return problems


def _write(inputs: Inputs, outputs: Outputs, findings: Findings, predictor: Predictor) -> None:
    if outputs.predictions is not None and inputs.points is not None:
        write(outputs.predictions, predictions_text(inputs.points, predictor))
    if outputs.extended is not None:
        write(outputs.extended, extended_text(inputs, findings))
    if outputs.report is not None:
        write(outputs.report, render(inputs, findings))


class Progress:
    """Says on stderr what is going on: each stage once, and long ones again every few seconds."""

    EVERY = 5.0

    def __init__(self, memory: Memory) -> None:
        self.memory = memory
        self.began = self.told = time.perf_counter()
        self.stage, self.resumed = "", False

    @property
    def seconds(self) -> float:
        """Time since the beginning."""
        return time.perf_counter() - self.began

    def __call__(self, stage: str, share: float) -> None:
        """Take note of a stage and of the share of the whole work that is done."""
        now = time.perf_counter()
        if self.memory.reused and not self.resumed:
            self.resumed = True
            note("an earlier diagnosis of the same files was interrupted: what it computed is used again")
        if stage != self.stage or now - self.told > self.EVERY:
            note(f"{100 * share:3.0f} %  {stage}")
            self.stage, self.told = stage, now
