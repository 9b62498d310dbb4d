"""The figures of the report, as SVG text. Same rows, same bytes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..show.drawing import COLOURS, empty, legend, svg
from .errors import GROUPINGS, Channel, Row, Rows, distinct, errors, numbers

#: Shapes for the two directions.
SHAPES = {1: "o", 2: "^"}
DIRECTIONS = {1: "1", 2: "2 (reverse)"}

#: Words for the loss columns; a column that is not here is shown under its own name.
LOSSES = {
    "P_mesh_W": "gear mesh",
    "P_trb_W": "tapered roller bearings",
    "P_dgb_W": "deep groove ball bearing",
    "P_needle_W": "needle bearings",
    "P_seal_W": "seals",
    "P_churn_W": "churning",
}
UNITS = {"n_set_rpm": "rpm", "T_set_Nm": "N.m"}


def shown_unit(channel: Channel) -> str:
    """The unit of a channel's values; its errors have `channel.unit`."""
    return "°C" if channel.unit == "K" else channel.unit


def parity(rows: Rows, channels: Sequence[Channel]) -> str:
    """Measured against simulated, one panel a channel, coloured by oil, shaped by direction."""
    figure, panels = empty(4.0 * len(channels), 4.9, 1, len(channels))
    for panel, channel in zip(panels, channels, strict=True):
        x, y = numbers(rows, channel.column), numbers(rows, channel.measured)
        low, high = float(np.nanmin([x, y])), float(np.nanmax([x, y]))
        margin = 0.04 * (high - low) or 1.0
        ends = (low - margin, high + margin)
        panel.plot(ends, ends, color="#888888", linewidth=1)
        _scatter(panel, rows, x, y)
        panel.set(xlim=ends, ylim=ends, box_aspect=1, title=channel.label)
        panel.set_xlabel(f"simulated [{shown_unit(channel)}]")
        panel.set_ylabel(f"measured [{shown_unit(channel)}]")
    legend(figure, panels[0])
    return svg(figure)


def residuals(rows: Rows, channels: Sequence[Channel], noise: Mapping[str, Any]) -> str:
    """Simulated minus measured, one line of panels a channel, against speed, torque, oil and direction.

    A band, where the channel has a noise floor, is two of them wide to either side.
    """
    known = ("n_set_rpm", "T_set_Nm", "oil", "direction")
    groupings = [by for by in known if any(row.get(by) is not None for row in rows)]
    figure, panels = empty(12.0, 2.7 * len(channels) + 0.8, len(channels), len(groupings), sharex="col", sharey="row")
    for i, channel in enumerate(channels):
        line = panels[i * len(groupings) : (i + 1) * len(groupings)]
        for panel, by in zip(line, groupings, strict=True):
            _residual(panel, rows, channel, by, noise.get(channel.key))
            panel.label_outer()
        line[0].set_ylabel(f"{channel.label}\nsimulated - measured [{channel.unit}]")
    legend(figure, panels[0])
    return svg(figure)


def _residual(panel: Axes, rows: Rows, channel: Channel, by: str, noise: float | None) -> None:
    """One panel: errors of a channel over the groups of one grouping, side by side where they share a group."""
    panel.axhline(0, color="#888888", linewidth=1)
    if noise is not None:
        panel.axhspan(-2 * noise, 2 * noise, color="#eeeeee", zorder=0)
    values = [row.get(by) for row in rows]
    known = distinct(values)
    x = np.array([math.nan if v is None else known.index(v) for v in values]) + _spread(rows, by)
    _scatter(panel, rows, x, errors(rows, channel))
    words = {"direction": DIRECTIONS}.get(by, {})
    panel.set_xticks(range(len(known)), [words.get(v, f"{v:g}" if by in UNITS else str(v)) for v in known])
    panel.set_xlim(-0.6, len(known) - 0.4)
    panel.set_xlabel(f"{GROUPINGS[by]} [{UNITS[by]}]" if by in UNITS else GROUPINGS[by])


def _spread(rows: Rows, by: str) -> np.ndarray:
    """Sideways places that keep the oils and directions of one group apart, unless the group itself is one."""
    oils = distinct(row.get("oil") for row in rows)
    place = {oil: 0.0 if by == "oil" else 0.5 * (i - (len(oils) - 1) / 2) / len(oils) for i, oil in enumerate(oils)}
    side = 0.0 if by == "direction" else 0.05 if by != "oil" else 0.12
    return np.array([place.get(r.get("oil"), 0.0) + (side if r.get("direction") == 2 else -side) for r in rows])


