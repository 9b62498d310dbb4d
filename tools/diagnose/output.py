"""A diagnosis as the JSON object of its schema, and as one screen of text."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from ..console import table
from . import words
from .findings import Estimate, Experiment, Findings, Gain, Named

SCHEMA = "gearheat.diagnosis/1"
#: Digits that are kept of every number: beyond them the order of sums shows.
DIGITS = 6
#: A size above this cannot be: no data of this kind would reveal the cause.
INVISIBLE = 1e6
#: Causes on the screen; warnings on the screen.
SHOWN, WARNINGS = 6, 4


def schema() -> dict[str, Any]:
    """The JSON schema of the result."""
    text = files("gearheat.tools").joinpath("templates/diagnosis.schema.json").read_text(encoding="utf-8")
    return dict(json.loads(text))


def as_object(findings: Findings) -> dict[str, Any]:
    """The JSON object of a diagnosis; the same findings give the same object."""
    return {
        "schema": SCHEMA,
        "verdict": findings.verdict,
        "test": {
            "alpha": findings.alpha,
            "p_any": _number(findings.p_any),
            "p_omnibus": _number(findings.p_omnibus),
            "p_adequacy": _number(findings.p_adequacy),
            "null": "bootstrap",
            "draws": findings.draws,
        },
        "hypotheses": [
            {"causes": list(h.causes), "probability": _probability(h.probability)} for h in findings.hypotheses
        ],
        "causes": [_cause(c) for c in findings.causes],
        "confusable": [list(group) for group in findings.confusable if len(group) > 1],
        "impact": {
            key: {"value": _number(value), "ci95": [_number(low), _number(high)]}
            for key, (value, low, high) in findings.impact.items()
        },
        **_played(findings),
        "gain": _gain(findings.gain),
        "gain_grouped": [_gain(g) for g in findings.grouped],
        "next_experiment": [
            {
                "id": e.id,
                "what": e.what,
                "separates": list(e.separates),
                "separation_before": _number(e.before),
                "separation_after": _number(e.after),
            }
            for e in findings.next_experiment
        ],
        "warnings": list(findings.warnings),
    }


def _played(findings: Findings) -> dict[str, Any]:
    """What the rig leaves on the data, calibrated and extended; nothing where it is not extended."""
    if words.applied(findings) is None or not findings.played:
        return {}
    units = {"T_oil": "T_oil_K", "T_wall": "T_wall_K", "loss": "loss_Nm"}
    left = {
        units[c]: {"rms_calibrated": _number(a), "rms_extended": _number(b)} for c, (a, b) in findings.played.items()
    }
    return {"played": left}


def _gain(gain: Gain) -> dict[str, Any]:
    return _known(
        {
            "scheme": gain.scheme,
            "nested": True,
            "channel": gain.channel,
            "rmse_before": _number(gain.rmse_before),
            "rmse_after": _number(gain.rmse_after),
            "ratio_ci90": [_number(v) for v in gain.ratio_ci90],
            "noise_floor": None if gain.noise_floor is None else _number(gain.noise_floor),
            "n": gain.n,
            "rivals": {name: _number(value) for name, value in gain.rivals.items()},
        }
    )


def _cause(cause: Named) -> dict[str, Any]:
    visible = math.isfinite(cause.detectable) and abs(cause.detectable) < INVISIBLE
    regime = {key: [None if v is None else _number(v) for v in ends] for key, ends in cause.regime.items()}
    return _known(
        {
            "id": cause.id,
            "probability": _probability(cause.probability),
            "detectable": _number(cause.detectable) if visible else None,
            "parameters": [_parameter(p) for p in cause.parameters],
            "regime": regime or None,
            "p_split": None if cause.p_split is None else _number(cause.p_split),
            "q": None if cause.q is None else _number(cause.q),
        }
    )


def _parameter(found: Estimate) -> dict[str, Any]:
    interval = [_number(found.low), _number(found.high)]
    return {"name": found.name, "value": _number(found.value), "ci95": interval, "unit": found.unit}


def _known(entries: Mapping[str, Any]) -> dict[str, Any]:
    """The entries that have a value."""
    return {key: value for key, value in entries.items() if value is not None}


def _number(value: float) -> float:
    """A number to the digits that are kept, never minus zero."""
    return float(f"{float(value):.{DIGITS}g}") + 0.0


def _probability(value: float) -> float:
    """A probability, rounded down so that sums stay below one."""
    return math.floor(min(max(float(value), 0.0), 1.0) * 1e6 + 1e-6) / 1e6


def show(findings: Findings) -> None:
    """Print a diagnosis on one screen."""
    print(words.verdict(findings))
    found = words.applied(findings) is not None
    print(f"  {words.chance(findings.p_any)}; {words.adequacy(findings)}" if found else f"  {words.adequacy(findings)}")
    listed = [c for c in findings.causes if c.probability >= 0.01][:SHOWN]
    if listed:
        body = [(words.percent(c.probability), c.id, _first(c), words.certificate(c), words.regime(c)) for c in listed]
        table("", ("probability", "cause", "size (95 %)", "q (other half)", "where"), body)
    if findings.confusable and found:
        first, *others = findings.confusable[0]
        print(f"these data cannot tell {first} from {', '.join(others)}")
    if not found:
        seen = [f"{c.id} {size}" for c in findings.causes if (size := words.visible(c))]
        print(f"would have been found in 80 of 100 such campaigns: {', '.join(seen) or 'nothing'}")
    if found and (effects := [text for key in words.IMPACTS if (text := words.impact(findings, key))]):
        print(f"mean effect on the readings: {', '.join(effects)}")
    if found and findings.played:
        print(f"played over these readings (root mean square): {words.played(findings)}")
        if lacking := words.not_played(findings):
            print(f"  {lacking}")
    print(f"oil temperature of readings left out: {words.gain(findings.gain)}")
    for grouped in findings.grouped if found else ():
        print(f"  {words.gain(grouped)}")
    for experiment in findings.next_experiment[:1]:
        print(f"measure next: {experiment.what} ({_separation(experiment)})")
    for warning in findings.warnings[:WARNINGS]:
        print(f"warning: {warning}")
    if (more := len(findings.warnings) - WARNINGS) > 0:
        print(f"{more} more warnings in the report and in the JSON result")


def _first(cause: Named) -> str:
    return f"{cause.parameters[0].name} = {words.estimate(cause.parameters[0])}" if cause.parameters else ""


def _separation(experiment: Experiment) -> str:
    before, after = words.number(experiment.before, 2), words.number(experiment.after, 2)
    return f"separates {' and '.join(experiment.separates)}: from {before} to {after} sigma"
