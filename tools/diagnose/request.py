"""What a diagnosis is asked: files and options, and what the files hold, all their problems at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from ..model.errors import DataError, GearheatError
from ..model.parts import PARTS
from ..scenarios.load import load
from ..scenarios.scenario import Scenario
from .campaign.card import Card, read_card
from .campaign.read import read_campaign
from .campaign.table import Campaign
from .library.extra_parts import EXTRA_PARTS

T = TypeVar("T")

#: Causes that may be looked for together.
MOST = 8


@dataclass(frozen=True)
class Request:
    """Files and options of a diagnosis.

    Args:
        rig: name of a shipped rig, or path of a rig file
        data: table of readings, one row each
        logs: tables of logged samples of the same machine
        card: accuracies, priors and protocol
        reference: readings of the same machine when it was healthy; `reference_logs` are its logs then
        sibling_logs: logs of other machines of its type
        libraries: files with further causes
        predict: points to predict
        causes: how many may act together
        alpha: accepted rate of false alarms
        seed: of everything that is drawn
    """

    rig: str
    data: Path | None = None
    logs: tuple[Path, ...] = ()
    card: Path | None = None
    reference: Path | None = None
    reference_logs: tuple[Path, ...] = ()
    sibling_logs: tuple[Path, ...] = ()
    libraries: tuple[Path, ...] = ()
    predict: Path | None = None
    causes: int = 2
    alpha: float = 0.05
    seed: int = 0

    def files(self) -> list[tuple[str, Path]]:
        """The files that are read, each with the name of its option."""
        single = {"DATA": self.data, "--card": self.card, "--reference": self.reference, "--predict": self.predict}
        several = {"--logs": self.logs, "--reference-logs": self.reference_logs, "--sibling-logs": self.sibling_logs}
        several["--library"] = self.libraries
        found = [(name, path) for name, path in single.items() if path is not None]
        return found + [(name, path) for name, paths in several.items() for path in paths]

    def problems(self) -> list[str]:
        """What is wrong with the options, and files that do not exist."""
        checks = {
            "no data are given. Name a table of readings, or logs with --logs FILE.": self.data is None
            and not self.logs,
            f"--alpha {self.alpha:g} is no rate of false alarms. Give a number between 0 and 1, such as 0.05.": not (
                0.0 < self.alpha < 1.0
            ),
            f"--causes {self.causes}: how many causes may act together. Give 1 to {MOST}.": not 1
            <= self.causes
            <= MOST,
            f"--seed {self.seed} is below zero. Give 0 or more.": self.seed < 0,
        }
        lost = [f"{name} {path}: there is no such file." for name, path in self.files() if not path.is_file()]
        return [text for text, wrong in checks.items() if wrong] + lost


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
        return tuple(dict.fromkeys(text for found in (self.card.warnings, *tables) for text in found))


def read(request: Request) -> Inputs:
    """Read and check all files but logs and libraries.

    Args:
        request: files and options

    Raises:
        DataError: all problems of files and options at once
    """
    problems = request.problems()

    def tried(path: Path | None, step: Callable[[Path], T]) -> T | None:
        if path is None or not path.is_file():
            return None
        try:
            return step(path)
        except GearheatError as error:
            problems.extend(p for p in error.problems if p not in problems)
            return None

    card = tried(request.card, read_card) if request.card is not None else read_card(None)
    scenario: Scenario | None = None
    try:
        scenario = load(request.rig, PARTS | EXTRA_PARTS)
    except GearheatError as error:
        problems += error.problems
    if scenario is None:
        raise DataError(problems)
    rig, known = scenario, card or Card()  # tables are read against a default card where the user's is wrong
    data, reference = (
        tried(p, lambda path: read_campaign(path, rig, known)) for p in (request.data, request.reference)
    )
    points = tried(request.predict, lambda path: read_campaign(path, rig, known, points=True))
    if problems or card is None:
        raise DataError(problems)
    return Inputs(request, scenario, card, data, reference, points)
