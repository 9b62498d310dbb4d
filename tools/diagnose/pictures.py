"""The figures of a diagnosis, as SVG text: what the model gets wrong, before and after the extension."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from ...scenarios.measured import Campaign, Reading
from .. import plots
from .card import Card
from .findings import Findings

BEFORE, AFTER = plots.COLOURS[1], plots.COLOURS[0]
#: Channel -> what it is, unit.
CHANNELS = {
    "T_oil": ("oil", "K"),
    "T_oil2": ("oil, second probe", "K"),
    "T_wall": ("wall", "K"),
    "loss": ("loss", "N.m"),
}


#: More groups of readings than these have no line through their means.
MOST_GROUPS = 8


@dataclass(frozen=True)
class Axis:
    """Against what residuals are drawn: a number, or words side by side."""

    label: str
    value: Callable[[Reading], float | str]


AXES = (
    Axis("carrier speed [rpm]", lambda r: r.values["n_carrier_rpm"]),
    Axis("carrier torque [N.m]", lambda r: r.values["T_carrier_Nm"]),
    Axis("oil", lambda r: r.oil),
    Axis("direction", lambda r: plots.DIRECTIONS[r.direction]),
    Axis("running order", lambda r: float(r.order)),
)


def in_running_order(data: Campaign) -> list[Reading]:
    """The readings as the arrays of `Findings.rows` hold them."""
    return [reading for test in data.tests() for reading in test.halves]


def scatter(channel: str, card: Card) -> float:
    """Standard deviation of one reading of a channel against the model, by the card's repeatabilities."""
    if channel == "loss":
        return math.hypot(card.channel("T_carrier_Nm").repeat_sd, 4 * card.channel("T_sun_Nm").repeat_sd)
    return math.hypot(card.channel(f"{channel}_C").repeat_sd, card.channel("T_amb_C").repeat_sd)


def errors(findings: Findings) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Channel -> simulated less measured, before and after the extension (n, n)."""
    found = {}
    for channel, (measured, nominal, extended) in findings.rows.items():
        truth = np.asarray(measured, dtype=float)
        found[channel] = (np.asarray(nominal, dtype=float) - truth, np.asarray(extended, dtype=float) - truth)
    return found


def residuals(findings: Findings, data: Campaign, card: Card, *, extended: bool) -> str:
    """Simulated less measured of every channel against speed, torque, oil, direction and running order.

    Args:
        findings: with the readings of `data`
        data: the campaign
        card: accuracies, for the band that readings scatter in
        extended: whether there is an extension to show
    """
    readings = in_running_order(data)
    axes = [axis for axis in AXES if len({axis.value(r) for r in readings}) > 1]
    found = errors(findings)
    if not found or not axes:
        return ""
    figure, panels = plots.empty(12.0, 2.5 * len(found) + 0.6, len(found), len(axes), sharex="col", sharey="row")
    for i, (channel, (before, after)) in enumerate(found.items()):
        line = panels[i * len(axes) : (i + 1) * len(axes)]
        for panel, axis in zip(line, axes, strict=True):
            band = 2 * scatter(channel, card)
            panel.axhspan(-band, band, color="#eeeeee", zorder=0)
            panel.axhline(0, color="#888888", linewidth=1)
            x = _place(panel, axis, readings)
            shift = 0.12 if isinstance(axis.value(readings[0]), str) else 0.0
            for y, colour, word, side in sides(before, after, extended=extended):
                _drawn(panel, x + side * shift, y, readings, colour, word, hollow=side < 0)
                _trend(panel, x + side * shift, y, colour)
            panel.set_xlabel(axis.label)
            panel.label_outer()
        name, unit = CHANNELS.get(channel, (channel, ""))
        line[0].set_ylabel(f"{name}\nsimulated - measured [{unit}]")
    plots.legend(figure, panels[0])
    return plots.svg(figure)


def sides(before: np.ndarray, after: np.ndarray, *, extended: bool) -> list[tuple[np.ndarray, str, str, int]]:
    """What is drawn of a channel: values, colour, word, and to which side of its place."""
    if not extended:
        return [(before, AFTER, "calibrated model", 0)]
    return [(before, BEFORE, "before", -1), (after, AFTER, "after", 1)]


def _trend(panel: Axes, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """A line through the means of readings that stand close together, where there are several such groups."""
    order = np.argsort(x, kind="stable")
    gaps = np.diff(x[order]) > 0.05 * np.ptp(x)
    groups = np.split(order, np.flatnonzero(gaps) + 1)
    if 1 < len(groups) <= MOST_GROUPS:
        means = [(float(x[g].mean()), float(y[g].mean())) for g in groups]
        panel.plot(*zip(*means, strict=True), color=colour, linewidth=1.5)


def _place(panel: Axes, axis: Axis, readings: Sequence[Reading]) -> np.ndarray:
    """Places of the readings along an axis; words stand side by side."""
    values = [axis.value(reading) for reading in readings]
    if not isinstance(values[0], str):
        return np.array(values, dtype=float)
    known = list(dict.fromkeys(sorted(str(v) for v in values)))
    panel.set_xticks(range(len(known)), known)
    panel.set_xlim(-0.6, len(known) - 0.4)
    return np.array([float(known.index(str(v))) for v in values])


def _drawn(
    panel: Axes, x: np.ndarray, y: np.ndarray, readings: Sequence[Reading], colour: str, word: str, *, hollow: bool
) -> None:
    for direction, shape in plots.SHAPES.items():
        mine = np.array([r.direction == direction for r in readings])
        if mine.any():
            face = "none" if hollow else colour
            label = f"{word}, direction {plots.DIRECTIONS[direction]}"
            panel.plot(x[mine], y[mine], shape, color=colour, markerfacecolor=face, markersize=4.5, label=label)


def root_mean_squares(findings: Findings) -> Mapping[str, tuple[float, float]]:
    """Channel -> root mean square of simulated less measured, before and after, in sample."""
    return {c: (float(np.sqrt(np.mean(b**2))), float(np.sqrt(np.mean(a**2)))) for c, (b, a) in errors(findings).items()}
