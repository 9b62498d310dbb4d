"""Sweeps: steady states or warm-ups of many rows, by a grid or at random, kept in a table."""

from __future__ import annotations

import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.batch import Status
from ...model.core.flat import Quantity
from ...model.errors import Problems, SolveError
from ...model.files import flows
from ...model.units import from_si, show_unit
from ...scenarios.duty import TIME
from ...scenarios.given import (
    RigLike,
    Settings,
    assignments_of,
    grid_text,
    listed,
    pairs_of,
    range_text,
    scenario_of,
    spell,
)
from ..show.console import counting, note
from ..show.display import Display, optional
from ..show.picture import Picture
from . import sampling
from .cluster import run_on_cluster
from .simulate import Duty, duty_file
from .sweep_plan import MOST_DRAWN, Plan, Request, plan_sweep
from .sweep_rows import TELLING, Block, Column, Store, local, refuse_other, work_file, write_table


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Display):
    """The rows of a sweep.

    Attributes:
        plan: what was varied and kept
        summary: status of the rows, range and mean of the outputs, laws outside their range
        seconds: that the rows took; None where an earlier run had finished them
        rows: kept outputs of all rows (rows times output times, outputs and what tells of a row), where it was asked to
            draw or nothing was written
        out: the table
    """

    plan: Plan
    summary: Summary
    seconds: float | None
    rows: np.ndarray | None = None
    out: Path | None = None

    @property
    def title(self) -> str:
        """The rig and the number of rows."""
        kind = {"steady": "steady states", "warmup": "warm-ups"}[self.plan.kind]
        return f"{self.plan.rig}: {len(self.plan.values)} {kind}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Least, mean and largest value of each output."""
        rows = [(name, *numbers, unit, doc) for name, unit, doc, numbers in self.summary.outputs()]
        return ("name", "low", "mean", "high", "unit", "meaning"), rows

    def as_dict(self) -> dict[str, Any]:
        """The summary."""
        return {**self.summary.as_dict(self.out), "plot": None}

    def check(self) -> None:
        """Refuse a sweep without results.

        Raises:
            SolveError: no row has one
        """
        if not self.summary.count:
            raise SolveError(
                f"{self.out or self.plan.rig}: none of its {len(self.plan.values)} rows has a result. Run one of them"
                f" with `gearheat {'steady' if self.plan.kind == 'steady' else 'simulate'}` to see why, and choose"
                " other ranges."
            )

    def to_pandas(self) -> Any:
        """All rows, as the table has them.

        Raises:
            DataError: pandas is not installed
        """
        pandas = optional("pandas")
        if self.rows is None:
            assert self.out is not None  # rows are dropped only where they were written
            read = pandas.read_parquet if self.out.suffix == ".parquet" else pandas.read_csv
            return read(self.out)
        whole = slice(0, len(self.plan.values))
        cells = zip(self.plan.columns, self.plan.cells(whole, self.rows), strict=True)
        return pandas.DataFrame({c.title: c.cells(n) for c, n in cells})

    def drawing(self) -> Picture | None:
        """Lines over one quantity that is varied, contours over two; of a warm-up its end. None without rows."""
        from ..show.fields import Field, fields

        plan, found = self.plan, self.rows
        if found is None or not 1 <= len(plan.axes) <= MOST_DRAWN:
            return None
        every = len(plan.job.times) or 1
        ends = found[every - 1 :: every]
        ends = np.where(ends[:, [len(plan.job.outputs)]] == Status.OK, ends, np.nan)
        columns = {name: ends[:, plan.job.outputs.index(name)] for name in plan.drawn}
        columns = {axis.name: plan.values[:, k] for k, axis in enumerate(plan.axes)} | columns
        units = {name: plan.flat.quantity(name).unit for name in columns}
        shows = [Field(n, show_unit(units[n]), Column(n, units[n]).values(c)) for n, c in columns.items()]
        names = " and ".join(axis.name for axis in plan.axes)
        return fields(f"{plan.rig}: {names}", shows[: len(plan.axes)], shows[len(plan.axes) :])


def sweep(
    rig: RigLike,
    vary: Mapping[str, Any] | str | Sequence[str],
    *,
    out: str | Path | None = None,
    sample: int | None = None,
    grid: str | int | Sequence[int] | None = None,
    method: str = "lhs",
    seed: int = 0,
    set: Settings = (),
    output: str | Sequence[str] = (),
    kind: str = "steady",
    duty: Duty | None = None,
    duration: Any = None,
    every: Any = None,
    jobs: int = 0,
    scheduler: str | None = None,
    draw: bool = False,
) -> Sweep:
    """Steady states or warm-ups of many rows, on a grid or at random. An interrupted sweep goes on.

    Args:
        rig: name, file or rig
        vary: name -> tuple (low, high) or (low, high, points of a grid), or a list of values, each combined with all
            others, names of a catalogue for a part that is filled from one; or texts such as
            "carrier.tau=500..2700 N.m", "carrier.tau=500,900,2700 N.m", "oil=PAOR,MINR",
            "cooling.A~normal(0.8, 0.05) m2", and "uncertainty" for every uncertain parameter of the rig
        out: CSV or Parquet file; in memory if None
        sample: number of random rows
        grid: rows of a grid, a number for each range that is varied, such as "20x10" or (20, 10)
        method: how random rows are drawn, "lhs" (Latin hypercube) or "monte-carlo"
        seed: the same seed gives the same sample
        set: values by name: texts with units, quantities of pint, or numbers in SI
        output: outputs to keep; all if none is named
        kind: "steady", or "warmup"
        duty: of a warm-up, the same for all rows
        duration: of a warm-up at constant inputs, such as "330 min"
        every: time between the rows of a warm-up; only the end if None
        jobs: threads, 0 for one per core
        scheduler: address of a Dask scheduler that spreads the rows over its workers
        draw: keep the rows for a picture

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> rows = gh.sweep("planetary", {"carrier.w": ("50 rpm", "250 rpm", 5)}, output=["oil.T"])
        >>> len(rows.plan.values)
        5
    """
    scenario = scenario_of(rig)
    texts, counts = varied_texts(vary, scenario.settable)
    with duty_file(duty) if duty is not None else nullcontext() as path, tempfile.TemporaryDirectory() as folder:
        request = Request(
            scenario,
            texts,
            None if out is None else Path(out),
            sample,
            "x".join(counts) or None if grid is None else grid_text(grid),
            method,
            seed,
            assignments_of(set, scenario.settable),
            listed(output, "output"),
            kind,
            path,
            None if duration is None else spell(duration, TIME, "--duration"),
            None if every is None else spell(every, TIME, "--every"),
            jobs,
            scheduler,
            draw,
        )
        return _run(request, Path(folder))


