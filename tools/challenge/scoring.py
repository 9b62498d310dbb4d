"""Scores of answers: one outcome per case, and the metrics of a sheet beside their bars.

Names count by class: causes that no data of this kind can separate are one answer. "Exact" is equality of sets of
names: a true cause with a second one beside it is not exact.

Single and regime-limited causes lie far from every rival: they must be told by their name. Of a cause that is alike
another one nobody could tell more than a set that holds it: there the set counts, and not to be sure of the wrong
name; how often the right name comes first there is told without a bar, alone and together with all other single ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .answers import Answer, rms

#: Probability above which an answer is sure.
SURE = 0.9

#: Kinds of cases whose causes have names.
NAMED = ("single", "regime", "pair", "alike")


@dataclass(frozen=True)
class Outcome:
    """What an answer to a case is worth. Without an answer everything counts as missed, and a clean case as an alarm.

    Args:
        case, kind: of the case
        snr: signal-to-noise of the quietest hidden effect; 0 for none
        truth, top: names as they count, joined by " + "; "nothing" for none
        answered: whether there was an answer
        alarm: whether it said that something is wrong
        exact: whether the likeliest hypothesis is the truth
        shared: how many of the true names the likeliest hypothesis holds
        covered: whether the truth is among the hypotheses that make 0.9 together
        size: how many those are
        sure_wrong: whether it names a cause with more than 0.9 that is not the truth
        impact_error: error of the stated change of the readings over that change; None where there is hardly any
        gain: error of the extended prediction over that of the nominal one; None where the oil hardly changes
        seconds: time the diagnosis took
    """

    case: int
    kind: str
    snr: float
    truth: str
    top: str
    answered: bool
    alarm: bool
    exact: bool
    shared: int
    covered: bool
    size: int
    sure_wrong: bool
    impact_error: float | None
    gain: float | None
    seconds: float
    problem: str = ""


def score(truth: Mapping[str, Any], answer: Answer | None, seconds: float, problem: str = "") -> Outcome:
    """The outcome of one case."""
    names = frozenset(str(n) for n in truth["answer"])
    told = answer or Answer("consistent", ())
    top, credible = told.top, told.credible()
    wrong = top.claims and told.alarm and top.probability > SURE and top.names != names
    return Outcome(
        case=int(truth["case"]),
        kind=str(truth["kind"]),
        snr=min((float(e["snr"]) for e in truth["effects"]), default=0.0),
        truth=_joined(names),
        top=_joined(top.names) if told.alarm or not top.claims else "nothing",
        answered=answer is not None,
        alarm=told.alarm,
        exact=told.alarm and top.names == names,
        shared=len(top.names & names) if told.alarm else 0,
        covered=any(h.names == names for h in credible),
        size=len(credible),
        sure_wrong=wrong,
        impact_error=_impact_error(truth, told) if truth["kind"] in NAMED else None,
        gain=_gain(truth, told) if truth["kind"] in NAMED else None,
        seconds=seconds,
        problem=problem,
    )


def _joined(names: frozenset[str]) -> str:
    return " + ".join(sorted(names)) or "nothing"


def _impact_error(truth: Mapping[str, Any], told: Answer) -> float | None:
    """Error of the impact over the impact, each channel by its repeatability; None below one repeatability."""
    sd = truth["repeat_sd"]
    true = np.array([truth["impact"][c] / sd[c] for c in sd])
    if np.abs(true).max() < 1.0:
        return None
    said = np.array([(told.impact.get(c, 0.0) if told.alarm else 0.0) / sd[c] for c in sd])
    return float(np.linalg.norm(said - true) / np.linalg.norm(true))


def _gain(truth: Mapping[str, Any], told: Answer) -> float | None:
    """Error of the extended over that of the nominal prediction; None where the oil changes by less than its noise.

    Points at which the rig runs away count for nothing.
    """
    points = [p for p in truth["points"] if math.isfinite(p["T_oil_C"])]
    if rms([p["T_oil_C"] - p["T_oil_without_C"] for p in points]) < truth["repeat_sd"]["T_oil_K"]:
        return None
    if any(p["point"] not in told.nominal or p["point"] not in told.extended for p in points):
        return 1.0
    before = rms([told.nominal[p["point"]] - p["T_oil_C"] for p in points])
    after = rms([told.extended[p["point"]] - p["T_oil_C"] for p in points])
    return after / max(before, 1e-6)


def wilson(hits: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate; (0, 1) without cases."""
    if n == 0:
        return 0.0, 1.0
    rate, square = hits / n, z * z
    middle = (rate + square / (2 * n)) / (1 + square / n)
    half = z / (1 + square / n) * math.sqrt(rate * (1 - rate) / n + square / (4 * n * n))
    low, high = max(middle - half, 0.0), min(middle + half, 1.0)
    return (0.0 if hits == 0 else low), (1.0 if hits == n else high)


