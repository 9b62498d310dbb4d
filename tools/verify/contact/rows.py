"""Rows of the verification table, and the pieces of work that give them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

#: What a piece of work gives: "rows" of the table, and whatever the figures draw.
Found = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """One piece of work that is kept once it is done.

    Args:
        item: heading of its rows
        name: its name among those of the item
        work: computes it
        quick: whether it belongs to the quick subset
    """

    item: str
    name: str
    work: Callable[[], Found]
    quick: bool = False

    @property
    def key(self) -> str:
        """A name for its file."""
        return "".join(c if c.isalnum() else "-" for c in f"{self.item} {self.name}".lower())


def row(case: str, quantity: str, reference: float, ours: float, rel: float, load_error: float = 0.0) -> Found:
    """One row of the table.

    Args:
        case: what was solved
        quantity: what is compared
        reference: what it is compared with
        ours: what the solver gives
        rel: largest accepted distance over the reference; 0 where it is only reported
        load_error: load missing over the load
    """
    deviation = ours / reference - 1
    verdict = "reported" if rel == 0 else "within" if abs(deviation) <= rel else "outside"
    return {
        "case": case,
        "quantity": quantity,
        "reference": reference,
        "ours": ours,
        "deviation": deviation,
        "tolerance": rel,
        "verdict": verdict,
        "load_error": load_error,
    }


def bound(
    case: str,
    quantity: str,
    ours: float,
    *,
    least: float | None = None,
    most: float | None = None,
    judged: bool = True,
) -> Found:
    """One row of the table whose reference is a bound.

    Args:
        case: what was solved
        quantity: what is measured
        ours: its value
        least: the bound below it
        most: the bound above it
        judged: whether it has to hold; else it is only reported
    """
    limit = least if least is not None else most
    assert limit is not None
    held = (least is None or ours >= least) and (most is None or ours <= most)
    found = row(case, quantity, limit, ours, 0.0)
    sign = ">=" if least is not None else "<="
    return {**found, "tolerance": sign, "verdict": "reported" if not judged else "within" if held else "outside"}
