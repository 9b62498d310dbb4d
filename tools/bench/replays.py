"""Replays of measured years: when the watch alarms, whether the diagnosis of the same samples does, what it costs."""

from __future__ import annotations

import csv
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...scenarios.shipped import RIGS
from ..compare.published import campaign
from ..diagnose.api import diagnose
from ..show.console import note
from ..watch.api import watch
from .harness import TABLES

#: Heads of the tables of `rows_of` and `sums_of`.
HEAD = ("machine and year", "windows", "time of a window [s]", "alarm", "window before; in it", "named", "over at")
SUMS = ("what", "value")
#: A year [s].
YEAR = 365.25 * 86400.0


def measure() -> dict[str, Any]:
    """Each year of each machine of a campaign as it comes, beside the diagnosis of what had come at each alarm."""
    asked = TABLES["watch"]
    with tempfile.TemporaryDirectory() as folder:
        made = campaign(asked["campaign"], RIGS / asked["campaign"], folder)
        given = {"rig": made.adapter.rig, "card": made.card}
        years = [_replay(name, paths, given, Path(folder)) for name, paths in made.cases.items()]
    return summed(years)


def summed(years: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """What years say together: alarms, false ones by years of samples, cost."""
    asked = TABLES["watch"]
    healthy = [year for year in years if year["case"] not in asked["changed"]]
    seconds, samples = (sum(year[key] for year in years) for key in ("s", "samples"))
    worst = max(years, key=lambda year: year["last_s"])
    return {
        "years": years,
        "times_real": samples * asked["step"] / seconds,
        "core_share": asked["machines"] * seconds / samples / asked["step"],
        "worst_core_share": asked["machines"] * worst["last_s"] / asked["every"] / asked["step"],
        "false_alarms": sum(len(year["alarms"]) for year in healthy),
        "healthy_years": sum(year["samples"] for year in healthy) * asked["step"] / YEAR,
        "agree": sum(_agrees(alarm) for year in years for alarm in year["alarms"]),
        "alarms": sum(len(year["alarms"]) for year in years),
    }


def _replay(name: str, paths: Sequence[Path | None], given: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """One year: its alarms, and processor time of a window, the healthy logs apart."""
    note(name)
    log, own, *others = paths
    assert log
    healthy: dict[str, Any] = {"sibling_logs": [p for p in others if p], "reference_logs": [own] if own else []}
    began, took, windows, alarms = time.process_time(), [], [""], []
    for event in watch(**given, **healthy, source=log, every=TABLES["watch"]["every"], once=True):
        if event["event"] == "alarm":
            alarms.append({"to": event["to"], "before": windows[-1], "over": "", "causes": event["causes"]})
        elif event["event"] == "cleared":
            alarms[-1]["over"] = event["to"]
        elif event["event"] == "window":
            windows.append(event["to"])
            took.append(time.process_time() - began)
            began = time.process_time()
    for alarm in alarms:
        for key, until in (("batch", alarm["to"]), ("batch_before", alarm["before"])):
            alarm[key] = _diagnosed(log, until, folder, {**given, **healthy}) if until else None
    with log.open(encoding="utf-8") as file:
        samples = min(len(took) * TABLES["watch"]["every"], sum(1 for _ in file) - 1)
    later = took[1:]
    return {
        "case": name,
        "samples": samples,
        "windows": len(took),
        "s": sum(later) + sum(later) / max(len(later), 1),  # the first one has read the healthy logs
        "last_s": later[-1] if later else 0.0,
        "alarms": alarms,
    }


def _diagnosed(log: Path, until: str, folder: Path, given: Mapping[str, Any]) -> dict[str, Any]:
    """The diagnosis of a log up to a time."""
    cut = folder / f"cut_{log.name}"
    with log.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    at = head.index(TABLES["watch"]["time"])
    with cut.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([head, *(row for row in rows if row[at].rstrip("Z") <= until.rstrip("Z"))])
    found = diagnose(None, logs=cut, quick=True, **given)
    causes = [{"id": c.id, "probability": round(c.probability, 4)} for c in found.causes]
    return {"alarm": found.verdict != "consistent", "causes": causes}


def _agrees(alarm: Mapping[str, Any]) -> bool:
    """Whether the diagnosis alarms with the same name, and not a window before."""
    at, before = alarm["batch"], alarm["batch_before"]
    return bool(at["alarm"] and _first(at) == _first(alarm) and not (before and before["alarm"]))


def _first(told: Mapping[str, Any]) -> str:
    return str(told["causes"][0]["id"]) if told["causes"] else "none stands out"


def rows_of(found: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """The rows of the table under `HEAD`."""
    rows: list[tuple[Any, ...]] = []
    for year in found["years"]:
        own = (year["case"], year["windows"], round(year["s"] / max(year["windows"], 1), 1))
        for alarm in year["alarms"] or [None]:
            told = ("none", "", "", "")
            if alarm:
                batch = "the diagnosis agrees" if _agrees(alarm) else "the diagnosis differs"
                named = f"{_first(alarm)} {alarm['causes'][0]['probability']:.0%}" if alarm["causes"] else _first(alarm)
                told = (alarm["to"][:10], f"{alarm['before'][:10]}; {batch}", named, alarm["over"][:10])
            rows.append((*own, *told))
            own = ("", "", "")
    return rows


def sums_of(found: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The rows of the table under `SUMS`."""
    asked, rate = TABLES["watch"], found["false_alarms"] / found["healthy_years"]
    return [
        ("alarms; at the window and with the name of the diagnosis", f"{found['alarms']}; {found['agree']}"),
        ("false alarms in years of samples", f"{found['false_alarms']} in {found['healthy_years']:.2f}"),
        ("false alarms a machine and year", f"{rate:.1f}"),
        ("times real time", f"{found['times_real']:.0f}"),
        (f"{asked['machines']} machines, share of a core, mean", f"{found['core_share']:.2%}"),
        (
            f"{asked['machines']} machines, share of a core, last window of the longest year",
            f"{found['worst_core_share']:.2%}",
        ),
    ]
