"""Readings as they go into the files of a case: instruments, noise, tables, card."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from .plan import OIL, OIL_NAME, Plan

#: Usual class of every instrument: repeatability and fixed tolerance, in the unit of the column.
CLASSES: Mapping[str, tuple[float, float]] = {
    "n_carrier_rpm": (0.3, 0.15),
    "T_carrier_Nm": (0.8, 0.9),
    "T_sun_Nm": (0.2, 0.2),
    "T_oil_C": (0.35, 0.15),
    "T_oil2_C": (0.35, 0.3),
    "T_wall_C": (0.4, 0.2),
    "T_amb_C": (0.25, 0.15),
}
UNITS = {"rpm": "rpm", "Nm": "N.m", "C": "degC"}
FULL_SCALE: Mapping[str, float] = {"T_carrier_Nm": 3000.0, "T_sun_Nm": 1000.0}
DAY_COOLING_SD = 0.015  # standard deviation of a day's cooling as the card states it, relative [1]
#: What is given at points to predict.
GIVEN = ("n_carrier_rpm", "T_carrier_Nm", "T_amb_C")

#: Relative uncertainty of the model's parameters, as the card states it.
PRIOR_SD: Mapping[str, float] = {
    "mu": 0.10,
    "brg": 0.12,
    "seal": 0.15,
    "hconv": 0.08,
    "rad": 0.08,
    "gow": 0.20,
    "gwh": 0.20,
    "cap": 0.10,
}

#: First day of the campaign of the data.
FIRST_DAY = date(2020, 3, 2)
#: How long before it the reference campaign began.
EARLIER = timedelta(days=35)


@dataclass(frozen=True)
class Instruments:
    """What the card says of the channels, what they really do, and how rough readings are.

    Args:
        repeat_sd, offset_sd: as stated
        offset: the tolerance that each of them happens to have
        understated: real tolerances over the stated ones
        tails: degrees of freedom of Student's t; 0 for normal noise
        missing: share of readings that are not there
        gross: chance of one gross reading in the data, half of that in the reference
    """

    repeat_sd: Mapping[str, float]
    offset_sd: Mapping[str, float]
    offset: Mapping[str, float]
    understated: float = 1.0
    tails: float = 0.0
    missing: float = 0.0
    gross: float = 0.0

    @property
    def channels(self) -> tuple[str, ...]:
        """Columns."""
        return tuple(self.repeat_sd)

    def without_noise(self, values: np.ndarray) -> np.ndarray:
        """Readings (channels, 2, tests) with the fixed tolerances, without noise."""
        return np.asarray(values + np.array([self.offset[c] for c in self.channels])[:, None, None])

    def noisy(self, values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Readings as they go into a file."""
        if self.tails:
            z = rng.standard_t(self.tails, values.shape) * np.sqrt((self.tails - 2.0) / self.tails)
        else:
            z = rng.normal(0.0, 1.0, values.shape)
        sd = np.array([self.repeat_sd[c] for c in self.channels])
        return np.asarray(self.without_noise(values) + z * sd[:, None, None])


def draw_instruments(rng: np.random.Generator, octaves: float, *, second_oil: bool, **rough: float) -> Instruments:
    """Instruments up to some octaves better or worse than usual."""
    scale = {c: 2.0 ** rng.uniform(-octaves, octaves) for c in CLASSES}
    z = {c: rng.normal() for c in CLASSES}
    channels = [c for c in CLASSES if c != "T_oil2_C"] + ["T_oil2_C"] * second_oil
    repeat = {c: float(f"{scale[c] * CLASSES[c][0]:.3g}") for c in channels}
    tolerance = {c: float(f"{scale[c] * CLASSES[c][1]:.3g}") for c in channels}
    understated = rough.get("understated", 1.0)
    offset = {c: understated * tolerance[c] * float(z[c]) for c in channels}
    return Instruments(repeat, tolerance, offset, **rough)


def card(instruments: Instruments, *, bearing_oil: bool, room_drift: float) -> dict[str, Any]:
    """The card of a campaign of the planetary rig."""
    channels: dict[str, dict[str, float]] = {}
    for c in instruments.channels:
        channels[c] = {"repeat_sd": instruments.repeat_sd[c], "offset_sd": instruments.offset_sd[c]}
        channels[c] |= {"full_scale": FULL_SCALE[c]} if c in FULL_SCALE else {}
    lubricant = "oil" if bearing_oil else "grease"
    return {
        "schema": "gearheat.card/1",
        "units": {c: UNITS[c.rpartition("_")[2]] for c in instruments.channels},
        "channels": channels,
        "day_cooling_sd": DAY_COOLING_SD,
        "prior_sd": dict(PRIOR_SD),
        "protocol": {
            "dwell_min": [240, 90],
            "stop_min": 5,
            "T_start_minus_amb_K": 0,
            "ambient": "linear between the readings",
            "ambient_start_minus_reading_K": round(room_drift, 2),
            "reading": "last sample of the dwell",
        },
        "lubrication": {"gears": "oil", "bearings": lubricant, "needles": lubricant},
        "oil": dict(OIL),
        "series": False,
    }


