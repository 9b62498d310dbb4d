"""One self-contained HTML page about a campaign: how close, where wrong, what the model is made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from ...model.run.result import Outside
from ...model.sources import LawInfo, sources
from ..show.console import cell
from ..show.pages import page
from . import plots
from .errors import Comparison, Rows, measured, numbers, present
from .rivals import Score
from .summary import error_lines, group_lines


@dataclass(frozen=True)
class Study:
    """A campaign that was simulated.

    Attributes:
        rig, doc: name and description of the rig
        fmu: file name of the FMU that was played
        rows: the readings, simulated and measured
        curves: some tests over time, columns as in `plots.warm_up`
        loss_columns: columns of `rows` that are the single losses
        laws, outside: what the model cites, and what it used outside its range
        parameters: (name, value with unit, source)
        unchecked: catalogue entries in use, and which of their values were never checked against a print
        errata: (source and place, what it says, what it should be, evidence)
        energy_residual_max: largest violation of the energy balance over the throughput
    """

    rig: str
    doc: str
    fmu: str
    rows: Rows
    curves: Mapping[int, Mapping[str, np.ndarray]]
    loss_columns: tuple[str, ...]
    laws: tuple[LawInfo, ...]
    outside: tuple[Outside, ...]
    parameters: tuple[tuple[str, str, str], ...]
    unchecked: tuple[str, ...]
    errata: tuple[tuple[str, str, str, str], ...]
    energy_residual_max: float


#: Columns of the table of all readings.
READING = ("point", "test", "direction", "oil", "n_set_rpm", "T_set_Nm", "T_amb_C")


def render(study: Study, comparison: Comparison | None, scores: Sequence[Score]) -> str:
    """The page as HTML text, the same bytes for the same study. Without a comparison it shows the simulation alone."""
    return page(
        "gearheat.tools.compare",
        "report.html",
        study=study,
        compared=None if comparison is None else _compared(study.rows, comparison, scores),
        tests=len({row["test"] for row in study.rows}),
        warm_up=Markup(plots.warm_up(study.curves, study.rows)) if study.curves else "",
        breakdown=_breakdown(study),
        laws=_laws(study.laws),
        unverified=[law.name for law in study.laws if not law.verified],
        outside=_outside(study.outside),
        parameters=html_table(("parameter", "value", "source"), study.parameters, text=(2,)),
        errata=html_table(("place", "says", "should be", "evidence"), study.errata, text=(1, 2, 3)),
        rows=_readings(study.rows),
    )


def _breakdown(study: Study) -> Markup:
    """Losses of every test, or of the one point there is."""
    if not study.loss_columns:
        return Markup("")
    if len(study.rows) == 1:
        return Markup(plots.shares(study.rows[0], study.loss_columns))
    return Markup(plots.breakdown(study.rows, study.loss_columns))


def _compared(rows: Rows, comparison: Comparison, scores: Sequence[Score]) -> dict[str, Any]:
    """What the page says about measured values."""
    channels = present(rows)
    noise = comparison.noise_floor
    simulated = [numbers(rows, c.column) for c in channels]
    drawn = [  # two sensors may read one temperature of the model
        c for k, c in enumerate(channels) if not any(np.array_equal(simulated[k], other) for other in simulated[:k])
    ]
    return {
        "scores": scores,
        "noise": noise,
        "repeated": ", ".join("/".join(str(t) for t in tests) for tests in noise["repeated"]) or "none",
        "summary": html_table(*error_lines(comparison, scores), ours=0),
        "parity": Markup(plots.parity(rows, drawn)),
        "residuals": Markup(plots.residuals(rows, channels, noise)),
        "groups": html_table(*group_lines(comparison)),
    }


def html_table(head: Sequence[str], body: Iterable[Sequence[Any]], text: Sequence[int] = (), ours: int = -1) -> Markup:
    """An HTML table; columns in `text` are set to the left, row `ours` stands out."""

    def row(tag: str, values: Sequence[Any]) -> str:
        cells = ((f'<{tag} class="text">' if i in text else f"<{tag}>", cell(v)) for i, v in enumerate(values))
        return "".join(f"{opening}{escape(value)}</{tag}>" for opening, value in cells)

    lines = [f"<tr>{row('th', head)}</tr>"]
    for i, values in enumerate(body):
        lines.append(f"<tr{' class=ours' if i == ours else ''}>{row('td', values)}</tr>")
    return Markup("<table>\n" + "\n".join(lines) + "\n</table>")


def _laws(laws: Sequence[LawInfo]) -> Markup:
    known = sources()
    body = []
    for law in laws:
        source = known.get(law.source)
        cited = source.cited if source else law.source
        body.append((law.name, cited, law.where, law.valid, "verified" if law.verified else "unverified"))
    return html_table(("law", "source", "place", "valid", "against print"), body, text=(1, 2, 3, 4))


def _outside(outside: Sequence[Outside]) -> Markup:
    body = [(o.law, o.component, o.argument, o.low, o.high, o.lowest, o.highest, o.regime) for o in outside]
    head = ("law", "part", "argument", "valid from", "to", "met from", "to", "regime there")
    return html_table(head, body, text=(1, 2, 7)) if body else Markup("")


def _readings(rows: Rows) -> Markup:
    columns = [c.column for c in measured(rows)]
    head = [*READING, *(name for column in columns for name in (column, f"{column}_meas"))]
    head = [name for name in head if any(name in row for row in rows)]
    return html_table(head, [[row.get(name) for name in head] for row in rows], text=(3,))
