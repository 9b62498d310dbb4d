"""One self-contained HTML page about a diagnosis: what is wrong, what to do, how big, how sure, then the evidence.

Its static pictures are SVG text.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from ...show import pages
from ...show.drawing import COLOURS, empty, legend, svg
from ..answer.channels import levels
from ..answer.evidence import Picture, Rows, View
from ..answer.findings import Findings
from ..answer.numbers import Array
from . import phrases, tables
from .phrases import name_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Least probability of a bar.
LITTLE = 0.01
#: Readings of the interactive plot, at most.
MOST = 5000
#: Colour of residuals of the nominal rig.
BEFORE = COLOURS[1]
#: Colour of residuals of the extended rig.
AFTER = COLOURS[0]
#: Direction -> its mark and its name.
MARKS = {1: ("o", "direction +1"), -1: ("^", "direction -1"), 0: ("s", "")}
#: Readings that are drawn in a static picture, at most.
DRAWN = 600
#: More than these groups of readings have no line through their means.
GROUPS = 8
#: Readings with no gap of this share of their range between them are a group.
CLOSE = 0.05
#: Values of a quantity that each have a tick.
FEW = 3


def render(findings: Findings) -> str:
    """The page as HTML text, the same bytes for the same findings."""
    return pages.page(
        "gearheat.tools.diagnose.report",
        "diagnosis.html",
        findings=findings,
        said=findings.says,
        about=findings.about,
        bars=_bars(findings),
        pictures=[_picture(findings, p) for p in findings.pictures],
        overview=Markup(overview(findings)),
        views=Markup(views(findings.views)),
        gain=f"{phrases.gain(findings.gain)}." if findings.gain else "",
        doubt=phrases.doubt(findings),
        **{name: _sections(made(findings)) for name, made in tables.SECTIONS.items()},
        plot=_data(findings),
        **pages.load_plot_library(),
    )


def _sections(found: Sequence[tables.Table]) -> list[dict[str, Any]]:
    return [{"title": t.title, "note": t.note, "table": pages.html_table(t.columns, t.rows)} for t in found if t.rows]


def _bars(findings: Findings) -> list[dict[str, str]]:
    """Probabilities of the causes, and what else may be."""
    rest = max(0.0, 1.0 - sum(h.probability for h in findings.hypotheses))
    listed = tables.list_causes(findings)
    rows = [(name_of(c.id), c.id, c.probability, c.mc_error) for c in listed]
    if further := [c for c in findings.causes if c not in listed and c.probability >= LITTLE]:
        words = f"each of {len(further)} further causes at most" if len(further) > 1 else "1 further cause"
        rows.append((words, "", max(c.probability for c in further), 0.0))
    rows += [("nothing wrong", "", findings.nothing, 0.0), ("less probable than those listed", "", rest, 0.0)]
    return [
        {"name": name, "id": id, "percent": phrases.percent(p, error), "width": f"{100 * min(p, 1.0):.1f}"}
        for name, id, p, error in rows
        if p >= LITTLE
    ]


def _picture(findings: Findings, found: Picture) -> dict[str, Any]:
    """A picture of a cause and the sentences beside it."""
    told: dict[str, Any] = {"name": name_of(found.cause), "svg": Markup(svg(picture(findings, found)))}
    if cause := findings.cause(found.cause):
        size = ", ".join(filter(None, (phrases.size(cause), phrases.where(cause, findings.channels))))
        told |= {"size": size, "doc": cause.doc, "percent": phrases.percent(cause.probability, cause.mc_error)}
    return told


def _data(findings: Findings) -> Markup:
    """What the interactive plot shows, as JSON that may stand in a page."""
    rows = findings.rows
    every = slice(None, None, max(1, -(-len(rows.row) // MOST)))
    if not rows.channels or not rows.quantities:
        return Markup("")
    channels = {}
    for name, values in rows.channels.items():
        known = findings.channel(name)
        models = {word: _left(values.measured, model)[every] for model, _, word in sides(values)}
        channels[name] = {"unit": known.difference if known else "", "sd": values.sd, "left": models}
    quantities = {
        key: {"label": q.label, "unit": phrases.SHOWN.get(q.unit, q.unit), "values": q.values[every]}
        for key, q in rows.quantities.items()
    }
    rest = {"row": rows.row[every], "test": rows.test[every], "direction": rows.direction[every]}
    return pages.as_data(rest | {"channels": channels, "quantities": quantities})


def _left(measured: Sequence[float | None], model: Sequence[float | None]) -> list[float | None]:
    pairs = zip(measured, model, strict=True)
    return [None if m is None or s is None else float(f"{m - s:.4g}") for m, s in pairs]


def picture(findings: Findings, found: Picture) -> Figure:
    """What is left in a channel against the quantity that a cause acts on, without and with the cause."""
    quantity = findings.rows.quantities[found.quantity]
    direction = findings.rows.direction
    sd = rows.sd if (rows := findings.rows.channels.get(found.channel)) else None
    figure, panels = empty(10.0, 3.4, 1, 2, sharex=True, sharey=True)
    sides = (("without this cause", found.before, BEFORE), ("with this cause", found.after, AFTER))
    for panel, (title, values, colour) in zip(panels, sides, strict=True):
        _band(panel, sd)
        _residuals(panel, _numbers(quantity.values), _numbers(values), direction, colour)
        panel.set_title(title)
        _along(panel, quantity)
    panels[0].set_ylabel(_ordinate(findings, found.channel))
    if len(set(direction)) > 1:
        panels[0].legend(fontsize=8)
    return figure


def overview(findings: Findings) -> str:
    """What is left in every channel against every quantity, before and after; empty without readings."""
    rows = findings.rows
    axes = [q for q in rows.quantities.values() if len(set(q.values) - {None}) > 1]
    if not rows.channels or not axes:
        return ""
    size = max(3.0 * len(axes), 5.0), 2.4 * len(rows.channels) + 0.4
    figure, panels = empty(*size, len(rows.channels), len(axes), sharex="col", sharey="row")
    for i, (name, values) in enumerate(rows.channels.items()):
        line = panels[i * len(axes) : (i + 1) * len(axes)]
        for panel, axis in zip(line, axes, strict=True):
            _band(panel, values.sd)
            for model, colour, word in sides(values):
                left = _numbers(values.measured) - _numbers(model)
                _residuals(panel, _numbers(axis.values), left, rows.direction, colour, word)
            _along(panel, axis)
            panel.label_outer()
        line[0].set_ylabel(_ordinate(findings, name))
    legend(figure, panels[0])
    return svg(figure)


def sides(values: Rows.Values) -> list[tuple[Array, str, str]]:
    """The models that readings are compared with: values, colour, word."""
    both = [(values.nominal, BEFORE, "calibrated model"), (values.extended, AFTER, "with the causes")]
    return both if values.extended else both[:1]


def views(found: Sequence[View]) -> str:
    """Deviation of each channel from what the others imply, in running order; empty where none has any."""
    drawn = [v for v in found if v.deviation]
    if not drawn:
        return ""
    figure, panels = empty(10.0, 2.2 * len(drawn) + 0.4, len(drawn), 1, sharex=True)
    for panel, view in zip(panels, drawn, strict=True):
        _residuals(panel, _numbers(view.order), _numbers(view.deviation), view.direction, COLOURS[0])
        panel.set_ylabel(f"{view.channel} [{phrases.SHOWN.get(view.unit, view.unit)}]")
        panel.set_title(view.asks)
    panels[-1].set_xlabel("running order")
    if len(set(drawn[0].direction)) > 1:
        panels[0].legend(fontsize=8)
    return svg(figure)


def _band(panel: Axes, sd: float | None) -> None:
    """Two standard deviations to either side."""
    if sd is not None:
        panel.axhspan(-2 * sd, 2 * sd, color="#eeeeee", zorder=0)


def _residuals(panel: Axes, x: np.ndarray, y: np.ndarray, direction: Array, colour: str, word: str = "") -> None:
    """Points by direction, where there is any, and a line through the means of groups."""
    panel.axhline(0, color="#888888", linewidth=1)
    ways = np.array(direction or [0] * len(x))
    drawn = (np.arange(len(x)) % -(-len(x) // DRAWN) == 0) & np.isfinite(x) & np.isfinite(y)
    for way, (mark, name) in MARKS.items():
        mine = drawn & (ways == way)
        if mine.any():
            label = ", ".join(filter(None, (word, name)))
            face = colour if way >= 0 else "none"
            panel.plot(x[mine], y[mine], mark, color=colour, markerfacecolor=face, markersize=4, label=label)
    _trend(panel, x, y, colour)


def _trend(panel: Axes, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """A line through the means of readings that stand close together, where there are a few such groups."""
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    groups = levels(x, CLOSE) if len(x) else []
    if 1 < len(groups) <= GROUPS:
        panel.plot([x[g].mean() for g in groups], [y[g].mean() for g in groups], color=colour, linewidth=1.5)


def _along(panel: Axes, quantity: Rows.Quantity) -> None:
    """Label of the axis; a tick for each value where there are but a few."""
    unit = phrases.SHOWN.get(quantity.unit, quantity.unit)
    panel.set_xlabel(f"{quantity.label} [{unit}]" if unit else quantity.label)
    places = sorted({v for v in quantity.values if v is not None})
    if len(places) <= FEW:
        panel.set_xticks(places)
        panel.margins(x=0.25)


def _ordinate(findings: Findings, name: str) -> str:
    channel = findings.channel(name)
    return f"{name}\nmeasured - simulated{f' [{channel.difference}]' if channel else ''}"


def _numbers(values: Sequence[float | None]) -> np.ndarray:
    return np.array(values, dtype=float)  # None becomes NaN
