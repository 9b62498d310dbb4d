"""Notes under an answer: laws outside their range, catalogue values never checked against a print."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .console import say


def print_outside(outside: Sequence[Mapping[str, Any]]) -> None:
    """Print a line for each law that was used outside its range.

    Args:
        outside: `part`, `law`, `argument`, `range`, `met` and `regime` of each
    """
    for o in outside:
        (least, most), (low, high) = o["met"], o["range"]
        met = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        there = f": {o['regime']}" if o["regime"] else ""
        say(f"outside its range: {o['part']}: {o['law']}, {o['argument']} = {met} (valid {low:g} to {high:g}){there}")


def unchecked_lines(entries: Iterable[Mapping[str, Any]]) -> list[str]:
    """Entries of catalogues with values never checked against a print, a line each."""
    return [f'{e["catalogue"]} "{e["entry"]}": {", ".join(e["values"])}' for e in entries]


def print_unchecked(entries: Iterable[Mapping[str, Any]]) -> None:
    """Print which values of the catalogue were never checked against a print."""
    for line in unchecked_lines(entries):
        say(f"catalogue values not checked against a print: {line}")
