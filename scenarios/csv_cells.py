"""Cells of tables: numbers, no reading, decimals with two readings, and many wrong cells told in few words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

import numpy as np

from ..model.units import parse_number

#: What programs write where nothing was read, in small letters.
NOTHING = frozenset(("", "nan", "na", "n/a", "#n/a", "#nv", "null", "none", "-", "--", "---"))
#: A number as a cell may have it.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
#: Problems of one kind that are told one by one; the rest are counted.
ALIKE = 3

_QUOTED = re.compile('".*"')
#: A number whose point or comma may separate thousands, and one where it separates decimals.
_GROUP = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}")
_DECIMAL = re.compile(r"[+-]?\d*([.,])\d+(?:[eE][+-]?\d+)?")


def is_nothing(cell: str) -> bool:
    """Whether a cell stands for no reading.

    Args:
        cell: as it is written
    """
    return cell.strip().lower() in NOTHING


def fold(name: str, wrong: Iterable[tuple[int, str]]) -> list[str]:
    """Problems of cells; beyond the first of a kind the rest are told in one, so that no kind hides another.

    Args:
        name: of the file
        wrong: line, and text with the cell in quotation marks; those that differ in the cell alone are of one kind
    """
    kinds: dict[str, list[tuple[int, str]]] = {}
    for line, text in wrong:
        kinds.setdefault(_QUOTED.sub('"..."', text), []).append((line, text))
    problems = []
    for kind, found in kinds.items():
        problems += [f"{name} line {line}: {text}" for line, text in found[:ALIKE]]
        if rest := found[ALIKE:]:
            problems.append(f"{name} lines {rest[0][0]} to {rest[-1][0]}, {len(rest)} of them: {kind}")
    return problems


def ragged_rows(name: str, header: Sequence[str], rows: Iterable[tuple[int, Sequence[str]]]) -> list[str]:
    """Rows that have more or fewer cells than the header.

    Args:
        name: of the file
        header: names of its columns
        rows: line and cells of each
    """
    said = "{} cells under {} column names. Write one cell per column, decimals with a point."
    odd = [(line, len(cells)) for line, cells in rows if len(cells) != len(header)]
    return fold(name, ((line, said.format(n, len(header))) for line, n in odd))


def two_readings(name: str, rows: Iterable[tuple[int, Sequence[str]]], sure: set[str] | None = None) -> str | None:
    """Where a point or a comma may separate decimals or thousands, with both readings; None where all is clear.

    Args:
        name: of the file
        rows: line and cells of each
        sure: takes the signs that separate decimals beyond doubt; those of earlier rows are in it
    """
    sure = set() if sure is None else sure
    unsure: dict[str, tuple[int, str]] = {}
    for line, cell in ((line, cell.strip()) for line, row in rows for cell in row):
        if match := _GROUP.fullmatch(cell):
            unsure.setdefault(match[1], (line, cell))
        elif match := _DECIMAL.fullmatch(cell):
            sure.add(match[1])
    for sign, (line, cell) in unsure.items():
        if sure != {sign}:
            small, large = cell.replace(sign, "."), cell.replace(sign, "")
            return (
                f'{name} line {line}: "{cell}" may be {float(small):g} or {large}. Write thousands without a sign, and'
                " all decimals with the same one."
            )
    return None


def numbers(cells: Sequence[str]) -> np.ndarray | None:
    """The numbers of a column (n,), all at once; None where one of the cells holds no finite number."""
    if not all(map(NUMBER.fullmatch, cells)):
        return None
    found = np.fromiter(map(float, cells), float, len(cells))
    try:
        for cell in {cells[int(k)] for k in np.flatnonzero(found == 0.0)}:
            parse_number(cell)
    except ValueError:  # one is too small to be held
        return None
    return found if np.isfinite(found).all() else None


def number(cell: str) -> float:
    """The finite number in a cell. Raises ValueError saying what is wrong with it."""
    if not cell:
        raise ValueError("is empty. Write a number")
    if cell.lower().lstrip("+-") in ("nan", "inf", "infinity"):
        raise ValueError("is not finite. Write a number or leave out the row")
    if not NUMBER.fullmatch(cell):
        raise ValueError("is no number. Write a number with a decimal point and no unit")
    try:
        value = parse_number(cell)
    except ValueError:
        raise ValueError("is too small to be held. Write 0, or check its exponent") from None
    if not math.isfinite(value):
        raise ValueError("is not finite. Write a number or leave out the row")
    return value
