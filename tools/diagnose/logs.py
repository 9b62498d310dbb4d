"""From logs to findings: has a machine changed since its healthy past, by more than its type does, and how."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import DataError, Problems
from ...scenarios.measured.logs import Log, read_log
from .answer import channels, compose, findings as f
from .answer.decide import Decision, decide, temper
from .answer.estimate import impacts_of
from .answer.evidence import DataQuality, GrossReading, Picture, Rows
from .answer.numbers import array
from .answer.quality import is_apart
from .infer.found import Found, Hypothesis
from .infer.logs import DAY, LATER, Fleet, Question, fleet, problem_of, question, window_length
from .infer.problem import Aside
from .infer.weigh import Options, Progress, weigh
from .library.cause import Cause
from .library.knobs import moves
from .model.formula import Formula
from .model.logged import Logged
from .model.windows import Windows, means, of_readings, windows
from .report.words import with_words
from .request import Inputs, Request
from .setting import Setting

#: Time in which what a cause changes has come about [s].
WARM = 3 * DAY
#: p of what is left, at most: samples count for less than they may, so that it is smaller than expected.
QUIET = 0.98
#: Parts of the spans that are left out in turn.
FOLDS = 3


@dataclass(frozen=True, eq=False)
class Logs:
    """Logs in question, and those of healthy machines: of this one, and of others of its type."""

    logs: Sequence[Log]
    reference: Sequence[Log] = ()
    siblings: Sequence[Log] = ()

    @property
    def healthy(self) -> tuple[Log, ...]:
        """Of all machines."""
        return (*self.reference, *self.siblings)


@dataclass(frozen=True, eq=False)
class LogDiagnosis:
    """What the logs say; `spans` are those in question as a campaign."""

    found: Found
    decision: Decision
    findings: f.Findings
    spans: Logged

    @property
    def causes(self) -> tuple[str, ...]:
        """All that logs can show."""
        return tuple(dict.fromkeys(formula.cause.id for formula in self.found.formulas))

    def asked(self, cause: Cause) -> str:
        """As what logs were asked about a cause: itself, or of those like it the one that they speak for most."""
        alike = dict.fromkeys(of.cause.id for of in self.found.formulas if of.cause.like == cause.like != "")
        known = cause.id in self.causes or not alike
        return cause.id if known else max(alike, key=lambda id: self.found.log_bayes_factor([id]))

    def of(self, cause: str) -> float:
        """Probability of a cause."""
        known = self.decision.marginal.get(cause)
        return known.probability if known else 0.0


def read_logs(inputs: Inputs) -> Logs:
    """All logs of a request.

    Raises:
        DataError: all problems of the files
    """
    request, problems = inputs.request, Problems()

    def read(paths: Sequence[Path]) -> tuple[Log, ...]:
        found = [problems.of(partial(read_log, path, inputs.scenario, inputs.card)) for path in paths]
        return tuple(log for log in found if log is not None)

    logs, reference, siblings = (read(p) for p in (request.logs, request.reference_logs, request.sibling_logs))
    problems.check(DataError)
    return Logs(_in_turn(logs), _in_turn(reference), siblings)


def _in_turn(logs: Sequence[Log]) -> tuple[Log, ...]:
    """Logs of one machine: without dates each begins behind the one before."""
    found = list(logs[:1])
    for log in logs[1:]:
        late = max(found[-1].time[-1] + log.step - log.time[0], 0.0)
        found.append(log if log.dated else replace(log, time=log.time + late))
    return tuple(found)


def logged(inputs: Inputs, progress: Progress) -> LogDiagnosis:
    """What the logs of a request say: whether a machine has changed, and what; progress as of `diagnosis.diagnose`.

    Raises:
        DataError: all problems of the logs
    """
    data = read_logs(inputs)
    check(data)
    length = window_length(data.logs)
    known = fleet(
        inputs.scenario, data.reference, data.siblings, data.logs[0], lambda t, p: progress(t, 0.02 + 0.4 * p), length
    ).going_on(data.logs)
    asked = question(known, data.logs, lambda stage, p: progress(stage, 0.42 + 0.2 * p))
    return composed(inputs, known, asked, data, progress)


def formulas_of(known: Fleet, log: Log) -> tuple[Formula, ...]:
    """Forms of all causes that logs with the sensors of one can show."""
    names, read = [s.name for s in log.sensors], [s.name for s in log.read]
    return tuple(Formula(cause, form, names, read) for cause in moves(known.filter.knobs) for form in cause.forms)


def judged(
    inputs: Inputs,
    known: Fleet,
    asked: Question,
    logs: Logs,
    progress: Progress = lambda stage, share: None,
    formulas: Sequence[Formula] = (),
) -> LogDiagnosis:
    """The answer without pictures, gain and words, from what healthy logs and those in question say.

    Args:
        inputs: rig, card and options
        known: what the healthy logs say
        asked: what the logs in question say
        logs: as they were read
        progress: called with (stage, fraction done)
        formulas: those of `formulas_of`, where they are there
    """
    request, problem = inputs.request, problem_of(known, asked, logs.logs)
    formulas = tuple(formulas or formulas_of(known, logs.logs[0]))
    causes = tuple({formula.cause.id: formula.cause for formula in formulas}.values())
    made = Setting(inputs.scenario, inputs.scenario.spec, causes, formulas, problem)
    options = Options(request.alpha, request.seed, request.causes)
    found = temper(weigh(problem, formulas, options, lambda t, p: progress(t, 0.62 + 0.2 * p)))
    decision = decide(found)
    return LogDiagnosis(found, decision, _findings(made, found, decision, inputs, logs), problem.spans)


def composed(
    inputs: Inputs, known: Fleet, asked: Question, logs: Logs, progress: Progress = lambda stage, share: None
) -> LogDiagnosis:
    """The whole answer; as `judged`."""
    told = judged(inputs, known, asked, logs, progress)
    findings = told.findings
    if findings.verdict != "consistent" and not inputs.request.quick and told.spans.campaign.n > 1:
        findings = findings.model_copy(update={"gain": _gain(known, asked, told, inputs.request, progress)})
    rows, drawn, off = _pictures(known, asked, told, logs.logs[0])
    quality = findings.data_quality.model_copy(update={"as_filed": {} if logs.healthy else off})
    update = {"rows": rows, "pictures": drawn, "data_quality": quality} | _impacts(known, asked, told, logs.logs)
    return replace(told, findings=with_words(findings.model_copy(update=update)))


def _findings(made: Setting, found: Found, decision: Decision, inputs: Inputs, data: Logs) -> f.Findings:
    """The findings without pictures and words."""
    logs, segments = data.logs, sum(int(log.stretch.max()) + 1 for log in data.logs)
    return f.Findings(
        **compose.common(made, found, decision),
        about=f.About(
            data=", ".join(log.name for log in logs),
            rig=made.scenario.name,
            readings=sum(int(np.isfinite(log.values[s.name]).sum()) for log in logs for s in log.read),
            tests=segments,
            reference=", ".join(log.name for log in data.healthy),
            logs=tuple(log.name for log in (*logs, *data.healthy)),
            log_rows=sum(log.n for log in (*logs, *data.healthy)),
            segments=segments,
            seed=inputs.request.seed,
        ),
        test=f.Alarm(
            alpha=inputs.request.alpha,
            p_any=decision.p_any,
            p_adequacy=None if decision.p_adequacy is None else min(decision.p_adequacy, QUIET),
            draws=len(found.drawn),
        ),
        data_quality=DataQuality(gross=tuple(_gross(logs))),
        channels=tuple(channels.channel(s) for s in logs[0].sensors),
        warnings=tuple(dict.fromkeys(_warnings(data))),
    )


def check(data: Logs) -> None:
    """Logs go together: the same step, sensors and kind of time."""
    first, problems = data.logs[0], Problems()
    for log in (*data.logs[1:], *data.healthy):
        if abs(log.step - first.step) > 1e-6 * first.step:
            problems.append(f"{log.name}: samples every {log.step:g} s, {first.name} every {first.step:g} s. Resample.")
        if missing := {s.name for s in first.sensors} - {s.name for s in log.sensors}:
            problems.append(f"{log.name}: has no column for {', '.join(sorted(missing))}, which {first.name} has.")
        if log.dated != first.dated:
            said = "dates" if log.dated else "seconds"
            problems.append(f"{log.name}: has {said}, {first.name} has not. Make them alike.")
    problems.check(DataError)


def _warnings(data: Logs) -> Iterator[str]:
    given = {"--reference-logs": data.reference, "--sibling-logs": data.siblings}
    if lacks := " and ".join(name for name, logs in given.items() if not logs):
        yield f"without {lacks} it is not known how healthy machines of this type differ: changes are judged by priors"
    ways = {" two weeks after the reference": bool(data.reference), " one behind the other": len(data.logs) > 1}
    if not data.logs[0].dated and (said := [way for way, holds in ways.items() if holds]):
        yield f"the logs have no dates: those in question count as{','.join(said)}. Give dates if not"
    yield from (text for log in data.logs for text in log.warnings)


def _gross(logs: Sequence[Log]) -> list[GrossReading]:
    return [
        GrossReading(
            row=int(np.searchsorted(log.lines, g.line)) + 1,
            line=g.line,
            channel=g.column,
            size_sd=g.size_sd,
            shown=g.shown - 273.15,
            expected=g.expected - 273.15,
            unit="degC",
        )
        for log in logs
        for g in log.gross
    ]


def _gain(known: Fleet, asked: Question, told: LogDiagnosis, request: Request, progress: Progress) -> f.Gain:
    """Free-running error of spans of the logs, with the causes that are found without them."""
    own, data, spans, found = known.filter, asked.windows, told.spans, told.found
    options = Options(request.alpha, request.seed, request.causes, critical=found.critical)
    read, folds = spans.read, min(FOLDS, spans.campaign.n)
    before, after, chosen = known.usual(data), known.usual(data), Counter[str]()
    for k in range(folds):
        rows = np.arange(k, spans.campaign.n, folds)
        aside = frozenset(Aside(int(i)) for i in np.flatnonzero(np.isin(spans.row, rows)))
        kept = weigh(found.problem.without(aside), found.formulas, options).hypotheses[0]
        chosen.update(kept.causes)
        held = np.isin(asked.span, rows)
        after[held] += _moves(spans, kept)[asked.span[held]]
        progress("spans left out", 0.82 + 0.16 * (k + 1) / folds)
    errors = [own.run(data, z, slopes=False).error for z in (before, after)]
    counted = np.isfinite(errors[0]).sum(axis=(0, 1))
    j = min(np.flatnonzero(counted), key=lambda k: read[k].kind != "oil_temp")  # of the oil, where it is read
    s = read[j]
    old, new = (channels.difference(s, float(np.sqrt(np.nanmean(e[:, :, j] ** 2)))) for e in errors)
    sides = [f.Gain.Both.model_validate({"without": e, "with": e}) for e in (old, new)]
    return f.Gain(
        scheme="leave-out-spans",
        channel=s.name,
        unit=channels.unit_of_difference(s),
        n=int(counted[j]),
        rmse_before=old,
        rmse_after=new,
        before=sides[0],
        after=sides[1],
        chosen=dict(chosen.most_common()),
        folds=folds,
    )


def _moves(spans: Logged, h: Hypothesis, *only: str) -> np.ndarray:
    """How far a hypothesis, or some of its causes, moves the knobs in each span (n, k)."""
    return spans.moves([(a.formula, a.t) for a in h.fit.look.acting if not only or a.id in only])


def _pictures(
    known: Fleet, asked: Question, told: LogDiagnosis, log: Log
) -> tuple[Rows, tuple[Picture, ...], dict[str, float]]:
    """The windows as rows, the machine's past before those in question, a picture a cause, and means of the errors."""
    own, read, leader, spans = known.filter, log.read, told.decision.leader, told.spans
    past, now = known.past, asked.windows
    begin = now.time.min() if log.dated else past.time.max(initial=-np.inf) + LATER
    when = np.r_[past.time - begin, now.time - now.time.min()]
    by_time = np.argsort(when, kind="stable")

    def left(data: Windows, moves: np.ndarray) -> np.ndarray:
        """Measured less simulated, free-running: means of the windows (n, reads)."""
        return means(own.run(data, known.usual(data) + moves, slopes=False).error)

    def whole(part: np.ndarray) -> np.ndarray:
        """Past and present in the order of time; the past is as it is."""
        return np.asarray(np.concatenate([healthy, part])[by_time].T)

    healthy, before = (left(data, np.zeros((len(data.time), len(own.knobs)))) for data in (past, now))
    after = {cause: left(now, _moves(spans, leader, cause)[asked.span]) for cause in leader.causes}
    together = [left(now, _moves(spans, leader)[asked.span])] if leader.causes else []
    measured = np.concatenate([means(np.where(d.counts[:, :, None], d.read, np.nan)) for d in (past, now)])[by_time].T
    shown = {}
    for j, s in enumerate(read):
        lines = [measured[j], *(measured[j] - whole(e)[j] for e in (before, *together))]
        values = [array(channels.in_unit(s, s.signs[0] * line)) for line in lines]
        shown[s.name] = Rows.Values(measured=values[0], nominal=values[1], extended=values[2] if together else ())
    time = Rows.Quantity(label="time since the first log in question", unit="d", values=array(when[by_time] / DAY))
    found = []
    for cause, e in after.items():
        whole_of = np.maximum(np.nansum(before**2 + own.read_sd**2, axis=0), own.read_sd**2)
        share = np.nansum(before**2 - e**2, axis=0) / whole_of
        best = int(np.argmax(share))  # where most of what is more than noise is taken away
        unit = channels.difference(read[best], read[best].signs[0])
        sides = [array(unit * whole(part)[best]) for part in (before, e)]
        found.append(Picture(cause=cause, channel=read[best].name, quantity="time", before=sides[0], after=sides[1]))
    errors = zip(read, of_readings(np.mean, before).tolist(), strict=True)
    off = {s.name: e for s, e in errors if s.kind.endswith("_temp") and is_apart(e, s.offset_sd)}
    return Rows(row=tuple(range(1, len(when) + 1)), channels=shown, quantities={"time": time}), tuple(found), off


