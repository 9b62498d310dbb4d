"""The command `sweep`: steady states or warm-ups of many rows, by a grid or at random, kept in a table."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.batch import Batch, Status
from ...model.core.flat import FlatModel
from ...model.errors import GearheatError, ScenarioError, SolveError
from ...model.files import flows
from ...model.run.point import problem_of
from ...model.run.schedule import Schedule
from ...model.run.simulate import simulate
from ...model.run.steady import steady
from ...model.units import from_si, shown, to_si
from ...scenarios.duty import duty_names, read_duty
from ...scenarios.load import load
from ...scenarios.scenario import Scenario
from ..show.console import answer, file_of, note, plottable, say, table, writable
from . import sampling
from .settings import adjusted, flat_of
from .simulate import first_temperatures
from .steady import outside_of, tell_outside, told
from .sweep_file import SUFFIXES, Column, Store, parquet_missing, work_file, write_table
from .sweep_rows import TELLING, Block, Job, clustered, dask_missing, local
from .uncertainties import UNCERTAINTY, reasons, sampled, shares
from .unchecked import print_unchecked, unchecked

#: Rows of a block: what an interruption may cost, and what a worker of a cluster gets at a time.
BLOCKS = {"steady": 8192, "warmup": 256}
#: Quantities that a picture can be drawn over.
MOST_DRAWN = 2
#: Outputs that a picture shows of a rig without oil, body and efficiency.
MOST_PANELS = 6


@dataclass(frozen=True)
class Request:
    """What a user asks for, as written on the command line."""

    rig: str
    vary: Sequence[str]
    out: Path
    sample: int | None = None
    grid: str | None = None
    method: str = "lhs"
    seed: int = 0
    assignments: Sequence[str] = ()
    outputs: Sequence[str] = ()
    kind: str = "steady"
    duty: Path | None = None
    duration: str | None = None
    every: str | None = None
    jobs: int = 0
    scheduler: str | None = None
    json: str | None = None
    plot: Path | None = None


@dataclass(frozen=True)
class Plan:
    """A sweep, ready to run: the values of its rows (rows, axes) and what is done with them.

    `unchecked` holds the catalogue entries in use with values that were compared with no print, `drawn` the outputs
    that a picture shows.
    """

    rig: str
    kind: str
    axes: tuple[sampling.Axis, ...]
    values: np.ndarray
    job: Job
    flat: FlatModel
    unchecked: Sequence[Mapping[str, Any]]
    drawn: Sequence[str]

    @property
    def columns(self) -> list[Column]:
        """The columns of the table."""
        unit = {name: self.flat.quantity(name).unit for name in (*self.job.varied, *self.job.outputs)}
        telling = {"energy_residual": "1", "outside": "1"}
        return [
            Column("row"),
            *(Column(name, unit[name]) for name in self.job.varied),
            *([Column("time", "s")] if self.job.times else []),
            *(Column(name, unit[name]) for name in self.job.outputs),
            *(Column(name, telling.get(name)) for name in TELLING),
        ]

    @property
    def blocks(self) -> list[slice]:
        """The rows of each block."""
        size = BLOCKS[self.kind]
        return [slice(a, min(a + size, len(self.values))) for a in range(0, len(self.values), size)]

    def cells(self, rows: slice, found: np.ndarray) -> list[np.ndarray]:
        """The columns of the table for the finished rows of a block."""
        times = len(self.job.times) or 1
        values = np.repeat(self.values[rows], times, axis=0)
        number = np.repeat(np.arange(rows.start, rows.stop) + 1, times)
        moments = [np.tile(np.array(self.job.times), rows.stop - rows.start)] if self.job.times else []
        return [number, *values.T, *moments, *found.T]

    def outside(self, row: int) -> list[dict[str, Any]]:
        """The laws that one row used outside their range: the row is run again by itself."""
        varied = {name: float(v) for name, v in zip(self.job.varied, self.values[row], strict=True)}
        first = {name: varied[v] if isinstance(v, str) else v for name, v in self.job.start.items()}
        states = {name: v for name, v in (first | varied).items() if self.flat.index[name][0] == "state"}
        given = {name: v for name, v in varied.items() if name not in states}
        try:
            if self.job.schedule is None:
                return outside_of(steady(self.flat, given))
            return outside_of(simulate(self.flat, self.job.schedule, start=states, values=given))
        except SolveError:  # found by the batch from another start
            return []


def command(request: Request) -> None:
    """Plan, solve what an earlier run has not finished, write the table."""
    writable(request.out, file_of(request.json))
    plottable(request.plot)
    plan = planned(request)
    blocks = plan.blocks
    key = plan.job.key(plan.values, BLOCKS[plan.kind])
    with Store(work_file(request.out), key, len(plan.job.outputs) + len(TELLING)) as store:
        left = [k for k in range(len(blocks)) if k not in store.places]
        if len(left) < len(blocks):
            done = len(plan.values) - sum(blocks[k].stop - blocks[k].start for k in left)
            note(f"{done} of {len(plan.values)} rows were finished before: {store.path}")
        todo: Iterable[Block] = ((k, plan.values[blocks[k]]) for k in left)
        if request.scheduler is not None:
            solved = clustered(plan.job, todo, request.scheduler)
        else:
            solved = local(plan.job, todo, request.jobs)
        began = time.perf_counter()
        try:
            for k, found in _watched(solved, [blocks[k] for k in left], blocks):
                store.put(k, found)
        except KeyboardInterrupt:
            note(f"The finished rows are kept in {store.path}: the same command goes on from there.")
            raise
        seconds = time.perf_counter() - began
        summary = _Summary(plan)
        write_table(request.out, plan.columns, (summary.seen(b, store.get(k)) for k, b in enumerate(blocks)))
        if request.plot is not None and summary.count:
            _plot(request.plot, plan, np.concatenate([store.get(k) for k in range(len(blocks))]))
        store.remove()
    payload = {**summary.payload(request.out), "plot": request.plot and str(request.plot)}
    answer(payload, request.json, partial(_print, summary, payload["outside"], request.out, seconds, bool(left)))
    if not summary.count:
        raise SolveError(
            f"{request.out}: none of its {len(plan.values)} rows has a result. Run one of them with `gearheat"
            f" {'steady' if plan.kind == 'steady' else 'simulate'}` to see why, and choose other ranges."
        )


def _plot(path: Path, plan: Plan, found: np.ndarray) -> None:
    """Draw the rows of a sweep over what is varied; of a warm-up its end."""
    from ..show.fields import Field, fields
    from ..show.plotting import plotted

    every = len(plan.job.times) or 1
    ends = found[every - 1 :: every]
    ends = np.where(ends[:, [len(plan.job.outputs)]] == Status.OK, ends, np.nan)
    columns = {name: ends[:, plan.job.outputs.index(name)] for name in plan.drawn}
    columns = {axis.name: plan.values[:, k] for k, axis in enumerate(plan.axes)} | columns
    units = {name: plan.flat.quantity(name).unit for name in columns}
    shows = [Field(n, shown(units[n]), Column(n, units[n]).values(c)) for n, c in columns.items()]
    names = " and ".join(axis.name for axis in plan.axes)
    plotted(path, fields(f"{plan.rig}: {names}", shows[: len(plan.axes)], shows[len(plan.axes) :]))


def planned(request: Request, scenario: Scenario | None = None) -> Plan:
    """What a request means.

    Args:
        request: as the user wrote it
        scenario: its rig, where that is loaded already

    Raises:
        GearheatError: all that is wrong with it, as far as it can be seen together
    """
    written: tuple[sampling.Written, ...] = ()
    problems = _problems(request)
    vary = [text for text in request.vary if text != UNCERTAINTY]
    try:
        written = sampling.read(vary) if vary or not request.vary else ()
    except GearheatError as error:
        problems += error.problems
    names = [w.name for w in written]
    given = {text.partition("=")[0].strip() for text in request.assignments}
    problems += [f"--vary: {name} is set as well. Take one away." for name in names if name in given]
    scenario = load(request.rig) if scenario is None else scenario
    scheduled: tuple[str, ...] = ()
    try:
        scheduled = duty_names(request.duty) if request.duty is not None else ()
    except GearheatError as error:
        problems += error.problems
    try:
        scenario = adjusted(scenario, request.assignments, named=[*names, *scheduled])
    except GearheatError as error:
        problems += error.problems
    if problems:
        raise ScenarioError(problems)
    flat = flat_of(scenario)
    kinds = ("input", "parameter", "state") if request.kind == "warmup" else ("input", "parameter")
    found = [problem_of(flat, name, kinds, "--vary") for name in names]
    found += [problem_of(flat, name, ("state", "output"), "--output") for name in _outputs(request)]
    found += [f"--vary: {name} is given by the duty. Take one away." for name in names if name in scheduled]
    if problems := [p for p in found if p]:
        raise ScenarioError(problems)
    axes = sampling.axes(written, {name: flat.quantity(name) for name in names})
    if request.grid is not None:
        values = sampling.gridded(axes, request.grid)
    else:
        axes, values = _sampled(request, scenario, flat, axes)
    job = _job(request, scenario, flat, tuple(axis.name for axis in axes))
    drawn = _outputs(request) or told(scenario) or job.outputs[:MOST_PANELS]
    return Plan(scenario.name, request.kind, axes, values, job, flat, unchecked(scenario, flat), drawn)


def _sampled(
    request: Request, scenario: Scenario, flat: FlatModel, axes: tuple[sampling.Axis, ...]
) -> tuple[tuple[sampling.Axis, ...], np.ndarray]:
    """Axes and values of random rows, all uncertain parameters among them where they are asked for."""
    drawn = partial(sampling.sampled, rows=request.sample or 0, method=request.method, seed=request.seed)
    if UNCERTAINTY not in request.vary:
        return axes, drawn(axes)
    why = reasons(scenario, flat, [axis.name for axis in axes])
    values = drawn((*axes, *shares(why)))
    more, uncertain = sampled(why, flat, values[:, len(axes) :])
    return (*axes, *more), np.column_stack([values[:, : len(axes)], uncertain])


def _problems(request: Request) -> list[str]:
    """What is wrong with the options themselves."""
    found: list[str | None] = []
    if request.out.suffix not in SUFFIXES and not flows(request.out):
        found.append(f"-o {request.out}: unknown kind of file. Its name must end in {' or '.join(SUFFIXES)}.")
    elif request.out.suffix == ".parquet":
        found.append(parquet_missing())
    if request.scheduler is not None:
        found.append(dask_missing())
    if UNCERTAINTY in request.vary:
        options = {"--plot": request.plot, "--grid": request.grid}
        found += [f"{name} does not go with --vary {UNCERTAINTY}. Leave it out." for name, v in options.items() if v]
    if request.plot is not None and len(request.vary) > MOST_DRAWN:
        found.append(f"--plot draws over one or two quantities; {len(request.vary)} are varied. Vary fewer.")
    if (request.sample is None) == (request.grid is None):
        found.append("Give the number of rows either by --sample N or by --grid NxM.")
    timed = [option for option in ("duty", "duration", "every") if getattr(request, option) is not None]
    if request.kind == "steady" and timed:
        found.append(f"--{timed[0]} belongs to a warm-up. Add --kind warmup, or leave it out.")
    if request.kind == "warmup" and (request.duty is None) == (request.duration is None):
        found.append('A warm-up lasts either as long as its --duty or a --duration, for example "330 min". Give one.')
    return [problem for problem in found if problem]


def _outputs(request: Request) -> list[str]:
    """Paths asked for, written with commas or one by one."""
    return list(dict.fromkeys(name.strip() for text in request.outputs for name in text.split(",") if name.strip()))


def _job(request: Request, scenario: Scenario, flat: FlatModel, varied: tuple[str, ...]) -> Job:
    outputs = tuple(_outputs(request)) or tuple(q.name for q in (*flat.states, *flat.outputs))
    if request.kind == "steady":
        return Job(Batch(flat), varied, outputs, {})
    if request.duty is not None:
        schedule = read_duty(request.duty, flat)
    else:
        duration = to_si(request.duration, "s", name="--duration")
        if not duration > 0:
            raise ScenarioError(f"--duration {request.duration} is not above 0. Give a time such as 330 min.")
        schedule = Schedule(np.array([0.0, duration]), {})
    start: dict[str, float | str] = {**first_temperatures(scenario, flat, schedule)}
    if scenario.room in varied:  # a machine that nothing is said about starts at the temperature of its room
        start = dict.fromkeys(start, scenario.room)
    start = {name: value for name, value in start.items() if name not in varied}
    return Job(Batch(flat), varied, outputs, start, schedule, _times(request, schedule))


def _times(request: Request, schedule: Schedule) -> tuple[float, ...]:
    """Output times of a warm-up: the end, or every so often and the end."""
    if request.every is None:
        return (schedule.stop,)
    every = to_si(request.every, "s", name="--every")
    if not every > 0:
        raise ScenarioError(f"--every {request.every} is not above 0. Give a time such as 10 min.")
    length = schedule.stop - schedule.start
    inside = schedule.start + every * np.arange(int(np.ceil(length / every * (1 - 1e-12))))
    return (*map(float, inside), schedule.stop)


def _watched(solved: Iterator[Block], left: Sequence[slice], blocks: Sequence[slice]) -> Iterator[Block]:
    """The blocks as they come, with progress on a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    screen = Console(stderr=True)
    total = sum(b.stop - b.start for b in blocks)
    done = total - sum(b.stop - b.start for b in left)
    parts = (TextColumn("rows"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*parts, console=screen, disable=not screen.is_terminal) as progress:
        task = progress.add_task("rows", total=total, completed=done)
        for k, found in solved:
            yield k, found
            progress.advance(task, blocks[k].stop - blocks[k].start)


class _Summary:
    """What a table holds, gathered while its blocks pass by."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.statuses = dict.fromkeys(Status, 0)
        n = len(plan.job.outputs)
        self.low, self.high, self.sum, self.count = np.full(n, np.inf), np.full(n, -np.inf), np.zeros(n), 0
        self.residual, self.outside = 0.0, 0
        self.worst: tuple[float, int] = (0.0, 0)  # law arguments outside their range and the row that has most of them

    def seen(self, rows: slice, found: np.ndarray) -> list[np.ndarray]:
        """Take note of a block on its way into the table."""
        n = len(self.plan.job.outputs)
        times = len(self.plan.job.times) or 1
        for status, count in zip(*np.unique(found[::times, n], return_counts=True), strict=True):
            self.statuses[Status(int(status))] += int(count)
        good = found[found[:, n] == Status.OK]
        if len(good):
            self.low, self.high = np.minimum(self.low, good[:, :n].min(0)), np.maximum(self.high, good[:, :n].max(0))
            self.sum, self.count = self.sum + good[:, :n].sum(0), self.count + len(good)
            self.residual = max(self.residual, float(good[:, n + 2].max()))
            self.outside += int((good[::times, n + 3] > 0).sum())
            counts = np.where(found[::times, n] == Status.OK, found[::times, n + 3], 0.0)
            k = int(np.argmax(counts))
            self.worst = max(self.worst, (float(counts[k]), rows.start + k), key=lambda w: w[0])
        return self.plan.cells(rows, found)

    def outputs(self) -> Iterator[tuple[str, str, str, list[float]]]:
        """Path, unit and meaning of each output, with its least, mean and largest value."""
        for i, name in enumerate(self.plan.job.outputs):
            q = self.plan.flat.quantity(name)
            numbers = (self.low[i], self.sum[i] / max(self.count, 1), self.high[i])
            yield (
                name,
                shown(q.unit),
                q.doc,
                [from_si(float(v), q.unit) for v in numbers] if self.count else [np.nan] * 3,
            )

    def payload(self, out: Path) -> dict[str, Any]:
        """The summary as an object."""
        plan = self.plan
        return {
            "schema": "gearheat.sweep/1",
            "rig": plan.rig,
            "kind": plan.kind,
            "out": str(out),
            "rows": len(plan.values),
            "status": {status.name.lower(): n for status, n in self.statuses.items() if n},
            "varied": {a.name: sampling.described(a, plan.flat.quantity(a.name)) for a in plan.axes},
            "outputs": {
                name: {"unit": unit, "low": low, "mean": mean, "high": high}
                for name, unit, _, (low, mean, high) in self.outputs()
            },
            "energy_residual": self.residual,
            "rows_outside": self.outside,
            "unchecked": plan.unchecked,
            "outside": {"row": self.worst[1] + 1, "laws": plan.outside(self.worst[1])} if self.outside else None,
        }


def _print(summary: _Summary, outside: dict[str, Any] | None, out: Path, seconds: float, worked: bool) -> None:
    rows = len(summary.plan.values)
    kind = {"steady": "steady states", "warmup": "warm-ups"}[summary.plan.kind]
    head = ("name", "low", "mean", "high", "unit", "meaning")
    lines = [(name, *numbers, unit, doc) for name, unit, doc, numbers in summary.outputs()]
    table(f"{summary.plan.rig}: {rows} {kind}", head, lines)
    failed = {s.name.lower(): n for s, n in summary.statuses.items() if n and s is not Status.OK}
    if failed:
        say("rows without a result: " + ", ".join(f"{name} {n}" for name, n in failed.items()))
    if outside is not None:
        say(f"rows with a law outside the range of its source: {summary.outside}, most of all row {outside['row']}:")
        tell_outside(outside["laws"])
    print_unchecked(summary.plan.unchecked)
    print(f"{out}" + (f" after {seconds:.1f} s" if worked else ""))
