"""Asking a diagnosis about a case, and reading what it answers."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import DataError
from .causes import merged_all

#: Gets the folder of a case; returns its result (JSON) and its predictions (CSV), which may be missing.
Diagnoser = Callable[[Path], tuple[Path, Path | None]]

#: Longest time for one case [s].
PATIENCE = 1800.0

#: Variables that tell linear algebra how many threads to use.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

#: What is no claim of a cause.
UNNAMED = frozenset({"model.unexplained"})

#: Files of a case and the options that name them, where they exist.
OPTIONS: Mapping[str, str] = {
    "CARD.json": "--card",
    "SERIES.csv": "--series",
    "REF.csv": "--reference",
    "REF_SERIES.csv": "--reference-series",
    "POINTS.csv": "--predict",
}


def ask_command(case: Path) -> tuple[Path, Path | None]:
    """Run `gearheat diagnose` on the files of a case, in a process of its own.

    Raises:
        DataError: it ends with another exit code than 0, or takes too long
    """
    place = case.parent / "answer"
    place.mkdir(exist_ok=True)
    result, predictions = place / "RESULT.json", place / "PREDICTIONS.csv"
    words = ["diagnose", str(case / "DATA.csv"), "--rig", "planetary", "--seed", "0", "--json", str(result)]
    for name, option in OPTIONS.items():
        if (case / name).exists():
            words += [option, str(case / name)]
    words += ["--predictions", str(predictions)]
    program = [sys.executable, "-c", "from gearheat.tools.cli import main; main()"]
    limits = dict.fromkeys(THREADS, "1")
    try:
        done = subprocess.run(
            [*program, *words],
            env={**os.environ, **limits},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise DataError(f"diagnose took more than {PATIENCE:g} s") from None
    if done.returncode != 0:
        said = done.stderr.strip().splitlines()[-1:] or ["no message"]
        raise DataError(f"diagnose ended with code {done.returncode}: {said[0]}")
    return result, predictions if predictions.exists() else None


@dataclass(frozen=True)
class Hypothesis:
    """Names as they count, and their probability."""

    names: frozenset[str]
    probability: float

    @property
    def claims(self) -> bool:
        """Whether it names a cause."""
        return bool(self.names) and self.names != UNNAMED


@dataclass(frozen=True)
class Answer:
    """What a diagnosis said: look-alikes that count as one are merged, likeliest hypothesis first."""

    verdict: str
    hypotheses: tuple[Hypothesis, ...]
    impact: Mapping[str, float] = field(default_factory=dict)
    nominal: Mapping[int, float] = field(default_factory=dict)
    extended: Mapping[int, float] = field(default_factory=dict)

    @property
    def alarm(self) -> bool:
        """Whether it says that something is wrong."""
        return self.verdict != "consistent"

    @property
    def top(self) -> Hypothesis:
        """The likeliest hypothesis; nothing with probability 0 if there is none."""
        return self.hypotheses[0] if self.hypotheses else Hypothesis(frozenset(), 0.0)

    def credible(self, level: float = 0.9) -> list[Hypothesis]:
        """The smallest set of hypotheses whose probabilities reach the level; all if they do not."""
        total, found = 0.0, []
        for hypothesis in self.hypotheses:
            found.append(hypothesis)
            total += hypothesis.probability
            if total >= level:
                break
        return found


def read_answer(result: Path, predictions: Path | None) -> Answer:
    """The answer in two files.

    Raises:
        DataError: the result is no JSON of the schema
    """
    try:
        said = json.loads(result.read_text(encoding="utf-8"))
        weights: dict[frozenset[str], float] = {}
        for h in said["hypotheses"]:
            names = merged_all(h["causes"])
            weights[names] = weights.get(names, 0.0) + float(h["probability"])
        verdict, impact = str(said["verdict"]), {k: _estimate(v) for k, v in said.get("impact", {}).items()}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"{result.name}: not a result of a diagnosis ({type(error).__name__}: {error})") from None
    ranked = sorted(weights.items(), key=lambda item: (-item[1], sorted(item[0])))
    hypotheses = tuple(Hypothesis(names, p) for names, p in ranked)
    nominal, extended = _predictions(predictions)
    return Answer(verdict, hypotheses, impact, nominal, extended)


def _estimate(value: Any) -> float:
    return float(value["value"] if isinstance(value, Mapping) else value)


def _predictions(path: Path | None) -> tuple[dict[int, float], dict[int, float]]:
    if path is None or not path.exists():
        return {}, {}
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    try:
        nominal = {int(r["point"]): float(r["T_oil_nominal_C"]) for r in rows}
        extended = {int(r["point"]): float(r["T_oil_extended_C"]) for r in rows}
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{path.name}: not a table of predictions ({type(error).__name__}: {error})") from None
    return nominal, extended


def rms(values: list[float]) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
