"""Scores of answers: one outcome per case, and the metrics of many, pooled over sheets, beside their bars.

Names count by class: causes that no data of this kind can separate are one answer. "Exact" is equality of sets of
names: a true cause with a second one beside it is not exact.

Single and regime-limited causes at least 3 sigma from every rival must be named. The others cannot be separated from
their rivals: a set that holds the cause counts, and not to be sure of a wrong name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .answers import Answer
from .hide import APART

#: Probability above which an answer is sure.
SURE = 0.9

#: Kinds of cases whose causes have names.
NAMED = ("single", "regime", "pair", "alike", "several", "severe")


@dataclass(frozen=True)
class Outcome:
    """What an answer to a case is worth. Without an answer everything counts as missed, and a clean case as an alarm.

    Args:
        sheet, case, kind: of the case
        snr, distance: signal-to-noise of the quietest hidden fault, and distance of the nearest rival; None: unknown
        truth, top: names as they count, joined by " + "; "nothing" for none
        p_truth, p_top: probabilities of these hypotheses
        answered: whether there was an answer
        alarm: whether it said that something is wrong
        exact: whether the likeliest hypothesis is the truth, or one as fair
        shared: how many of the true names are more likely than not; hidden: how many there are
        claimed: how many names are more likely than not
        covered: whether the truth is among the hypotheses that make 0.9 together; size: how many those are
        sure_wrong: whether it names a cause with more than 0.9 that is not the truth
        impact_error: error of the stated change of the readings over that change; None where there is hardly any
        gain: error of the extended prediction over that of the nominal one; None where the oil hardly changes
        gross: whether the one gross reading was pointed at; None without one
        seconds: processor time of the diagnosis
    """

    sheet: str
    case: str
    kind: str
    snr: float
    distance: float | None
    truth: str
    top: str
    p_truth: float
    p_top: float
    answered: bool
    alarm: bool
    exact: bool
    shared: int
    hidden: int
    claimed: int
    covered: bool
    size: int
    sure_wrong: bool
    impact_error: float | None
    gain: float | None
    gross: bool | None
    seconds: float
    problem: str = ""

    @property
    def by_name(self) -> bool:
        """Whether a single cause must be named."""
        return self.kind in ("single", "regime") and self.apart

    @property
    def apart(self) -> bool:
        """Whether what is hidden lies far enough from every rival."""
        return self.distance is None or self.distance >= APART

    @property
    def by_set(self) -> bool:
        """Whether a single cause cannot be separated from a rival, so that a set is the right answer."""
        return self.kind in ("single", "regime", "alike") and not self.by_name


def score(truth: Mapping[str, Any], answer: Answer | None, seconds: float, problem: str = "") -> Outcome:
    """The outcome of one case."""
    names = frozenset(str(n) for n in truth["answer"])
    right = [names, *({n} for n in truth.get("fair", ()))]
    given = answer or Answer("consistent", ())
    top, credible = given.top, given.credible()
    named = truth["kind"] in NAMED
    gross = truth.get("gross", {}).get("DATA")
    return Outcome(
        sheet=str(truth.get("sheet", "")),
        case=str(truth["case"]),
        kind=str(truth["kind"]),
        snr=min((float(e["snr"]) for e in truth["effects"]), default=0.0),
        distance=float(truth["rival"]["distance"]) if truth.get("rival") else None,
        truth=_join(names),
        top=_join(top.names) if given.alarm or not top.claims else "nothing",
        p_truth=sum(h.probability for h in given.hypotheses if h.names == names),
        p_top=top.probability,
        answered=answer is not None,
        alarm=given.alarm,
        exact=given.alarm and top.names in right,
        shared=len(given.likely & names),
        hidden=len(names),
        claimed=len(given.likely),
        covered=any(h.names in right for h in credible),
        size=len(credible),
        sure_wrong=top.claims and given.alarm and top.probability > SURE and top.names not in right,
        impact_error=_impact_error(truth, given) if named else None,
        gain=_gain(truth, given) if named else None,
        gross=(int(gross["row"]), str(gross["channel"])) in (given.gross or ()) if gross else None,
        seconds=seconds,
        problem=problem,
    )


def _join(names: frozenset[str]) -> str:
    return " + ".join(sorted(names)) or "nothing"


def _impact_error(truth: Mapping[str, Any], given: Answer) -> float | None:
    """Error of the impact over the impact, each channel by its repeatability; None below one repeatability."""
    sd = truth["repeat_sd"]
    true = np.array([truth["impact"][c] / sd[c] for c in sd])
    if np.abs(true).max() < 1.0:
        return None
    said = np.array([(given.impact.get(c, 0.0) if given.alarm else 0.0) / sd[c] for c in sd])
    return float(np.linalg.norm(said - true) / np.linalg.norm(true))


def _gain(truth: Mapping[str, Any], given: Answer) -> float | None:
    """Error of the extended over that of the nominal prediction; None where the oil changes by less than its noise.

    Points at which the rig runs away count for nothing.
    """
    points = [p for p in truth["points"] if math.isfinite(p["T_oil_C"])]
    if not points or _rms([p["T_oil_C"] - p["T_oil_without_C"] for p in points]) < truth["repeat_sd"]["T_oil_K"]:
        return None
    if any(p["point"] not in given.nominal or p["point"] not in given.extended for p in points):
        return 1.0
    before = _rms([given.nominal[p["point"]] - p["T_oil_C"] for p in points])
    after = _rms([given.extended[p["point"]] - p["T_oil_C"] for p in points])
    return after / max(before, 1e-6)


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def wilson(hits: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate; (0, 1) without cases."""
    if n == 0:
        return 0.0, 1.0
    rate, square = hits / n, z * z
    middle = (rate + square / (2 * n)) / (1 + square / n)
    half = z / (1 + square / n) * math.sqrt(rate * (1 - rate) / n + square / (4 * n * n))
    return (0.0 if hits == 0 else max(middle - half, 0.0)), (1.0 if hits == n else min(middle + half, 1.0))


