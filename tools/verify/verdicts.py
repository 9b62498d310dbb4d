"""Verdicts on published numbers: what is printed, what is expected, what the model gives, and whether they agree."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ...model.errors import ScenarioError
from ...model.units import in_unit, kind_of, show_unit, split_quantity
from ...scenarios.published import Number, Row

REPRODUCED = "reproduced"
CONTRADICTED = "published contradicts itself"
NOT_REPRODUCED = "not reproduced"
#: What fails comes first wherever verdicts are counted.
VERDICTS = (NOT_REPRODUCED, CONTRADICTED, REPRODUCED)
#: Least and most significant digits of what the model gives.
DIGITS = (6, 12)
#: Columns of a table of verdicts.
HEAD = ("number", "place", "published", "corrected", "model", "allowed", "verdict")
#: How a row comes by its number, in words.
HOW = {
    "steady": "steady state",
    "held": "temperatures held",
    "design": "design",
    "losses": "losses at readings",
    "contacts": "contacts of a cycle",
    "law": "law",
    "rows": "from other rows",
    "new": "a machine of gearheat new",
    "print": "arithmetic on print",
}


@dataclass(frozen=True)
class Value:
    """What the model gives for a row.

    Attributes:
        value: a number, or whether a statement holds; None where there is no solution
        unit: its SI unit, "" where that is not known; the number is then in SI all the same
        labelled: the number is in the unit of the row already
        problem: why there is no solution
    """

    value: float | bool | None
    unit: str = ""
    labelled: bool = False
    problem: str = ""


@dataclass(frozen=True)
class Verdict:
    """A row with what the model gives, all numbers in `unit`."""

    row: Row
    verdict: str
    unit: str = ""
    model: float | bool | None = None
    expected: float | None = None
    tolerance: float | None = None
    why: str = ""

    @property
    def kind(self) -> str:
        """ "published", "statement", or "recomputed" where the source prints no number."""
        if self.row.published is None:
            return "recomputed"
        return "statement" if isinstance(self.model, bool) else "published"

    @property
    def shown(self) -> str:
        """What the model gives, as a reader sees it."""
        if self.model is None:
            return "no solution"
        if isinstance(self.model, bool):
            return "holds" if self.model else "does not hold"
        return _with_unit(f"{self.model:.{self._digits}g}", self.unit)

    @property
    def _digits(self) -> int:
        """Significant digits that tell the model from the expected number to a tenth of what is allowed."""
        if not self.tolerance or not self.model:
            return DIGITS[0]
        needed = math.ceil(math.log10(abs(self.model) / self.tolerance)) + 1
        return min(max(needed, DIGITS[0]), DIGITS[1])

    @property
    def allowed(self) -> str:
        """The distance allowed, as a reader sees it."""
        return "" if self.tolerance is None else _with_unit(f"{self.tolerance:.2g}", _difference(self.unit))

    @property
    def distance(self) -> float:
        """How far the model is from the expected number."""
        return abs(float(self.model or 0.0) - (self.expected or 0.0))

    def as_dict(self) -> dict[str, Any]:
        """The row as `--json` gives it."""
        row = self.row
        return {
            "name": row.name,
            "where": row.where,
            "kind": self.kind,
            "run": row.run,
            "published": _format_printed(row.published, row.unit),
            "corrected": _format_printed(row.corrected, row.unit),
            "recomputed": _format_printed(row.recomputed, row.unit),
            "model": self.model,
            "unit": self.unit,
            "expected": self.expected,
            "tolerance": self.tolerance,
            "verdict": self.verdict,
            "why": self.why,
            "group": row.group,
            "how": HOW[row.run],
            "shown": self.shown,
            "allowed": self.allowed,
        }


@dataclass(frozen=True)
class Machine:
    """A rig with the verdicts on its published numbers."""

    name: str
    doc: str
    reproduces: str
    verdicts: tuple[Verdict, ...]
    errata: tuple[Mapping[str, str], ...]

    def as_dict(self) -> dict[str, Any]:
        """The machine as `--json` and the page have it."""
        return {
            "name": self.name,
            "doc": self.doc,
            "reproduces": self.reproduces,
            "counts": counts(self.verdicts),
            "kinds": kinds(self.verdicts),
            "rows": [verdict.as_dict() for verdict in self.verdicts],
            "errata": list(self.errata),
        }


def _format_printed(number: Number | None, unit: str) -> str | None:
    """A number as a reader sees it: a text with its unit, or a bare number with the unit given."""
    return number if number is None or isinstance(number, str) else _with_unit(f"{number:.10g}", unit)


def _with_unit(text: str, unit: str) -> str:
    return text if unit in ("", "1") else f"{text} {unit}"


def _difference(unit: str) -> str:
    return "K" if unit == "degC" else unit


def judge(row: Row, found: Value) -> Verdict:
    """The verdict on a row.

    Args:
        row: the published number
        found: what the model gives

    Raises:
        ScenarioError: number, unit and tolerance of the row do not fit the value
    """
    if found.value is None:
        return Verdict(row, NOT_REPRODUCED, why=found.problem)
    if isinstance(found.value, bool):
        return _on_statement(row, found.value)
    if row.is_statement:
        raise ScenarioError(f"{row.name}: has no tolerance. Give tol or rel, or a path that compares.")
    unit = _unit_of(row, found)
    value = found.value if found.labelled else _convert(row, found, unit)
    if row.contradiction:
        return Verdict(row, CONTRADICTED, unit, value, why=row.why)
    expected = _number(row, unit)
    tolerance = row.rel * abs(expected) if row.rel is not None else _tolerance(row, unit)
    if not abs(value - expected) <= tolerance:
        return Verdict(row, NOT_REPRODUCED, unit, value, expected, tolerance, row.why)
    verdict = REPRODUCED if row.corrected is None or row.published is None else CONTRADICTED
    return Verdict(row, verdict, unit, value, expected, tolerance, row.why)


def _on_statement(row: Row, holds: bool) -> Verdict:
    """A statement holds; or its correction does, and the printed one contradicts the source itself."""
    if not row.is_statement:
        raise ScenarioError(f"{row.name}: {row.path} holds or not, and needs no tolerance. Leave tol and rel out.")
    kind = REPRODUCED if row.corrected is None or row.published is None else CONTRADICTED
    return Verdict(row, kind if holds else NOT_REPRODUCED, model=holds, why=row.why)


def _unit_of(row: Row, found: Value) -> str:
    """The unit in which a row is shown: that of its number, else the row's own, else the value's."""
    written = _split_text(row.expected)[1] if isinstance(row.expected, str) else ""
    if written and not (row.contradiction and row.unit):
        return written
    if row.unit or row.contradiction:
        return row.unit or show_unit(found.unit) or "1"
    if isinstance(row.expected, str) and _split_text(row.expected)[0] is None:
        raise ScenarioError(f'{row.name}: "{row.expected}" is no number with a unit. Write for example "139.1 degC".')
    if found.unit not in ("", "1"):
        raise ScenarioError(f"{row.name}: has no unit. Give unit, for example {show_unit(found.unit)}.")
    return "1"


def _convert(row: Row, found: Value, unit: str) -> float:
    """The model's value in the unit of the row."""
    if found.unit and kind_of(found.unit) != kind_of(unit):
        raise ScenarioError(f'{row.name}: unit "{unit}" does not fit {found.unit} of {row.path or "the value"}.')
    return in_unit(float(found.value or 0.0), unit)


