"""Sentences of an answer: under the rows of a table, and notes on laws outside their range and unchecked values."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .console import cell, is_number, say, screen_width, table

#: Roles of parts that lose power, as several are called.
PLURAL = {"bearing": "bearings", "seal": "seals"}
#: Width that a column of sentences needs beside others [characters].
READABLE = 30
#: Indent of sentences under their row [characters].
INDENT = 4
#: Between columns [characters].
GAP = 3
#: Before the first column [characters].
MARGIN = 2


def print_outside(outside: Sequence[Mapping[str, Any]]) -> None:
    """Print a line for each law that was used outside its range, as the JSON objects list them, and one for all."""
    levels = [o["level"] for o in outside]
    if len(outside) > 1:
        early = sum(o["until_s"] is not None for o in outside)
        counts = f"{levels.count('warning')} far from it (warning), {levels.count('note')} near it or early (note)"
        say(
            f"{len(outside)} laws outside their range: {counts}" + (f", {early} at the beginning only" if early else "")
        )
    for o in sorted(outside, key=lambda o: o["level"] == "note"):
        (least, most), (low, high) = o["met"], o["range"]
        met = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        until = "" if o["until_s"] is None else f", until {o['until_s']:.4g} s"
        there = f": {o['regime']}" if o["regime"] else ""
        valid = f"{met}{until} (valid {low:g} to {high:g})"
        say(f"{o['level']}, outside its range: {o['part']}: {o['law']}, {o['argument']} = {valid}{there}")


def unchecked_lines(entries: Iterable[Mapping[str, Any]]) -> list[str]:
    """Entries of catalogues with values never checked against a print, a line each."""
    return [f'{e["catalogue"]} "{e["entry"]}": {", ".join(e["values"])}' for e in entries]


def print_unchecked(entries: Iterable[Mapping[str, Any]]) -> None:
    """Print which values of the catalogue were never checked against a print."""
    for line in unchecked_lines(entries):
        say(f"catalogue values not checked against a print: {line}")


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
