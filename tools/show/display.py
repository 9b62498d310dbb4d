"""Results that show themselves: some lines in a console, a table in a notebook, a table of pandas, a file."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from ...model.errors import DataError
from ...model.units import from_si, in_unit, show_unit
from .console import as_json, cell, plottable, write
from .endings import fitting
from .picture import Picture

if TYPE_CHECKING:
    import numpy as np

    from ...model.core.flat import FlatModel

#: Lines of a result in a console; a notebook shows all.
LINES = 10
#: Head and rows of a table.
Table = tuple[Sequence[str], Sequence[Sequence[Any]]]
#: Columns of a table of values.
HEAD = ("name", "value", "unit", "meaning")


def optional(package: str) -> Any:
    """A package that need not be installed.

    Raises:
        DataError: it is not installed
    """
    try:
        return importlib.import_module(package)
    except ImportError:
        raise DataError(f'this needs the package "{package}". Install it: pip install {package}') from None


class Display:
    """Base of results. A result says its title, its table and its JSON object; everything else follows."""

    #: What `save` writes, a key of `ENDINGS`.
    kind: ClassVar[str] = "JSON"

    @property
    def title(self) -> str:
        """What the result is of, in a few words."""
        raise NotImplementedError

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Head and rows, in the units shown to a person."""
        raise NotImplementedError

    def as_dict(self) -> dict[str, Any]:
        """The JSON object that the command prints."""
        raise NotImplementedError

    def drawing(self) -> Picture | None:
        """The result as a picture, None where there is nothing to draw."""
        return None

    def __repr__(self) -> str:
        head, rows = self.table()
        texts = [[cell(value) for value in row] for row in rows[:LINES]]
        texts = texts if tuple(head) == HEAD or not head else [list(head), *texts]
        widths = [max((len(line[i]) for line in texts), default=0) for i in range(len(head))]
        lines = ["  ".join(text.ljust(w) for text, w in zip(line, widths, strict=True)).rstrip() for line in texts]
        more = [f"... {len(rows) - LINES} more"] if len(rows) > LINES else []
        return "\n".join([self.title, *lines, *more])

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        from .drawing import svg
        from .pages import html_table

        head, rows = self.table()
        drawn = self.drawing()
        table = html_table(head, rows)
        return f"<b>{escape(self.title)}</b>\n{table}\n{svg(drawn.figure) if drawn is not None else ''}"

    def to_pandas(self) -> Any:
        """The table as a DataFrame.

        Raises:
            DataError: pandas is not installed
        """
        head, rows = self.table()
        return optional("pandas").DataFrame([list(row) for row in rows], columns=list(head))

    def file_text(self) -> str:
        """What `save` writes: the JSON object."""
        return as_json(self.as_dict())

    def save(self, path: str | Path) -> Path:
        """Write the result to a file: its JSON object, or all rows as CSV where it is columns of numbers.

        Args:
            path: file to write

        Raises:
            DataError: it cannot be written, or its ending is that of something else
        """
        fitting(Path(path), self.kind, "save")
        write(Path(path), self.file_text())
        return Path(path)

    def save_picture(self, path: str | Path) -> Path | None:
        """Write the picture; nothing where there is nothing to draw.

        Args:
            path: .svg, .png or .html

        Raises:
            DataError: it cannot be written
            ScenarioError: its ending is none of a picture
        """
        from .drawing import write_picture

        plottable(Path(path), "save_picture")
        if (picture := self.drawing()) is None:
            return None
        write_picture(Path(path), picture)
        return Path(path)


@dataclass(frozen=True, eq=False, repr=False)
class Answer(Display):
    """Base of results that are their JSON object.

    Attributes:
        found: the JSON object
        heading: the title
        shown: head and rows of the table
    """

    found: Mapping[str, Any]
    heading: str = field(default="", kw_only=True)
    shown: Table = field(default=((), ()), kw_only=True)

    @property
    def title(self) -> str:
        """What the result is of, in a few words."""
        return self.heading

    def table(self) -> Table:
        """Head and rows, in the units shown to a person."""
        return self.shown

    def as_dict(self) -> dict[str, Any]:
        """The JSON object that the command prints."""
        return dict(self.found)


class Columns(Display):
    """Base of results that are columns of numbers."""

    kind = "a table"

    def titled(self) -> Mapping[str, np.ndarray]:
        """Columns of all rows in the units shown to a person, by their titles."""
        raise NotImplementedError

    def file_text(self) -> str:
        """All rows as CSV, units in the header."""
        from .columns import table_text

        return table_text(self.titled())


class Quantities(Display):
    """Base of results that hold values by name in SI, of a model."""

    if TYPE_CHECKING:

        @property
        def flat(self) -> FlatModel:
            """The model."""

    def __getitem__(self, name: str) -> Any:
        """A value in SI."""
        raise NotImplementedError

    def to(self, name: str, unit: str) -> float:
        """A value in a unit.

        Args:
            name: path, such as "oil.T"
            unit: such as "degC"

        Raises:
            ScenarioError: there is no such value, or the unit does not fit
        """
        return in_unit(float(self[name]), unit, self.flat.quantity(name).unit)

    def rows(self, names: Sequence[str]) -> list[tuple[str, float, str, str]]:
        """Rows of a table under `HEAD`, of the named values."""
        known = [self.flat.quantity(name) for name in names]
        return [(q.name, from_si(float(self[q.name]), q.unit), show_unit(q.unit), q.doc) for q in known]


def lines_of(values: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Numbers and texts of an object as rows of a table, nested objects by dotted names."""
    found: list[tuple[str, Any]] = []
    for name, value in values.items():
        if isinstance(value, Mapping):
            found += [(f"{name}.{key}", inner) for key, inner in lines_of(value)]
        elif isinstance(value, int | float | str):
            found.append((name, value))
    return found
