"""The command `diagnose`: files in, findings out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..diagnose.report.findings import Findings, as_object
from ..diagnose.report.page import render
from ..diagnose.report.predictions import predictions_text
from ..diagnose.report.screen import text
from ..diagnose.request import Inputs, Request, read
from ..model.errors import DataError, GearheatError
from .console import as_json, file_of, writable, write

#: Told of each stage and of the share of the work that is done.
Progress = Callable[[str, float], None]
#: What is read and a listener for progress -> what was found, with its words.
Infer = Callable[[Inputs, Progress], Findings]


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
    inputs = _checked(request, outputs)
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
    print(as_json(as_object(findings)) if outputs.json == "-" else text(findings, everything=everything), end="")


def _inference() -> Infer:
    """The project's inference, imported when it is needed."""
    from ..diagnose.diagnosis import diagnosed

    return diagnosed


def _checked(request: Request, outputs: Outputs) -> Inputs:
    """The inputs, or all problems of files and options."""
    problems = []
    if (request.predict is None) != (outputs.predictions is None):
        problems.append(
            "--predict needs a place for the result. Give --predictions FILE, too."
            if outputs.predictions is None
            else "--predictions needs the points to predict. Give --predict FILE, too."
        )
    problems += shared(request.files(), outputs.files())
    inputs = None
    try:
        inputs = read(request)
    except GearheatError as error:
        problems += error.problems
    try:
        writable(*outputs.files().values())
    except GearheatError as error:
        problems += error.problems
    if problems or inputs is None:
        raise DataError(problems)
    return inputs


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


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """A bar on stderr while work goes on; nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda stage, share: bar.update(task, description=stage, completed=share)