def _number(row: Row, unit: str) -> float:
    """The expected number in a unit."""
    expected = row.expected
    if not isinstance(expected, str):
        return float("nan") if expected is None else float(expected)
    return _split_text(expected)[0] or 0.0


def _tolerance(row: Row, unit: str) -> float:
    """The distance allowed in the unit of the row; a difference of temperatures in K is one in degC."""
    if not isinstance(row.tol, str):
        return float(row.tol or 0.0)
    number, written = _split_text(row.tol)
    if number is None or (written and kind_of(written) != kind_of(unit)):
        raise ScenarioError(f'{row.name}: tol = "{row.tol}" does not fit "{unit}".')
    return number * _size(written or unit) / _size(unit)


@cache
def _size(unit: str) -> float:
    """A difference of one unit in SI."""
    return 1.0 / (in_unit(1.0, unit) - in_unit(0.0, unit))


def _split_text(text: str) -> tuple[float | None, str]:
    try:
        return split_quantity(text)
    except ValueError:
        return None, ""


def kinds(verdicts: Sequence[Verdict]) -> dict[str, int]:
    """How many rows are printed numbers, printed statements, and numbers recomputed because none is printed."""
    return {name: sum(v.kind == name for v in verdicts) for name in ("published", "statement", "recomputed")}


def counts(verdicts: Sequence[Verdict]) -> dict[str, int]:
    """How many rows have each verdict, what fails first."""
    return {name: sum(v.verdict == name for v in verdicts) for name in VERDICTS}


def number_of(value: Any) -> float | bool:
    """What an expression gave, as a number or a truth value. Raises ValueError for an array."""
    if np.ndim(value) != 0:
        raise ValueError(f"gives {np.size(value)} values. Reduce them, for example by max( )")
    return bool(value) if isinstance(value, bool | np.bool_) else float(value)


def lines(verdicts: Sequence[Verdict]) -> list[list[Any]]:
    """A line for each row, what fails first; rows of a group that all hold are one line."""
    found: list[list[Any]] = []
    before = ""
    groups: dict[str, list[Verdict]] = {}
    for verdict in sorted(verdicts, key=lambda v: VERDICTS.index(v.verdict) != 0):
        group = verdict.row.group
        if group and verdict.verdict != NOT_REPRODUCED:
            groups.setdefault(group, []).append(verdict)
            continue
        again = verdict.why != "" and verdict.why == before
        found.append(_line(verdict, "as above" if again else verdict.why))
        before = verdict.why
    return found + [_group_line(name, members) for name, members in groups.items()]


def _line(v: Verdict, why: str) -> list[Any]:
    row = v.row
    told = f"{v.verdict}: {why}" if why else v.verdict
    other = _format_printed(row.corrected if row.recomputed is None else row.recomputed, row.unit) or ""
    name = f"{row.law}: {row.name}" if row.law else row.name
    numbers = [_format_printed(row.published, row.unit) or "", other, v.shown, v.allowed]
    return [name, row.where, *numbers, told]


def _group_line(name: str, members: Sequence[Verdict]) -> list[Any]:
    worst = max(members, key=lambda v: v.distance / (v.tolerance or 1.0))
    model = f"within {worst.distance:.2g} {worst.unit}".removesuffix(" 1")
    return [name, members[0].row.where, f"{len(members)} numbers", "", model, worst.allowed, worst.verdict]
