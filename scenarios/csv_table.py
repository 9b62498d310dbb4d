"""Strict reading of CSV tables: every wrong cell is found in one pass and named by file, line and column.

Columns have the names that users write: the unit is what an ending or brackets say.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..model.errors import DataError, Problems, ScenarioError, suggestion, visible
from ..model.files import tables
from ..model.units import kind_of, show_unit, spell_unit, to_si
from .csv_cells import NUMBER, fold, is_nothing, number, ragged_rows, two_readings
from .document import WIDE, read_text

#: Columns in which a table of `gearheat sweep` says how each of its rows was found; nothing reads them.
ACCOUNTS = ("row", "status", "iterations", "energy_residual [1]", "outside [1]")
#: Most problems that one message lists; the rest are counted.
SHOWN = 30

#: How tables are written: UTF-8, or as Windows does in the west of Europe.
ENCODINGS = ("utf-8-sig", "cp1252")
#: What may separate columns.
SEPARATORS = ",;\t"
#: A first line by which Excel is told what separates columns.
_TOLD = re.compile(r"\"?sep=(.?)", re.IGNORECASE)

#: A number with a decimal comma, in a table whose columns no commas separate.
_COMMA = re.compile(r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)$")
#: What the ending of a column's name says about its unit.
ENDINGS: Mapping[str, str] = tables("scenarios", "units.toml")["endings"]

#: How a message advises a number with a unit; a column has the unit alone.
_EXAMPLE = re.compile(r'Write (for example )?"[^"]*"\.$')
_BRACKET = re.compile(r"(.*\S)\s*[\[(]\s*([^\])]+?)\s*[\])]")


@dataclass(frozen=True)
class Column:
    """What a table expects of one column: "number", "count" (a whole number) or "text", and its range."""

    name: str
    doc: str
    kind: Literal["number", "count", "text"] = "number"
    required: bool = True
    at_least: float = -math.inf
    above: float = -math.inf
    options: tuple[Any, ...] = ()


@dataclass(frozen=True)
class Table:
    """A table as read: per column one value per row (None where the cell is wrong), and the line of each row."""

    name: str
    columns: Mapping[str, tuple[Any, ...]]
    lines: tuple[int, ...]
    warnings: tuple[str, ...] = ()

    def place(self, row: int) -> str:
        """File and line of a row, for a message."""
        return f"{self.name} line {self.lines[row]}"


def raise_all(problems: Sequence[str], name: str) -> None:
    """Refuse a file that has problems; beyond a page of them the rest are counted.

    Args:
        problems: what is wrong with a file, one text each
        name: of the file

    Raises:
        DataError: there are problems
    """
    if len(problems) > SHOWN:
        rest = len(problems) - SHOWN
        problems = [
            *problems[:SHOWN],
            f"{name}: {rest} more problems. Mend the first ones and read it again.",
        ]
    Problems(problems).check(DataError)


def read_cells(
    path: Path, comments: bool = False, problems: list[str] | None = None
) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows (line number, cells) of a CSV file; blank lines and repeated headers are left out.

    Where semicolons or tabs separate the columns, decimals may have a comma; the cells given back have a point. Units
    that stand in a row of their own under the header go into its names.

    Args:
        path: the file
        comments: whether lines that begin with # are left out as well
        problems: take columns that are there twice or have no name, and rows of other lengths than the header; they are
            left out then

    Raises:
        DataError: no such file, not text, empty, no row under the header, or rows of other lengths
    """
    name = path.name
    lines = [(line, cells) for line, cells in _lines(path) if not (comments and cells[0].startswith("#"))]
    if not lines:
        raise DataError(f"{name}: the file is empty. It needs a line of column names and at least one row.")
    (_, header), *rows = lines
    wrong = header_problems(name, header)
    rows = [(line, cells) for line, cells in rows if cells != header]
    if rows:
        header, rows, more = take_units(name, header, rows)
        wrong += more
    else:
        wrong.append(f"{name}: there is no row under the column names. Add at least one.")
    wrong += ragged_rows(name, header, rows)
    if problems is None or not rows:
        raise_all(wrong, name)
    else:
        problems += wrong
    own = [k for k, h in enumerate(header) if h and header.index(h) == k]
    whole = ((line, cells) for line, cells in rows if len(cells) == len(header))
    return [header[k] for k in own], [(line, [cells[k] for k in own]) for line, cells in whole]