def _scatter(panel: Axes, rows: Rows, x: np.ndarray, y: np.ndarray) -> None:
    for i, oil in enumerate(distinct(row.get("oil") for row in rows)):
        for direction, shape in SHAPES.items():
            mine = np.array([r.get("oil") == oil and r.get("direction") == direction for r in rows])
            if mine.any():
                label = f"{oil}, direction {direction}"
                colour = COLOURS[i % len(COLOURS)]
                face = colour if direction == 1 else "none"
                panel.plot(x[mine], y[mine], shape, color=colour, markerfacecolor=face, markersize=5, label=label)


def warm_up(curves: Mapping[int, Mapping[str, np.ndarray]], rows: Rows) -> str:
    """Simulated temperatures over time of some tests, with the measured readings at the end of each half.

    Args:
        curves: test -> columns `time` [s] and temperatures [degC], the room's T_amb_C
        rows: readings with `test`, `time_s` and the measured temperatures
    """
    count = len(curves)
    across = min(count, 2)
    figure, panels = empty(12.0, 3.3 * -(-count // across) + 0.4, -(-count // across), across, sharex=True, sharey=True)
    names = [name for name in next(iter(curves.values())) if name not in ("time", "T_amb_C")]
    lines = {name: (name.removesuffix("_C"), COLOURS[i % len(COLOURS)]) for i, name in enumerate(names)}
    lines["T_amb_C"] = ("room", "#777777")
    for panel, (test, columns) in zip(panels, curves.items(), strict=False):
        mine = [row for row in rows if row["test"] == test]
        for name, (label, colour) in lines.items():
            if name not in columns:
                continue
            panel.plot(columns["time"] / 60, columns[name], color=colour, label=f"{label}, simulated")
            measured, times = numbers(mine, f"{name}_meas"), numbers(mine, "time_s") / 60
            if name != "T_amb_C" and np.isfinite(measured).any():
                panel.plot(times, measured, "o", color=colour, markerfacecolor="white", label=f"{label}, measured")
        panel.set_title(_test_title(mine, test))
        panel.set_ylabel("temperature [°C]")
        panel.set_xlabel("time [min]")
        panel.label_outer()
    for panel in panels[count:]:
        panel.set_visible(False)
    legend(figure, panels[0])
    return svg(figure)


def _test_title(rows: Rows, test: int) -> str:
    if not rows:
        return f"test {test}"
    first = rows[0]
    point = [f"{first[name]:g} {unit}" for name, unit in UNITS.items() if first.get(name) is not None]
    return f"test {test}: {', '.join([first['oil'], *point])}" if point else str(first["oil"])


def shares(row: Row, columns: Sequence[str]) -> str:
    """Bars of the single losses at one operating point."""
    figure, panels = empty(12.0, 0.45 * len(columns) + 1.0, 1, 1)
    values = [float(row[column]) for column in columns]
    names = [LOSSES.get(column, column) for column in columns]
    bars = panels[0].barh(names, values, color=COLOURS[0], height=0.6)
    panels[0].bar_label(bars, [f"{value:.3g} W" for value in values], padding=4)
    panels[0].invert_yaxis()
    panels[0].set_xlim(0, 1.12 * max(values) or 1.0)
    panels[0].set_xlabel("loss power [W]")
    panels[0].grid(False, axis="y")
    return svg(figure)


def breakdown(rows: Rows, columns: Sequence[str]) -> str:
    """Stacked bars of the computed losses of every test, one panel a direction, with the measured loss as a mark."""
    directions = [d for d in DIRECTIONS if any(row.get("direction") == d for row in rows)]
    figure, panels = empty(12.0, 3.2 * len(directions) + 0.4, len(directions), 1, sharex=True, sharey=True)
    for panel, direction in zip(panels, directions, strict=True):
        mine = [row for row in rows if row.get("direction") == direction]
        x, foot = np.arange(len(mine)), np.zeros(len(mine))
        for i, column in enumerate(columns):
            height = numbers(mine, column)
            label = LOSSES.get(column, column)
            panel.bar(x, height, bottom=foot, color=COLOURS[i % len(COLOURS)], label=label, width=0.75)
            foot = foot + height
        panel.plot(x, numbers(mine, "P_loss_W_meas"), "D", color="black", markerfacecolor="white", label="measured")
        panel.set_xticks(x, [str(row["test"]) for row in mine], fontsize=8)
        panel.set_xlim(-0.7, len(mine) - 0.3)
        panel.set(title=f"direction {DIRECTIONS[direction]}", ylabel="loss power [W]", xlabel="test")
        panel.grid(False, axis="x")
        panel.label_outer()
    legend(figure, panels[0])
    return svg(figure)