def median_interval(values: Sequence[float], z: float = 1.959964) -> tuple[float, float]:
    """95 % interval of a median from the ordered values."""
    ordered, n = sorted(values), len(values)
    low = max(math.floor(n / 2 - z * math.sqrt(n) / 2), 0)
    return ordered[low], ordered[n - 1 - low]


@dataclass(frozen=True)
class Bar:
    """A metric: what it takes of each case, None where it says nothing, and what it must reach.

    `bars` is what it must reach, the ambition on the own sheet, and that on others; None for what has no bar.
    """

    name: str
    take: Callable[[Outcome], float | bool | None]
    bars: tuple[float, float, float] | None = None
    how: str = "rate"
    at_most: bool = False


def _if(applies: bool, value: float | bool | None) -> float | bool | None:
    return value if applies else None


BARS: tuple[Bar, ...] = (
    Bar(
        "false alarms on clean data",
        lambda o: _if(o.kind == "clean", o.alarm or not o.answered),
        (0.07, 0.05, 0.05),
        at_most=True,
    ),
    Bar("detection", lambda o: _if(o.kind in NAMED, o.alarm), (0.93, 0.98, 0.99)),
    Bar("exact name first", lambda o: _if(o.by_name, o.exact), (0.80, 0.90, 0.92)),
    Bar("truth in the 90 % set", lambda o: _if(o.by_name, o.covered), (0.90, 0.93, 0.95)),
    Bar("size of the 90 % set, mean", lambda o: _if(o.by_name and o.answered, o.size), (2.2, 2.0, 1.6), "mean", True),
    Bar("two causes: both", lambda o: _if(o.kind == "pair", o.exact), (0.70, 0.75, 0.85)),
    Bar("two causes: at least one", lambda o: _if(o.kind == "pair", o.shared > 0), (0.90, 0.95, 0.97)),
    Bar(
        "several causes: share that is named",
        lambda o: _if(o.kind == "several" and o.apart, o.shared / max(o.hidden, 1)),
        (0.50, 0.60, 0.70),
        "mean",
    ),
    Bar(
        "several causes: wrong ones named, mean",
        lambda o: _if(o.kind == "several" and o.apart, o.claimed - o.shared),
        (0.30, 0.20, 0.10),
        "mean",
        True,
    ),
    Bar("regime-limited cause first", lambda o: _if(o.by_name and o.kind == "regime", o.exact), (0.80, 0.90, 0.94)),
    Bar(
        "outside: not claimed > .9",
        lambda o: _if(o.kind == "outside", o.answered and not o.sure_wrong),
        (0.50, 0.75, 0.80),
    ),
    Bar("single or regime wrong with > .9", lambda o: _if(o.by_name, o.sure_wrong), (0.03, 0.03, 0.03), at_most=True),
    Bar("nearer than 3 sigma: truth in the 90 % set", lambda o: _if(o.by_set, o.covered), (0.88, 0.93, 0.95)),
    Bar(
        "nearer than 3 sigma: wrong with > .9", lambda o: _if(o.by_set, o.sure_wrong), (0.08, 0.03, 0.03), at_most=True
    ),
    Bar("severe: first", lambda o: _if(o.kind == "severe", o.exact)),
    Bar("severe: in the 90 % set", lambda o: _if(o.kind == "severe", o.covered)),
    Bar("severe: wrong with > .9", lambda o: _if(o.kind == "severe", o.sure_wrong), at_most=True),
    Bar("weak: wrong with > .9", lambda o: _if(o.kind == "weak", o.sure_wrong), (0.10, 0.05, 0.05), at_most=True),
    Bar("impact error, median", lambda o: o.impact_error, (0.20, 0.10, 0.05), "median", True),
    Bar("held-out RMSE after/before, median", lambda o: o.gain, (0.35, 0.25, 0.15), "median", True),
    Bar("gross reading named by row and channel", lambda o: o.gross),
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


def metrics(outcomes: Sequence[Outcome]) -> list[Metric]:
    """All metrics of some cases; the ambition is that of the own sheet where all of them are of it."""
    column = 1 if {o.sheet for o in outcomes} == {"own"} else 2
    pooled = []
    for bar in BARS:
        values = [float(v) for v in map(bar.take, outcomes) if v is not None]
        value, interval = _summary(values, bar.how)
        must, ambitious = (bar.bars[0], bar.bars[column]) if bar.bars else (None, None)
        met = [_reaches(value, b, bar.at_most) for b in (must, ambitious)]
        pooled.append(Metric(bar.name, value, interval, len(values), bar.at_most, must, met[0], ambitious, met[1]))
    return pooled


def _summary(values: Sequence[float], how: str) -> tuple[float | None, tuple[float, float] | None]:
    if not values:
        return None, None
    if how == "rate":
        return float(np.mean(values)), wilson(int(sum(values)), len(values))
    if how == "median":
        return float(np.median(values)), median_interval(values)
    mean, half = float(np.mean(values)), 1.959964 * float(np.std(values)) / math.sqrt(len(values))
    return mean, (mean - half, mean + half)


def _reaches(value: float | None, bar: float | None, at_most: bool) -> bool | None:
    if value is None or bar is None:
        return None
    return value <= bar + 1e-12 if at_most else value >= bar - 1e-12


def report(outcomes: Sequence[Outcome], seed: int) -> dict[str, Any]:
    """Everything for the JSON file: pooled, by sheet, and every case."""
    sheets = list(dict.fromkeys(o.sheet for o in outcomes))
    times = [o.seconds for o in outcomes if o.answered]
    return {
        "schema": "gearheat.challenge/2",
        "seed": seed,
        "sheets": {s: sum(o.sheet == s for o in outcomes) for s in sheets},
        "kinds": {kind: sum(o.kind == kind for o in outcomes) for kind in dict.fromkeys(o.kind for o in outcomes)},
        "answered": sum(o.answered for o in outcomes),
        "by_name": sum(o.by_name for o in outcomes),
        "by_set": sum(o.by_set for o in outcomes),
        "metrics": [asdict(m) for m in metrics(outcomes)],
        "by_sheet": {s: [asdict(m) for m in metrics([o for o in outcomes if o.sheet == s])] for s in sheets},
        "cases": [asdict(o) for o in outcomes],
        "seconds": {"median": float(np.median(times)) if times else None, "longest": max(times, default=None)},
    }
