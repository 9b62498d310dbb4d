"""One self-contained HTML page about a campaign: how close, where wrong, what the model is made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes

from ...model.core.flat import FlatModel
from ...model.run.result import Outside
from ...model.sources import LawInfo, sources
from ...scenarios.scenario import Scenario
from ..describe import description as describe
from ..show.drawing import COLOURS, empty, hovering, legend, marks_on, svg
from ..show.notes import unchecked_lines
from ..show.pages import html_table, page
from ..show.picture import Picture
from .errors import GROUPINGS, Channel, Comparison, Row, Rows, Score, channels_of, distinct, errors, numbers, present
from .opening import opening
from .results import NOISE, error_lines, group_lines

#: Columns of the table of all readings.
READING = ("point", "test", "direction", "oil", "n_set_rpm", "T_set_Nm", "T_amb_C")
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


def render(
    scenario: Scenario,
    flat: FlatModel,
    found: Mapping[str, Any],
    comparison: Comparison | None,
    scores: Sequence[Score],
    *,
    curves: Mapping[int, Mapping[str, np.ndarray]],
    outside: Sequence[Outside],
    machine: Picture | None = None,
) -> str:
    """The page as HTML text, the same bytes for the same run. Without a comparison it shows the simulation alone.

    Args:
        scenario: the rig
        flat: its model
        found: the JSON object of the run
        comparison: of its readings
        scores: of statistical rivals
        curves: some tests over time, columns as in `warm_up`
        outside: laws that were used outside their range
        machine: drawing of the gearbox
    """
    rows, laws = found["rows"], describe.cite_laws(flat)
    parameters = describe.parameters(scenario, flat)
    errata = [(e.place, e.says, e.should_be, e.evidence) for e in scenario.errata]
    return page(
        "gearheat.tools.compare",
        "report.html",
        rig=scenario,
        found=found,
        compared=None if comparison is None else _describe_errors(scenario.name, rows, comparison, scores),
        machine=Markup("") if machine is None else hovering(machine.figure, machine.marks),
        tests=len({row["test"] for row in rows}),
        warm_up=Markup(warm_up(curves, rows)) if curves else "",
        breakdown=_breakdown(rows, [c for c in scenario.losses if c.startswith("P_") and c != "P_total_W"]),
        laws=_laws(laws),
        cited=len(laws),
        unverified=[law.name for law in laws if not law.verified],
        outside=_outside(outside),
        unchecked=unchecked_lines(found["unchecked"]),
        values=len(parameters),
        parameters=html_table(("parameter", "value", "source"), parameters),
        errata=html_table(("place", "says", "should be", "evidence"), errata),
        rows=_readings(rows),
    )


def _breakdown(rows: Rows, losses: Sequence[str]) -> Markup:
    """Losses of every test, or of the one point there is."""
    if not losses:
        return Markup("")
    return Markup(shares(rows[0], losses) if len(rows) == 1 else breakdown(rows, losses))


def _describe_errors(rig: str, rows: Rows, comparison: Comparison, scores: Sequence[Score]) -> dict[str, Any]:
    """What the page says about measured values."""
    channels = present(rows)
    noise = comparison.noise_floor
    simulated = [numbers(rows, c.column) for c in channels]
    drawn = [  # two sensors may read one temperature of the model
        c for k, c in enumerate(channels) if not any(np.array_equal(simulated[k], other) for other in simulated[:k])
    ]
    head, lines = error_lines(comparison, scores)
    own = 1 + next(k for k, line in enumerate(lines) if line[0] == NOISE)
    return {
        "opening": opening(rig, comparison),
        "scores": scores,
        "noise": noise,
        "repeated": ", ".join("/".join(str(t) for t in tests) for tests in noise["repeated"]) or "none",
        "summary": html_table(head, lines[:own], ours=0),
        "rivals": html_table(head, lines[own:]) if lines[own:] else "",
        "parity": parity(rows, drawn),
        "residuals": residuals(rows, channels, noise),
        "groups": html_table(*group_lines(comparison)),
    }


def _laws(laws: Sequence[LawInfo]) -> Markup:
    known = sources()
    body = []
    for law in laws:
        source = known.get(law.source)
        cited = source.cited if source else law.source
        body.append((law.name, cited, law.where, law.valid, "verified" if law.verified else "unverified"))
    return html_table(("law", "source", "place", "valid", "against print"), body)


def _outside(outside: Sequence[Outside]) -> Markup:
    body = [(o.law, o.component, o.argument, o.low, o.high, o.lowest, o.highest, o.regime) for o in outside]
    head = ("law", "part", "argument", "valid from", "to", "met from", "to", "regime there")
    return html_table(head, body) if body else Markup("")


def _readings(rows: Rows) -> Markup:
    columns = [c.column for c in channels_of(rows)]
    head = [*READING, *(name for column in columns for name in (column, f"{column}_meas"))]
    head = [name for name in head if any(name in row for row in rows)]
    return html_table(head, [[row.get(name) for name in head] for row in rows])


def shown_unit(channel: Channel) -> str:
    """The unit of a channel's values; its errors have `channel.unit`."""
    return "°C" if channel.unit == "K" else channel.unit


