"""A transient: the flat model driven by a schedule, restarted at jumps only, with its energy integrated alongside."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError, SolveError, suggestion
from ..units import text
from .fast import once
from .integrate import Failure, Stretch, Transient
from .point import Point, point, problem_of
from .result import Audit, Result
from .rows import evaluate, result
from .schedule import Schedule

#: Rows of a result where nothing else is asked for [s].
OUTPUT_STEP = 60.0
#: Numbers that are held at once for each state, input, parameter and expression of a row, with what makes them [1].
COPIES = 5
#: Memory that a run may take where the system does not tell how much there is [bytes].
USUAL_MEMORY = 8e9
#: Where Linux tells how much memory a container may take [bytes].
CONTAINER = Path("/sys/fs/cgroup/memory.max")

#: Methods by name.
METHODS = ("idas", "lsoda")

#: (states, inputs and parameters at the beginning; times of the rows) -> states there, a column each; all expressions
#: of the model, as `evaluate` finds them; supply and throughput of the run [J]. None where it does not get through.
Through = Callable[[Point, np.ndarray], tuple[np.ndarray, dict[str, np.ndarray], np.ndarray] | None]


def simulate(
    flat: FlatModel,
    schedule: Schedule,
    *,
    start: Mapping[str, float] | None = None,
    values: Mapping[str, float] | None = None,
    times: Sequence[float] | np.ndarray | None = None,
    tolerance: float = 1e-8,
    method: str = "idas",
    through: Through | None = None,
    every: float = OUTPUT_STEP,
) -> Result:
    """Run a model through a duty.

    Args:
        flat: the model
        schedule: inputs over time; inputs it does not name keep their value in `values` or their own
        start: states at the beginning, by path (SI)
        values: parameters and constant inputs, by path (SI)
        times: output times [s], not decreasing; a row at a jump shows the inputs after it, a time given twice both
            sides. Without it: as often as `every` says, and both sides of every jump
        tolerance: of the local error, relative to each state's nominal and its distance from the start
        method: "idas" (SUNDIALS BDF for differential-algebraic systems, through CasADi) or "lsoda" (SciPy, one Python
            call per right-hand side)
        through: an integration of one's own, to the same tolerance; the method says why where it does not get through
        every: time between two rows [s]

    Returns:
        all states, inputs and outputs, with the energy audit from integrated powers

    Raises:
        ScenarioError: unknown names, values out of range, times outside the duty
        SolveError: the integration cannot go on; the text names the time reached and the state at fault
    """
    asked = _problems(flat, schedule, times, method)
    if asked:
        raise ScenarioError(asked)
    begin = point(flat, values, start, who="simulate", taken=schedule.values)
    stretches = _stretches(flat, schedule, begin.u)
    rows = (
        _rows(flat, schedule, stretches, every)
        if times is None
        else _pick_rows(np.asarray(times, dtype=float), stretches)
    )
    u = np.hstack([stretch.inputs(rows.time[here]) for stretch, here in rows.of(stretches)])
    if through is not None and (found := through(begin, rows.time)) is not None:
        x, evaluated, energy = found
        last = x[:, -1]
    else:
        transient = Transient(flat, begin.x, begin.p, tolerance)
        x, z, last, energy = _integrate(transient, begin, stretches, rows, method)
        evaluated = evaluate(flat, x, u, begin.p, z)
    return _result(flat, rows.time, x, u, evaluated, begin, last, energy, tolerance)


def _integrate(
    transient: Transient, begin: Point, stretches: Sequence[Stretch], rows: _Rows, method: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """States and algebraic variables at the rows, the states at the end, supply and throughput [J]."""
    flat = transient.flat
    run: Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray]] = getattr(transient, method)
    x, z = (np.empty((len(group), len(rows.time))) for group in (flat.states, flat.algebraic))
    now, energy = begin.x, np.zeros(2)
    for stretch, here in rows.of(stretches):
        grid = _merge_times(stretch.time, rows.time[here])
        try:
            path, algebraic, gained = run(stretch, grid, now)
        except Failure as failure:
            raise SolveError(_message(flat, failure, begin, stretch, method)) from None
        except SolveError as error:
            raise SolveError(f"simulate: at {stretch.begin:.6g} s {error}") from None
        _check_ranges(flat, grid, path)
        shown = _nearest(grid, rows.time[here])
        x[:, here], z[:, here] = path[:, shown], algebraic[:, shown]
        now, energy = path[:, -1], energy + gained
    return x, z, now, energy


@dataclass(frozen=True)
class _Rows:
    """Times of the rows and the stretch each belongs to."""

    time: np.ndarray
    stretch: np.ndarray

    def of(self, stretches: Sequence[Stretch]) -> Iterator[tuple[Stretch, slice]]:
        """The rows of each stretch."""
        first = np.searchsorted(self.stretch, np.arange(len(stretches) + 1))
        return zip(stretches, map(slice, first, first[1:]), strict=False)


def _problems(
    flat: FlatModel, schedule: Schedule, times: Sequence[float] | np.ndarray | None, method: str
) -> list[str]:
    found = [problem for name in schedule.values if (problem := problem_of(flat, name, ("input",), "simulate"))]
    for name in schedule.values.keys() & flat.index.keys():
        column = schedule.values[name]
        extremes = dict.fromkeys((float(column.min()), float(column.max())))
        found += [f"simulate: duty: {p}" for value in extremes if (p := flat.quantity(name).problem(value))]
    if method not in METHODS:
        choice = " or ".join(METHODS)
        found.append(f'simulate: unknown method "{method}".{suggestion(method, METHODS)} Choose {choice}.')
    if times is None:
        return found
    moments = np.asarray(times, dtype=float)
    wrong = moments[~((moments >= schedule.start) & (moments <= schedule.stop))]
    if wrong.size:
        found.append(
            f"simulate: output time {wrong[0]:g} s lies outside the duty ({schedule.start:g} ... {schedule.stop:g} s)."
        )
    elif not moments.size or (np.diff(moments) < 0).any():
        found.append("simulate: output times must be given in order, at least one.")
    return found


def _stretches(flat: FlatModel, schedule: Schedule, u: np.ndarray) -> list[Stretch]:
    """The duty between jumps, with constant inputs filled in."""
    columns = [schedule.values.get(q.name, np.full(len(schedule.time), u[i])) for i, q in enumerate(flat.inputs)]
    table = np.array(columns).reshape(len(flat.inputs), len(schedule.time))
    found = [Stretch(schedule.time[part], table[:, part]) for part in schedule.stretches()]
    if not found:
        raise ScenarioError(f"simulate: the duty lasts no time (it stays at {schedule.start:g} s). Give it a duration.")
    return found


def _rows(flat: FlatModel, schedule: Schedule, stretches: Sequence[Stretch], step: float) -> _Rows:
    """A row every output step, and one at both ends of every stretch."""
    if not step > 0:
        raise ScenarioError(f"simulate: a row every {step:g} s. Give a time above 0.")
    n = (schedule.stop - schedule.start) / step + 2 * len(stretches)
    groups = (*flat.states, *flat.inputs, *flat.parameters)
    width = len(groups) + sum(flat.function.numel_out(name) for name in flat.function.name_out())
    if (needed := 8.0 * COPIES * n * width) > (there := memory()):
        raise ScenarioError(
            f"simulate: {schedule.stop - schedule.start:g} s with a row every {step:g} s and {len(stretches) - 1} jumps"
            f" are {n:.3g} rows, which take about {needed / 1e9:.3g} GB of memory; there are {there / 1e9:.3g} GB."
            " Give more time between the rows, or a shorter duty."
        )
    every = np.arange(schedule.start, schedule.stop, step)
    times = []
    for s in stretches:
        inside = every[slice(*np.searchsorted(every, (s.begin, s.end)))]
        times.append(_merge_times(np.array([s.begin, s.end]), inside))
    owners = [np.full(len(t), k) for k, t in enumerate(times)]
    return _Rows(np.concatenate(times), np.concatenate(owners))


def memory() -> float:
    """Memory of this machine, or what its container may take of it [bytes]."""
    try:
        held = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):  # Windows has no such call
        held = USUAL_MEMORY
    with suppress(OSError, ValueError):  # "max" is no number: no limit
        held = min(held, float(CONTAINER.read_text(encoding="ascii")))
    return held


def _pick_rows(times: np.ndarray, stretches: Sequence[Stretch]) -> _Rows:
    """The rows asked for: at a jump the side after it, where a time comes twice the first of them before it."""
    begins = np.array([s.begin for s in stretches])
    stretch = np.maximum(np.searchsorted(begins, times, side="right") - 1, 0)
    first_of_two = np.append(times[1:] == times[:-1], False)
    at_jump = first_of_two & (stretch > 0) & (times == begins[stretch])
    return _Rows(times, stretch - at_jump)


def _merge_times(edges: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Edges and times in order; times that round-off alone keeps from an edge or each other are one."""
    every = np.unique(np.concatenate([edges, times]))
    apart = 1e-9 * (1.0 + edges[-1] - edges[0])
    keep = np.append(True, np.diff(every) > apart)
    merged: np.ndarray = every[keep]
    merged[-1] = edges[-1]
    return merged


