"""What a diagnosis or a plan is asked: files and options, and what the files hold, all their problems at once."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from ...model.errors import DataError, Problems, suggestion
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.measured.card import Card, read_card
from ...scenarios.measured.checks import beside_reference, invisible, outlying, same_as_reference, too_small
from ...scenarios.measured.condense import condensed
from ...scenarios.measured.read import read_campaign
from ...scenarios.measured.series import read_samples, series_of
from ...scenarios.measured.table import Campaign
from ...scenarios.scenario import Scenario
from ..show.console import writable
from ..show.endings import fitting

#: What is written by options of a diagnosis.
WRITTEN = {"--json": "JSON", "--report": "a page", "--extended": "a rig file", "--predictions": "a table"}
#: The least rate of false alarms that draws of noise can tell.
LEAST = 0.001
#: Causes that may be looked for together.
MOST = 8
#: What the user should know of a series that has nothing to be compared with.
ALONE = (
    "--series without --reference-series: how this machine warms when it is healthy is not known. The series tells"
    " the length of the dwells, and of the rest only what stands out of a remainder that fades along each course."
)


@dataclass(frozen=True)
class Request:
    """Files and options of a diagnosis, as `gearheat.diagnose` describes them."""

    rig: RigLike
    data: Path | None = None
    logs: tuple[Path, ...] = ()
    card: Path | None = None
    reference: Path | None = None
    reference_logs: tuple[Path, ...] = ()
    sibling_logs: tuple[Path, ...] = ()
    libraries: tuple[Path, ...] = ()
    predict: Path | None = None
    causes: int = MOST
    quick: bool = False
    alpha: float = 0.01
    seed: int = 0
    series: Path | None = None
    reference_series: Path | None = None

    def files(self) -> list[tuple[str, Path]]:
        """The files that are read, each with the name of its option."""
        single = {"DATA": self.data, "--card": self.card, "--reference": self.reference, "--predict": self.predict}
        single |= {"--series": self.series, "--reference-series": self.reference_series}
        several = {"--logs": self.logs, "--reference-logs": self.reference_logs, "--sibling-logs": self.sibling_logs}
        several["--library"] = self.libraries
        found = [(name, path) for name, path in single.items() if path is not None]
        return found + [(name, path) for name, paths in several.items() for path in paths]

    def problems(self) -> list[str]:
        """What is wrong with the options."""
        alpha = f"--alpha {self.alpha:g} is no rate of false alarms. Give one from {LEAST:g} to below 1, such as 0.01."
        causes = f"--causes {self.causes}: how many causes may act together. Give 1 to {MOST}."
        lost = "needs the readings of the same tests."
        checks = (
            (self.data or self.logs, "no data are given. Name a table of readings, or logs with --logs FILE."),
            (LEAST <= self.alpha < 1.0, alpha),
            (1 <= self.causes <= MOST, causes),
            (self.seed >= 0, f"--seed {self.seed} is below zero. Give 0 or more."),
            (self.data or not self.predict, "--predict needs a table of readings beside the logs. Give DATA, too."),
            (self.data or not self.series, f"--series {lost} Name their table, too."),
            (self.reference or not self.reference_series, f"--reference-series {lost} Give --reference, too."),
        )
        return [text for sound, text in checks if not sound]


@dataclass(frozen=True)
class Inputs:
    """What the files of a request hold."""

    request: Request
    scenario: Scenario
    card: Card
    data: Campaign | None
    reference: Campaign | None
    points: Campaign | None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know of the files."""
        tables = [c.warnings for c in (self.data, self.reference, self.points) if c is not None]
        tables += [c.series.warnings for c in (self.data, self.reference) if c is not None and c.series is not None]
        if self.data is not None and self.reference is not None:
            tables += [(ALONE,)] if self.data.series and not self.reference.series else []
            tables.append(tuple(beside_reference(self.data, self.reference)))
        if self.data is not None and self.points is not None:
            tables.append(tuple(outlying(self.data, self.points)))
        told = dict.fromkeys(text for found in (self.card.warnings, *tables) for text in found)
        return tuple(sorted(told, key=lambda text: text.endswith("is not used.")))  # what matters more comes first

    @property
    def invisible(self) -> Mapping[str, str]:
        """Cause -> why the readings cannot show it."""
        return {} if self.data is None else invisible(self.data, logged=bool(self.request.logs or self.data.series))