def parity(rows: Rows, channels: Sequence[Channel]) -> Markup:
    """Measured against simulated, one panel a channel, coloured by oil, shaped by direction; points tell tests."""
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
    told: list[tuple[Axes, float, float, str]] = []
    for panel, channel in zip(panels, channels, strict=True):
        told += _tell(panel, rows, channel, numbers(rows, channel.column), numbers(rows, channel.measured))
    return hovering(figure, marks_on(figure, told))


def _tell(
    panel: Axes, rows: Rows, channel: Channel, x: np.ndarray, y: np.ndarray
) -> list[tuple[Axes, float, float, str]]:
    """Each reading that is drawn, at its place, in words."""
    return [(panel, a, b, _point(row, channel)) for row, a, b in zip(rows, x, y, strict=True) if np.isfinite(a + b)]


def _point(row: Row, channel: Channel) -> str:
    """A reading in words: its test, its operating point, simulated and measured."""
    simulated, measured = row[channel.column], row[channel.measured]
    point = [f"{row[name]:g} {unit}" for name, unit in UNITS.items() if row.get(name) is not None]
    test = [f"test {row['test']}"] if "test" in row else []
    where = ", ".join([*test, *([str(row["oil"])] if row.get("oil") else []), *point])
    unit = shown_unit(channel)
    return f"{where}\n{channel.label} {simulated:.4g} {unit} simulated, {measured:.4g} {unit} measured"


def residuals(rows: Rows, channels: Sequence[Channel], noise: Mapping[str, Any]) -> Markup:
    """Simulated minus measured, one line of panels a channel, against speed, torque, oil and direction.

    A band, where the channel has a noise floor, is two of them wide to either side; points tell tests.
    """
    known = ("n_set_rpm", "T_set_Nm", "oil", "direction")
    groupings = [by for by in known if any(row.get(by) is not None for row in rows)]
    figure, panels = empty(12.0, 2.7 * len(channels) + 0.8, len(channels), len(groupings), sharex="col", sharey="row")
    told: list[tuple[Axes, float, float, str]] = []
    for i, channel in enumerate(channels):
        line = panels[i * len(groupings) : (i + 1) * len(groupings)]
        for panel, by in zip(line, groupings, strict=True):
            told += _residual(panel, rows, channel, by, noise.get(channel.key))
            panel.label_outer()
        line[0].set_ylabel(f"{channel.label}\nsimulated - measured [{channel.unit}]")
    legend(figure, panels[0])
    return hovering(figure, marks_on(figure, told))


def _residual(
    panel: Axes, rows: Rows, channel: Channel, by: str, noise: float | None
) -> list[tuple[Axes, float, float, str]]:
    """One panel: errors of a channel over the groups of one grouping, side by side where they share a group.

    Returns:
        what its points tell
    """
    panel.axhline(0, color="#888888", linewidth=1)
    if noise is not None:
        panel.axhspan(-2 * noise, 2 * noise, color="#eeeeee", zorder=0)
    values = [row.get(by) for row in rows]
    known = distinct(values)
    x = np.array([math.nan if v is None else known.index(v) for v in values]) + _spread(rows, by)
    y = errors(rows, channel)
    _scatter(panel, rows, x, y)
    words = {"direction": DIRECTIONS}.get(by, {})
    panel.set_xticks(range(len(known)), [words.get(v, f"{v:g}" if by in UNITS else str(v)) for v in known])
    panel.set_xlim(-0.6, len(known) - 0.4)
    panel.set_xlabel(f"{GROUPINGS[by]} [{UNITS[by]}]" if by in UNITS else GROUPINGS[by])
    return _tell(panel, rows, channel, x, y)


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