@dataclass(frozen=True)
class Column:
    """A channel in a table with columns of its own.

    Args:
        sensor: its name on the card
        name: of the column
        scale: its value over that of the scaled rig
        reads: path in the model, where the rig's file has no such sensor
    """

    sensor: str
    name: str
    scale: float
    reads: str = ""


@dataclass(frozen=True)
class Layout:
    """Columns of a table.

    Args:
        humidity, start, date: whether there are such columns
        earlier: how long before the campaign of the data this one began
        shown: channel -> its column, in a table with columns of its own; empty where channels are columns
    """

    humidity: bool = False
    start: bool = False
    date: bool = False
    earlier: timedelta = timedelta()
    shown: Mapping[str, Column] = field(default_factory=dict)

    def name(self, channel: str) -> str:
        """Column of a channel."""
        return self.shown[channel].name if self.shown else channel

    def cells(self, values: Mapping[str, float]) -> dict[str, str]:
        """Cells of a row, by column, for values by channel."""
        if not self.shown:
            return {c: f"{v:.2f}" for c, v in values.items()}
        return {self.name(c): f"{v * self.shown[c].scale:.6g}" for c, v in values.items()}


def card_of_steady_points(instruments: Instruments, columns: Mapping[str, Column]) -> dict[str, Any]:
    """The card of a campaign with columns of its own.

    Args:
        instruments: of the campaign
        columns: channel -> column
    """
    accuracy = {"repeat_sd": instruments.repeat_sd, "offset_sd": instruments.offset_sd}
    return {
        "schema": "gearheat.card/2",
        "day_cooling_sd": DAY_COOLING_SD,
        "columns": {k.sensor: k.name for k in columns.values() if not k.reads},
        "channels": {k.sensor: {a: sd[c] * k.scale for a, sd in accuracy.items()} for c, k in columns.items()},
        "prior_sd": dict(PRIOR_SD),
        "sensors": {
            **{k.sensor: {"column": k.name, "reads": k.reads} for k in columns.values() if k.reads},
            columns["T_carrier_Nm"].sensor: {"magnitude": True},
        },
    }


def write_table(
    path: Path, plan: Plan, shown: np.ndarray, instruments: Instruments, layout: Layout, rng: np.random.Generator
) -> dict[str, Any] | None:
    """Write a table of steady readings in running order, some missing, perhaps one gross; returns the gross one."""
    order = [(int(j), half) for j in np.argsort(plan.order) for half in (0, 1)]
    kept = [i for i in range(len(order)) if rng.random() >= instruments.missing]
    gross = None
    if rng.random() < instruments.gross / (2.0 if layout.earlier else 1.0):
        place, c = int(rng.choice(kept)), str(rng.choice(list(instruments.channels)))
        by = float(rng.choice([-1.0, 1.0]) * rng.uniform(12.0, 25.0) * instruments.repeat_sd[c])
        shown = shown.copy()
        j, half = order[place]
        shown[instruments.channels.index(c), half, j] += by
        gross = {"point": place + 1, "row": kept.index(place) + 1, "channel": layout.name(c), "by": round(by, 3)}
    rows = []
    for i in kept:
        j, half = order[i]
        row = _conditions(plan, j, half, i + 1)
        row |= layout.cells(dict(zip(instruments.channels, shown[:, half, j], strict=True)))
        rows.append(row | _extra(plan, layout, j, half))
    _write(path, rows)
    return gross


def _extra(plan: Plan, layout: Layout, j: int, half: int) -> dict[str, str]:
    cells: dict[str, str] = {}
    if layout.date:
        cells["date"] = (FIRST_DAY - layout.earlier + timedelta(days=int(plan.order[j]) - 1)).isoformat()
    if layout.humidity:
        cells["humidity_pct"] = f"{plan.humidity[j]:.1f}"
    if layout.start:
        begin = (f"{plan.start[j]:.2f}", f"{plan.room[0, j]:.2f}", "") if half == 0 else ("", "", f"{plan.stop[j]:g}")
        cells |= dict(zip(("T_start_C", "T_amb_start_C", "stop_min"), begin, strict=True))
    return cells


def write_points(path: Path, plan: Plan, shown: np.ndarray, channels: Sequence[str], layout: Layout) -> None:
    """Write conditions to predict, as the instruments show them without noise."""
    rows = []
    for j in range(plan.columns):
        for half in (0, 1):
            row = _conditions(plan, j, half, 2 * j + half + 1)
            row |= layout.cells({c: shown[channels.index(c), half, j] for c in GIVEN})
            rows.append(row | _extra(plan, replace(layout, start=False, date=False), j, half))
    _write(path, rows)


def _conditions(plan: Plan, j: int, half: int, point: int) -> dict[str, str]:
    if plan.steady:
        return {"point": str(point), "test": str(j + 1)}
    dwell = f"{plan.dwell[half, j]:g}"
    known = {"point": point, "test": j + 1, "order": int(plan.order[j]), "direction": half + 1, "dwell_min": dwell}
    return {name: str(v) for name, v in known.items()} | {"oil": OIL_NAME}


def _write(path: Path, rows: Sequence[Mapping[str, str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