def median_interval(values: Sequence[float], z: float = 1.959964) -> tuple[float, float]:
    """95 % interval of a median from the ordered values."""
    ordered, n = sorted(values), len(values)
    if n == 0:
        return math.nan, math.nan
    low = math.floor(n / 2 - z * math.sqrt(n) / 2)
    return ordered[max(low, 0)], ordered[min(n - 1 - low, n - 1)]


@dataclass(frozen=True)
class Bar:
    """A metric of a sheet: the kinds of cases it is over, what it takes of them, and what it must reach.

    `bars` is what it must reach, the ambition on the own sheet, and that on the foreign one; None for what has no bar.
    """

    name: str
    kinds: tuple[str, ...]
    take: Callable[[Outcome], float | bool | None]
    bars: tuple[float, float, float] | None
    how: str = "rate"
    at_most: bool = False

    def on(self, sheet: str) -> tuple[float | None, float | None]:
        """What it must reach on a sheet, and the ambition."""
        return (None, None) if self.bars is None else (self.bars[0], self.bars[1 if sheet == "own" else 2])


#: One cause that can be told by its name, one that cannot, and both.
ONE = ("single", "regime")
ALIKE = ("alike",)
ANY = (*ONE, *ALIKE)

#: Ranges of signal-to-noise to tell apart.
LOUDNESS = ((0.0, 8.0), (8.0, 16.0), (16.0, 1e9))

BARS: tuple[Bar, ...] = (
    Bar(
        "false alarms on clean data", ("clean",), lambda o: o.alarm or not o.answered, (0.10, 0.05, 0.05), at_most=True
    ),
    Bar("detection", NAMED, lambda o: o.alarm, (0.93, 0.98, 0.99)),
    Bar("exact name first", ONE, lambda o: o.exact, (0.80, 0.90, 0.92)),
    Bar("truth in the 90 % set", ONE, lambda o: o.covered, (0.88, 0.93, 0.95)),
    Bar("size of the 90 % set, mean", ONE, lambda o: o.size if o.answered else None, (2.5, 2.0, 1.6), "mean", True),
    Bar("two causes: both", ("pair",), lambda o: o.exact, (0.60, 0.75, 0.85)),
    Bar("two causes: at least one", ("pair",), lambda o: o.shared > 0, (0.90, 0.95, 0.97)),
    Bar("regime-limited cause first", ("regime",), lambda o: o.exact, (0.80, 0.90, 0.94)),
    Bar("outside: not claimed > .9", ("outside",), lambda o: o.answered and not o.sure_wrong, (0.50, 0.75, 0.80)),
    Bar("single or regime wrong with > .9", ONE, lambda o: o.sure_wrong, (0.08, 0.03, 0.03), at_most=True),
    Bar("alike: truth in the 90 % set", ALIKE, lambda o: o.covered, (0.88, 0.93, 0.95)),
    Bar("alike: wrong with > .9", ALIKE, lambda o: o.sure_wrong, (0.08, 0.03, 0.03), at_most=True),
    Bar("alike: exact name first", ALIKE, lambda o: o.exact, None),
    Bar("exact name first, alike among them", ANY, lambda o: o.exact, None),
    Bar("weak: wrong with > .9", ("weak",), lambda o: o.sure_wrong, (0.10, 0.05, 0.05), at_most=True),
    Bar("impact error, median", NAMED, lambda o: o.impact_error, (0.20, 0.10, 0.05), "median", True),
    Bar("held-out RMSE after/before, median", NAMED, lambda o: o.gain, (0.35, 0.25, 0.15), "median", True),
)


