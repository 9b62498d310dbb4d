"""The commands `diagnose` and `plan`: files in, findings out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

from ...fmu.compiling import Progress
from ...model.errors import DataError, GearheatError
from ..diagnose.report import plan as plans
from ..diagnose.report.findings import Findings, as_object
from ..diagnose.report.page import render
from ..diagnose.report.predictions import predictions_text
from ..diagnose.report.screen import text
from ..diagnose.request import Inputs, PlanInputs, PlanRequest, Request, read, read_plan
from ..show.console import as_json, file_of, progress_bar, screen_width, writable, write

#: What is read and a listener for progress -> what was found, with its words; the same of a plan.
Infer = Callable[[Inputs, Progress], Findings]
Find = Callable[[PlanInputs, Progress], plans.Plan]
#: Kinds of pictures by the ending of their file's name.
PICTURES: Mapping[str, Literal["png", "svg"]] = {".png": "png", ".svg": "svg"}
T = TypeVar("T")


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


def diagnose_command(
    request: Request, outputs: Outputs, infer: Infer | None = None, *, everything: bool = False
) -> None:
    """Read, infer, write. Files are written when all of them are made: an interrupted run leaves none.

    Args:
        request: files and options
        outputs: the files to write
        infer: the inference; the project's own if None
        everything: print all tables

    Raises:
        GearheatError: all problems of files and options at once, before any work
    """
    problems = []
    if request.predict is not None and outputs.predictions is None:
        problems.append("--predict needs a place for the result. Give --predictions FILE, too.")
    if outputs.predictions is not None and request.predict is None:
        problems.append("--predictions needs the points to predict. Give --predict FILE, too.")
    inputs = _checked(problems, request.files(), outputs.files(), lambda: read(request))
    with progress_bar() as progress:
        findings = (infer or _inference())(inputs, progress)
    made: dict[Path | None, str] = {
        outputs.predictions: predictions_text(findings),
        outputs.extended: findings.extended_rig,
        outputs.report: render(findings) if outputs.report is not None else "",
        file_of(outputs.json): as_json(as_object(findings)),
    }
    for path, content in made.items():
        if path is not None:
            write(path, content)
    print(
        as_json(as_object(findings))
        if outputs.json == "-"
        else text(findings, everything=everything, width=screen_width()),
        end="",
    )


def _inference() -> Infer:
    """The project's inference, imported when it is needed."""
    from ..diagnose.diagnosis import diagnosed

    return diagnosed


def plan_command(
    request: PlanRequest, json: str | None, out: Path | None, find: Find | None = None, *, everything: bool = False
) -> None:
    """Read, plan, write.

    Args:
        request: files and options
        json: file of the JSON object, "-" for stdout
        out: picture to write
        find: what plans; the project's own if None
        everything: print all experiments and all causes

    Raises:
        GearheatError: all problems of files and options at once, before any work
    """
    problems = []
    if out is not None and out.suffix.lower() not in PICTURES:
        problems.append(f"--out {out}: is no picture that can be drawn. Give a name that ends in .png or .svg.")
    if out is not None and not request.causes:
        problems.append("--out draws the distances of causes. Name them with --separate CAUSE,CAUSE.")
    given = {"--json": file_of(json), "--out": out}
    files = {name: path for name, path in given.items() if path is not None}
    inputs = _checked(problems, request.files(), files, lambda: read_plan(request))
    with progress_bar() as progress:
        plan = (find or _planning())(inputs, progress)
    found = as_json(plans.as_object(plan))
    if out is not None:
        write(out, plans.picture(plan, PICTURES[out.suffix.lower()]))
    if (path := file_of(json)) is not None:
        write(path, found)
    print(found if json == "-" else plans.text(plan, everything=everything, width=screen_width()), end="")


def _planning() -> Find:
    """The project's planning, imported when it is needed."""
    from ..diagnose.planning import planned

    return planned


def _checked(
    problems: list[str], files: Iterable[tuple[str, Path]], written: Mapping[str, Path], step: Callable[[], T]
) -> T:
    """What is read, or all problems of files and options."""
    problems = problems + shared(files, written)
    found = None
    try:
        found = step()
    except GearheatError as error:
        problems += error.problems
    try:
        writable(*written.values())
    except GearheatError as error:
        problems += error.problems
    if problems or found is None:
        raise DataError(problems)
    return found


def shared(read: Iterable[tuple[str, Path]], written: Mapping[str, Path]) -> list[str]:
    """Problems of files that are written over others.

    Args:
        read: option and file, of each that is read
        written: option -> file that is written
    """
    taken, problems = {path.resolve(): name for name, path in read}, []
    for name, path in written.items():
        if (other := taken.setdefault(path.resolve(), name)) != name:
            problems.append(f"{name} {path}: is the file of {other}, too. Give each its own.")
    return problems
