"""What all static pictures share: style, colours, files (SVG, PNG, or a page that zooms). Same values, same bytes."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from markupsafe import Markup

from .console import write
from .pages import OWN, as_data, html_table, load_plot_library, page
from .picture import Mark, Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours that stay apart for colour-blind readers (Okabe and Ito 2008).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
#: What all pictures have alike.
STYLE: Any = mpl.rc_params_from_file(Path(__file__).with_name("pictures.mplstyle"), use_default_template=False)
#: Width and height of a figure that is made for a result [inch].
SIZE = (8.0, 4.5)


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
    from matplotlib.figure import Figure  # it loads slowly, and most results are not drawn

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


def marks_on(figure: Figure, told: Iterable[tuple[Axes, float, float, str]]) -> list[Mark]:
    """Places on panels, in their own coordinates, with what a page says there, as shares of the finished figure."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out: it takes as long as to draw
    back = figure.transFigure.inverted()
    places = [(*(panel.transData + back).transform((x, y)), words) for panel, x, y, words in told]
    return [(round(float(x), 4), round(1 - float(y), 4), words) for x, y, words in places]


def hovering(figure: Figure, marks: Iterable[Mark]) -> Markup:
    """A figure as SVG that says its marks beside the pointer, on pages that have the script `hover.js`."""
    return Markup('<div class="hover" data-marks="{}">{}<output></output></div>').format(
        json.dumps(list(marks), ensure_ascii=False), Markup(svg(figure))
    )


def write_picture(path: Path, picture: Picture) -> None:
    """Write a picture to a file whose ending says its kind, see `console.plottable`."""
    kind = path.suffix.lower()
    if kind == ".png":
        write(path, png(picture.figure))
        return
    write(path, svg(picture.figure) if kind == ".svg" else _page(picture))


def _page(picture: Picture) -> str:
    return page(
        OWN,
        "plot.html",
        picture=picture,
        figure=hovering(picture.figure, picture.marks),
        table=html_table(picture.columns, picture.rows) if picture.rows else "",
        data=as_data(picture.courses) if picture.courses else "",
        **load_plot_library(),
    )


def axes_or_new(axes: Axes | None) -> Axes:
    """Axes to draw on: those given, else those of a new figure."""
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.figure(figsize=SIZE, layout="constrained").add_subplot()
