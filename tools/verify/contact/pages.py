"""The verification table as Markdown, HTML and CSV, with its summary and figures."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ...show.console import cell
from ...show.pages import page
from .rows import Found, Job

Row = Mapping[str, Any]
COLUMNS = ("item", "case", "quantity", "reference", "ours", "deviation", "tolerance", "verdict")
SUMMARY = ("what", "rows", "within", "outside", "largest deviation", "tolerance")


def rows(found: Sequence[tuple[Job, Found]]) -> list[Row]:
    """All rows of the table, with the item each belongs to, the load of all contacts last."""
    table = [{"item": job.item, **row} for job, kept in found for row in kept.get("rows", ())]
    solved = [abs(row["load_error"]) for row in table]
    if not table:
        return []
    worst = max(solved)
    balance = {
        "item": "Load",
        "case": f"largest of {len(solved)} rows",
        "quantity": "load missing over the load",
        "reference": 0.0,
        "ours": worst,
        "deviation": worst,
        "tolerance": 1e-4,
        "verdict": "within" if worst <= 1e-4 else "outside",
    }
    return [*table, balance]


def summary(table: Sequence[Row]) -> list[list[str]]:
    """One line an item and quantity: how many rows lie where."""
    lines = []
    for item, quantity, judged in dict.fromkeys(map(_kind, table)):
        mine = [row for row in table if _kind(row) == (item, quantity, judged)]
        within = sum(row["verdict"] == "within" for row in mine)
        outside = sum(row["verdict"] == "outside" for row in mine)
        worst = max(mine, key=_badness)
        counts = [str(len(mine)), str(within or ""), str(outside or "")]
        lines.append([f"{item}: {quantity}", *counts, _deviation(worst), _tolerance(worst)])
    return lines


def _kind(row: Row) -> tuple[str, str, bool]:
    return row["item"], row["quantity"], row["verdict"] != "reported"


def _badness(row: Row) -> float:
    """How far a row is on the wrong side of a bound, or from its reference on either."""
    signs = {">=": -1.0, "<=": 1.0}
    bad = float(row["deviation"])
    return signs[row["tolerance"]] * bad if row["tolerance"] in signs else abs(bad)


def _deviation(row: Row) -> str:
    if isinstance(row["tolerance"], str):
        return cell(row["ours"])
    return f"{row['deviation']:.1e}" if row["item"] == "Load" else f"{100 * row['deviation']:+.1f} %"


def _tolerance(row: Row) -> str:
    tolerance = row["tolerance"]
    if isinstance(tolerance, str):
        return "reported" if row["verdict"] == "reported" else f"{tolerance} {cell(row['reference'])}"
    return "reported" if tolerance == 0 else "1e-4" if row["item"] == "Load" else f"{100 * tolerance:g} %"


def _cells(row: Row) -> list[str]:
    numbers = [cell(row["reference"]), cell(row["ours"])]
    return [row["item"], row["case"], row["quantity"], *numbers, _deviation(row), _tolerance(row), row["verdict"]]


def _markdown_table(columns: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    head = f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}\n"
    return head + "".join(f"| {' | '.join(line)} |\n" for line in lines)


def markdown(table: Sequence[Row], figures: Mapping[str, str]) -> str:
    """The page as Markdown.

    Args:
        table: all rows
        figures: title -> file name
    """
    shown = "".join(f"\n## {title}\n\n![{title}]({name})\n" for title, name in figures.items())
    return (
        f"# The contact solver, verified\n\n{_markdown_table(SUMMARY, summary(table))}{shown}\n## All rows\n\n"
        f"{_markdown_table(COLUMNS, map(_cells, table))}"
    )


def html(table: Sequence[Row], figures: Mapping[str, str]) -> str:
    """The page as one HTML file.

    Args:
        table: all rows
        figures: title -> SVG text
    """
    tables = {"summary_columns": SUMMARY, "summary": summary(table), "columns": COLUMNS}
    body = [_cells(row) for row in table]
    return page("gearheat.tools.verify", "contact.html", **tables, body=body, figures=figures)


def as_csv(table: Sequence[Row]) -> str:
    """All rows as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([row[c] for c in COLUMNS] for row in table)
    return text.getvalue()
