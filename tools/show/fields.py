"""Pictures of quantities: over time, over one that is varied, and as contours over two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import MaxNLocator

from ...model.units import from_si
from .drawing import COLOURS, empty, legend, marks_on
from .picture import Picture

#: Panels in a row.
ACROSS = 3
#: Steps between the ticks of the abscissa, at most: long numbers have room.
TICKS = 5
#: Contours of a panel.
LEVELS = 9
#: Points that a page holds of a course or a panel, at most.
MOST = 3000
#: Fills of a map by the unit of what it shows: light ones, as words stand on them.
FILLS = {"°C": "YlOrRd", "%": "YlGn", "W": "PuBu"}
#: What quantities are called, by the last word of their path.
NOUNS = {"w": "speed", "tau": "torque", "load": "load", "T": "temperature", "P_loss": "loss", "eta": "efficiency"}
#: Units of time by the shortest run they are for [s].
UNITS = (("h", 3600.0, 36000.0), ("min", 60.0, 600.0), ("s", 1.0, 0.0))
#: Kinds of lines, one for each round of the colours.
LINES = ("-", "--", ":", "-.")


@dataclass(frozen=True)
class Field:
    """Values of one quantity at all points (n), nan where there is none, in the unit they are shown in.

    Attributes:
        name: its path
        unit: of the values
        values: at all points
        point: value at the operating point, where it is known
        limit: value up to which the machine may run, where there is one
    """

    name: str
    unit: str
    values: np.ndarray
    point: float | None = None
    limit: float | None = None

    @property
    def sign(self) -> float:
        """-1 for a torque that only leaves the machine: it is drawn as a load."""
        return -1.0 if self.name.endswith(".tau") and np.nanmax(self.values) <= 0 else 1.0

    @property
    def scale(self) -> float:
        """What values are drawn in: loads without a sign, efficiencies in percent."""
        return 100.0 if self.name.endswith(".eta") else self.sign

    @property
    def shown_unit(self) -> str:
        """Unit of what is drawn."""
        return "%" if self.scale == 100.0 else {"degC": "°C", "1": ""}.get(self.unit, self.unit)

    @property
    def shown(self) -> np.ndarray:
        """Values as they are drawn."""
        return self.scale * self.values

    @property
    def title(self) -> str:
        """What it is in words, with the unit where it has one."""
        part, _, key = self.name.rpartition(".")
        noun = "load" if self.sign < 0 else NOUNS.get(key, key)
        words = noun if part in (noun, "efficiency") else f"{part} {noun}".strip()
        return " ".join([words.replace("_", " "), f"[{self.shown_unit}]" if self.shown_unit else ""]).strip()


def fields(title: str, over: Sequence[Field], drawn: Sequence[Field]) -> Picture:
    """A panel for each quantity that is drawn.

    Args:
        title: of the picture
        over: the one or two quantities that are varied
        drawn: the others, at the same points
    """
    across = min(len(drawn), ACROSS)
    down = -(-len(drawn) // across)
    figure, panels = empty(4.6 * across, 3.7 * down + 0.3, down, across)
    figure.suptitle(title)
    for panel, one in zip(panels, drawn, strict=False):
        (_lines if len(over) == 1 else _contours)(panel, over, one)
        panel.set(title=one.title, xlabel=over[0].title)
        panel.xaxis.set_major_locator(MaxNLocator(TICKS))
    for panel in panels[len(drawn) :]:
        panel.set_visible(False)
    marks = marks_on(
        figure, [told for panel, one in zip(panels, drawn, strict=False) for told in _told(panel, over, one)]
    )
    for panel in panels:
        _thin_labels(panel)
    ends = [(f.name, float(np.nanmin(f.values)), float(np.nanmax(f.values)), f.unit) for f in (*over, *drawn)]
    note = "Point at the picture to read values."
    note += " The cross is the operating point." if all(f.point is not None for f in over) else ""
    note += "".join(f" {_limit_words(f)}" for f in drawn if f.limit is not None)
    return Picture(figure, title, note, ("name", "low", "high", "unit"), ends, marks=marks)


def _limit_words(one: Field) -> str:
    """Where the limit is."""
    limit = f"limit of {one.limit:.4g} {one.shown_unit}"
    if one.limit is None or np.nanmin(one.shown) < one.limit < np.nanmax(one.shown):
        return f"The red line is the {limit}."
    return f"All points are {'within' if np.nanmax(one.shown) <= one.limit else 'beyond'} the {limit}."


def _thin_labels(panel: Axes) -> None:
    """Hide labels of contours that the panel's edge cuts or that lie over another or the operating point."""
    edge = panel.get_window_extent()
    kept = [line.get_window_extent().padded(6.0) for line in panel.lines]
    for word in panel.texts:
        box = word.get_window_extent()
        if edge.x0 <= box.x0 and edge.y0 <= box.y0 and box.x1 <= edge.x1 and box.y1 <= edge.y1:
            word.set_visible(not box.count_overlaps(kept))
        else:
            word.set_visible(False)
        kept += [box] if word.get_visible() else []


