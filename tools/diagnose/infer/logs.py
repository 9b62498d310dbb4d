"""Logs against a rig: the machine's knobs from its healthy past and its siblings, and whether they have moved since."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from ....model.core.flatten import flatten
from ....model.machines.roles import Roles
from ....model.machines.spec import assemble
from ....scenarios.measured.logs import Log
from ....scenarios.scenario import Scenario
from ..library.knobs import Knob, knobs
from ..model.logs import Filter, Passed
from ..model.plant import Plant
from ..model.windows import Windows, windows
from .levels import Effect, Levels, Quadratics, Target, estimate, first_levels

#: Passes over the healthy logs, and over those in question.
PASSES = 4
#: Each begins where the last one ended.
TARGET_PASSES = 4
#: State noise [K] of one sample of bodies that no sensor reads.
QUIET = 0.05
#: Of states that are no body's.
SWITCH = 0.8
#: Dates from which on something may have moved: at most so many.
DATES = 6
#: Windows on either side at least.
SIDE = 3
#: Prior probabilities of no cause, as most years of most machines have none.
NOTHING = 0.8
#: Of two.
TWO = 0.03
#: Causes that are tried together with others.
LEADING = 4
#: Correlations of errors are summed over so many samples at most, and down to so much.
MEMORY = 36
#: What lasts longer is a matter of windows and years.
CORRELATED = 0.05
#: Length of a year in time that is no calendar's [s].
YEAR = 365.25 * 86400.0

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Fleet:
    """Logs of machines of one type, a number each.

    Args:
        filter: the rig, compiled
        knobs: what may differ
        past: windows of all healthy logs
        season: number of the season of a machine that each window belongs to
        machine_of: machine of each season
        levels: what the healthy logs say
        independent: share of their samples that count as independent, 0 without any
    """

    filter: Filter
    knobs: tuple[Knob, ...]
    past: Windows
    season: np.ndarray
    machine_of: np.ndarray
    levels: Levels
    independent: float


@dataclass(frozen=True)
class Moved:
    """A cause in a form: the knob, when, its size and standard deviation, and the logarithm of its evidence."""

    knob: Knob
    when: str
    share: np.ndarray
    evidence: float
    size: float
    sd: float


@dataclass(frozen=True)
class Weighed:
    """All hypotheses about some windows.

    Args:
        nothing: probability that nothing has changed
        hypotheses: ids of causes -> probability; () is nothing
        moved: all single causes in all forms, most probable first
        share: probability of each of them within its cause
        detectable: knob -> size that would be found
    """

    nothing: float
    hypotheses: dict[tuple[str, ...], float]
    moved: tuple[Moved, ...]
    share: tuple[float, ...]
    detectable: dict[str, float]

    def of(self, cause: str) -> float:
        """Marginal probability of a cause."""
        return sum(p for causes, p in self.hypotheses.items() if cause in causes)

    @property
    def causes(self) -> tuple[str, ...]:
        """All causes, most probable first."""
        return tuple(sorted(dict.fromkeys(m.knob.cause for m in self.moved), key=lambda c: -self.of(c)))

    def best(self, cause: str) -> Moved:
        """The leading form of a cause."""
        return max((m for m in self.moved if m.knob.cause == cause), key=lambda m: m.evidence)

    def log_bayes_factor(self, causes: Iterable[str]) -> float:
        """Of causes against none: what the windows say without any prior, nothing of causes that have no knob.

        Of several that were not tried together, the one that explains most counts.
        """
        own = set(self.causes)
        known = tuple(sorted(own & set(causes)))
        prior = {0: NOTHING, 1: (1 - NOTHING - TWO) / len(own), 2: 2 * TWO / len(own) ** 2}
        tried = [known] if known in self.hypotheses else [(c,) for c in known]
        least = 1e-300
        logs = [np.log(max(self.hypotheses[key], least) / prior[len(key)]) for key in tried]
        return float(max(logs) - np.log(max(self.nothing, least) / NOTHING))


def filter_of(scenario: Scenario, log: Log) -> tuple[Filter, tuple[Knob, ...]]:
    """A rig and its knobs, compiled for logs with the sensors of one.

    Args:
        scenario: the rig
        log: with all sensors
    """
    roles = Roles.of(scenario.spec)
    relays = {f"{name}.relay": True for name in roles.having("switch")}
    spec = scenario.spec.with_values(relays)
    found = knobs(roles, log.sensors)
    found = tuple(k for k in found if all(p in _parameters(scenario) for p in k.paths))
    paths = list(dict.fromkeys(path for k in found for path in k.paths))
    plant = Plant(flatten(assemble(spec)), paths, [s.reads for s in log.given], [s.reads for s in log.read])
    own = Filter(plant, found, [s.name for s in log.given], [s.name for s in log.read], np.zeros(plant.nx))
    noise = []
    for q in plant.flat.states:
        body = q.name.rpartition(".")[2] == "T"
        noise.append(0.0 if q.unit != "K" else QUIET if body else SWITCH)
    own.drift = np.array(noise)
    return own, found


def _within(progress: Progress, stage: str, begin: float, width: float) -> Callable[[float], None]:
    """Progress of one pass among several."""
    return lambda share: progress(stage, begin + width * share)


def _parameters(scenario: Scenario) -> set[str]:
    return {f"{part.name}.{key}" for part in scenario.spec.parts for key in part.values}


def year_of(time: np.ndarray, dated: bool) -> np.ndarray:
    """Year of each time (n,): the calendar's, or numbers from 0 where there is none."""
    if not dated:
        return np.asarray(np.floor((time - time.min()) / YEAR), dtype=int)
    return np.array([datetime.fromtimestamp(t, UTC).year for t in time])


