"""The files of a case."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import date as date_
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from .card import Instruments
from .plan import CHANNELS, OIL_NAME, Plan
from .rig import Readings

#: First day of a campaign, and how long before it the reference campaign began.
FIRST_DAY, EARLIER = date_(2020, 3, 2), timedelta(days=35)
SAMPLE_S = 300

_DIGITS = {"rpm": 2, "Nm": 2, "C": 2}


@dataclass(frozen=True)
class Columns:
    """Optional columns of a table."""

    humidity: bool
    start: bool
    date: bool
    second_oil: bool
    first_day: date_ = FIRST_DAY


def table(path: Path, plan: Plan, shown: Readings, columns: Columns) -> None:
    """A table of steady readings, in running order."""
    channels = [c for c in CHANNELS if c in shown.values and c != "T_oil2_C"]
    head = ["point", "test", "order", "direction", "dwell_min", "oil", *channels]
    head += _optional(columns)
    lines: list[list[str]] = []
    for j in np.argsort(plan.order):
        for half in (0, 1):
            line = _conditions(plan, int(j), half, len(lines) + 1)
            line += [_text(c, shown.values[c][half, j]) for c in channels]
            lines.append(line + _extra(plan, shown, columns, int(j), half))
    _write(path, head, lines)


def _optional(columns: Columns) -> list[str]:
    names = ["T_oil2_C"] if columns.second_oil else []
    names += ["date"] if columns.date else []
    names += ["humidity_pct"] if columns.humidity else []
    return names + (["T_start_C", "T_amb_start_C", "stop_min"] if columns.start else [])


def _extra(plan: Plan, shown: Readings, columns: Columns, j: int, half: int) -> list[str]:
    found = [_text("T_oil2_C", shown.values["T_oil2_C"][half, j])] if columns.second_oil else []
    if columns.date:
        found.append((columns.first_day + timedelta(days=int(plan.order[j]) - 1)).isoformat())
    if columns.humidity:
        found.append(f"{plan.humidity[j]:.1f}")
    if columns.start:
        begin = [f"{plan.start[j]:.2f}", f"{plan.room[0, j]:.2f}", ""]
        found += begin if half == 0 else ["", "", f"{plan.stop[j]:g}"]
    return found


def points(path: Path, plan: Plan, shown: Readings, columns: Columns) -> None:
    """Conditions to predict, as the instruments show them without noise."""
    channels = ["n_carrier_rpm", "T_carrier_Nm", "T_amb_C"]
    head = ["point", "test", "order", "direction", "dwell_min", "oil", *channels]
    head += ["humidity_pct"] if columns.humidity else []
    lines = []
    for j in range(plan.columns):
        for half in (0, 1):
            line = _conditions(plan, j, half, 2 * j + half + 1)
            line += [_text(c, shown.values[c][half, j]) for c in channels]
            lines.append(line + ([f"{plan.humidity[j]:.1f}"] if columns.humidity else []))
    _write(path, head, lines)


def point_truth(plan: Plan, ill: np.ndarray, well: np.ndarray) -> list[dict[str, Any]]:
    """What the oil sensor shows at the points, with and without what is hidden."""
    return [
        {
            "point": 2 * j + half + 1,
            "T_oil_C": round(float(ill[half, j]), 4),
            "T_oil_without_C": round(float(well[half, j]), 4),
        }
        for j in range(plan.columns)
        for half in (0, 1)
    ]


def series(
    path: Path, plan: Plan, steps: Readings, shown: Readings, instruments: Instruments, rng: np.random.Generator
) -> None:
    """A time series of every test: a sample every five minutes while it runs; the last of a half is the reading."""
    channels = ["n_carrier_rpm", "T_carrier_Nm", "T_oil_C", "T_wall_C", "T_amb_C"]
    head = ["test", "time_s", "direction", *channels]
    lines = []
    for j in np.argsort(plan.order):
        for half in (0, 1):
            rows = np.flatnonzero(steps.direction[:, 0] == half + 1)
            clock = 60.0 * steps.minutes[rows, j]
            inside = np.arange(np.ceil(clock[0] / SAMPLE_S) * SAMPLE_S, clock[-1] - 1.0, SAMPLE_S)
            curves = {c: PchipInterpolator(clock, steps.values[c][rows, j])(inside) for c in channels}
            noise = {c: rng.normal(instruments.offset[c], instruments.repeat_sd[c], len(inside)) for c in channels}
            for i, t in enumerate(inside):
                values = [_text(c, curves[c][i] + noise[c][i]) for c in channels]
                lines.append([str(j + 1), f"{t:.0f}", str(half + 1), *values])
            last = [_text(c, shown.values[c][half, j]) for c in channels]
            lines.append([str(j + 1), f"{clock[-1]:.0f}", str(half + 1), *last])
    _write(path, head, lines)


def _conditions(plan: Plan, j: int, half: int, point: int) -> list[str]:
    known = [point, j + 1, int(plan.order[j]), half + 1, f"{plan.dwell[half, j]:g}", OIL_NAME]
    return [str(v) for v in known]


def _text(column: str, value: float) -> str:
    return f"{value:.{_DIGITS[column.rpartition('_')[2]]}f}"


def _write(path: Path, head: Sequence[str], lines: Iterable[Sequence[str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(lines)
