"""From logs to findings: has a machine changed since its healthy past, by more than its type does, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from ...model.errors import DataError
from ...scenarios.measured.logs import Log, read_log
from ...scenarios.measured.table import Sensor
from ...scenarios.scenario import Scenario
from .answer import channels, findings as f
from .answer.evidence import DataQuality, Estimate, GrossReading, Picture, Rows
from .answer.numbers import array
from .infer.logs import Fleet, Moved, Progress, Question, Weighed, fleet, question, weigh
from .model.windows import Windows, windows
from .report.words import with_words
from .request import Inputs

#: An answer is named alone, or its set is, from this probability on.
SURE = 0.9
#: Causes that have a picture, at most.
PICTURES = 3
#: A day [s].
DAY = 86400.0
#: Units of readings by kind of sensor.
UNITS = {"oil_temp": "degC", "wall_temp": "degC", "ambient": "degC", "torque": "N.m", "speed": "rad/s", "power": "W"}


@dataclass(frozen=True, eq=False)
class LogDiagnosis:
    """What the logs say: of all of them, and of each year alone."""

    fleet: Fleet
    question: Question
    whole: Weighed
    years: dict[str, Weighed]
    findings: f.Findings


def diagnose_logs(
    scenario: Scenario,
    logs: Sequence[Log],
    reference: Sequence[Log] = (),
    siblings: Sequence[Log] = (),
    *,
    alpha: float = 0.05,
    seed: int = 0,
    progress: Progress = lambda stage, share: None,
) -> LogDiagnosis:
    """Whether a machine has changed, and what.

    Args:
        scenario: the rig
        logs: in question, of one machine
        reference: of the same machine when it was healthy
        siblings: of other machines of its type
        alpha: accepted rate of false alarms
        seed: kept for the record; nothing is drawn
        progress: called with (stage, fraction done)

    Raises:
        DataError: logs do not go together
    """
    _check(logs, [*reference, *siblings])
    known = fleet(scenario, reference, siblings, logs[0], lambda stage, share: progress(stage, 0.02 + 0.6 * share))
    asked = question(known, logs, lambda stage, share: progress(stage, 0.62 + 0.25 * share))
    progress("hypotheses", 0.87)
    return composed(scenario, known, asked, logs, reference, siblings, alpha=alpha, seed=seed)


def composed(
    scenario: Scenario,
    known: Fleet,
    asked: Question,
    logs: Sequence[Log],
    reference: Sequence[Log] = (),
    siblings: Sequence[Log] = (),
    *,
    alpha: float = 0.05,
    seed: int = 0,
) -> LogDiagnosis:
    """The answer, from what healthy logs and those in question say.

    Args:
        scenario: the rig
        known: what the healthy logs say
        asked: what the logs in question say
        logs, reference, siblings: as they were read
        alpha: accepted rate of false alarms
        seed: kept for the record
    """
    whole = weigh(known, asked)
    years = {label: weigh(known, asked, asked.year == i, dates=False) for i, label in enumerate(asked.labels)}
    found = _findings(scenario, logs, reference, siblings, known, asked, whole, years, alpha, seed)
    return LogDiagnosis(known, asked, whole, years, with_words(found))


def logged(inputs: Inputs, progress: Progress) -> LogDiagnosis:
    """What the logs of a request say.

    Args:
        inputs: what its files hold
        progress: called with (stage, fraction done)

    Raises:
        DataError: all problems of the logs
    """
    request, problems = inputs.request, list[str]()

    def read(paths: Sequence[Path]) -> list[Log]:
        found = []
        for path in paths:
            try:
                found.append(read_log(path, inputs.scenario, inputs.card))
            except DataError as error:
                problems.extend(error.problems)
        return found

    logs, reference, siblings = (read(p) for p in (request.logs, request.reference_logs, request.sibling_logs))
    if problems:
        raise DataError(problems)
    alpha, seed = request.alpha, request.seed
    return diagnose_logs(inputs.scenario, logs, reference, siblings, alpha=alpha, seed=seed, progress=progress)


def _check(logs: Sequence[Log], healthy: Sequence[Log]) -> None:
    """Logs go together: the same step, sensors and kind of time."""
    first, problems = logs[0], []
    for log in (*logs[1:], *healthy):
        if abs(log.step - first.step) > 1e-6 * first.step:
            problems.append(f"{log.name}: samples every {log.step:g} s, {first.name} every {first.step:g} s. Resample.")
        missing = {s.name for s in first.sensors} - {s.name for s in log.sensors}
        if missing:
            problems.append(f"{log.name}: has no column for {', '.join(sorted(missing))}, which {first.name} has.")
        if log.dated != first.dated:
            problems.append(
                f"{log.name}: has {'dates' if log.dated else 'seconds'}, {first.name} has not. Make them alike."
            )
    if problems:
        raise DataError(problems)


def _findings(
    scenario: Scenario,
    logs: Sequence[Log],
    reference: Sequence[Log],
    siblings: Sequence[Log],
    known: Fleet,
    asked: Question,
    whole: Weighed,
    years: dict[str, Weighed],
    alpha: float,
    seed: int,
) -> f.Findings:
    causes = tuple(_cause(whole, c) for c in whole.causes)
    answers = _answers(whole)
    verdict: f.Verdict = "consistent" if whole.nothing > 0.5 else "explained" if len(answers) == 1 else "ambiguous"
    best = max(whole.moved, key=lambda m: m.evidence)
    leading = [whole.best(c) for c in dict.fromkeys(c for answer in answers for (c,) in answer.causes)]
    rows, pictures = _pictures(known, asked, leading[:PICTURES], logs[0].read)
    warnings = [
        text for w in (_lacking(reference, siblings), *(_year_text(y, w) for y, w in years.items())) if (text := w)
    ]
    return f.Findings(
        verdict=verdict,
        about=f.About(
            data=", ".join(log.name for log in logs),
            rig=scenario.name,
            readings=sum(int(np.isfinite(log.values[s.name]).sum()) for log in logs for s in log.read),
            tests=sum(int(log.stretch.max()) + 1 for log in logs),
            reference=", ".join(log.name for log in (*reference, *siblings)),
            logs=tuple(log.name for log in (*logs, *reference, *siblings)),
            log_rows=sum(log.n for log in (*logs, *reference, *siblings)),
            segments=sum(int(log.stretch.max()) + 1 for log in logs),
            seed=seed,
        ),
        test=f.Alarm(alpha=alpha, p_any=_p_any(whole, best, alpha), p_adequacy=_adequacy(asked), null="analytic"),
        hypotheses=tuple(
            f.Hypothesis(causes=c, probability=p) for c, p in whole.hypotheses.items() if p > 1e-4 or not c
        ),
        answers=answers,
        causes=causes,
        data_quality=DataQuality(gross=tuple(_gross(logs))),
        channels=tuple(
            f.Channel(
                name=s.name,
                column=s.column,
                kind=s.kind,
                role="read" if s.role == "read" else "given",
                unit=UNITS[s.kind],
                repeat_sd=s.repeat_sd,
                offset_sd=s.offset_sd,
            )
            for s in logs[0].sensors
        ),
        gain=_gain(known, asked, logs, whole) if verdict != "consistent" else None,
        rows=rows,
        pictures=pictures,
        warnings=tuple(warnings),
    )


def _lacking(reference: Sequence[Log], siblings: Sequence[Log]) -> str:
    if reference and siblings:
        return ""
    lacks = " and ".join(
        name for name, logs in (("--reference-logs", reference), ("--sibling-logs", siblings)) if not logs
    )
    return f"without {lacks} it is not known how healthy machines of this type differ: changes are judged by priors"


def _year_text(year: str, weighed: Weighed) -> str:
    """One year in words."""
    if weighed.nothing > 0.5:
        return f"{year}: nothing has changed ({weighed.nothing:.0%})"
    named = [c for c in weighed.causes if weighed.of(c) > 0.1]
    best = [(c, weighed.best(c)) for c in named[:3]]
    told = [f"{c} {weighed.of(c):.0%} ({m.knob.name} {_size_text(m)})" for c, m in best]
    return f"{year}: changed ({1 - weighed.nothing:.0%}): {'; '.join(told) or 'no cause stands out'}"


def _size_text(m: Moved) -> str:
    if m.knob.unit == "1":
        return f"{100 * np.expm1(m.size):+.0f} % +- {100 * m.sd * np.exp(m.size):.0f} %"
    return f"{m.size:+.1f} +- {m.sd:.1f} {m.knob.unit}"


def _cause(whole: Weighed, cause: str) -> f.Cause:
    m = whole.best(cause)
    own = [(k, share) for k, share in zip(whole.moved, whole.share, strict=True) if k.knob.cause == cause]
    size = _estimate(m)
    return f.Cause(
        id=cause,
        probability=min(whole.of(cause), 1.0),
        detectable=whole.detectable[m.knob.name],
        parameters=(size,),
        forms=tuple(f.FormShare(name=f"{k.knob.name}, {k.when}", share=share) for k, share in own if share > 0.01),
        doc=m.knob.doc,
        exposes="",
        usual=m.knob.usual,
        unit=m.knob.unit,
        meaning=size.doc,
    )


def _estimate(m: Moved) -> Estimate:
    name, doc = ("ln_factor", "logarithm of the factor") if m.knob.unit == "1" else ("shift", "change")
    interval = (m.size - 1.96 * m.sd, m.size + 1.96 * m.sd)
    return Estimate(name=name, value=m.size, ci95=interval, unit=m.knob.unit, doc=doc)


def _answers(whole: Weighed) -> tuple[f.Answer, ...]:
    """The leading hypotheses that reach the sure probability together, nothing left out."""
    if whole.nothing > 0.5:
        return ()
    found, reached, total = [], 0.0, 1 - whole.nothing
    for causes, p in whole.hypotheses.items():
        if not causes or reached > SURE * total:
            continue
        found.append(f.Answer(causes=tuple((c,) for c in causes), probability=p))
        reached += p
        if len(found) == 1 and p > SURE:
            break
    return tuple(found)


def _p_any(whole: Weighed, best: Moved, alpha: float) -> float:
    """p of the largest deviation among all, on the side of alpha on which the probabilities are."""
    z2 = (best.size / max(best.sd, 1e-12)) ** 2
    p = min(1.0, len(whole.moved) * float(chi2.sf(z2, 1)))
    return max(p, alpha) if whole.nothing > 0.5 else min(p, 0.99 * alpha)


def _adequacy(asked: Question) -> float:
    """p of the prediction errors' size over the logs in question against that of the healthy ones, by windows."""
    left = np.nanmean(asked.passed.error**2 / asked.passed.variance, axis=(1, 2))
    n = max(len(left), 1)
    spread = max(float(np.nanstd(left)), 1e-9)
    z = (float(np.nanmean(left)) - 1.0) / (spread / np.sqrt(n) + 0.5)
    return float(np.clip(chi2.sf(max(z, 0.0) ** 2, 1), 1e-6, 0.98))


