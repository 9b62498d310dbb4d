"""Predictions of what the instruments will show, as CSV text."""

from __future__ import annotations

import csv
import io

from ..answer.findings import Findings

#: Unit of a channel -> ending of its columns.
ENDINGS = {"degC": "C", "N.m": "Nm"}


def predictions_text(findings: Findings) -> str:
    """A row a point: for each channel the value calibrated without a cause, and with the causes."""
    names = list(dict.fromkeys(name for p in findings.predictions for name in p.nominal))
    units = {name: c.unit if (c := findings.channel(name)) is not None else "" for name in names}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    head = [f"{name}_{model}_{ENDINGS.get(units[name], units[name])}".rstrip("_")
            for name in names for model in ("nominal", "extended")]  # fmt: skip
    writer.writerow(["point", *head])
    for p in findings.predictions:
        pairs = [values.get(name) for name in names for values in (p.nominal, p.extended)]
        writer.writerow([p.point, *("" if v is None else f"{v:.3f}" for v in pairs)])
    return out.getvalue()
