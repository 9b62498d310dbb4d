"""The report of a run as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gearheat.tools.show import console

#: Columns of the table of cases.
CASES = ("case", "kind", "S/N", "rival", "truth (p)", "answer (p)", "remarks")


def show(result: Mapping[str, Any]) -> None:
    """Print the report as tables."""
    wrong = [_case(c) for c in result["cases"] if _is_missed(c)]
    console.table("cases that are not as they should be", CASES, wrong, wrapped=True)
    head = ("metric", "value", "95 % interval", "cases", "must", "ambitious")
    sheets = ", ".join(f"{count} {sheet}" for sheet, count in result["sheets"].items())
    kinds = ", ".join(f"{count} {kind}" for kind, count in result["kinds"].items())
    if len(result["sheets"]) > 1:
        by_sheet = [
            (m["name"], *(_value(f[i]) for f in result["by_sheet"].values())) for i, m in enumerate(result["metrics"])
        ]
        console.table("by sheet: value (cases)", ("metric", *result["sheets"]), by_sheet)
    console.table(
        f"{sheets}, seed {result['seed']} ({kinds})", head, [_row(m) for m in result["metrics"]], wrapped=True
    )
    far = f"{result['by_name']} single causes lie 3 sigma or more from every rival"
    console.say(f"{far}; {result['by_set']} are told by a set")
    seconds = result["seconds"]
    if seconds["median"] is not None:
        console.say(f"processor time per case: median {seconds['median']:.1f} s, longest {seconds['longest']:.1f} s")
    missing = sum(result["sheets"].values()) - result["answered"]
    if missing:
        console.say(f"without an answer, counted as missed: {missing}")


def _is_missed(c: Mapping[str, Any]) -> bool:
    if not c["answered"] or c["sure_wrong"]:
        return True
    if c["kind"] in ("clean", "weak", "outside"):
        return bool(c["kind"] == "clean" and c["alarm"])
    return not c["exact"]


def _case(c: Mapping[str, Any]) -> tuple[str, ...]:
    rival = "" if c["distance"] is None else f"{c['distance']:.1f}"
    remarks = [
        "no answer" if not c["answered"] else "",
        "sure" if c["sure_wrong"] else "",
        "in the set" if c["covered"] else "",
    ]
    name = f"{c['sheet']} {c['case']}"
    named = f"{c['truth']} ({c['p_truth']:.2f})", f"{c['top']} ({c['p_top']:.2f})"
    return name, c["kind"], f"{c['snr']:.1f}", rival, *named, ", ".join(r for r in remarks if r)


def _value(m: Mapping[str, Any]) -> str:
    return "" if m["value"] is None else f"{m['value']:.2f} ({m['n']})"


def _row(m: Mapping[str, Any]) -> tuple[str, ...]:
    def bar(value: float | None, reached: bool | None) -> str:
        met = "" if reached is None else " reached" if reached else " missed"
        return "" if value is None else f"{'<=' if m['at_most'] else '>='} {value:.2f}{met}"

    value = "" if m["value"] is None else f"{m['value']:.2f}"
    interval = "" if m["interval"] is None else f"{m['interval'][0]:.2f} ... {m['interval'][1]:.2f}"
    bars = bar(m["must"], m["must_met"]), bar(m["ambitious"], m["ambitious_met"])
    return m["name"], value, interval, str(m["n"]), *bars