def _gross(logs: Sequence[Log]) -> list[GrossReading]:
    found = []
    for log in logs:
        for g in log.gross:
            row = int(np.searchsorted(log.lines, g.line)) + 1
            found.append(
                GrossReading(
                    row=row,
                    line=g.line,
                    channel=g.column,
                    size_sd=g.size_sd,
                    shown=g.shown - 273.15,
                    expected=g.expected - 273.15,
                    unit="degC",
                )
            )
    return found


def _gain(known: Fleet, asked: Question, logs: Sequence[Log], whole: Weighed) -> f.Gain | None:
    """Free-running error of each stretch of the logs, with sizes found without it."""
    own = known.filter
    data = windows(logs, own.given, own.read, 0)
    before = np.tile(known.levels.mean[0], (len(data.read), 1))
    after = before.copy()
    chosen: dict[str, int] = {}
    begins = [w[0] for w in data.rows]
    for i, (number, begin) in enumerate(zip(data.machine, begins, strict=True)):
        last = data.rows[i].max()
        held = (asked.windows.machine == number) & (asked.windows.rows.max(axis=1) >= begin)
        held &= asked.windows.rows.max(axis=1) <= last
        if held.all():
            continue
        fold = weigh(known, asked, ~held, dates=False)
        if fold.nothing > 0.5:
            continue
        m = max(fold.moved, key=lambda k: k.evidence)
        chosen[m.knob.cause] = chosen.get(m.knob.cause, 0) + 1
        after[i, known.knobs.index(m.knob)] += m.size
    if not chosen:
        return None
    errors = [own.run(data, z, free=True, slopes=False).error[:, :, 0] for z in (before, after)]
    old, new = (float(np.sqrt(np.nanmean(e**2))) for e in errors)
    both = f.Gain.Both(without=old, **{"with": old}), f.Gain.Both(without=new, **{"with": new})
    return f.Gain(
        scheme="leave-one-segment",
        channel=own.read[0],
        n=int(np.isfinite(errors[0]).sum()),
        rmse_before=old,
        rmse_after=new,
        before=both[0],
        after=both[1],
        chosen=chosen,
        folds=len(begins),
    )


