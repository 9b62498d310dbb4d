"""One self-contained HTML page about a diagnosis: what is wrong, what to do, how big, how sure, then the evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from ...show import pages
from ..answer.evidence import Picture
from ..answer.findings import Findings
from . import figures, phrases, tables
from .phrases import name_of

#: Least probability of a bar.
LITTLE = 0.01
#: Readings of the interactive plot, at most.
MOST = 5000


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
        overview=Markup(figures.overview(findings)),
        views=Markup(figures.views(findings.views)),
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
        most = max(c.probability for c in further)
        rows.append((f"each of {len(further)} further causes at most", "", most, 0.0))
    if findings.remainder is not None:
        rows.append(("something outside the library", "", findings.remainder.probability, findings.remainder.mc_error))
    rows += [("nothing wrong", "", findings.nothing, 0.0), ("less probable than those listed", "", rest, 0.0)]
    return [
        {"name": name, "id": id, "percent": phrases.percent(p, error), "width": f"{100 * min(p, 1.0):.1f}"}
        for name, id, p, error in rows
        if p >= LITTLE
    ]


def _picture(findings: Findings, found: Picture) -> dict[str, Any]:
    """A picture of a cause and the sentences beside it."""
    told: dict[str, Any] = {"name": name_of(found.cause), "svg": Markup(figures.picture(findings, found))}
    if cause := findings.cause(found.cause):
        size = ", ".join(filter(None, (phrases.size(cause), phrases.where(cause))))
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
        models = {word: _left(values.measured, model)[every] for model, _, word in figures.sides(values)}
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