def varied_texts(vary: Any, known: Callable[[], Mapping[str, Quantity]]) -> tuple[list[str], list[str]]:
    """What is varied as texts, and the points of its ranges where they are given.

    Args:
        vary: by name a tuple (low, high) or (low, high, points), values in another sequence, or a text; or texts
        known: tells the quantity of each name

    Raises:
        ScenarioError: what is neither
    """
    texts, counts, problems = list[str](), list[str](), Problems()
    for one in pairs_of(vary):
        if isinstance(one, str):
            texts.append(one)
            continue
        name, given = one
        with problems:
            if isinstance(given, str):
                texts.append(f"{name}={given}")
            elif isinstance(given, tuple):
                texts.append(f"{name}={range_text(given[:2], known().get(name), f'--vary {name}')}")
                counts += [str(n) for n in given[2:]]
            else:
                values = list(given) if isinstance(given, Iterable) else [given]
                written = ",".join(spell(value, known().get(name), f"--vary {name}") for value in values)
                texts.append(f"{name}={written}{',' * (len(values) == 1)}")
    problems.check()
    return texts, counts


def _run(request: Request, folder: Path) -> Sweep:
    """Plan, solve what an earlier run has not finished, write the table; a sweep without one works in the folder."""
    plan = plan_sweep(request)
    out, blocks = request.out, plan.blocks
    lasting = out is not None and not flows(out)
    if out is not None and lasting:
        refuse_other(out, plan.columns)
    place = work_file(out if out is not None and lasting else folder / "rows.csv")
    with Store(place, plan.key, len(plan.job.outputs) + len(TELLING)) as store:
        left = [k for k in range(len(blocks)) if k not in store.places]
        done = len(plan.values) - sum(blocks[k].stop - blocks[k].start for k in left)
        if len(left) < len(blocks):
            note(f"{done} of {len(plan.values)} rows were finished before: {store.path}")
        todo: Iterable[Block] = ((k, plan.values[blocks[k]]) for k in left)
        if request.scheduler is not None:
            solved = run_on_cluster(plan.job, todo, request.scheduler)
        else:
            solved = local(plan.job, todo, request.jobs)
        began = time.perf_counter()
        try:
            with counting("rows", len(plan.values), done) as advance:
                for k, found in solved:
                    store.put(k, found)
                    advance(blocks[k].stop - blocks[k].start)
        except KeyboardInterrupt:
            if lasting:
                note(f"The finished rows are kept in {store.path}: the same command goes on from there.")
            raise
        seconds = time.perf_counter() - began if left else None
        summary = Summary(plan)
        cells = (summary.seen(b, store.get(k)) for k, b in enumerate(blocks))
        if out is not None:
            write_table(out, plan.columns, cells)
        else:
            deque(cells, maxlen=0)
        keep = (request.drawn or out is None) and summary.count
        rows = np.concatenate([store.get(k) for k in range(len(blocks))]) if keep else None
        store.remove()
    return Sweep(plan, summary, seconds, rows, out)


class Summary:
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
        means = self.sum / max(self.count, 1)
        for name, *numbers in zip(self.plan.job.outputs, self.low, means, self.high, strict=True):
            q = self.plan.flat.quantity(name)
            yield name, show_unit(q.unit), q.doc, [from_si(float(v), q.unit) if self.count else np.nan for v in numbers]

    def as_dict(self, out: Path | None) -> dict[str, Any]:
        """The summary as an object, with the place of the table."""
        plan = self.plan
        return {
            "schema": "gearheat.sweep/1",
            "rig": plan.rig,
            "kind": plan.kind,
            "out": out and str(out),
            "rows": len(plan.values),
            "status": {status.name.lower(): n for status, n in self.statuses.items() if n},
            "varied": {a.name: sampling.describe_axis(a, plan.flat.quantity(a.name)) for a in plan.axes},
            "outputs": {
                name: {"unit": unit, "low": low, "mean": mean, "high": high}
                for name, unit, _, (low, mean, high) in self.outputs()
            },
            "energy_residual": self.residual,
            "rows_outside": self.outside,
            "unchecked": plan.unchecked,
            "outside": {"row": self.worst[1] + 1, "laws": plan.outside(self.worst[1])} if self.outside else None,
        }