def _impacts(known: Fleet, asked: Question, told: LogDiagnosis, logs: Sequence[Log]) -> dict[str, Any]:
    """What the causes of the leader change, each and all together, as fields of the findings: means of free runs.

    Whole logs are run, with the largest move of each cause, and count by how far it has moved on average.
    """
    own, leader, read, changes = known.filter, told.decision.leader, logs[0].read, {}
    if not leader.fit.causes:
        return {}
    first = int(WARM / logs[0].step)  # rows that begin each window, which are not corrected
    whole = windows([_warmed(log, min(first, log.n)) for log in logs], own.given, own.read, 4 * first, first)
    usual, free = known.usual(whole), replace(whole, counts=whole.there)

    def shown(moves: np.ndarray | float) -> np.ndarray:
        return np.asarray(np.nanmean(own.run(free, usual + moves, slopes=False).shown[whole.counts], axis=0))

    sound, signs = shown(0.0), np.array([s.signs[0] for s in read])
    for cause in leader.fit.causes:
        moves = _moves(told.spans, leader, cause)
        far = np.abs(moves).sum(axis=1)
        share = far[asked.span].mean() / far.max()
        changes[cause] = share * signs * (shown(moves[far.argmax()]) - sound)
    each = {c: impacts_of(told.found.problem, leader, read, {c: changed}) for c, changed in changes.items()}
    causes = (c.model_copy(update={"impact": each.get(c.id, {})}) for c in told.findings.causes)
    return {"causes": tuple(causes), "impact": impacts_of(told.found.problem, leader, read, changes)}


def _warmed(log: Log, first: int) -> Log:
    """The log in one stretch behind its first rows: all runs begin as warm as was read, and need time to differ."""
    rows = np.r_[:first, : log.n]
    values = {name: column[rows] for name, column in log.values.items()}
    return replace(log, values=values, time=log.time[rows], stretch=np.zeros(len(rows), dtype=int))