def _told(panel: Axes, over: Sequence[Field], one: Field) -> list[tuple[Axes, float, float, str]]:
    """What is said at the points of a panel."""
    good = np.flatnonzero(np.isfinite(one.values))
    good = good[:: max(1, -(-len(good) // MOST))]
    axes = [*over, one]
    words = ["\n".join(f"{f.title.partition(' [')[0]} {f.shown[i]:.4g} {f.shown_unit}" for f in axes) for i in good]
    places = over[1].shown if len(over) == 2 else one.shown
    points = zip(over[0].shown[good], places[good], words, strict=True)
    return [(panel, float(x), float(y), text) for x, y, text in points]


def _lines(panel: Axes, over: Sequence[Field], one: Field) -> None:
    order = np.argsort(over[0].shown, kind="stable")
    panel.plot(over[0].shown[order], one.shown[order], "o-", markersize=3, color=COLOURS[0])
    if one.limit is not None and np.nanmax(one.shown) > one.limit:
        panel.axhline(one.limit, color="#c00000")


def _contours(panel: Axes, over: Sequence[Field], one: Field) -> None:
    """Contours between points, wherever they lie, filled, with the operating point and the limit."""
    good = np.isfinite(one.values)
    x, y, values = over[0].shown[good], over[1].shown[good], one.shown[good]
    panel.set_ylabel(over[1].title)
    if len(values) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        panel.text(0.5, 0.5, "too few points", transform=panel.transAxes, ha="center")
        return
    if np.ptp(values) <= 1e-9 * np.max(np.abs(values)):
        panel.text(0.5, 0.5, f"{values[0]:.4g} everywhere", transform=panel.transAxes, ha="center")
        return
    low, high = values.min(), values.max()
    levels = [v for v in MaxNLocator(LEVELS + 1, min_n_ticks=1).tick_values(low, high) if low < v < high]
    panel.grid(False)
    panel.tricontourf(x, y, values, levels=[low, *levels, high], cmap=FILLS.get(one.shown_unit, "Purples"), alpha=0.8)
    lines = panel.tricontour(x, y, values, levels=levels, colors="#333333", linewidths=0.8)
    halo: list[AbstractPathEffect] = [withStroke(linewidth=2.5, foreground="white")]
    for word in panel.clabel(lines, fontsize=9, colors="black", inline=False):
        word.set_path_effects(halo)
    if one.limit is not None and low < one.limit < high:
        panel.tricontour(x, y, values, levels=[one.limit], colors="#c00000", linewidths=2.5)
    if (at := [f.point for f in over if f.point is not None])[1:]:
        panel.plot(
            at[0] * over[0].scale, at[1] * over[1].scale, "P", markersize=11, color="black", mec="white", mew=1.2
        )


def courses(title: str, time: np.ndarray, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> Picture:
    """The temperatures among the columns over time.

    Args:
        title: of the picture
        time: of the rows [s]; a time given twice is a jump
        columns: path -> values in SI
        units: SI unit of each column
    """
    unit, size, _ = next(u for u in UNITS if time[-1] - time[0] >= u[2])
    warm = {name: from_si(c, "K") for name, c in columns.items() if units[name] == "K"}
    figure, (panel,) = empty(12.0, 5.0 + 0.25 * (len(warm) // 4), 1, 1)
    colours = [COLOURS[i % len(COLOURS)] for i in range(len(warm))]
    for i, (name, values) in enumerate(warm.items()):
        panel.plot(time / size, values, LINES[i // len(COLOURS) % len(LINES)], color=colours[i], label=name)
    panel.set(title=title, xlabel=f"time [{unit}]", ylabel="temperature [°C]")
    legend(figure, panel)
    kept = np.unique(np.append(np.arange(0, len(time), max(1, -(-len(time) // MOST))), len(time) - 1))
    data = {
        "x": {"label": f"time [{unit}]", "values": np.round(time[kept] / size, 6).tolist()},
        "y": "temperature [°C]",
        "series": [
            {"label": name, "stroke": colours[i], "dashed": i >= len(COLOURS), "values": np.round(v[kept], 3).tolist()}
            for i, (name, v) in enumerate(warm.items())
        ],
    }
    ends = [(name, float(v[0]), float(v.min()), float(v.max()), float(v[-1])) for name, v in warm.items()]
    head = ("temperature [°C]", "first", "lowest", "highest", "last")
    return Picture(figure, title, "Drag to zoom, double-click to go back.", head, ends, data)
