"""Published numbers of a rig: one row a number, with what an erratum makes of it and how the model gives it.

    [[row]]
    name = "lubricant at 332 N.m"
    where = "Smith2020, table 4"          # place in the source
    published = "139.1 degC"              # as printed: a number with its unit, or a statement in words
    corrected = "139.5 degC"              # what an erratum makes of it; left out where the printed number stands
    recomputed = "139.5 degC"             # a recomputation from the source, where it prints no number
    contradiction = true                  # the printed number cannot hold, and no corrected one exists
    why = "..."                           # needed with corrected and contradiction
    tol = "0.6 K"                         # or rel = 0.01: distance allowed from the last of these numbers
    unit = "N.mm"                         # of numbers that stand without one

How the model gives it is one of:

    run = "steady"                        # a steady state: set = { "output.tau" = "-332 N.m" }, path = "oil.T"
    run = "held"                          # all temperatures held at temperature = "85 degC": set, path
    run = "design"                        # free = "wave_generator.w", target = "mesh.h_min=0.88 um", set
    run = "losses"                        # the losses at measured readings: set, select = { test = [1, 2] }, path
    run = "contacts"                      # the contacts over a mesh cycle: set, path, at = 60 (theta_deg, linear)
    run = "law"                           # law = "cycloid.curvature", args = { ... }, item = 0
    run = "rows"                          # of = { a = "name of a row", b = "of another" }, path = "a - b"
    run = "new"                           # a machine drawn up from set = { stages = "worm", ratio = 20, ... }: path
    run = "print"                         # path = "0.0303 + 0.0588": arithmetic on printed numbers alone

A `path` may be an expression, in SI: "3 * gear_set.P_loss". One that compares, such as "max(Lambda) < 0.7", is a
statement; it needs no tolerance and either holds or not. A table `[[table]]` with `data = "name.csv"` makes a row of
each number in the CSV file; see `SheetTable`. A table `[set]` holds what every row sets that does not say otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ..model.errors import Problems, ScenarioError
from .csv_cells import number
from .csv_table import read_cells
from .document import paths, read_toml
from .tables import Strict

Number = str | float

#: Keys of a row that say how the model gives the number -> the runs that need them, and those that may have them.
_NEEDED: Mapping[str, tuple[str, ...]] = {
    "steady": ("path",),
    "held": ("path", "temperature"),
    "design": ("free", "target"),
    "losses": ("path",),
    "contacts": ("path",),
    "law": ("law", "args"),
    "rows": ("of", "path"),
    "new": ("set", "path"),
    "print": ("path",),
}
_ALLOWED: Mapping[str, tuple[str, ...]] = {
    "steady": ("set",),
    "held": ("set",),
    "design": ("set", "path"),
    "losses": ("set", "select"),
    "contacts": ("set", "at"),
    "law": ("item",),
}

Run = Literal["steady", "held", "design", "losses", "contacts", "law", "rows", "new", "print"]

GOLDEN = Path(str(files("gearheat.model").joinpath("golden")))


class Row(Strict):
    """One published number, or one statement."""

    name: str = Field(description="what the number is, in words")
    where: str = Field(description="place in the source")
    published: Number | None = Field(None, description="the printed number with its unit, or the printed statement")
    corrected: Number | None = Field(None, description="what an erratum makes of it")
    recomputed: Number | None = Field(None, description="a recomputation, where the source prints no number")
    contradiction: bool = Field(False, description="true where the printed number cannot hold")
    why: str = Field("", description="why the printed number does not stand")
    tol: Number | None = Field(None, description='distance allowed, for example "0.6 K"')
    rel: float | None = Field(None, description="distance allowed over the number")
    unit: str = Field("", description="unit of numbers that stand without one")
    run: Run = Field(description=f"one of {', '.join(_NEEDED)}")
    set: dict[str, Any] = Field({}, description="path -> value with its unit, or choice")
    path: str = Field("", description="path of an output, column, or an expression in them")
    temperature: str = Field("", description='temperature of all bodies, for example "85 degC"')
    free: str | list[str] = Field("", description="path of a parameter or input, or a list of them")
    target: str | list[str] = Field("", description='"PATH=VALUE", or a list of them')
    select: dict[str, Any] = Field({}, description="column -> value, or list of values")
    at: float | None = Field(None, description="angle of the contact in degrees")
    law: str = Field("", description='"module.function" of a law')
    args: dict[str, Any] = Field({}, description="argument -> number in SI, or text with a unit")
    item: int | None = Field(None, description="which of several results of a law, from 0")
    of: dict[str, str] = Field({}, description="name in the expression -> name of a row")
    group: str = Field("", description="name of the table that the row belongs to")

    @property
    def expected(self) -> Number | None:
        """The number that the model is compared with."""
        given = (self.corrected, self.published, self.recomputed)
        return next((number for number in given if number is not None), None)

    @property
    def is_statement(self) -> bool:
        """Whether it holds or not, and no number is compared."""
        return not self.contradiction and self.tol is None and self.rel is None


class Cells(Strict):
    """Where the numbers of one column of a CSV table come from in the model."""

    path: str = Field(description="path of an output, or column")
    set: dict[str, Any] = Field({}, description="path -> value with its unit, or choice")
    select: dict[str, Any] = Field({}, description="column -> value, or list of values")


class SheetTable(Strict):
    """A CSV file of numbers: a row per line, a number per column named in `columns`, all found by the same run.

    The columns named in `keys` select a reading of the rig (run = "losses").
    """

    name: str = Field(description="what the table is, in words")
    where: str = Field(description="place in the source")
    data: str = Field(description="name of the CSV file beside this one")
    kind: Literal["published", "recomputed"] = Field(description="published, or recomputed where no source prints it")
    tol: Number | None = Field(None, description='distance allowed, for example "0.3 W"')
    rel: float | None = Field(None, description="distance allowed over the number")
    unit: str = Field("", description="unit of the numbers")
    run: Literal["losses"] = Field(description='"losses"')
    set: dict[str, Any] = Field({}, description="path -> value with its unit, or choice")
    keys: list[str] = Field(description="columns that say which reading a line is of")
    columns: dict[str, Cells] = Field(description="column of the file -> where the model has it")


class PublishedTable(Strict):
    """A file of published numbers."""

    set: dict[str, Any] = Field({}, description="path -> value or choice, for every row that sets values")
    row: list[Row] = Field([], description="one table [[row]] a number")
    table: list[SheetTable] = Field([], description="CSV files with many numbers")


def read_published(path: Path) -> tuple[Row, ...]:
    """The rows of a file of published numbers.

    Args:
        path: a `published.toml`

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    raw = PublishedTable.read(path.name, read_toml(path))
    problems = Problems(
        f"{path.name} [row {i}] {row.name}: {wrong}" for i, row in enumerate(raw.row, 1) for wrong in _wrong(row)
    )
    names = [row.name for row in raw.row]
    for name in dict.fromkeys(n for n in names if names.count(n) > 1):
        problems.append(f'{path.name}: two rows are named "{name}". Name them apart.')
    for row in raw.row:
        unknown = [other for other in row.of.values() if other not in names]
        problems += [f'{path.name} {row.name}: there is no row "{other}".' for other in unknown]
    every = (*raw.row, *(row for sheet in raw.table for row in _cells(path, sheet, problems)))
    problems.check()
    common = dict(paths(raw.set))  # what all rows set whose run takes values
    takers = [run for run, keys in _ALLOWED.items() if "set" in keys]
    return tuple(
        row.model_copy(update={"set": {**common, **dict(paths(row.set))}}) if row.run in takers else row
        for row in every
    )