def take_units(
    name: str, header: list[str], rows: list[tuple[int, list[str]]]
) -> tuple[list[str], list[tuple[int, list[str]]], list[str]]:
    """Header with the units that stand in a row of their own under it, the other rows, and what is wrong with them.

    Args:
        name: of the file
        header: names of the columns
        rows: line and cells of each, the first one at least
    """
    (line, cells), *others = rows
    filled = [cell for cell in cells if not is_nothing(cell)]
    units = {cell: unit for cell in filled if (unit := _unit(cell))}
    least = max(2, len(filled) // 2 + 1)  # one alone may be a name: "P1" is a unit, too
    if any(map(NUMBER.fullmatch, cells)) or sum(c in units for c in cells) < least or len(cells) != len(header):
        return header, rows, []
    pairs = [(h, split_unit(h)[1], units.get(cell, "")) for h, cell in zip(header, cells, strict=True)]
    wrong = [
        f'{name} line {line}: column "{h}" is in {own} by its name, and in {unit} by the row of units. Mend one.'
        for h, own, unit in pairs
        if own and unit and own != unit and kind_of(own) == kind_of(unit)  # "wind_m_s" is in no seconds
    ]
    return [f"{h} [{unit}]" if unit and not own else h for h, own, unit in pairs], others, wrong


def _unit(cell: str) -> str:
    """The unit that is all of a cell, "" where there is none."""
    unit = spell_unit(cell.strip("[]() "))
    with suppress(ScenarioError):
        return unit if kind_of(unit) and not {*unit} & {*":="} else ""
    return ""


def read_header(path: Path) -> list[str]:
    """Names of the columns of a CSV file, whatever stands below. Raises DataError as `read_cells`."""
    lines = _lines(path, head_only=True)
    return lines[0][1] if lines else read_cells(path)[0]


def header_problems(name: str, header: Sequence[str]) -> list[str]:
    """Columns that are there twice or have no name.

    Args:
        name: of the file
        header: names of its columns
    """
    twice = sorted({h for h in header if h and header.count(h) > 1})
    nameless = [i for i, h in enumerate(header, 1) if not h]
    return [f'{name} line 1: column "{h}" is there twice. Keep one.' for h in twice] + [
        f"{name} line 1: column {i} has no name. Give it one." for i in nameless
    ]


def _lines(path: Path, head_only: bool = False) -> list[tuple[int, list[str]]]:
    text = read_text(path, "CSV", DataError, ENCODINGS)
    shown = visible(text.replace("\x00", "\ufffd")).splitlines()
    head = next((line for line in shown if line.strip() and not line.startswith("#")), "")
    sign = _separator(head)
    reader = csv.reader([head] if head_only else shown, delimiter=sign)
    try:
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise DataError(f"{path.name} line {reader.line_num}: is no CSV ({error}).") from None
    if sign != "," and (problem := two_readings(path.name, rows)):
        raise DataError(problem)
    cells = [(line, plain(row, sign)) for line, row in rows if not tells_sign(row)]
    return [(line, row) for line, row in cells if any(row)]


def written(head: bytes) -> tuple[str, str]:
    """Encoding of a table and what separates its columns, by its first lines.

    Args:
        head: the lines: of names, and that of units below it
    """
    if head.startswith(WIDE):
        return "utf-16", _separator(head.decode("utf-16", errors="ignore"))  # the line ends within a letter
    for encoding in ENCODINGS:
        with suppress(UnicodeDecodeError):
            return encoding, _separator(head.decode(encoding))
    return ENCODINGS[0], SEPARATORS[0]


def _separator(head: str) -> str:
    """What separates columns: as is told, else what stands most often between their names, else a comma."""
    names = head.partition("\n")[0]
    return told[1] if (told := _TOLD.match(head)) and told[1] else max(SEPARATORS, key=names.count)


def tells_sign(row: Sequence[str]) -> bool:
    """Whether a first row only tells what separates columns.

    Args:
        row: its cells
    """
    return bool(row and _TOLD.fullmatch(row[0]))


def plain(cells: Sequence[str], sign: str) -> list[str]:
    """Cells without spaces round them, decimal commas as points.

    Args:
        cells: of a row
        sign: what separates columns; decimals have a point where it is a comma
    """
    stripped = list(map(str.strip, cells))
    return stripped if sign == "," else [_COMMA.sub(r"\1.\2", cell) for cell in stripped]


def parse(path: Path, columns: Iterable[Column]) -> tuple[Table, list[str]]:
    """The table in a file and all that is wrong with its columns and cells; unknown columns only warn.

    The accounts of a sweep do not even warn.

    Args:
        path: the CSV file
        columns: the columns that are known, with unit and range

    Raises:
        DataError: what `read_cells` finds, since nothing can be read beyond it
    """
    problems: list[str] = []
    header, rows = read_cells(path, problems=problems)
    known = {c.name: c for c in columns}
    problems += _missing(path.name, header, known)
    swept = set(ACCOUNTS) <= set(header)
    warnings = tuple(
        f'{path.name}: column "{h}" is not used.{suggestion(h, known.keys() - set(header))}'
        for h in header
        if h not in known and not (swept and h in ACCOUNTS)
    )
    read: dict[str, list[Any]] = {h: [] for h in header if h in known}
    wrong = []
    for line, cells in rows:
        for name, cell in zip(header, cells, strict=True):
            if name in known:
                try:
                    read[name].append(_value(cell, known[name]))
                except ValueError as error:
                    read[name].append(None)
                    wrong.append((line, f'{name} = "{cell}" {error}.'))
    problems += fold(path.name, wrong)
    return Table(path.name, {n: tuple(v) for n, v in read.items()}, tuple(line for line, _ in rows), warnings), problems


def _missing(name: str, header: Sequence[str], known: Mapping[str, Column]) -> list[str]:
    """Required columns that are not there, with the unknown column that may be meant."""
    missing = [column for column in known.values() if column.required and column.name not in header]
    names = [column.name for column in missing]
    meant = {match[0]: h for h in header if h not in known and (match := get_close_matches(h, names, n=1))}
    remedies = {m: f'Is it "{h}"? Rename it.' for m, h in meant.items()}
    return [
        f'{name} line 1: column "{c.name}" ({c.doc}) is missing. {remedies.get(c.name, "Add it.")}' for c in missing
    ]


def _value(cell: str, column: Column) -> Any:
    if column.kind == "text":
        if column.required and not cell:
            raise ValueError(f"is empty. Write the {column.doc}")
        return cell
    if not column.required and is_nothing(cell):
        return math.nan
    wanted = "" if column.required else f". Write the {column.doc}, or give the column another name"
    if column.kind == "count" and wanted and not NUMBER.fullmatch(cell):
        raise ValueError(f"is no whole number{wanted}")
    value = number(cell)
    if column.kind == "count":
        if value != int(value):
            raise ValueError(f"is no whole number{wanted}")
        value = int(value)
    if column.options and value not in column.options:
        raise ValueError(f"is not known. Write one of: {', '.join(str(o) for o in column.options)}")
    if value < column.at_least or value <= column.above:
        limit = f"above {column.above:g}" if column.above > -math.inf else f"at least {column.at_least:g}"
        raise ValueError(f"is out of range. The {column.doc} must be {limit}")
    return value


def split_unit(column: str) -> tuple[str, str]:
    """The name of a quantity and the unit that stand in a column's name: "T_oil_C" -> ("T_oil", "degC").

    Args:
        column: with a unit as its ending or in brackets ("M_ab [Nm]"); the unit is "" where there is none
    """
    if match := _BRACKET.fullmatch(column.strip()):
        return match[1], spell_unit(match[2])
    for ending, unit in ENDINGS.items():
        if column.endswith(ending) and len(column) > len(ending):
            return column.removesuffix(ending), unit
    return column, ""


def bare_name(column: str) -> str:
    """What is compared of a column's name: without its unit, in small letters."""
    return split_unit(column)[0].casefold()


def scale(unit: str, si: str, *, name: str) -> tuple[float, float]:
    """Factor and offset that take a value of a unit to SI: value * factor + offset.

    Args:
        unit: of the column
        si: the model's unit of what it holds: "K", "K (difference)", "N.m", ...
        name: of the column, for the message

    Raises:
        ScenarioError: a unit of another kind, or none where there must be one
    """
    usual = {"K": "degC", "N.m": "Nm"}.get(si, show_unit(si))
    if unit in ("", "1") and si != "1":
        raise ScenarioError(
            f'{name}: its unit is not known. Write it behind the column\'s name, "[{usual}]", or in the'
            " card's table [units]."
        )
    try:
        zero, one = (to_si(f"{value:g} {'' if unit == '1' else unit}".strip(), si, name="") for value in (0.0, 1.0))
    except ScenarioError as error:
        said = str(error).removeprefix(f' = "0 {unit}": ')
        raise ScenarioError(f"{name}: " + _EXAMPLE.sub(f'Write one that does, such as "[{usual}]".', said)) from None
    return one - zero, zero


def is_of(unit: str, si: str) -> bool:
    """Whether a unit is one of what an SI unit measures.

    Args:
        unit: of a column
        si: as "W"
    """
    with suppress(ScenarioError):
        return bool(scale(unit, si, name=""))
    return False


def in_si(values: np.ndarray, unit: str, si: str, *, name: str) -> np.ndarray:
    """Values of a column in SI (n,).

    Args:
        values: as they stand (n,)
        unit: of the column
        si: the model's unit of what it holds
        name: of the column, for the message

    Raises:
        ScenarioError: a unit of another kind, or none where there must be one
    """
    factor, offset = scale(unit, si, name=name)
    return np.asarray(values * factor + offset)
