"""Logs against a rig: the machine's knobs from its healthy past and its siblings, and whether they have moved since."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

import numpy as np

from ....model.machines.roles import Roles
from ....scenarios.measured.logs import Log
from ....scenarios.measured.nominal import Nominal, drive_by
from ....scenarios.measured.table import Campaign
from ....scenarios.scenario import Scenario
from ..library.knobs import knobs
from ..model.curves import Curves
from ..model.entries import Term
from ..model.logged import Logged
from ..model.logs import Filter, Quadratics
from ..model.plant import Plant
from ..model.windows import WINDOW, Duty, Windows, at_duty, windows
from .levels import SEASON, Levels, estimate, evidence_of, first_levels
from .problem import Look, Problem
from .walk import PASSES, Places, curves, independent, suit, walk
from .weigh import Progress

#: A day [s].
DAY = 86400.0
#: State noise [K] of one sample of bodies that no sensor reads.
QUIET = 0.05
#: Of states that are no body's.
SWITCH = 0.8
#: Seasons in question at most; of longer logs some count as one.
SEASONS = 12
#: Spans of time of which the logs in question tell the knobs, about.
SPANS = 16
#: Pieces of short logs whose knobs are sought each apart without healthy logs: else a change would count as scatter.
PIECES = 3
#: Samples of a window that count, at least, and windows below which logs are short.
SHORTEST = 40
FEW = 5
#: Of the logarithm of the scatter of what the filter says, which healthy logs have told.
STIFF = 0.02
#: Time from the last healthy logs to those in question, where it is no calendar's [s].
LATER = 14 * DAY
#: How losses, heat paths and instruments follow a feature of the duty otherwise than their laws say, as a share of how
#: machines differ,
LAW = 0.15
#: and what is no cause, as heat capacities: by them a rig of few bodies errs in what passes soon.
INNER = 0.3
#: What is left of a temperature by a feature of the duty [K].
ERR = 0.8
#: Shares of all this: the first is taken by which healthy logs are not less likely than by another by so many nats.
FOLLOWED = (1.0, 0.3, 0.1, 0.03)
REFUTED = 2.0
#: How windows of a season differ, as shares of how machines do: chosen with them.
WANDERED = (0.1, 0.03, 0.01)
#: Length of a year in time that is no calendar's [s].
YEAR = 365.25 * DAY


@dataclass(frozen=True, eq=False)
class Fleet:
    """Logs of machines of one type, a number each.

    Args:
        filter: the rig, compiled
        past: windows of the healthy logs of the machine in question
        levels: what the healthy logs say; that machine is the first
        share: of their samples that counts, 0 without any
        length: samples of a window that count
        curves: of its knobs
        duty: what is usual
        seasons: machine and number of a season -> number of that one in the levels, its middle time [s]
    """

    filter: Filter
    past: Windows
    levels: Levels
    share: float
    length: int
    curves: Curves
    duty: Duty
    seasons: Mapping[tuple[int, int], tuple[int, float]] = field(default_factory=dict)

    def of(self, machine: int) -> Fleet:
        """The same with one of its machines in question, without its past."""
        mean, covariance = (a[[machine]] for a in (self.levels.mean, self.levels.covariance))
        levels = replace(self.levels, mean=mean, covariance=covariance)
        seasons = {(0, number): known for (one, number), known in self.seasons.items() if one == machine}
        past = self.past.some(np.zeros(0, dtype=int))
        return replace(self, past=past, levels=levels, seasons=seasons)

    def does(self, data: Windows) -> np.ndarray:
        """What the machine's knobs do in windows of their duties, in proportion to effects (n, k)."""
        return at_duty(self.duty.at(data), self.levels.mean[[0] * len(data.time)])

    def usual(self, data: Windows) -> np.ndarray:
        """The machine's knobs in windows of their duties (n, k)."""
        return self.curves.back(self.does(data))

    def going_on(self, logs: Sequence[Log]) -> Fleet:
        """The same for logs in question in one season of the machine's healthy ones, the nearer the more so.

        Logs without dates count as some weeks after the last of the healthy ones.
        """
        ends = np.array([log.time[k] for log in logs for k in (0, -1)])
        own, dated = [season for machine, season in self.seasons if not machine], all(log.dated for log in logs)
        there = set(season_of(ends, True).tolist()) if dated else set(own[-1:])
        if len(there) != 1 or not there <= set(own):
            return self
        number, time = self.seasons[0, there.pop()]
        away = abs(float(ends.mean()) - time) if dated else LATER
        return replace(self, levels=self.levels.within(number, away / (YEAR / 4)))