def _cells(path: Path, sheet: SheetTable, problems: Problems) -> Iterator[Row]:
    """A row for each number of a CSV table beside a file, while problems are collected."""
    with problems:
        header, lines = read_cells(path.parent / sheet.data, comments=True)
        if unknown := [name for name in (*sheet.keys, *sheet.columns) if name not in header]:
            where = f"{path.name} [table] {sheet.name}"
            raise ScenarioError(f"{where}: {sheet.data} has no column {', '.join(unknown)}. Name its columns.")
        for line, cells in lines:
            found = dict(zip(header, cells, strict=True))
            for column, source in sheet.columns.items():
                try:
                    keys = {key: number(found[key]) for key in sheet.keys}
                    yield _cell(sheet, source, column, keys, number(found[column]))
                except ValueError as error:
                    problems.append(f"{sheet.data} line {line}: {column} {error}.")


def _cell(sheet: SheetTable, source: Cells, column: str, keys: Mapping[str, float], value: float) -> Row:
    said = ", ".join(f"{key} {key_value:g}" for key, key_value in keys.items())
    return Row.model_validate(
        {
            **sheet.model_dump(include={"where", "tol", "rel", "unit", "run"}),
            "name": f"{sheet.name}: {said}, {column}",
            "group": sheet.name,
            sheet.kind: value,
            "set": {**sheet.set, **source.set},
            "path": source.path,
            "select": {**keys, **source.select},
        }
    )


