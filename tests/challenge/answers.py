"""Asking a diagnosis about a case, and reading what it answers: stable fields of its JSON only."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import gearheat
from gearheat.model.errors import DataError
from gearheat.tools.cli.__main__ import THREADS

from .classes import classes_of

#: Gets the name of a rig, the files of a case by what they are, and a folder for answers; writes RESULT.json there, and
#: PREDICTIONS.csv and SECONDS (its processor time) if it can.
Diagnoser = Callable[[str, Mapping[str, Path], Path], None]

#: The command, in a process that notes its processor time [s]; a rule of the inference may be off.
PROGRAM = """
import atexit, importlib, json, os, pathlib
from gearheat.tools.cli.__main__ import main
for name, value in json.loads(os.environ.get("RULE_OFF", "{}")).items():
    module, _, constant = name.rpartition(".")
    setattr(importlib.import_module("gearheat.tools.diagnose." + module), constant, value)
atexit.register(lambda: pathlib.Path(os.environ["SECONDS_FILE"]).write_text(str(sum(os.times()[:4]))))
main()
"""

#: Longest time for one case [s]: a hundred times the usual one.
TIMEOUT = 1800.0

#: What stands in a hypothesis for effects without a name.
UNNAMED = frozenset({"model.unexplained"})

#: Files of a case -> option of the command.
OPTIONS: Mapping[str, str] = {
    "card": "--card",
    "reference": "--reference",
    "points": "--predict",
    "log": "--logs",
    "reference_log": "--reference-logs",
}


def ask_command(
    rig: str, files: Mapping[str, Path], place: Path, off: Mapping[str, float] = MappingProxyType({})
) -> None:
    """Run `gearheat diagnose` on the files of a case, in a process of its own with one thread.

    Args:
        rig: its name
        files: of the case, by what they are
        place: folder for the answer
        off: constants of the inference -> values without a rule

    Raises:
        DataError: it ends with another exit code than 0, or takes too long
    """
    words = ["diagnose", *([str(files["data"])] if "data" in files else []), "--rig", rig, "--quick", "--seed", "0"]
    words += ["--json", str(place / "RESULT.json")]
    for name, option in OPTIONS.items():
        if name in files:
            words += [option, str(files[name])]
    words += ["--predictions", str(place / "PREDICTIONS.csv")] if "points" in files else []
    program = [sys.executable, "-c", PROGRAM, *words]
    env = {**os.environ, **dict.fromkeys(THREADS, "1"), "SECONDS_FILE": str(place / "SECONDS")}
    env["RULE_OFF"] = json.dumps(dict(off))
    try:
        done = subprocess.run(program, env=env, capture_output=True, text=True, timeout=TIMEOUT, check=False)
    except subprocess.TimeoutExpired:
        raise DataError(f"diagnose took more than {TIMEOUT:g} s") from None
    if done.returncode != 0:
        message = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise DataError(f"diagnose ended with code {done.returncode}: {message}")


def ask_here(rig: str, files: Mapping[str, Path], place: Path) -> None:
    """Diagnose a case in this process: cheaper for a few.

    Args:
        rig: its name
        files: of the case, by what they are
        place: folder for the answer
    """
    place.mkdir(parents=True, exist_ok=True)
    predictions = place / "PREDICTIONS.csv" if "points" in files else None
    outputs = gearheat.Outputs(predictions=predictions, json=str(place / "RESULT.json"))
    card, reference, points = (files.get(what) for what in ("card", "reference", "points"))
    diagnosis = gearheat.diagnose(
        files["data"], rig, card=card, reference=reference, predict=points, quick=True, outputs=outputs
    )
    diagnosis.write(outputs)


@dataclass(frozen=True)
class Hypothesis:
    """Names as they count, and their probability."""

    names: frozenset[str]
    probability: float

    @property
    def claims(self) -> bool:
        """Whether it names a cause."""
        return bool(self.names - UNNAMED)


@dataclass(frozen=True)
class Answer:
    """The answer of a diagnosis: causes of one class are merged, likeliest hypothesis first.

    Args:
        verdict: its word; anything but "consistent" is an alarm
        hypotheses: of causes
        impact: mean change of the readings
        nominal, extended: predicted oil temperatures by point
        gross: rows and columns of single readings that it calls wrong; None where it says nothing of them
        chances: probability of each name, whatever else acts
    """

    verdict: str
    hypotheses: tuple[Hypothesis, ...]
    impact: Mapping[str, float] = field(default_factory=dict)
    nominal: Mapping[int, float] = field(default_factory=dict)
    extended: Mapping[int, float] = field(default_factory=dict)
    gross: frozenset[tuple[int, str]] | None = None
    chances: Mapping[str, float] = field(default_factory=dict)

    @property
    def likely(self) -> frozenset[str]:
        """Names that are more likely than not: what it claims of several causes; none without an alarm."""
        return frozenset(name for name, p in self.chances.items() if p >= 0.5 and name not in UNNAMED and self.alarm)

    @property
    def alarm(self) -> bool:
        """Whether it says that something is wrong."""
        return self.verdict != "consistent"

    @property
    def top(self) -> Hypothesis:
        """The likeliest hypothesis, under an alarm the likeliest that something is wrong; nothing if there is none."""
        told = [h for h in self.hypotheses if h.names or not self.alarm]
        return told[0] if told else Hypothesis(frozenset(), 0.0)

    def credible(self, level: float = 0.9) -> list[Hypothesis]:
        """The smallest set of hypotheses whose probabilities reach the level; all if they do not."""
        total, credible = 0.0, []
        for hypothesis in self.hypotheses:
            credible.append(hypothesis)
            total += hypothesis.probability
            if total >= level:
                break
        return credible


def read_answer(place: Path) -> Answer:
    """The answer in a folder; a remainder does not count where a hypothesis names causes as well.

    Raises:
        DataError: the result is no JSON of the schema
    """
    try:
        result = json.loads((place / "RESULT.json").read_text(encoding="utf-8"))
        weights: dict[frozenset[str], float] = {}
        for h in result["hypotheses"]:
            names = classes_of(h["causes"])
            names = names - UNNAMED or names
            weights[names] = weights.get(names, 0.0) + float(h["probability"])
        chances: dict[str, float] = {}
        for c in result.get("causes", ()):
            for name in classes_of([c["id"]]):
                chances[name] = chances.get(name, 0.0) + float(c["probability"])
        verdict, impact = str(result["verdict"]), {k: _estimate(v) for k, v in result.get("impact", {}).items()}
        gross = _gross(result)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"{place.name}: not a result of a diagnosis ({type(error).__name__}: {error})") from None
    ranked = sorted(weights.items(), key=lambda item: (-item[1], sorted(item[0])))
    nominal, extended = _predictions(place / "PREDICTIONS.csv")
    return Answer(verdict, tuple(Hypothesis(*h) for h in ranked), impact, nominal, extended, gross, chances)


def _estimate(value: Any) -> float:
    return float(value["value"] if isinstance(value, Mapping) else value)


def _gross(result: Mapping[str, Any]) -> frozenset[tuple[int, str]] | None:
    """Rows of the data, from 1, and columns."""
    if "data_quality" not in result:
        return None
    columns = {c["name"]: c.get("column") or c["name"] for c in result.get("channels", ())}
    gross = result["data_quality"].get("gross", ())
    return frozenset((int(g["row"]), str(columns.get(g["channel"], g["channel"]))) for g in gross)


def _predictions(path: Path) -> tuple[dict[int, float], dict[int, float]]:
    if not path.exists():
        return {}, {}
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    try:
        nominal = {int(r["point"]): float(r["T_oil_nominal_C"]) for r in rows}
        extended = {int(r["point"]): float(r["T_oil_extended_C"]) for r in rows}
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{path.name}: not a table of predictions ({type(error).__name__}: {error})") from None
    return nominal, extended
