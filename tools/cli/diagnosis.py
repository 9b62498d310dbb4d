"""What the model gets wrong in measured data, and which experiment would tell."""

from __future__ import annotations

from pathlib import Path

import gearheat as gh

from ...model.errors import ScenarioError
from ..show import console

#: Whether a column holds magnitudes, as options say it.
MAGNITUDES = {"yes": True, "no": False}


def diagnose(
    rig: str,
    data: Path | None = None,
    card: Path | None = None,
    logs: list[Path] | None = None,
    reference: Path | None = None,
    series: Path | None = None,
    reference_series: Path | None = None,
    reference_logs: list[Path] | None = None,
    sibling_logs: list[Path] | None = None,
    library: list[Path] | None = None,
    predict: Path | None = None,
    predictions: Path | None = None,
    causes: int = 8,
    alpha: float = 0.01,
    seed: int = 0,
    quick: bool = False,
    everything: bool = False,
    json: str | None = None,
    report: Path | None = None,
    extended: Path | None = None,
    live: Path | None = None,
    plot: Path | None = None,
) -> None:
    """What the model gets wrong in measured data: causes by name, size and certainty, and what to measure next."""
    console.writable(live)
    console.plottable(plot)
    outputs = gh.Outputs(predictions, json, report, extended)
    findings = gh.diagnose(
        data,
        rig,
        card=card,
        logs=logs,
        reference=reference,
        reference_logs=reference_logs,
        sibling_logs=sibling_logs,
        library=library,
        predict=predict,
        causes=causes,
        quick=quick,
        alpha=alpha,
        seed=seed,
        series=series,
        reference_series=reference_series,
        outputs=outputs,
    )
    findings.write(outputs)
    if plot is not None and findings.save_picture(plot) is None:
        console.note(f"no cause to draw: {plot} is not written")
    if live is not None:
        gh.page(rig, extended=[extended] if extended and extended.is_file() else ()).save(live, report=report)
    if json == "-":
        print(console.as_json(findings.as_dict()), end="")
    else:
        print(findings.text(everything=everything, width=console.screen_width()), end="")


def plan(
    rig: str,
    separate: str = "",
    card: Path | None = None,
    points: Path | None = None,
    reference: bool = False,
    library: list[Path] | None = None,
    everything: bool = False,
    out: Path | None = None,
    json: str | None = None,
) -> None:
    """Which causes a campaign can tell apart on a rig, and which experiments would, before anything is measured."""
    causes = [name for name in map(str.strip, separate.split(",")) if name]
    found = gh.plan(
        rig, separate=causes, card=card, points=points, library=library, reference=reference, json=json, out=out
    )
    if out is not None:
        found.save_picture(out)
    if (path := console.file_of(json)) is not None:
        found.save(path)
    if json == "-":
        print(console.as_json(found.as_dict()), end="")
    else:
        print(found.text(everything=everything, width=console.screen_width()), end="")


def card(
    rig: str,
    data: Path | None = None,
    column: list[str] | None = None,
    unit: list[str] | None = None,
    magnitude: list[str] | None = None,
    out: Path | None = None,
    json: str | None = None,
) -> None:
    """A card for the campaigns of a rig: every key with its default and what it means, fitted to a table."""
    columns, units, signs = (dict(map(_pair, texts or [])) for texts in (column, unit, magnitude))
    if (columns or units or signs) and data is None:
        raise ScenarioError("--column, --unit and --magnitude say what a table has. Name it with --data FILE.")
    if wrong := [text for text in signs.values() if text not in MAGNITUDES]:
        raise ScenarioError(f"--magnitude: expected SENSOR=yes or SENSOR=no, not {wrong[0]!r}.")
    magnitudes = {name: MAGNITUDES[text] for name, text in signs.items()}
    found = gh.card(rig, data, columns=columns, units=units, magnitudes=magnitudes)
    for name, named in found.columns.items():
        console.note(f"{named}: {name}")
    for problem in found.problems:
        console.note(f"not yet: {problem}")
    if out is not None:
        found.save(out)
        console.note(f"wrote {out}")
    if json is not None or out is None:
        console.answer(found.as_dict(), json, lambda: print(found.as_toml(), end=""))


def _pair(text: str) -> tuple[str, str]:
    """What stands before and behind the last sign of equality."""
    name, sign, value = text.rpartition("=")
    if not sign:
        raise ScenarioError(f'"{text}": expected NAME=VALUE.')
    return name.strip(), value.strip()


def campaign(
    name: str,
    folder: Path,
    out: Path = Path("campaign"),
    case: str = "",
    quick: bool = False,
    json: str | None = None,
) -> None:
    """A campaign that others published: checks the files you downloaded, writes card and tables, and diagnoses them."""
    made = gh.campaign(name, folder, out, case=case)
    known = made.as_dict()
    console.note(f"{made.title}. {known['source']}; {known['licence']}. Known: {known['known']}")
    findings = {}
    for one, paths in made.cases.items():
        console.note(f"{one}: {', '.join(map(str, paths))}")
        findings[one] = made.diagnose(one, quick=quick)
        if json != "-":
            print(f"{one}\n{findings[one].text(width=console.screen_width())}", end="")
    if json is not None:
        cases = {one: found.as_dict() for one, found in findings.items()}
        console.answer({**known, "findings": cases}, json, lambda: None)
