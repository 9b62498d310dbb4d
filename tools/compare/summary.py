"""A comparison and its rivals as one table for people and one object for programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from .errors import GROUPINGS, Comparison
from .rivals import Score


def as_dict(comparison: Comparison, scores: Sequence[Score]) -> dict[str, Any]:
    """Keys `rmse`, `noise_floor`, `rivals`, `groups`."""
    return {
        "rmse": comparison.rmse(),
        "noise_floor": dict(comparison.noise_floor),
        "rivals": {score.name: {k: v for k, v in asdict(score).items() if k != "name"} for score in scores},
        "groups": [asdict(group) for group in comparison.groups],
    }


def hundredths(value: float | None) -> str:
    """An error as a table shows it."""
    return "" if value is None else f"{value:.2f}"


def error_lines(comparison: Comparison, scores: Sequence[Score]) -> tuple[list[str], list[list[Any]]]:
    """Head and body: channels across; simulation overall and by grid, noise floor and rivals down."""
    rmse = comparison.rmse()
    channels = comparison.channels

    def line(name: str, values: Any) -> list[Any]:
        return [name, *(hundredths(values.get(c.key)) for c in channels)]

    body = [line("simulation, all readings", rmse["overall"])]
    body += [line(f"simulation, {grid}", found) for grid, found in rmse.items() if grid != "overall"]
    body.append(line("noise floor", comparison.noise_floor))
    for score in scores:
        body.append(line(f"{score.name}, in sample", score.in_sample))
        body.append(line(f"{score.name}, left-out tests", score.leave_one_test_out))
    return ["root mean square", *(f"{c.label} [{c.unit}]" for c in channels)], body


def group_lines(comparison: Comparison) -> tuple[list[str], list[list[Any]]]:
    """Head and body: groups down, mean and root mean square of each channel across."""
    channels = comparison.channels
    found: dict[tuple[str, Any], dict[str, Any]] = {}
    for group in comparison.groups:
        found.setdefault((group.by, group.value), {"n": group.n})[group.channel] = group
    body = []
    for (by, value), of in found.items():
        pairs = [(of[c.key].mean, of[c.key].rms) if c.key in of else (None, None) for c in channels]
        name = (
            "all"
            if by == "all"
            else f"{GROUPINGS[by]} {value:g}"
            if isinstance(value, float)
            else f"{GROUPINGS[by]} {value}"
        )
        body.append([name, of["n"], *(hundredths(x) for pair in pairs for x in pair)])
    return ["group", "readings", *(f"{c.short} {what} [{c.unit}]" for c in channels for what in ("mean", "rms"))], body
