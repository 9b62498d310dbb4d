"""What the sheets share: the folder, the rigs in it, work beside the page, and the command that does the same."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import gearheat as gh
from nicegui import run, ui

T = TypeVar("T")

#: Commands that are shown at once.
SHOWN = 3


class Bench:
    """A folder on which the desk works.

    Args:
        folder: made where it is missing
    """

    def __init__(self, folder: Path) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise gh.GearheatError(f"-o {folder}: cannot be made ({error.strerror}). Name another folder.") from None
        self.folder = folder
        self.lines: list[str] = []
        self.log: Any = None

    def rigs(self) -> list[str]:
        """Names of the shipped rigs, behind the rig files of the folder."""
        own = [str(path) for path in sorted(self.folder.glob("*.toml")) if not path.name.endswith(".card.toml")]
        return [*own, *gh.rigs()]

    def pick_rig(self, label: str = "Rig", value: str = "") -> Any:
        """A field for the name of a rig; it knows the files that were made since when it is opened."""
        field = ui.select(self.rigs(), label=label, value=value or "planetary", with_input=True).classes("w-64")
        field.on("focus", lambda: field.set_options(self.rigs(), value=field.value))
        return field

    def say(self, *words: str) -> None:
        """Show the command that does what was clicked."""
        self.say_line("gearheat " + shlex.join(words))

    def say_line(self, line: str) -> None:
        """Show a line that does what was clicked."""
        self.lines = [*self.lines, line][-SHOWN:]
        self.log.clear()
        with self.log:
            for said in self.lines:
                ui.label(said).classes("command select-all")

    async def work(self, place: Any, job: Callable[[], T]) -> T | None:
        """What a job gives, done beside the page; None where it fails, and the place then says why.

        Args:
            place: element of the page that is filled afterwards
            job: without arguments
        """
        place.clear()
        with place:
            ui.spinner()
        try:
            found: T = await run.io_bound(job)
        except gh.GearheatError as error:
            place.clear()
            with place:
                tell(error.problems)
            return None
        place.clear()
        return found

    def link(self, path: Path) -> str:
        """Address of a file of the folder, seen from the page; another one whenever the file has changed."""
        return f"files/{path.name}?{path.stat().st_mtime_ns}"


def tell(problems: Iterable[str]) -> None:
    """Problems in the place of an answer."""
    for problem in problems:
        ui.label(problem).classes("problem text-negative whitespace-pre-wrap")


def table(title: str, head: Sequence[Any], rows: Iterable[Sequence[Any]]) -> Any:
    """A table of a result, numbers in digits that are read."""
    columns = [{"name": str(k), "label": str(h), "field": str(k), "align": "left"} for k, h in enumerate(head)]
    cells = [{str(k): digits(v) for k, v in enumerate(row)} for row in rows]
    return ui.table(columns=columns, rows=cells, title=title).props("dense flat wrap-cells")


def digits(value: Any) -> Any:
    """A number as a table shows it."""
    return f"{value:.5g}" if isinstance(value, float) else value
