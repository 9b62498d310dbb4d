"""A diagnosis on the screen: the first answers in a few lines, everything else on demand."""

from __future__ import annotations

import io
import textwrap

from rich import box
from rich.console import Console
from rich.table import Table as Drawn

from ...show.console import fitting
from ..answer.findings import Findings
from . import phrases
from .tables import Table, tables

#: Width of the text at most.
WIDTH = 110
#: Of tables where no screen limits them.
WIDE = 150
#: Of the words before each paragraph.
LEFT = 11
#: Warnings on the first screen.
WARNINGS = 3


def text(findings: Findings, *, everything: bool = False, width: int | None = None) -> str:
    """The result as text.

    Args:
        findings: with their words
        everything: all tables and warnings, not the first screen alone
        width: columns of the screen, None where there is none
    """
    said = findings.says
    lines = [
        ("stands out", said.stands_out),
        ("verdict", said.verdict),
        ("do now", said.do),
        ("size", said.size),
        ("how sure", said.sure),
        ("cannot be", said.cannot_be),
        *(("data", line) for line in said.data),
    ]
    if findings.gain is not None:
        lines.append(("gain", f"{phrases.gain(findings.gain)}."))
    shown = findings.warnings if everything else findings.warnings[:WARNINGS]
    lines += [("warning", w) for w in shown]
    if more := len(findings.warnings) - len(shown):
        lines.append(("", f"{more} more warning{'s' * (more > 1)}: --all"))
    found = [paragraph(word, line, width) for word, line in lines if line]
    if everything:
        found += [drawn(t, width) for t in tables(findings)]
    return "\n".join(found) + "\n"


def paragraph(word: str, line: str, width: int | None = None, left: int = LEFT) -> str:
    """A text with a word in so many columns to its left; for the width see `text`."""
    return textwrap.fill(
        line,
        min(width or WIDTH, WIDTH),
        initial_indent=f"{word:<{left}}",
        subsequent_indent=" " * left,
        break_long_words=False,
        break_on_hyphens=False,
    )


def drawn(table: Table, width: int | None = None) -> str:
    """A table as text. No word or number is broken: where there is no room, the last columns of sentences are left out,
    and named; the others go on below. For the width see `text`.
    """
    words = [[cell.split() for cell in column] for column in zip(table.columns, *table.rows, strict=True)]
    least = [max((len(word) for cell in column for word in cell), default=0) for column in words]
    whole = [all(len(cell) < 2 for cell in cells) for cells in words]
    out = io.StringIO()
    screen = Console(file=out, width=min(width or WIDE, WIDE), markup=False, emoji=False, highlight=False)
    groups = fitting(least, whole, screen.width, repeated=True)
    for k, group in enumerate(groups):
        made = Drawn(box=box.SIMPLE_HEAD)
        if not k and table.title:  # a title of rich would wrap at a narrow table's width
            screen.print(table.title)
        for i in group:
            made.add_column(table.columns[i], overflow="fold", min_width=least[i], no_wrap=whole[i])
        for row in table.rows:
            made.add_row(*(row[i] for i in group))
        screen.print(made)
    shown = {i for group in groups for i in group}
    if left := ", ".join(name for i, name in enumerate(table.columns) if i not in shown):
        line = f"left out for want of room: {left}; widen the screen, or take --json"
        out.write(paragraph("", line, width, 0) + "\n")
    if table.note:
        out.write(paragraph("", table.note, width, 0) + "\n")
    return "\n".join(line.rstrip() for line in out.getvalue().splitlines())
