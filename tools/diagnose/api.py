"""What the model gets wrong in measured data, and which experiments would tell.

All problems of files and options are named before any work.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from ...model.errors import Problems
from ...scenarios.frames import Table as File, Tables as Files, card_file, path_or_none, paths_of, rows_told
from ...scenarios.given import RigLike, listed
from ..show.console import as_json, file_of, plottable, progress_bar, write
from ..show.display import Display
from ..show.picture import Picture
from .answer.findings import Findings
from .answer.numbers import as_object
from .answer.plan import Plan
from .report import plan as plans
from .report.page import picture, render
from .report.screen import text
from .report.tables import predictions_text
from .request import MOST, PlanRequest, Request, read, read_plan


@dataclass(frozen=True)
class Outputs:
    """Where results go; None writes nothing, "-" as `json` is stdout."""

    predictions: Path | None = None
    json: str | None = None
    report: Path | None = None
    extended: Path | None = None

    def files(self) -> dict[str, Path | None]:
        """The files that are written, by the name of their option."""
        given = {"--predictions": self.predictions, "--json": file_of(self.json), "--report": self.report}
        return given | {"--extended": self.extended}


class Diagnosis(Display, Findings):
    """Findings that show themselves and are written."""

    def __repr__(self) -> str:
        return f"{self.title}\n{self.text().rstrip()}"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text())}</pre>\n{super()._repr_html_()}"

    @property
    def title(self) -> str:
        """The verdict in a word."""
        return f"{self.about.rig}: {self.verdict}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Answers with their probabilities."""
        named = [(" + ".join(" or ".join(names) for names in a.causes), a.probability) for a in self.answers]
        return ("answer", "probability"), [(names or "nothing wrong", probability) for names, probability in named]

    def drawing(self) -> Picture | None:
        """Readings less the model, without and with the leading cause; None where no cause is pictured."""
        if not self.pictures:
            return None
        figure = picture(self, self.pictures[0])
        figure.suptitle(self.says.verdict)
        return Picture(figure, self.says.verdict)

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
        """Write the HTML page to a file.

        Raises:
            DataError: it cannot be written
        """
        write(Path(path), render(self))
        return Path(path)

    def write(self, outputs: Outputs) -> None:
        """Write files when all of them are made: an interrupted run leaves none.

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

    def drawing(self) -> Picture | None:
        """The distances of the causes; None where none were named."""
        return Picture(plans.picture(self), self.title) if self.causes else None

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


@rows_told()
def diagnose(
    data: File | None,
    rig: RigLike,
    *,
    card: File | None = None,
    logs: Files = None,
    reference: File | None = None,
    reference_logs: Files = None,
    sibling_logs: Files = None,
    library: Files = None,
    predict: File | None = None,
    causes: int = MOST,
    quick: bool = False,
    alpha: float = Request.alpha,
    seed: int = 0,
    series: File | None = None,
    reference_series: File | None = None,
    outputs: Outputs | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Diagnosis:
    """Compare measured data with the model of a rig, and name what explains the difference.

    Args:
        data: table of readings, one row each, a file or a DataFrame as all tables; None with logs only
        rig: name of a shipped rig, or path of a rig file
        card: accuracies, priors and protocol
        logs: tables of logged samples
        reference: readings of the same rig when it was healthy; `reference_logs` are its logs then
        sibling_logs: logs of other machines of its type
        library: files with further causes
        predict: points to predict
        causes: how many may act together
        quick: without gain on readings left out and without next experiments
        alpha: accepted rate of false alarms
        seed: of everything that is drawn
        series: logged courses of the tests of `data`, `reference_series` of those of `reference`
        outputs: files that will be written from the findings, checked before any work
        progress: called with each stage and the share done; a bar on stderr without

    Raises:
        GearheatError: all problems of files and options at once

    Example:
        >>> import gearheat as gh
        >>> found = gh.diagnose("readings.csv", "mine.toml", card="card.toml")  # doctest: +SKIP
        >>> found.report("campaign.html")  # doctest: +SKIP
    """
    request = Request(
        rig,
        path_or_none(data),
        paths_of(logs),
        card_file(card),
        path_or_none(reference),
        paths_of(reference_logs),
        paths_of(sibling_logs),
        paths_of(library),
        path_or_none(predict),
        causes=causes,
        quick=quick,
        alpha=alpha,
        seed=seed,
        series=path_or_none(series),
        reference_series=path_or_none(reference_series),
    )
    problems, written = [], {} if outputs is None else outputs.files()
    if outputs is not None and predict is not None and outputs.predictions is None:
        problems.append("--predict needs a place for the result. Give --predictions FILE, too.")
    if outputs is not None and outputs.predictions is not None and predict is None:
        problems.append("--predictions needs the points to predict. Give --predict FILE, too.")
    if outputs is not None and outputs.extended is not None and data is None:
        problems.append("--extended needs a table of readings beside the logs. Give DATA, too.")
    inputs = read(request, written, problems)
    from . import diagnosis  # what it needs loads slowly

    with progress_bar() as bar, threadpool_limits(1, "blas"):  # small matrices: others only wait, and add otherwise
        return Diagnosis.model_construct(**dict(diagnosis.diagnose(inputs, progress or bar)))


def plan(
    rig: RigLike,
    *,
    separate: str | Sequence[str] = (),
    card: File | None = None,
    points: File | None = None,
    library: Files = None,
    reference: bool = False,
    json: str | None = None,
    out: File | None = None,
) -> PlanAnswer:
    """What a campaign will tell of every cause, and which experiments tell some causes apart; no data are needed.

    Args:
        rig: name of a shipped rig, or path of a rig file
        separate: causes to tell apart
        card: accuracies, priors and protocol
        points: table of conditions; a grid over the rig's range without it
        library: files with further causes
        reference: whether there is a healthy campaign of the same points as well
        json: place of the JSON object, checked before any work
        out: place of the picture of distances, checked before any work

    Raises:
        GearheatError: all problems of files and options at once

    Example:
        >>> import gearheat as gh
        >>> gh.plan("planetary", separate=["losses.churning", "losses.seal_drag"])  # doctest: +SKIP
    """
    request = PlanRequest(
        rig, tuple(listed(separate)), card_file(card), path_or_none(points), paths_of(library), reference
    )
    problems, picture = Problems(), path_or_none(out)
    problems.of(lambda: plottable(picture, "--out"))
    if picture is not None and not separate:
        problems.append("--out draws the distances of causes. Name them with --separate CAUSE,CAUSE.")
    inputs = read_plan(request, {"--json": file_of(json), "--out": picture}, problems)
    from . import diagnosis  # what it needs loads slowly

    with progress_bar() as progress, threadpool_limits(1, "blas"):
        return PlanAnswer.model_construct(**dict(diagnosis.plan(inputs, progress)))