def filter_of(scenario: Scenario, log: Log) -> Filter:
    """A rig with its knobs, driven by what logs give, compiled for logs with the sensors of one."""
    driven = drive_by(scenario, log.sensors)
    roles = Roles.of(driven.spec)
    relays = {f"{name}.relay": True for name in roles.having("switch")}
    flat, nominal = driven.spec.with_values(relays).flat(), Nominal(driven)
    loss = abs(sum(nominal.value(f"{end}.w") * nominal.value(f"{end}.tau") for end in roles.ends))
    free = flat.index.keys() - {s.reads for s in log.sensors}
    found = tuple(k for k in knobs(roles, log.sensors, loss) if free >= set(k.paths))
    paths = list(dict.fromkeys(path for k in found for path in k.paths))
    plant = Plant(flat.holding(paths), paths, [s.reads for s in log.given], [s.reads for s in log.read])
    noise = np.array([QUIET if q.name in flat.bodies else SWITCH if q.unit == "K" else 0.0 for q in flat.states])
    return Filter(plant, found, log.given, log.read, noise)


def _pass(progress: Progress, logs: str) -> Callable[[int, float], None]:
    """Progress of passes over some logs."""
    return lambda n, share: progress(f"{logs}, pass {n + 1} of at most {PASSES}", (n + share) / PASSES)


