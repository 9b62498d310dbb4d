"""Temperatures over time as a picture: lines, and the same for a page that zooms."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...model.units import from_si
from .drawing import COLOURS, empty, legend
from .picture import Picture

#: Points of a course that a page holds, at most.
MOST = 3000
#: Units of time by the shortest run they are for [s].
UNITS = (("h", 3600.0, 36000.0), ("min", 60.0, 600.0), ("s", 1.0, 0.0))
#: Kinds of lines, one for each round of the colours.
LINES = ("-", "--", ":", "-.")


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
