"""Pictures of quantities: over time, over one that is varied, and as contours over two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ...model.units import from_si
from .drawing import COLOURS, empty, legend
from .picture import Picture

#: Panels in a row.
ACROSS = 3
#: Contours of a panel.
LEVELS = 9
#: Points of a course that a page holds, at most.
MOST = 3000
#: Units of time by the shortest run they are for [s].
UNITS = (("h", 3600.0, 36000.0), ("min", 60.0, 600.0), ("s", 1.0, 0.0))
#: Kinds of lines, one for each round of the colours.
LINES = ("-", "--", ":", "-.")


@dataclass(frozen=True)
class Field:
    """Values of one quantity at all points (n), nan where there is none, in the unit they are shown in."""

    name: str
    unit: str
    values: np.ndarray

    @property
    def title(self) -> str:
        """The name, with the unit where it has one."""
        return self.name if self.unit == "1" else f"{self.name} [{self.unit}]"


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
    for panel in panels[len(drawn) :]:
        panel.set_visible(False)
    ends = [(f.name, float(np.nanmin(f.values)), float(np.nanmax(f.values)), f.unit) for f in (*over, *drawn)]
    return Picture(figure, title, columns=("name", "low", "high", "unit"), rows=ends)


def _lines(panel: Axes, over: Sequence[Field], one: Field) -> None:
    order = np.argsort(over[0].values, kind="stable")
    panel.plot(over[0].values[order], one.values[order], "o-", markersize=3, color=COLOURS[0])


def _contours(panel: Axes, over: Sequence[Field], one: Field) -> None:
    """Contours between points, wherever they lie."""
    good = np.isfinite(one.values)
    x, y, values = over[0].values[good], over[1].values[good], one.values[good]
    panel.set_ylabel(over[1].title)
    if len(values) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        panel.text(0.5, 0.5, "too few points", transform=panel.transAxes, ha="center")
    elif np.ptp(values) <= 1e-9 * np.max(np.abs(values)):
        panel.text(0.5, 0.5, f"{values[0]:.4g} everywhere", transform=panel.transAxes, ha="center")
    else:
        low, high = values.min(), values.max()
        levels = [v for v in MaxNLocator(LEVELS + 1, min_n_ticks=1).tick_values(low, high) if low < v < high]
        panel.clabel(panel.tricontour(x, y, values, levels=levels, cmap="viridis"), fontsize=8)


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
