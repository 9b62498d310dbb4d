"""What all static pictures share: style, colours, SVG text. Same values, same bytes."""

from __future__ import annotations

import io
import re
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

#: Colours that stay apart for colour-blind readers (Okabe and Ito 2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLE: Any = {
    "svg.hashsalt": "gearheat",
    "svg.fonttype": "path",
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}


def svg(figure: Figure) -> str:
    """A figure as SVG text without prolog and date."""
    text = io.StringIO()
    with mpl.rc_context(STYLE):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(r"^.*?(?=<svg)", "", text.getvalue(), flags=re.DOTALL)


def png(figure: Figure) -> bytes:
    """A figure as PNG without the name of a program."""
    data = io.BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(data, format="png", dpi=150, metadata={"Software": None})
    return data.getvalue()


def empty(width: float, height: float, rows: int, columns: int, **kwargs: Any) -> tuple[Figure, list[Axes]]:
    """An empty figure of so many inches, and its panels row by row."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False, **kwargs)
    return figure, list(panels.ravel())


def legend(figure: Figure, panel: Axes) -> None:
    """One legend under all panels, in as many columns as fit."""
    handles, labels = panel.get_legend_handles_labels()
    fit = int(figure.get_figwidth() / (0.6 + 0.07 * max(map(len, labels), default=0)))  # inches at this size of type
    columns = max(1, min(4 if len(labels) > 5 else 5, fit))
    with mpl.rc_context(STYLE):
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize=9)
