"""A diagnosis or a plan from files: all problems of files and options are named before any work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..show.console import as_json, file_of, progress_bar, write
from ..show.display import Display
from .answer.findings import Findings
from .answer.numbers import as_object
from .answer.plan import Plan
from .report import plan as plans
from .report.page import render
from .report.screen import text
from .report.tables import predictions_text
from .request import PlanRequest, Request, read, read_plan

#: Kinds of pictures by the ending of their file's name.
PICTURES: Mapping[str, Literal["png", "svg"]] = {".png": "png", ".svg": "svg"}


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


class Diagnosis(Display, Findings):
    """Findings that show themselves and are written."""

    @property
    def title(self) -> str:
        """The verdict in a sentence."""
        return f"{self.about.rig}: {self.verdict}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Answers with their probabilities."""
        named = [(" + ".join(" or ".join(names) for names in a.causes), a.probability) for a in self.answers]
        rows = [(names or "nothing wrong", probability) for names, probability in named]
        return ("answer", "probability"), rows

    def as_dict(self) -> dict[str, Any]:
        """The JSON object, without what is not known."""
        return as_object(self)

    def text(self, *, everything: bool = False, width: int | None = None) -> str:
        """The findings as text.

        Args:
            everything: with all tables
            width: of the screen
        """
        return text(self, everything=everything, width=width)

    def report(self, path: str | Path) -> Path:
        """Write the HTML page.

        Args:
            path: file to write

        Raises:
            DataError: it cannot be written
        """
        write(Path(path), render(self))
        return Path(path)

    def write(self, outputs: Outputs) -> None:
        """Write files when all of them are made: an interrupted run leaves none.

        Args:
            outputs: the files

        Raises:
            DataError: one cannot be written
        """
        made: dict[Path | None, str] = {
            outputs.predictions: predictions_text(self),
            outputs.extended: self.extended_rig,
            outputs.report: render(self) if outputs.report is not None else "",
            file_of(outputs.json): as_json(as_object(self)),
        }
        for path, content in made.items():
            if path is not None:
                write(path, content)


class PlanAnswer(Display, Plan):
    """A plan that shows itself and is drawn."""

    @property
    def title(self) -> str:
        """The answer in a sentence."""
        return plans.sentence(self) or f"{self.rig}: which causes a campaign can tell apart"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Experiments in the order of what they tell."""
        return ("experiment",), [(self.what(one.id),) for one in self.catalogue]

    def as_dict(self) -> dict[str, Any]:
        """The JSON object, without what is not known."""
        return as_object(self)

    def text(self, *, everything: bool = False, width: int | None = None) -> str:
        """The plan as text.

        Args:
            everything: with all experiments and causes
            width: of the screen
        """
        return plans.text(self, everything=everything, width=width)

    def save_picture(self, path: str | Path) -> Path:
        """Write the distances of the causes as a picture.

        Args:
            path: .png or .svg

        Raises:
            DataError: it cannot be written
        """
        write(Path(path), plans.picture(self, PICTURES[Path(path).suffix.lower()]))
        return Path(path)


def ask(request: Request, outputs: Outputs | None = None) -> Diagnosis:
    """Read and infer.

    Args:
        request: files and options
        outputs: files that will be written, checked before any work

    Raises:
        GearheatError: all problems of files and options at once
    """
    problems, written = [], {} if outputs is None else outputs.files()
    if outputs is not None and request.predict is not None and outputs.predictions is None:
        problems.append("--predict needs a place for the result. Give --predictions FILE, too.")
    if outputs is not None and outputs.predictions is not None and request.predict is None:
        problems.append("--predictions needs the points to predict. Give --predict FILE, too.")
    inputs = read(request, written, problems)
    from .diagnosis import diagnosed  # what it needs loads slowly

    with progress_bar() as progress:
        return Diagnosis.model_construct(**dict(diagnosed(inputs, progress)))


def ask_plan(request: PlanRequest, *, json: str | None = None, out: Path | None = None) -> PlanAnswer:
    """Read and plan.

    Args:
        request: files and options
        json: place of the JSON object, checked before any work
        out: place of the picture, checked before any work

    Raises:
        GearheatError: all problems of files and options at once
    """
    problems = []
    if out is not None and out.suffix.lower() not in PICTURES:
        problems.append(f"--out {out}: is no picture that can be drawn. Give a name that ends in .png or .svg.")
    if out is not None and not request.causes:
        problems.append("--out draws the distances of causes. Name them with --separate CAUSE,CAUSE.")
    given = {"--json": file_of(json), "--out": out}
    inputs = read_plan(request, {name: path for name, path in given.items() if path is not None}, problems)
    from .planning import planned  # what it needs loads slowly

    with progress_bar() as progress:
        return PlanAnswer.model_construct(**dict(planned(inputs, progress)))
