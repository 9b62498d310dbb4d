"""Figures of the verification, as SVG text: the same bytes for the same results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from ...show.drawing import COLOURS, STYLE, empty, svg
from .pages import Row
from .rows import Found

#: Items whose references are films.
FILMS = ("Hamrock and Dowson", "Nijenbanning, Venner and Moes", "Line contact")
MARKS = "osD^v<>"


def films(table: Sequence[Row]) -> str:
    """Ours over reference for every row whose reference is a film, one panel an item."""
    items = [item for item in FILMS if _of(table, item)]
    figure, panels = empty(4.2 * max(len(items), 1), 4.2, 1, max(len(items), 1))
    for panel, item in zip(panels, items, strict=False):
        mine = [row for row in _of(table, item) if row["tolerance"]]
        values = [v for row in mine for v in (row["reference"], row["ours"])]
        low, high = 0.9 * min(values), 1.1 * max(values)
        ends, rel = np.array([low, high]), float(mine[0]["tolerance"])
        panel.fill_between(ends, ends * (1 - rel), ends * (1 + rel), color="#eeeeee", label=f"{100 * rel:g} %")
        panel.plot(ends, ends, color="#888888", linewidth=1)
        for i, quantity in enumerate(dict.fromkeys(row["quantity"] for row in mine)):
            points = [(row["reference"], row["ours"]) for row in mine if row["quantity"] == quantity]
            panel.plot(*zip(*points, strict=True), MARKS[i], color=COLOURS[i], markersize=4, label=quantity)
        _logarithmic(panel, title=item, xlabel="reference", ylabel="this solver")
        panel.set(xlim=(low, high), ylim=(low, high))
        if high > 10 * low:  # ticks between the decades have no room for numbers
            for axis in (panel.xaxis, panel.yaxis):
                axis.set_minor_formatter(NullFormatter())
        _legend(panel)
    return svg(figure)


def _of(table: Sequence[Row], item: str) -> list[Row]:
    return [row for row in table if row["item"] == item]


def _logarithmic(panel: Axes, **words: str) -> None:
    with mpl.rc_context(STYLE):
        panel.set(xscale="log", yscale="log", **words)


def _legend(panel: Axes) -> None:
    with mpl.rc_context(STYLE):
        panel.legend(fontsize=8)


def convergence(found: Mapping[str, Found]) -> str:
    """Differences between successive grids over the distance of nodes, one panel a contact."""
    figure, panels = empty(5.2 * len(found), 4.2, 1, len(found), sharey=True)
    for panel, (name, study) in zip(panels, found.items(), strict=True):
        spacing = np.array(study["spacing"][:-1])
        for i, (what, apart) in enumerate(study["apart"].items()):
            panel.plot(spacing, apart, f"-{MARKS[i]}", color=COLOURS[i % len(COLOURS)], markersize=4, label=what)
        top = max(values[0] for values in study["apart"].values())
        panel.plot(spacing, top * (spacing / spacing[0]) ** 2, "--", color="#888888", label="second order")
        _logarithmic(panel, title=name, xlabel="distance of nodes over a", ylabel="change on the next finer grid")
        _legend(panel)
    return svg(figure)


def cost(study: Found) -> str:
    """Processor time per unknown over the number of nodes a side."""
    figure, panels = empty(5.2, 3.6, 1, 1)
    each = np.array(study["us_per_unknown"])
    panels[0].plot(study["nodes"], each / each[0], "-o", color=COLOURS[0])
    with mpl.rc_context(STYLE):
        panels[0].set_xscale("log", base=2)
        panels[0].set_xticks(study["nodes"], [str(n) for n in study["nodes"]])
        panels[0].minorticks_off()
    panels[0].set_ylim(0, 1.15 * float((each / each[0]).max()))
    panels[0].set(xlabel="nodes a side", ylabel=f"cost per unknown over that on {study['nodes'][0]}²")
    return svg(figure)


def shape(study: Found) -> str:
    """Film over the plane as lines of equal film, and film and pressure along the middle."""
    figure, panels = empty(10.4, 4.0, 1, 2)
    x, y, p, h = (np.array(study[k]) for k in ("x", "y", "p", "h"))
    levels = [0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0]
    with mpl.rc_context(STYLE):
        lines = panels[0].contour(x, y, h.T, levels, cmap="viridis", linewidths=0.8)
        panels[0].clabel(lines, [0.8, 1.0, 1.2, 2.0], fontsize=7)
    panels[0].set(xlim=(-2, 1.5), ylim=(-1.5, 1.5), aspect="equal", xlabel="x/a", ylabel="y/a", title="film over h_c")
    middle = len(y) // 2
    panels[1].plot(x, h[:, middle], color=COLOURS[0], label="film over h_c")
    panels[1].plot(x, p[:, middle], color=COLOURS[1], label="pressure over Hertz'")
    dry = np.sqrt(np.maximum(1 - x**2, 0.0))
    panels[1].plot(x, dry, color="#888888", linewidth=1, linestyle="--", label="Hertz")
    panels[1].set(xlim=(-2, 1.5), ylim=(0, 3), xlabel="x/a", title="in the middle, y = 0")
    _legend(panels[1])
    return svg(figure)


def dent(found: Mapping[str, Found]) -> str:
    """Place of what a dent brings into the film over time, and films along the middle, one line of panels a case."""
    figure, panels = empty(10.4, 3.6 * len(found), len(found), 2)
    for i, (name, study) in enumerate(found.items()):
        place, film = panels[2 * i], panels[2 * i + 1]
        moments = np.array(study["moments"])
        near = [-1.6 < at < 0.9 for at in study["dent"]]  # of the dent: else there is nothing to see
        seen = [at if at is not None and seen else np.nan for at, seen in zip(study["places"], near, strict=True)]
        place.plot(moments, study["dent"], color="#888888", label="the dent itself")
        place.plot(moments, seen, "o", color=COLOURS[0], markersize=3, label="largest change of the film")
        place.set(title=name, xlabel="time, u_m t/a", ylabel="x/a", ylim=(-1.2, 1.2))
        film.plot(study["x"], study["smooth"], color="#888888", linestyle="--", label="smooth")
        shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, len(study["films"])))
        for shade, moment, line in zip(shades, study["shown"], study["films"], strict=True):
            film.plot(study["x"], line, color=shade, linewidth=1, label=f"u_m t/a = {moment:.2f}")
        film.set(xlim=(-1.5, 1.2), ylim=(0, 2), xlabel="x/a", ylabel="film over h_c, y = 0")
        _legend(place)
        _legend(film)
    return svg(figure)


def cycle(study: Found, bands: Mapping[str, tuple[float, float]]) -> str:
    """A mesh cycle: load, film, specific film thickness and asperity share over the angle, and pressures.

    Args:
        study: what was computed
        bands: the article's bands of "ratio" and "share"
    """
    figure, panels = empty(12.0, 7.2, 2, 3)
    angles = study["angles"]
    labels = {"load": "load [kN/m]", "ratio": "h_c/sigma", "share": "share of the load on asperities"}
    for panel, key in zip((panels[0], panels[2], panels[3]), labels, strict=True):
        panel.plot(angles, study[key], "-o", color=COLOURS[0], markersize=3, label="this solver")
        if key in bands:
            panel.axhspan(*bands[key], color="#f3d9c9", label="the article")
        panel.set(xlabel="angle of the pin [deg]", ylabel=labels[key])
        _legend(panel)
    for i, (key, label) in enumerate((("transient", "transient"), ("steady", "steady"), ("regression", "formula"))):
        panels[1].plot(angles, study[key], "-", color=COLOURS[i], label=label)
    panels[1].set(xlabel="angle of the pin [deg]", ylabel="central film [nm]")
    _legend(panels[1])
    for i, profile in enumerate(study["profiles"]):
        panels[4].plot(profile["x"], profile["p"], color=COLOURS[i], label=f"{profile['angle']:.0f} deg")
    reach = 1.5 * max(abs(v) for p in study["profiles"] for v, q in zip(p["x"], p["p"], strict=True) if q > 0.2)
    panels[4].set(xlim=(-reach, reach), xlabel="x [um]", ylabel="pressure [GPa]")
    _legend(panels[4])
    panels[5].set_visible(False)
    return svg(figure)