def read(request: Request, written: Mapping[str, Path | None] = {}, problems: Iterable[str] = ()) -> Inputs:
    """Read and check all files but logs and libraries; `written` is option -> file, `problems` are known already.

    Raises:
        DataError: all problems of files and options at once
    """
    reader = _Reader(request, written, problems)
    data = reader.logged(reader.table(request.data), request.series)
    reference = reader.logged(reader.table(request.reference), request.reference_series)
    points = reader.table(request.predict, points=True)
    if data is not None:
        reader.problems += too_small(data)
        reader.problems += [] if reference is None else same_as_reference(data, reference)
    scenario, card = reader.checked()
    if reference is not None:
        reference, _ = condensed(reference, card)
    if data is not None:
        data, card = condensed(data, card)
    return Inputs(request, scenario, card, data, reference, points)


@dataclass(frozen=True)
class PlanRequest:
    """Files and options of a plan, as `gearheat.plan` describes them."""

    rig: RigLike
    causes: tuple[str, ...] = ()
    card: Path | None = None
    points: Path | None = None
    libraries: tuple[Path, ...] = ()
    reference: bool = False

    def files(self) -> list[tuple[str, Path]]:
        """The files that are read, each with the name of its option."""
        single = [(name, path) for name, path in (("--card", self.card), ("--points", self.points)) if path is not None]
        return single + [("--library", path) for path in self.libraries]

    def problems(self) -> list[str]:
        """What is wrong with the options."""
        names = self.causes
        twice = [n for n in dict.fromkeys(names) if names.count(n) > 1]
        return [f"--separate: {name} is there twice. Name each cause once." for name in twice]


@dataclass(frozen=True)
class PlanInputs:
    """What the files of a plan hold."""

    request: PlanRequest
    scenario: Scenario
    card: Card
    points: Campaign | None


def read_plan(request: PlanRequest, written: Mapping[str, Path | None], problems: Iterable[str]) -> PlanInputs:
    """Read and check all files of a plan but libraries, as `read` does."""
    reader = _Reader(request, written, problems)
    points = reader.table(request.points, points=True)
    return PlanInputs(request, *reader.checked(), points)


def unknown_causes(names: Collection[str], known: Collection[str]) -> list[str]:
    """Problems of causes to tell apart that the library of a rig does not have, or of one alone."""
    alone = f"--separate {', '.join(names)}: there is nothing to tell it from. Name two causes or more."
    problems = [alone] if len(names) == 1 else []
    for name in (n for n in names if n not in known):
        alike = " or ".join([f'"{c}"' for c in known if name[:4] in c][:3])
        close = suggestion(name, known) or (f" Did you mean {alike}?" if alike else "")
        problems.append(f'--separate: there is no cause "{name}".{close or " Known: " + ", ".join(known) + "."}')
    return problems


def _shared(read: Iterable[tuple[str, Path]], written: Mapping[str, Path | None]) -> list[str]:
    """Problems of files that are written over others, each by the name of its option."""
    taken, problems = {path.resolve(): name for name, path in read}, []
    for name, path in written.items():
        if path is not None and (other := taken.setdefault(path.resolve(), name)) != name:
            problems.append(f"{name} {path}: is the file of {other}, too. Give each its own.")
    return problems


class _Reader:
    """Reads rig, card and tables, collecting problems; nothing of it outlives the reading."""

    def __init__(
        self, request: Request | PlanRequest, written: Mapping[str, Path | None], problems: Iterable[str]
    ) -> None:
        files = request.files()
        said = {True: "is a folder. Give a file", False: "there is no such file"}
        lost = [f"{name} {path}: {said[path.is_dir()]}." for name, path in files if not path.is_file()]
        self.problems = Problems([*problems, *request.problems(), *lost, *_shared(files, written)])
        card = request.card
        self.card = self.problems.of(lambda: read_card(card)) if card is None or card.is_file() else None
        self.scenario = self.problems.of(lambda: scenario_of(request.rig))
        self.problems.of(lambda: writable(*written.values()))
        for option in sorted(WRITTEN.keys() & written):
            self.problems.of(partial(fitting, written[option], WRITTEN[option], option))

    def table(self, path: Path | None, *, points: bool = False) -> Campaign | None:
        """A table; None where there is none, or something is wrong with it."""
        scenario, card = self.scenario, self.card
        if path is None or scenario is None or card is None or not path.is_file():
            return None
        return self.problems.of(lambda: read_campaign(path, scenario, card, points=points))

    def logged(self, campaign: Campaign | None, path: Path | None) -> Campaign | None:
        """A table with the logged courses of its tests, where there are any."""
        scenario, card = self.scenario, self.card
        if path is None or scenario is None or card is None or not path.is_file():
            return campaign
        samples = self.problems.of(lambda: read_samples(path, scenario, card))
        if campaign is None or samples is None:
            return campaign
        return replace(campaign, series=self.problems.of(lambda: series_of(samples, campaign)))

    def checked(self) -> tuple[Scenario, Card]:
        """Rig and card, or all problems."""
        if self.problems or self.scenario is None or self.card is None:
            raise DataError(self.problems)
        return self.scenario, self.card
