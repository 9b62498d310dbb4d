"""Many runs of one model in one call: steady states and warm-ups of arrays of rows, through the C code of its FMU.

    batch = Batch(flat)
    rows = batch.steady(*batch.vectors({"carrier.tau": np.linspace(500.0, 2700.0, 100_000)}))
    rows["oil.T"], rows.status

Every row stands for itself: its result has the same bits whatever rows stand beside it and however many threads share
the work. A `Batch` can be pickled; where it is unpickled its C code is compiled, or found in the user's cache.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np

from ..model.core.flat import FlatModel, Quantity
from ..model.errors import ScenarioError, suggestion
from ..model.run.result import SLACK
from ..model.run.schedule import Schedule
from .batch_library import (
    BESIDE,
    EXTRA,
    FEW,
    Duty,
    address,
    broken_relations,
    driver,
    instructions,
    relations_source,
    rows_from,
    share_rows,
    steady_source,
    warmup_source,
    widen,
)
from .grid import Grid, grid

#: Of the local error of a warm-up, in nominals of the states.
TOLERANCE = 1e-4

#: Steps of a warm-up between two points of its schedule or output; a row that needs more is stopped.
MOST_STEPS = 1_000_000
#: Steps that a warm-up takes, by which it is judged how much there is to do; and one more for each piece of its duty.
STEPS = 40

#: Steady states that a thread takes at a time. The results do not depend on it.
STEADY_BLOCK = 1024
#: Warm-ups that a thread takes at a time: fewer, as each takes longer.
WARMUP_BLOCK = 64


class Status(IntEnum):
    """What became of a row; its numbers are NaN unless it is OK."""

    OK = 0
    NO_EQUILIBRIUM = 1  #: no steady state was found
    UNSTABLE = 2  #: the only equilibrium found is one the machine leaves by itself
    NOT_FINITE = 3  #: the model cannot be evaluated at the start
    STOPPED = 4  #: a warm-up cannot go on: a state leaves its range or changes without bound
    OUT_OF_RANGE = 5  #: an input, a parameter or a start value is not finite or out of its range, or an output
    NO_SOLUTION = 6  #: an implicit equation has no solution at the start, or on the way of a warm-up
    CONTRADICTION = 7  #: a relation between parameters does not hold


@dataclass(frozen=True)
class Rows:
    """Results of n rows; of a warm-up with m times every row of `x` and `y` holds m times.

    Attributes:
        columns: name of each state and output -> kind and position
        x: states (n, states) or (n, m, states)
        y: outputs (n, outputs) or (n, m, outputs)
        status: of each row (n)
        iterations: steps of Newton's method, or of the solver (n)
        supplied, gained, throughput: energy that came in, that the states gained, and the sum of all that crossed the
            boundary [J]; for steady states the powers [W], where nothing is gained (n)
        outside: law arguments outside the range of their source, at the worst time (n)
        time: times of a warm-up [s] (m); None for steady states
    """

    columns: Mapping[str, tuple[str, int]]
    x: np.ndarray
    y: np.ndarray
    status: np.ndarray
    iterations: np.ndarray
    supplied: np.ndarray
    gained: np.ndarray
    throughput: np.ndarray
    outside: np.ndarray
    time: np.ndarray | None = None

    def __getitem__(self, name: str) -> np.ndarray:
        """A state or an output by path. Raises ScenarioError with suggestions for an unknown one."""
        if name not in self.columns:
            raise ScenarioError(f'the rows have no "{name}".{suggestion(name, self.columns)}')
        kind, i = self.columns[name]
        return (self.x if kind == "state" else self.y)[..., i]

    @property
    def residual(self) -> np.ndarray:
        """Violation of the energy balance of each row, relative to its throughput (n)."""
        residual: np.ndarray = np.abs(self.supplied - self.gained) / np.maximum(self.throughput, 1e-3)
        return residual


@dataclass(frozen=True)
class Prepared:
    """A duty laid out for a model: points in time, and the same as C knows it."""

    points: Grid
    duty: Duty


class Batch:
    """A flat model for runs of many rows, compiled when the first of a kind is run.

    Args:
        flat: the model
    """

    def __init__(self, flat: FlatModel) -> None:
        self.name = flat.name
        self.states, self.inputs, self.parameters = flat.states, flat.inputs, flat.parameters
        self.outputs, self.relations = flat.outputs, flat.relations
        self._flat = flat
        self._limits = [_limits(group) for group in (self.inputs, self.parameters, self.states)]

    @cached_property
    def steady_source(self) -> str:
        """The C text for steady states."""
        return steady_source(self._flat)

    @cached_property
    def warmup_source(self) -> str:
        """The C text for warm-ups."""
        return warmup_source(self._flat, MOST_STEPS)

    @cached_property
    def relations_source(self) -> str:
        """The C text for the relations between parameters."""
        return relations_source(self._flat)

    def contradictions(self, p: np.ndarray | None = None) -> list[str | None]:
        """Per row of parameters, or for one vector, the first relation that does not hold; None where all do."""
        places = broken_relations(self.relations_source, self._checked(None, p, None)[1][1])
        names = [f'{r.component}: "{r.name}"' for r in self.relations]
        return [names[i] if i >= 0 else None for i in places]

    def __getstate__(self) -> dict[str, Any]:
        """All but the symbols, which cannot be pickled and are in the C text."""
        names = ("steady_source", "warmup_source", "relations_source")
        texts = {name: getattr(self, name) for name in names}
        return {name: value for name, value in self.__dict__.items() if name != "_flat"} | texts

    @property
    def columns(self) -> dict[str, tuple[str, int]]:
        """What a row holds: path -> ("state" or "output", position)."""
        groups = {"state": self.states, "output": self.outputs}
        return {q.name: (kind, i) for kind, group in groups.items() for i, q in enumerate(group)}

    def vectors(self, values: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Inputs, parameters and start states for `steady` and `warmup` from values by path (SI).

        Args:
            values: path of an input, a parameter or a state -> a number for all rows, or an array of one per row;
                what is not named keeps the model's own value

        Returns:
            u, p, start; each a vector where no array was given for any of its quantities

        Raises:
            ScenarioError: unknown names, arrays of different lengths
        """
        groups = (self.inputs, self.parameters, self.states)
        known = {q.name for group in groups for q in group}
        problems = [f'{self.name}: "{n}" is no value to set.{suggestion(n, known)}' for n in values if n not in known]
        given = {name: np.asarray(value, dtype=float) for name, value in values.items()}
        lengths = {value.shape for value in given.values() if value.ndim}
        if len(lengths) > 1:
            problems.append(f"{self.name}: arrays of different lengths: {sorted(s[0] for s in lengths)}. Give one.")
        if problems:
            raise ScenarioError(problems)
        u, p, start = (_stack(group, given) for group in groups)
        return u, p, start

    def steady(
        self,
        u: np.ndarray | None = None,
        p: np.ndarray | None = None,
        start: np.ndarray | None = None,
        *,
        threads: int = 0,
    ) -> Rows:
        """The steady state of each row, found as `gearheat.model.run.steady` finds it.

        Args:
            u, p: inputs (n, inputs) and parameters (n, parameters), or a vector for all rows; the model's own if None
            start: states to start from (n, states), or a vector for all rows; the model's own if None
            threads: threads that share the rows, 0 for one per core

        Raises:
            ScenarioError: arrays of the wrong shape
            FmuError: the model has no C code, or the compiler fails
        """
        n, vectors, verdict = self._checked(u, p, start)
        home = np.array([q.start for q in self.inputs])
        x, y = np.empty((n, len(self.states))), np.empty((n, len(self.outputs) + EXTRA))
        status, iterations = np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32)
        run = driver("batch_steady", widen(self.steady_source, instructions(), BESIDE), n)

        def block(a: int, b: int) -> int:
            results = [address(array[a:]) for array in (x, y, status, iterations)]
            return int(run(b - a, *rows_from(vectors, a), address(home), *results))

        share_rows(block, n, STEADY_BLOCK, threads)
        k = len(self.outputs)
        supply, throughput, outside = y[:, k], y[:, k + 1], y[:, k + 2]
        rows = Rows(self.columns, x, y[:, :k], status, iterations, supply, np.zeros(n), throughput, outside)
        return _mark_rows(rows, verdict, self.outputs)

    def warmup(
        self,
        schedule: Schedule | Prepared,
        u: np.ndarray | None = None,
        p: np.ndarray | None = None,
        start: np.ndarray | None = None,
        *,
        times: Sequence[float] | np.ndarray | None = None,
        tolerance: float = TOLERANCE,
        threads: int = 0,
    ) -> Rows:
        """Each row through a duty, by the solver of the FMU.

        Args:
            schedule: inputs over time, the same for all rows; inputs it does not name keep the row's value. A prepared
                one has its times and its tolerance
            u, p: inputs (n, inputs) and parameters (n, parameters), or a vector for all rows; the model's own if None
            start: states at the beginning (n, states), or a vector for all rows; the model's own if None
            times: output times [s], not decreasing; a row at a jump shows the inputs behind it, a time given twice
                both sides; the end of the schedule if None
            tolerance: of the local error, relative to each state's nominal
            threads: threads that share the rows, 0 for one per core

        Raises:
            ScenarioError: arrays of the wrong shape, names or values of the schedule that do not fit the model
            FmuError: times outside the schedule, the model has no C code, or the compiler fails
        """
        n, vectors, verdict = self._checked(u, p, start)
        prepared = schedule if isinstance(schedule, Prepared) else self.prepared(schedule, times, tolerance)
        points, duty = prepared.points, prepared.duty
        m = len(points.row_time)
        x, y, energy = np.empty((n, m, len(self.states))), np.empty((n, m, len(self.outputs))), np.empty((n, 4))
        status, steps = np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32)
        work, beside = n * (STEPS + duty.m), BESIDE if n > FEW else FEW
        run = driver("batch_warmup", widen(self.warmup_source, instructions(), beside), work)

        def block(a: int, b: int) -> int:
            results = [address(array[a:]) for array in (x, y, energy, status, steps)]
            return int(run(b - a, ctypes.byref(duty), *rows_from(vectors, a), m, *results))

        share_rows(block, n, WARMUP_BLOCK, threads)
        supplied, gained, throughput, outside = energy.T
        rows = Rows(self.columns, x, y, status, steps, supplied, gained, throughput, outside, points.row_time)
        return _mark_rows(rows, verdict, self.outputs)

    def prepared(
        self,
        schedule: Schedule,
        times: Sequence[float] | np.ndarray | None = None,
        tolerance: float = TOLERANCE,
    ) -> Prepared:
        """A duty laid out once for many calls of `warmup`.

        Args:
            schedule: inputs over time (SI)
            times: times of the rows [s]; the end when None
            tolerance: relative, of the solver

        Raises:
            ScenarioError: all that is wrong with the duty or the tolerance
        """
        if problems := self._schedule_problems(schedule, tolerance):
            raise ScenarioError(problems)
        inputs = {name: (schedule.time, values) for name, values in schedule.values.items()}
        length = schedule.stop - schedule.start
        points = grid(inputs, schedule.start, schedule.stop, length, [schedule.stop] if times is None else times)
        return Prepared(points, Duty(points, self.inputs, tolerance))

    def _checked(
        self, u: np.ndarray | None, p: np.ndarray | None, start: np.ndarray | None
    ) -> tuple[int, tuple[np.ndarray, ...], np.ndarray]:
        """Number of rows, their arrays as C takes them, and what is wrong with the values of each row."""
        named = (("inputs", self.inputs, u), ("parameters", self.parameters, p), ("states", self.states, start))
        vectors, problems, counts = [], [], set()
        for word, group, given in named:
            vector = np.ascontiguousarray([q.start for q in group] if given is None else given, dtype=float)
            if vector.ndim not in (1, 2) or vector.shape[-1] != len(group):
                problems.append(f"{self.name}: {word} of shape {vector.shape}. Expected ({len(group)},) or a row each.")
            elif vector.ndim == 2:
                counts.add(len(vector))
            vectors.append(vector)
        if len(counts) > 1:
            problems.append(f"{self.name}: arrays of {' and '.join(map(str, sorted(counts)))} rows. Give one number.")
        if problems:
            raise ScenarioError(problems)
        n = counts.pop() if counts else 1
        broken = broken_relations(self.relations_source, vectors[1])
        verdict = np.where(broken < 0, Status.OK, Status.CONTRADICTION)
        for limits, vector in zip(self._limits, vectors, strict=True):
            verdict = np.where(_in_range(limits, vector), verdict, Status.OUT_OF_RANGE)
        return n, tuple(vectors), np.broadcast_to(verdict, n)

    def _schedule_problems(self, schedule: Schedule, tolerance: float) -> list[str]:
        known = {q.name: q for q in self.inputs}
        problems = [
            f'{self.name}: the duty gives "{n}", which is no input.{suggestion(n, known)}'
            for n in schedule.values
            if n not in known
        ]
        for name in schedule.values.keys() & known.keys():
            column = schedule.values[name]
            extremes = dict.fromkeys((float(column.min()), float(column.max())))
            problems += [f"{self.name}: duty: {p}" for value in extremes if (p := known[name].problem(value))]
        if not schedule.stop > schedule.start:
            problems.append(f"{self.name}: the duty lasts no time. Give it a duration.")
        if not 0 < tolerance < 1:
            problems.append(f"{self.name}: tolerance {tolerance:g} is out of range. Give one between 0 and 1.")
        return problems