def _nearest(grid: np.ndarray, times: np.ndarray) -> np.ndarray:
    after = np.clip(np.searchsorted(grid, times), 1, len(grid) - 1)
    return np.where(times - grid[after - 1] < grid[after] - times, after - 1, after)


def _result(
    flat: FlatModel,
    time: np.ndarray,
    x: np.ndarray,
    u: np.ndarray,
    evaluated: dict[str, np.ndarray],
    begin: Point,
    last: np.ndarray,
    energy: np.ndarray,
    tolerance: float,
) -> Result:
    stored = _make_energy(flat)
    ends = [float(stored(state, u[:, k], begin.p)) for state, k in ((begin.x, 0), (last, -1))]
    held = float(max(np.abs(evaluated["stored"]).max(), *map(abs, ends)))
    audit = Audit(float(energy[0]), ends[1] - ends[0], float(energy[1]), held)
    return result(flat, "transient", time, x, u, evaluated, audit, tolerance)


@once
def _make_energy(flat: FlatModel) -> Any:
    """CasADi function (x, u, p) -> energy of the states."""
    return ca.Function("stored", [flat.x, flat.u, flat.p], [flat.stored])


def _check_ranges(flat: FlatModel, grid: np.ndarray, path: np.ndarray) -> None:
    """Raise SolveError where a state leaves its range by more than round-off."""
    for q, row in zip(flat.states, path, strict=True):
        slack = 1e-6 * q.nominal
        wrong = np.flatnonzero((row < q.low - slack) | (row > q.high + slack))
        if wrong.size:
            i, unit = int(wrong[0]), "" if q.unit == "1" else f" {q.unit}"
            raise SolveError(
                f"simulate: {q.name} leaves its range ({q.low:g} ... {q.high:g}{unit}) at {grid[i]:.6g} s: "
                f"it has reached {text(row[i], q.unit)}.\n"
                f"Check what drives {q.name.rpartition('.')[0]} before that time."
            )


