"""Pictures of quantities over what is varied: lines over one, contours over two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from .drawing import COLOURS, empty
from .picture import Picture

#: Panels in a row.
ACROSS = 3
#: Contours of a panel.
LEVELS = 9


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