def season_of(time: np.ndarray, dated: bool) -> np.ndarray:
    """Number of the quarter of a year of each time (n,): the calendar's, or from 0 where there is none."""
    if not dated:
        return np.asarray(np.floor((time - time.min()) / (YEAR / 4)), dtype=int)
    dates = [datetime.fromtimestamp(t, UTC) for t in time]
    return np.array([4 * d.year + (d.month - 1) // 3 for d in dates])


def fleet(
    scenario: Scenario,
    reference: Sequence[Log],
    siblings: Sequence[Log],
    all_sensors: Log,
    progress: Progress = lambda stage, share: None,
) -> Fleet:
    """What the healthy logs say of the machine and its type.

    Args:
        scenario: the rig
        reference: the machine's own past; several are one machine
        siblings: a log of each other machine
        all_sensors: a log that has the sensors of those in question
        progress: told of each stage and the share done
    """
    own, found = filter_of(scenario, all_sensors)
    logs = [*reference, *siblings]
    machine_of_log = [0] * len(reference) + [1 + i for i in range(len(siblings))]
    sd = np.array([k.sd for k in found])
    machines = 1 + len(siblings)
    begun = first_levels(sd, machines)
    if not logs:
        empty = windows([all_sensors], own.given, own.read).some(np.zeros(0, dtype=int))
        return Fleet(own, found, empty, np.zeros(0, dtype=int), np.zeros(0, dtype=int), begun, 0.0)
    past = windows(logs, own.given, own.read)
    seasons = season_of(past.time, all(log.dated for log in logs))
    machine = np.array(machine_of_log)[past.machine]
    keys = sorted(set(zip(machine.tolist(), seasons.tolist(), strict=True)))
    number = {key: i for i, key in enumerate(keys)}
    season = np.array([number[key] for key in zip(machine.tolist(), seasons.tolist(), strict=True)])
    machine_of = np.array([m for m, _ in keys])
    z, levels, thin = np.zeros((machines, len(sd))), begun, 1.0
    for n in range(PASSES):
        at = z[machine]
        stage = f"healthy logs, pass {n + 1} of {PASSES}"
        passed = own.run(past, at, progress=_within(progress, stage, n / PASSES, 1 / PASSES))
        own.scatter = _scatter(own, passed)
        thin = independent(passed) if n + 1 == PASSES else 1.0  # samples count in full on the way there
        levels = estimate(_quadratics(passed, at, thin), season, machine_of, begun)
        z = z + np.clip(levels.mean - z, -sd, sd)
    return Fleet(own, found, past, season, machine_of, levels, thin)


def _quadratics(passed: Passed, at: np.ndarray, thin: float) -> Quadratics:
    """Log likelihoods about zero from slopes and curvatures at z (n, k), of which a share counts."""
    curvature = thin * passed.curvature
    return Quadratics(thin * passed.slope + (curvature @ at[:, :, None])[:, :, 0], curvature)


def _scatter(own: Filter, passed: Passed) -> np.ndarray:
    """Scatter of the readings that makes the prediction errors as large as they are."""
    usual = np.nanmedian(passed.error**2 / passed.variance, axis=(0, 1)) / 0.455
    return np.asarray(own.scatter * np.clip(np.where(np.isfinite(usual), usual, 1.0), 0.25, 4.0) ** 0.5)


def independent(passed: Passed) -> float:
    """Share of the samples that count as independent: one over the sum of the errors' correlations in time."""
    e = np.clip(passed.error / np.sqrt(passed.variance), -3.0, 3.0)
    e = e - np.nanmean(e, axis=(0, 1))
    own = np.nanmean(e**2, axis=(0, 1))
    shares = []
    for j in range(e.shape[2]):
        lags = [float(np.nanmean(e[:, k:, j] * e[:, :-k, j]) / own[j]) for k in range(1, min(MEMORY, e.shape[1] - 1))]
        first = next((k for k, rho in enumerate(lags) if rho < CORRELATED), len(lags))
        shares.append(1 / (1 + 2 * sum(lags[:first])))
    return float(np.mean(shares))


@dataclass(frozen=True, eq=False)
class Question:
    """Logs in question: their windows, the year and season of each, names of the years, what each window says."""

    windows: Windows
    year: np.ndarray
    season: np.ndarray
    labels: tuple[str, ...]
    found: Quadratics
    passed: Passed


def question(found: Fleet, logs: Sequence[Log], progress: Progress = lambda stage, share: None) -> Question:
    """Run the logs in question at the machine's knobs, then where each season has moved to.

    Args:
        found: what the healthy logs say
        logs: of the machine
        progress: told of each stage and the share done
    """
    own = found.filter
    data = windows(logs, own.given, own.read)
    dated = all(log.dated for log in logs)
    years, seasons = year_of(data.time, dated), season_of(data.time, dated)
    named, year = np.unique(years, return_inverse=True)
    seasons_there, season = np.unique(seasons, return_inverse=True)
    at = np.tile(found.levels.mean[0], (len(year), 1))
    sd = np.array([k.sd for k in found.knobs])
    for n in range(TARGET_PASSES):
        stage = f"logs in question, pass {n + 1} of {TARGET_PASSES}"
        passed = own.run(data, at, progress=_within(progress, stage, n / TARGET_PASSES, 1 / TARGET_PASSES))
        last = n + 1 == TARGET_PASSES
        quadratics = _quadratics(passed, at, (found.independent or independent(passed)) if last else 1.0)
        if not last:
            by_season = quadratics.spread(found.levels.window).summed(season, len(seasons_there))
            wide = np.linalg.inv(found.levels.covariance[0] + np.diag(found.levels.season + sd**2))
            C = np.linalg.inv(by_season.H + wide)
            moved = (C @ (by_season.eta + wide @ found.levels.mean[0])[:, :, None])[:, :, 0]
            at = (at[0] + np.clip(moved - at[0], -2 * sd, 2 * sd))[season]
    return Question(data, year, season, tuple(str(y) for y in named), quadratics, passed)


def profiles(time: np.ndarray, dated: bool) -> list[tuple[str, np.ndarray, float]]:
    """When a cause acts: in words, share of its size in each window (n,), and prior weight; drifts reach it at the end.

    Args:
        time: of the windows (n,)
        dated: whether it is a calendar's
    """
    n = len(time)
    found = [("throughout", np.ones(n), 0.5)]
    order = np.sort(time)
    inner = np.linspace(SIDE, n - SIDE, DATES + 2).astype(int)[1:-1] if n > 3 * SIDE else np.zeros(0, dtype=int)
    cuts = np.unique(inner).tolist()
    for cut in cuts:
        date = (order[cut - 1] + order[cut]) / 2
        word = datetime.fromtimestamp(date, UTC).strftime("%Y-%m-%d") if dated else f"{date / 86400:.1f} d"
        found.append((f"since {word}", (time > date).astype(float), 0.4 / len(cuts)))
    if len(cuts):
        found.append(("drifting", (time - time.min()) / max(np.ptp(time), 1.0), 0.1))
    return found


def weigh(found: Fleet, asked: Question, keep: np.ndarray | None = None, *, dates: bool = True) -> Weighed:
    """Probabilities of all causes, single and in pairs.

    Args:
        found: what the healthy logs say
        asked: the logs in question
        keep: which of their windows (n,) bool; all without
        dates: whether causes may begin at a date or drift, too
    """
    keep = np.ones(len(asked.year), dtype=bool) if keep is None else keep
    _, season = np.unique(asked.season[keep], return_inverse=True)
    levels = found.levels
    target = Target(asked.found.some(keep), season, levels.mean[0], levels.covariance[0], levels)
    forms = profiles(asked.windows.time[keep], asked.windows.time.min() > YEAR)
    forms = forms if dates else [("throughout", np.ones(keep.sum()), 1.0)]
    causes = dict.fromkeys(k.cause for k in found.knobs)
    per_cause = {c: sum(k.cause == c for k in found.knobs) for c in causes}
    singles: list[tuple[Moved, Effect, float]] = []
    detectable: dict[str, float] = {}
    for j, knob in enumerate(found.knobs):
        for when, share, weight in forms:
            effect = Effect(j, share, when)
            log, size, cov = target.evidence([effect], [knob.usual])
            prior = np.log((1 - NOTHING - TWO) / len(causes) / per_cause[knob.cause] * weight)
            sd = float(np.sqrt(cov[0, 0]))
            if when == "throughout":
                known = max(1 / cov[0, 0] - 1 / knob.usual**2, 1e-12)
                detectable[knob.name] = float(4.0 / np.sqrt(known))
            singles.append((Moved(knob, when, share, log + prior, float(size[0]), sd), effect, float(prior)))
    singles.sort(key=lambda s: -s[0].evidence)
    logs: dict[tuple[str, ...], list[float]] = {(): [np.log(NOTHING)]}
    for moved, _, _ in singles:
        logs.setdefault((moved.knob.cause,), []).append(moved.evidence)
    for (a, b), log in _pairs(target, singles, len(causes)):
        logs.setdefault(tuple(sorted((a, b))), []).append(log)
    total = {key: float(np.logaddexp.reduce(values)) for key, values in logs.items()}
    top = max(total.values())
    weights = {key: np.exp(value - top) for key, value in total.items()}
    hypotheses = {key: float(w / sum(weights.values())) for key, w in weights.items()}
    of_cause = {c: np.logaddexp.reduce([m.evidence for m, _, _ in singles if m.knob.cause == c]) for c in causes}
    shares = tuple(float(np.exp(m.evidence - of_cause[m.knob.cause])) for m, _, _ in singles)
    ranked = dict(sorted(hypotheses.items(), key=lambda item: -item[1]))
    return Weighed(hypotheses[()], ranked, tuple(m for m, _, _ in singles), shares, detectable)


def _pairs(
    target: Target, singles: Sequence[tuple[Moved, Effect, float]], causes: int
) -> list[tuple[tuple[str, str], float]]:
    """Evidence of pairs: each of the leading causes with the leading form of every other knob."""
    best: dict[int, tuple[Moved, Effect, float]] = {}
    for single in singles:
        best.setdefault(single[1].knob, single)
    leading = sorted(best.values(), key=lambda s: -s[0].evidence)[:LEADING]
    found, done = [], set[tuple[int, int]]()
    for first in leading:
        for second in best.values():
            key = tuple(sorted((first[1].knob, second[1].knob)))
            if first[0].knob.cause == second[0].knob.cause or key in done:
                continue
            done.add((key[0], key[1]))
            log, _, _ = target.evidence([first[1], second[1]], [first[0].knob.usual, second[0].knob.usual])
            prior = np.log(TWO) + first[2] + second[2] - 2 * np.log(1 - NOTHING - TWO)
            found.append(((first[0].knob.cause, second[0].knob.cause), log + float(prior) + np.log(2)))
    return found
