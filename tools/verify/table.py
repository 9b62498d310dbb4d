"""Verdicts as tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .verdicts import NOT_REPRODUCED, VERDICTS, Verdict, as_printed

HEAD = ("number", "place", "published", "corrected", "model", "allowed", "verdict")


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
    other = as_printed(row.corrected if row.recomputed is None else row.recomputed, row.unit) or ""
    name = f"{row.law}: {row.name}" if row.law else row.name
    numbers = [as_printed(row.published, row.unit) or "", other, v.shown, v.allowed]
    return [name, row.where, *numbers, told]


def _group_line(name: str, members: Sequence[Verdict]) -> list[Any]:
    worst = max(members, key=lambda v: v.distance / (v.tolerance or 1.0))
    model = f"within {worst.distance:.2g} {worst.unit}".removesuffix(" 1")
    return [name, members[0].row.where, f"{len(members)} numbers", "", model, worst.allowed, worst.verdict]