def _pictures(
    known: Fleet, asked: Question, moved: Sequence[Moved], read: Sequence[Sensor]
) -> tuple[Rows, tuple[Picture, ...]]:
    """The windows as rows, the machine's healthy past before those in question, and a picture a cause.

    Args:
        known: what the healthy logs say
        asked: the logs in question
        moved: causes, each in its leading form, the likeliest first
        read: the sensors that are compared
    """
    own, level = known.filter, known.levels.mean[0]
    past, now = known.past.some(known.machine_of[known.season] == 0), asked.windows
    by_time = np.argsort(np.r_[past.time, now.time], kind="stable")

    def left(data: Windows, z: np.ndarray) -> np.ndarray:
        """Measured less simulated, free-running: means of the windows (n, reads)."""
        return np.asarray(np.nanmean(own.run(data, z, free=True, slopes=False).error, axis=1))

    def whole(part: np.ndarray) -> np.ndarray:
        """Past and present in the order of time; the past is as it is."""
        return np.asarray(np.concatenate([healthy, part])[by_time].T)

    healthy, at = left(past, np.tile(level, (len(past.time), 1))), np.tile(level, (len(now.time), 1))
    before, after = left(now, at), []
    for m in moved:
        z = at.copy()
        z[:, known.knobs.index(m.knob)] += m.share * m.size
        after.append(left(now, z))
    counted = [np.where(d.counts[:, :, None], d.read, np.nan) for d in (past, now)]
    measured = np.concatenate([np.nanmean(c, axis=1) for c in counted if len(c)])[by_time].T
    shown = {}
    for j, s in enumerate(read):
        lines = [measured[j], *(measured[j] - whole(e)[j] for e in (before, *after[:1]))]
        values = [array(channels.in_unit(s, line)) for line in lines]
        shown[s.name] = Rows.Values(measured=values[0], nominal=values[1], extended=values[2] if after else ())
    days = (np.sort(np.r_[past.time, now.time]) - now.time.min()) / DAY
    time = Rows.Quantity(label="time since the first log in question", unit="d", values=array(days))
    found = []
    for m, e in zip(moved, after, strict=True):
        best = int(np.argmax(np.nanmean(before**2 - e**2, axis=0)))  # where most is taken away
        lines = [array(channels.difference(read[best], 1.0) * whole(part)[best]) for part in (before, e)]
        found.append(
            Picture(cause=m.knob.cause, channel=read[best].name, quantity="time", before=lines[0], after=lines[1])
        )
    n = len(days)
    return Rows(row=tuple(range(1, n + 1)), channels=shown, quantities={"time": time}), tuple(found)
