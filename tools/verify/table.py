"""Verdicts as tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from .verdicts import NOT_REPRODUCED, VERDICTS, Machine, Verdict, as_printed

HEAD = ("number", "place", "published", "corrected", "model", "allowed", "verdict")


def details(
    machines: Sequence[Machine], laws: Sequence[Verdict]
) -> Iterator[tuple[str, Sequence[str], Sequence[Sequence[Any]]]]:
    """Title, head and rows of the numbers of each machine, then of the laws.

    Args:
        machines: the rigs
        laws: verdicts on the golden rows of laws
    """
    for machine in machines:
        if machine.verdicts:
            yield f"{machine.name}: {machine.doc}", HEAD, _lines(machine.verdicts)
    if laws:
        yield "Laws", HEAD, _lines(laws)


def counts_table(found: Mapping[str, Any]) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
    """Head and rows of the counts by verdict and by kind.

    Args:
        found: the object of `--json`
    """
    named = [*((m["name"], m) for m in found["machines"] if m["rows"]), ("laws", found["laws"]), ("in all", found)]
    body = [[name, *part["counts"].values(), *part["kinds"].values()] for name, part in named]
    return ("", *VERDICTS, *found["kinds"]), body


def remarks(machines: Sequence[Machine], laws: Sequence[Verdict]) -> Iterator[str]:
    """Machines without published numbers, and by name what fails.

    Args:
        machines: the rigs
        laws: verdicts on the golden rows of laws
    """
    for machine in machines:
        if not machine.verdicts:
            yield f"{machine.name}: has no published numbers. {machine.reproduces}".strip()
    failed = [f"{m.name}: {v.row.name}" for m in machines for v in m.verdicts if v.verdict == NOT_REPRODUCED]
    failed += [f"{v.row.law}: {v.row.name}" for v in laws if v.verdict == NOT_REPRODUCED]
    if failed:
        numbers = "1 published number is" if len(failed) == 1 else f"{len(failed)} published numbers are"
        yield f"{numbers} not reproduced: {'; '.join(failed)}."


def _lines(verdicts: Sequence[Verdict]) -> list[list[Any]]:
    """A line for each row, what fails first; rows of a group that all hold are one line."""
    lines: list[list[Any]] = []
    before = ""
    groups: dict[str, list[Verdict]] = {}
    for verdict in sorted(verdicts, key=lambda v: VERDICTS.index(v.verdict) != 0):
        group = verdict.row.group
        if group and verdict.verdict != NOT_REPRODUCED:
            groups.setdefault(group, []).append(verdict)
            continue
        again = verdict.why != "" and verdict.why == before
        lines.append(_line(verdict, "as above" if again else verdict.why))
        before = verdict.why
    return lines + [_group_line(name, members) for name, members in groups.items()]


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