def _message(flat: FlatModel, failure: Failure, begin: Point, stretch: Stretch, method: str) -> str:
    """Where the integration stopped and the state that moved furthest for its size."""
    if failure.passable:
        other = next(m for m in METHODS if m != method)
        return (
            f"simulate: {method} gives up between {stretch.begin:g} and {stretch.end:g} s, though small steps get "
            f'through. Use the method "{other}" or a looser tolerance.'
        )
    if failure.block:
        return f"simulate: the run stops at {failure.time:.6g} s: behind that {failure.block}"
    if not flat.states:
        return f"simulate: {flat.name} cannot be evaluated at {failure.time:g} s."
    nominal = np.array([q.nominal for q in flat.states])
    speed = np.abs(np.where(np.isfinite(failure.rate), failure.rate, np.inf)) / (nominal + np.abs(failure.x))
    worst = flat.states[int(np.argmax(speed))]
    i = flat.index[worst.name][1]
    return (
        f"simulate: the run stops at {failure.time:.6g} s: {worst.name} has reached {text(failure.x[i], worst.unit)} "
        f"and changes by {failure.rate[i]:.3g} {worst.unit}/s.\n"
        f"It started at {text(begin.x[i], worst.unit)}. Check what drives {worst.name.rpartition('.')[0]} "
        f"at that time, and its parameters."
    )