def window_length(logs: Sequence[Log]) -> int:
    """Samples of a window that count: of short logs so many that these have as many windows as spans."""
    n = sum(log.n for log in logs)
    return WINDOW if n >= FEW * WINDOW else int(np.clip(n // SPANS, SHORTEST, WINDOW))


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
    length: int = WINDOW,
) -> Fleet:
    """What the healthy logs say of the machine and its type.

    Args:
        scenario: the rig
        reference: the machine's own past; several are one machine
        siblings: a log of each other machine
        all_sensors: a log that has the sensors of those in question
        progress: told of each stage and the share done
        length: samples of a window that count
    """
    own = filter_of(scenario, all_sensors)
    logs = [*reference, *siblings]
    sd = np.array([k.sd for k in own.knobs])
    past = windows(logs or [all_sensors], own.given, own.read, length)
    duty = Duty.of(past, all_sensors.given, all_sensors.read)
    errs = [knob.unit == "K" and knob.sensor in own.read for knob in own.knobs]
    slopes = np.where(errs, ERR, sd * [LAW if knob.cause else INNER for knob in own.knobs])
    slopes, n = np.tile(slopes, len(duty.usual)), 1 + len(siblings)
    usual = np.array([k.season or SEASON * k.sd for k in own.knobs])
    tried = [first_levels(sd, usual, share * slopes, n, wander) for share in FOLLOWED for wander in WANDERED]
    begun = tried[0]
    if not logs:
        return Fleet(own, past.some(np.zeros(0, dtype=int)), begun, 0.0, length, Curves({}, np.zeros(len(sd))), duty)
    machine = np.array([0] * len(reference) + [1 + i for i in range(len(siblings))])[past.machine]
    each = np.column_stack([machine, season_of(past.time, all(log.dated for log in logs))])
    keys, season = np.unique(each, axis=0, return_inverse=True)
    suit(own, past, np.zeros((len(machine), len(sd))))
    bent, there = curves(own, past), duty.at(past)
    places = Places(machine, there, np.zeros((len(machine), len(sd))), bent)
    z, passed = walk(own, past, places, begun.covariance[0], _pass(progress, "healthy logs"))
    share = independent(passed)
    told = places.told(passed, z).times(share)
    logs_of = [evidence_of(told, there, machine, one) for one in tried]
    begun = next(one for one, log in zip(tried, logs_of, strict=True) if log > max(logs_of) - REFUTED)
    levels = estimate(told, there, season, keys[:, 0], begun)
    seasons = {(int(m), int(q)): (n, float(past.time[season == n].mean())) for n, (m, q) in enumerate(keys)}
    return Fleet(own, past.some(machine == 0), levels, share, length, bent, duty, seasons)


@dataclass(frozen=True, eq=False)
class Question:
    """Logs in question.

    Args:
        windows: of them
        season: number of the season of each window
        span: number of the span of time of each window, those of a season one after the other
        told: what each window says of moves of the knobs from the machine's values, in proportion to effects
        curves: of moves from the machine's values
    """

    windows: Windows
    season: np.ndarray
    span: np.ndarray
    told: Quadratics
    curves: Curves


def question(found: Fleet, logs: Sequence[Log], progress: Progress = lambda stage, share: None) -> Question:
    """What the logs in question say of the knobs, told where each season has moved to; progress as of `fleet`."""
    levels, k = found.levels, len(found.filter.knobs)
    data = windows(logs, found.filter.given, found.filter.read, found.length)
    there, season = np.unique(season_of(data.time, all(log.dated for log in logs)), return_inverse=True)
    season = season * min(SEASONS, len(there)) // len(there)
    if not found.share:  # what is shown later is of this filter, too
        suit(found.filter, data, np.zeros((len(season), k)))
    own, span = copy(found.filter), _spans(data.time, season, SPANS)
    changed = np.diag([knob.sd**2 if knob.cause else 0.0 for knob in own.knobs])
    wide = levels.covariance[0, :k, :k] + levels.season[:k, :k] + changed
    own.least = own.scatter if found.share else own.least
    bent = found.curves if found.share else curves(own, data)
    group = season if found.share else _spans(data.time, season, PIECES)
    places = Places(group, np.ones((len(season), 1)), found.does(data), bent)
    at, passed = walk(own, data, places, wide, _pass(progress, "logs in question"))
    told = places.told(passed, at).times(found.share or independent(passed))
    return Question(data, season, span, told, bent.about(levels.mean[0, :k]))


def _spans(time: np.ndarray, season: np.ndarray, many: int) -> np.ndarray:
    """Number of the span of each window (n,): of about so many, each season in as many of like numbers of windows."""
    each = max(many // (int(season.max()) + 1), 1)
    span, first = np.zeros(len(time), dtype=int), 0
    for number in range(int(season.max()) + 1):
        mine = np.flatnonzero(season == number)
        parts = np.array_split(mine[np.argsort(time[mine], kind="stable")], min(each, len(mine)))
        for k, part in enumerate(parts):
            span[part] = first + k
        first += len(parts)
    return span


class LogProblem(Problem):
    """Logs in question as readings: what the filter says of the knobs in each span.

    Args:
        data: the spans
        season: number of the season of each
        root: how the knobs of each differ between healthy seasons, for independent normal numbers (n, k, r)
        levels: of healthy machines
    """

    def __init__(self, data: Logged, season: np.ndarray, root: np.ndarray, levels: Levels) -> None:
        super().__init__([data], 0.0)
        self.spans, self.ends = data, np.zeros(data.m, dtype=bool)
        self.alike, self.same = np.ones((data.m, data.m)), np.eye(data.m)  # each entry is a channel of its own
        root = data.felt(root, data.row)
        own = (season[:, None] == np.unique(season))[data.row]
        self.seasons = (root[:, :, None] * own[:, None, :]).reshape(data.m, -1)
        #: Of the logarithm of a standard deviation that is known to so many degrees of freedom.
        self.loose = float(1 / np.sqrt(2 * levels.freedom))

    def scatters(self, look: Look) -> list[Term]:
        """What scatters: the filter's own, and healthy seasons."""
        own = Term("what the filter says", variance=np.ones(self.m), loose=STIFF)
        return [own, Term("seasons", self.seasons, loose=self.loose)]

    def inputs(self, look: Look) -> list[tuple[str, np.ndarray]]:
        """Scatter of what drives the rig is the filter's."""
        return []


def problem_of(found: Fleet, asked: Question, logs: Sequence[Log]) -> LogProblem:
    """The logs in question as a problem like that of readings, beside what healthy ones say."""
    own, data = found.filter, asked.windows
    n = int(asked.span.max()) + 1
    told = asked.told.spread(found.levels.window).summed(asked.span, n)
    time = np.array([data.time[asked.span == k].mean() for k in range(n)])
    dated, name = all(log.dated for log in logs), ", ".join(log.name for log in logs)
    clock = "%Y-%m-%d" if np.ptp(time) > n * DAY else "%Y-%m-%d %H:%M"
    begin = [float(data.time[asked.span == k].min()) for k in range(n)]
    date = tuple(f"{datetime.fromtimestamp(t, UTC):{clock}}" if dated else f"{t:.4g} s" for t in begin)
    values = {s.name: np.zeros(n) for s in logs[0].sensors}
    campaign = Campaign.of(name, logs[0].sensors, values, np.arange(n), order=time, date=date, names=("",) * n)
    season = np.array([asked.season[asked.span == k][0] for k in range(n)])
    duties = found.duty.at(data)
    duty = np.array([duties[asked.span == k].mean(axis=0) for k in range(n)])
    follow = np.kron(duty, np.eye(len(own.knobs))).reshape(n, len(own.knobs), -1)
    machine, seasons = (follow @ np.linalg.cholesky(C) for C in (found.levels.covariance[0], found.levels.season))
    spans = Logged(own.plant, campaign, own.knobs, told, machine, asked.curves)
    return LogProblem(spans, season, seasons, found.levels)