def _stack(group: Sequence[Quantity], given: Mapping[str, np.ndarray]) -> np.ndarray:
    """Values of a group in order: a vector, or a row per entry of the arrays given."""
    columns = [given.get(q.name, np.array(q.start)) for q in group]
    if not columns:
        return np.empty(0)
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*columns), axis=-1))


def _limits(group: Sequence[Quantity]) -> tuple[np.ndarray, ...]:
    """Lower and upper limits of a group, and whether each is left out."""
    names = ("low", "high", "low_open", "high_open")
    return tuple(np.array([getattr(q, name) for q in group]) for name in names)


def _in_range(limits: tuple[np.ndarray, ...], vector: np.ndarray) -> Any:
    """Which rows have all their values in range: one answer for a vector that all rows share."""
    low, high, low_open, high_open = limits
    above = np.where(low_open, vector > low, vector >= low)
    below = np.where(high_open, vector < high, vector <= high)
    return (np.isfinite(vector) & above & below).all(axis=-1)


def _mark_rows(rows: Rows, verdict: np.ndarray, outputs: Sequence[Quantity]) -> Rows:
    """The rows, without those whose values or outputs are out of range or whose values contradict each other."""
    rows.status[:] = np.where(verdict == Status.OK, rows.status, verdict)
    for i, q in enumerate(outputs):
        if np.isfinite([q.low, q.high]).any():
            y = rows.y[..., i].reshape(len(rows.status), -1)
            slack = SLACK * (q.nominal + np.abs(y))
            wrong = ((y < q.low - slack) | (y > q.high + slack)).any(axis=1)
            rows.status[wrong & (rows.status == int(Status.OK))] = Status.OUT_OF_RANGE
    failed = rows.status != int(Status.OK)
    if failed.any():
        for array in (rows.x, rows.y, rows.supplied, rows.gained, rows.throughput, rows.outside):
            array[failed] = np.nan
    return rows
