"""Files of pictures: an SVG, a PNG, or an HTML page with a table, and with courses that one can zoom."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup
from matplotlib.axes import Axes

from .console import write
from .drawing import png, svg
from .pages import OWN, as_data, html_table, load_plot_library, page
from .picture import Picture

#: Width and height of a figure that is made for a result [inch].
SIZE = (8.0, 4.5)


def write_picture(path: Path, picture: Picture) -> None:
    """Write a picture to a file whose ending says its kind, see `console.plottable`."""
    kind = path.suffix.lower()
    if kind == ".png":
        write(path, png(picture.figure))
        return
    drawn = svg(picture.figure)
    write(path, drawn if kind == ".svg" else _page(picture, drawn))


def _page(picture: Picture, drawn: str) -> str:
    return page(
        OWN,
        "plot.html",
        picture=picture,
        figure=Markup(drawn),
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
