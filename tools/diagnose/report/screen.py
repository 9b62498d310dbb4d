"""A diagnosis on the screen: the first answers in a few lines, everything else on demand."""

from __future__ import annotations

import io
import textwrap

from rich import box
from rich.console import Console
from rich.table import Table as Drawn

from . import phrases
from .findings import Findings
from .tables import Table, tables

#: Width of the text, of tables, and of the words before each paragraph; warnings on the first screen.
WIDTH, WIDE, LEFT, WARNINGS = 110, 150, 11, 3


def text(findings: Findings, *, everything: bool = False) -> str:
    """The result as text.

    Args:
        findings: with their words
        everything: all tables and warnings, not the first screen alone
    """
    said = findings.says
    lines = [("verdict", said.verdict), ("do now", said.do), ("size", said.size), ("how sure", said.sure)]
    lines += [("cannot be", said.cannot_be), *(("data", line) for line in said.data)]
    if findings.gain is not None:
        lines.append(("gain", f"{phrases.gain(findings.gain)}."))
    shown = findings.warnings if everything else findings.warnings[:WARNINGS]
    lines += [("warning", w) for w in shown]
    if more := len(findings.warnings) - len(shown):
        lines.append(("", f"{more} more warnings: --all"))
    found = [paragraph(word, line) for word, line in lines if line]
    if everything:
        found += [drawn(t) for t in tables(findings)]
    return "\n".join(found) + "\n"


def paragraph(word: str, line: str) -> str:
    """A text with a word to its left."""
    return textwrap.fill(line, WIDTH, initial_indent=f"{word:<{LEFT}}", subsequent_indent=" " * LEFT)


def drawn(table: Table) -> str:
    """A table as text."""
    made = Drawn(title=table.title, title_justify="left", box=box.SIMPLE_HEAD)
    for column in table.columns:
        made.add_column(column, overflow="fold")
    for row in table.rows:
        made.add_row(*row)
    out = io.StringIO()
    Console(file=out, width=WIDE, markup=False, emoji=False, highlight=False).print(made)
    if table.note:
        out.write(textwrap.fill(table.note, WIDTH) + "\n")
    return "\n".join(line.rstrip() for line in out.getvalue().splitlines())
