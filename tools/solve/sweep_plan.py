"""What a sweep is asked for, and what that means: rows, what is varied, what is kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.batch import Batch
from ...model.core.flat import FlatModel
from ...model.errors import Problems, ScenarioError, SolveError
from ...model.files import flows
from ...model.run.point import problem_of
from ...model.run.schedule import Schedule
from ...model.run.simulate import simulate
from ...model.run.steady import steady
from ...model.units import to_si
from ...scenarios.duty import duty_names, read_duty
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.measured.times import LATEST, YEAR
from ...scenarios.scenario import Scenario
from . import sampling
from .sampling import UNCERTAINTY, draw_values, reasons, shares
from .settings import adjust, find_unchecked, flat_of, refuse_given
from .simulate import first_temperatures
from .steady import leading_outputs, outside_of
from .sweep_rows import SUFFIXES, TELLING, WORDS, Column, Job

#: Rows of a block: what an interruption may cost, and what a worker of a cluster gets at a time.
BLOCKS = {"steady": 8192, "warmup": 256}
#: Output times of a warm-up.
MOST_TIMES = 1_000_000
#: Quantities that a picture can be drawn over.
MOST_DRAWN = 2
#: Outputs that a picture shows of a rig without oil, body and efficiency.
MOST_PANELS = 6


@dataclass(frozen=True)
class Request:
    """What a user asks for; without `out` the rows are kept in memory."""

    rig: RigLike
    vary: Sequence[str]
    out: Path | None = None
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
    drawn: bool = False


@dataclass(frozen=True)
class Plan:
    """A sweep, ready to run: the values of its rows (rows, axes) and what is done with them.

    `unchecked` holds the catalogue entries in use with values never checked against a print, `drawn` the outputs
    that a picture shows, `filled` the names of the entries that parts are filled from, by number of each row.
    """

    rig: str
    kind: str
    axes: tuple[sampling.Axis, ...]
    values: np.ndarray
    job: Job
    flat: FlatModel
    unchecked: Sequence[Mapping[str, Any]]
    drawn: Sequence[str]
    filled: tuple[tuple[Column, np.ndarray], ...] = ()

    @property
    def columns(self) -> list[Column]:
        """The columns of the table."""
        unit = {name: self.flat.quantity(name).unit for name in (*self.job.varied, *self.job.outputs)}
        telling = {"energy_residual": "1", "outside": "1"}
        return [
            Column("row"),
            *(column for column, _ in self.filled),
            *(Column(name, unit[name]) for name in self.job.varied),
            *([Column("time", "s")] if self.job.times else []),
            *(Column(name, unit[name]) for name in self.job.outputs),
            *(Column(name, telling.get(name), WORDS if name == "status" else ()) for name in TELLING),
        ]

    @property
    def key(self) -> str:
        """Hash of all that the rows depend on."""
        return self.job.key(self.values, BLOCKS[self.kind])

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
        filled = [np.repeat(own[rows], times) for _, own in self.filled]
        return [number, *filled, *values.T, *moments, *found.T]

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


def plan_sweep(request: Request) -> Plan:
    """What a request means.

    Args:
        request: as the user wrote it

    Raises:
        GearheatError: all that is wrong with it, as far as it can be seen together
    """
    written: tuple[sampling.Written, ...] = ()
    problems = _problems(request)
    vary = [text for text in request.vary if text != UNCERTAINTY]
    with problems:
        written = sampling.read(vary) if vary or not request.vary else ()
    scenario = scenario_of(request.rig)
    parts = {w.name: w.values for w in written if w.kind == "values" and w.name in scenario.types}
    written = tuple(w for w in written if w.name not in parts)
    names = [w.name for w in written]
    given = {text.partition("=")[0].strip() for text in request.assignments}
    problems += [f"--vary: {name} is set as well. Take one away." for name in (*names, *parts) if name in given]
    scheduled: tuple[str, ...] = ()
    with problems:
        scheduled = duty_names(request.duty) if request.duty is not None else ()
    with problems:
        refuse_given(request.assignments, scheduled, "the duty")
        scenario = adjust(scenario, request.assignments, named=[*names, *scheduled])
    problems.check()
    flat = flat_of(scenario)
    kinds = ("input", "parameter", "state") if request.kind == "warmup" else ("input", "parameter")
    found = [problem_of(flat, name, kinds, "--vary") for name in names]
    found += [problem_of(flat, name, ("state", "output"), "--output") for name in _outputs(request)]
    found += [f"--vary: {name} is given by the duty. Take one away." for name in names if name in scheduled]
    Problems(filter(None, found)).check()
    axes = sampling.axes(written, {name: flat.quantity(name) for name in names})
    axes = (*(sampling.Axis(n, "values", 0, len(v) - 1, tuple(range(len(v)))) for n, v in parts.items()), *axes)
    if request.sample is None:
        values = sampling.lay_grid(axes, request.grid or "")
    else:
        axes, values = _draw_rows(request, scenario, flat, axes)
    filled = tuple((Column(n, words=v), values[:, k]) for k, (n, v) in enumerate(parts.items()))
    axes, values = _fill(scenario, flat, filled, axes, values)
    job = _job(request, scenario, flat, tuple(axis.name for axis in axes))
    unchecked = find_unchecked(scenario, flat, [(part, name) for part, own in parts.items() for name in own])
    drawn = _outputs(request) or leading_outputs(scenario) or job.outputs[:MOST_PANELS]
    return Plan(scenario.name, request.kind, axes, values, job, flat, unchecked, drawn, filled)


def _fill(
    scenario: Scenario,
    flat: FlatModel,
    filled: Sequence[tuple[Column, np.ndarray]],
    axes: tuple[sampling.Axis, ...],
    values: np.ndarray,
) -> tuple[tuple[sampling.Axis, ...], np.ndarray]:
    """Axes and values (rows, axes) with what entries give parts in the place of their numbers, which come first."""
    more, columns = list[sampling.Axis](), list[np.ndarray]()
    for column, number in filled:
        given = [scenario.following(scenario.entry_values(column.name, name)) for name in column.words]
        own = {path: scenario.spec.part(path.rpartition(".")[0]).values for one in given for path in one}
        for path in (path for path in own if path in flat.index):
            each = np.array([one.get(path, own[path][path.rpartition(".")[2]]) for one in given])
            more.append(sampling.Axis(path, "values", each.min(), each.max(), tuple(map(float, each))))
            columns.append(each[number.astype(int)])
    return (*more, *axes[len(filled) :]), np.column_stack([*columns, values[:, len(filled) :]])


def _draw_rows(
    request: Request, scenario: Scenario, flat: FlatModel, axes: tuple[sampling.Axis, ...]
) -> tuple[tuple[sampling.Axis, ...], np.ndarray]:
    """Axes and values of random rows, all uncertain parameters among them where they are asked for."""
    drawn = partial(sampling.draw_sample, rows=request.sample or 0, method=request.method, seed=request.seed)
    if UNCERTAINTY not in request.vary:
        return axes, drawn(axes)
    why = reasons(scenario, flat, [axis.name for axis in axes])
    values = drawn((*axes, *shares(why)))
    more, uncertain = draw_values(why, flat, values[:, len(axes) :])
    return (*axes, *more), np.column_stack([values[:, : len(axes)], uncertain])


def _problems(request: Request) -> Problems:
    """What is wrong with the options themselves."""
    found: list[str | None] = []
    if request.out is not None and request.out.suffix not in SUFFIXES and not flows(request.out):
        found.append(f"-o {request.out}: unknown kind of file. Its name must end in {' or '.join(SUFFIXES)}.")
    elif request.out is not None and request.out.suffix == ".parquet":
        found.append(_missing("pyarrow", "-o FILE.parquet", "parquet", ", or write .csv"))
    if request.scheduler is not None:
        found.append(_missing("distributed", "--scheduler", "dask", ""))
    if UNCERTAINTY in request.vary:
        options = {"--plot": request.drawn, "--grid": request.grid}
        found += [f"{name} does not go with --vary {UNCERTAINTY}. Leave it out." for name, v in options.items() if v]
    if request.drawn and len(request.vary) > MOST_DRAWN:
        found.append(f"--plot draws over one or two quantities; {len(request.vary)} are varied. Vary fewer.")
    ways = [way for way in (request.sample, request.grid) if way is not None]
    if len(ways) != 1 and (ways or not all(map(sampling.lists, request.vary))):
        found.append("Give the number of rows either by --sample N or by --grid NxM.")
    if request.method not in ("lhs", "monte-carlo"):
        found.append(f'--method {request.method} is not known. Choose "lhs" or "monte-carlo".')
    if request.jobs < 0:
        found.append(f"--jobs {request.jobs} is below zero. Give how many threads, or 0 for one per core.")
    timed = [option for option in ("duty", "duration", "every") if getattr(request, option) is not None]
    if request.kind == "steady" and timed:
        found.append(f"--{timed[0]} belongs to a warm-up. Add --kind warmup, or leave it out.")
    if request.kind == "warmup" and (request.duty is None) == (request.duration is None):
        found.append('A warm-up lasts either as long as its --duty or a --duration, for example "330 min". Give one.')
    return Problems(filter(None, found))


def _missing(package: str, option: str, extra: str, otherwise: str) -> str | None:
    """What is wrong where an option needs a package that is not installed."""
    try:
        import_module(package)
    except ImportError:
        return f'{option} needs the package "{package}". Install it: pip install "gearheat[{extra}]"{otherwise}'
    return None


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
        if not 0 < duration <= LATEST:
            raise ScenarioError(
                f"--duration {request.duration} is not above 0 and below {LATEST / YEAR:g} years. Give a time such as"
                " 330 min."
            )
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
    if length / every > MOST_TIMES:
        raise ScenarioError(f"--every {request.every}: {length / every:.3g} times a row. Give at most {MOST_TIMES}.")
    inside = schedule.start + every * np.arange(int(np.ceil(length / every * (1 - 1e-12))))
    return (*map(float, inside), schedule.stop)
