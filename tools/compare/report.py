"""One self-contained HTML page about a campaign: how close, where wrong, what the model is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from ...model.core.flat import FlatModel
from ...model.run.result import Outside
from ...model.sources import LawInfo, sources
from ...scenarios.scenario import Scenario
from ..describe import description as describe
from ..show.notes import unchecked_lines
from ..show.pages import html_table, page
from . import plots
from .errors import Comparison, Rows, channels_of, numbers, present
from .results import error_lines, group_lines
from .rivals import Score

#: Columns of the table of all readings.
READING = ("point", "test", "direction", "oil", "n_set_rpm", "T_set_Nm", "T_amb_C")


def render(
    scenario: Scenario,
    flat: FlatModel,
    found: Mapping[str, Any],
    comparison: Comparison | None,
    scores: Sequence[Score],
    *,
    curves: Mapping[int, Mapping[str, np.ndarray]],
    outside: Sequence[Outside],
) -> str:
    """The page as HTML text, the same bytes for the same run. Without a comparison it shows the simulation alone.

    Args:
        scenario: the rig
        flat: its model
        found: the JSON object of the run
        comparison: of its readings
        scores: of statistical rivals
        curves: some tests over time, columns as in `plots.warm_up`
        outside: laws that were used outside their range
    """
    rows, laws = found["rows"], describe.cite_laws(flat)
    parameters = describe.parameters(scenario, flat)
    errata = [(e.place, e.says, e.should_be, e.evidence) for e in scenario.errata]
    return page(
        "gearheat.tools.compare",
        "report.html",
        rig=scenario,
        found=found,
        compared=None if comparison is None else _describe_errors(rows, comparison, scores),
        tests=len({row["test"] for row in rows}),
        warm_up=Markup(plots.warm_up(curves, rows)) if curves else "",
        breakdown=_breakdown(rows, [c for c in scenario.losses if c.startswith("P_") and c != "P_total_W"]),
        laws=_laws(laws),
        cited=len(laws),
        unverified=[law.name for law in laws if not law.verified],
        outside=_outside(outside),
        unchecked=unchecked_lines(found["unchecked"]),
        values=len(parameters),
        parameters=html_table(("parameter", "value", "source"), parameters),
        errata=html_table(("place", "says", "should be", "evidence"), errata),
        rows=_readings(rows),
    )


def _breakdown(rows: Rows, losses: Sequence[str]) -> Markup:
    """Losses of every test, or of the one point there is."""
    if not losses:
        return Markup("")
    return Markup(plots.shares(rows[0], losses) if len(rows) == 1 else plots.breakdown(rows, losses))


def _describe_errors(rows: Rows, comparison: Comparison, scores: Sequence[Score]) -> dict[str, Any]:
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


def _laws(laws: Sequence[LawInfo]) -> Markup:
    known = sources()
    body = []
    for law in laws:
        source = known.get(law.source)
        cited = source.cited if source else law.source
        body.append((law.name, cited, law.where, law.valid, "verified" if law.verified else "unverified"))
    return html_table(("law", "source", "place", "valid", "against print"), body)


def _outside(outside: Sequence[Outside]) -> Markup:
    body = [(o.law, o.component, o.argument, o.low, o.high, o.lowest, o.highest, o.regime) for o in outside]
    head = ("law", "part", "argument", "valid from", "to", "met from", "to", "regime there")
    return html_table(head, body) if body else Markup("")


def _readings(rows: Rows) -> Markup:
    columns = [c.column for c in channels_of(rows)]
    head = [*READING, *(name for column in columns for name in (column, f"{column}_meas"))]
    head = [name for name in head if any(name in row for row in rows)]
    return html_table(head, [[row.get(name) for name in head] for row in rows])
