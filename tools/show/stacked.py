"""Tables that print long text below the row on narrow terminals."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from .console import cell, is_number, say, screen_width, table

#: Width that a column of sentences needs beside others [characters].
READABLE = 30
#: Indent of sentences under their row [characters].
INDENT = 4
#: Between columns [characters].
GAP = 3
#: Before the first column [characters].
MARGIN = 2


def print_stacked(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]], below: int) -> None:
    """Print a table; its last columns, sentences, stand under each row where they do not fit beside it.

    Args:
        title: above it
        columns: names of the columns
        rows: a value per column
        below: how many of the last columns are sentences
    """
    body = [[cell(value) for value in row] for row in rows]
    widths = [max(map(len, (name, *(row[i] for row in body)))) for i, name in enumerate(columns)]
    room, split = screen_width() or 160, len(columns) - below
    beside = [*widths[:split], *(min(w, READABLE) for w in widths[split:])]
    if sum(w + GAP for w in beside) + 1 <= room:
        table(title, columns, body)
        return
    sentences = textwrap.TextWrapper(
        room,
        initial_indent=" " * INDENT,
        subsequent_indent=" " * (INDENT + 2),
        break_long_words=False,
        break_on_hyphens=False,
    )
    right = [i > 0 and all(is_number(row[i]) for row in body) for i in range(split)]
    apart = MARGIN + sum(w + GAP for w in widths[:split]) - GAP > room  # the name has a line of its own
    if apart:
        widths[0] = len(columns[0])

    def line(cells: Sequence[str]) -> str:
        kept = [c.rjust(w) if r else c.ljust(w) for c, w, r in zip(cells, widths, right, strict=False)]
        return (" " * MARGIN + (" " * GAP).join(kept)).rstrip()

    say(f"{title}\n")
    print(line(columns[:split]))
    print(" " + "─" * (sum(widths[:split]) + GAP * (split - 1) + 2))
    for row in body:
        if apart:
            print(" " * MARGIN + row[0])
            row[0] = ""
        print(line(row[:split]))
        for text in filter(None, row[split:]):
            print("\n".join(sentences.wrap(text)))
    print()