@dataclass(frozen=True)
class Metric:
    """A metric with its 95 % interval, number of cases and bars; value None without cases, bars where it has any."""

    name: str
    value: float | None
    interval: tuple[float, float] | None
    n: int
    at_most: bool
    must: float | None
    must_met: bool | None
    ambitious: float | None
    ambitious_met: bool | None


def metrics(outcomes: Sequence[Outcome], sheet: str) -> list[Metric]:
    """All metrics of a sheet."""
    found = []
    for bar in BARS:
        taken = [bar.take(o) for o in outcomes if o.kind in bar.kinds]
        values = [float(v) for v in taken if v is not None]
        value, interval = _summary(values, bar.how)
        must, ambitious = bar.on(sheet)
        met = [_reached(value, b, bar.at_most) for b in (must, ambitious)]
        found.append(Metric(bar.name, value, interval, len(values), bar.at_most, must, met[0], ambitious, met[1]))
    return found


def _summary(values: Sequence[float], how: str) -> tuple[float | None, tuple[float, float] | None]:
    if not values:
        return None, None
    if how == "rate":
        return float(np.mean(values)), wilson(int(sum(values)), len(values))
    if how == "median":
        return float(np.median(values)), median_interval(values)
    mean, half = float(np.mean(values)), 1.959964 * float(np.std(values)) / math.sqrt(len(values))
    return mean, (mean - half, mean + half)


def _reached(value: float | None, bar: float | None, at_most: bool) -> bool | None:
    if value is None or bar is None:
        return None
    return value <= bar + 1e-12 if at_most else value >= bar - 1e-12


def confusion(outcomes: Sequence[Outcome]) -> dict[str, dict[str, int]]:
    """Truth -> likeliest answer -> number of cases; without the weak ones, which nobody need find."""
    found: dict[str, dict[str, int]] = {}
    for o in sorted(outcomes, key=lambda o: (o.truth, o.top)):
        if o.kind != "weak":
            row = found.setdefault(o.truth, {})
            answer = o.top if o.answered else "no answer"
            row[answer] = row.get(answer, 0) + 1
    return found


def by_loudness(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Detection and exact names of single and regime-limited causes, by signal-to-noise."""
    found = []
    for low, high in LOUDNESS:
        here = [o for o in outcomes if o.kind in ONE and low <= o.snr < high]
        detected, exact = sum(o.alarm for o in here), sum(o.exact for o in here)
        found.append(
            {
                "snr": [low, high],
                "n": len(here),
                "detected": detected,
                "exact": exact,
                "detected_interval": wilson(detected, len(here)),
                "exact_interval": wilson(exact, len(here)),
            }
        )
    return found


def report(outcomes: Sequence[Outcome], sheet: str, seed: int) -> dict[str, Any]:
    """Everything for the JSON file; times stand apart, all else is the same for the same code, sheet and seed."""
    ordered = sorted(outcomes, key=lambda o: o.case)
    times = [o.seconds for o in ordered if o.answered]
    cases = [{k: v for k, v in asdict(o).items() if k != "seconds"} for o in ordered]
    return {
        "schema": "gearheat.challenge/1",
        "sheet": sheet,
        "seed": seed,
        "n": len(ordered),
        "kinds": {kind: sum(o.kind == kind for o in ordered) for kind in dict.fromkeys(o.kind for o in ordered)},
        "answered": sum(o.answered for o in ordered),
        "metrics": [asdict(m) for m in metrics(ordered, sheet)],
        "by_loudness": by_loudness(ordered),
        "confusion": confusion(ordered),
        "cases": cases,
        "seconds": {
            "median": float(np.median(times)) if times else None,
            "longest": max(times, default=None),
            "each": [round(o.seconds, 2) for o in ordered],
        },
    }