def _wrong(row: Row) -> Iterator[str]:
    """What does not fit together in a row."""
    if row.expected is None:
        yield "has no number. Give published, corrected or recomputed."
    if row.recomputed is not None and (row.published is not None or row.corrected is not None):
        yield "recomputed stands beside a printed number. Leave it out."
    if (row.contradiction or row.corrected is not None) and not row.why:
        yield "why is missing. Say why the printed number does not stand."
    if row.contradiction and row.corrected is not None:
        yield "contradiction and corrected exclude each other: with a corrected number, leave contradiction out."
    if row.corrected is not None and row.corrected == row.published:
        yield "corrected is the published number. Leave it out."
    if row.tol is not None and row.rel is not None:
        yield "has both tol and rel. Give one."
    needed = _NEEDED[row.run]
    allowed = (*needed, *_ALLOWED.get(row.run, ()))
    for key in ("set", "path", "temperature", "free", "target", "select", "at", "law", "args", "item", "of"):
        given = getattr(row, key) not in (None, "", {}, [])
        if key in needed and not given:
            yield f'{key} is missing for run = "{row.run}" ({Row.model_fields[key].description}).'
        elif given and key not in allowed:
            yield f'{key} means nothing with run = "{row.run}". Leave it out.'


def golden_rows() -> tuple[Row, ...]:
    """The golden rows of all laws: a number from print for each.

    A row of `model/golden/*.toml` has `law` ("module.function"), `args` (numbers in SI, or text with a unit), `expect`
    with `unit`, and `tol` in that unit or `rel`. `kind` says what the number is: "published" as the source prints it,
    "corrected" by an erratum (`published` and `why` then say what stands in print and why it cannot), "reproduced" a
    recomputation that no one printed, "misprint" what a misprint of the source leads to. `item` picks from a law with
    several results.

    Raises:
        ScenarioError: everything wrong with the files at once
    """
    found: list[Row] = []
    problems = Problems()
    for path in sorted(GOLDEN.glob("*.toml")):
        raw = [_published(row) for row in read_toml(path).get("row", []) if "law" in row]
        with problems:
            found += PublishedTable.read(path.name, {"row": raw}).row
    problems.check()
    return tuple(found)


def _published(row: Mapping[str, Any]) -> dict[str, Any]:
    """A golden row in the form of all published numbers."""
    kind = row["kind"] if row["kind"] in ("published", "corrected") else "recomputed"
    names = {"source": "where", "expect": kind}
    kept = {names.get(key, key): value for key, value in row.items() if key not in ("kind", "unit")}
    return kept | {"run": "law", "unit": row.get("unit", "").removesuffix("1")}
