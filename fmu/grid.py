"""Communication points, input values and rows of a run, laid out before the first step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.errors import FmuError

#: Communication steps of a run at most.
MOST_STEPS = 1e7

#: Input name -> (times, values), linear between the points; a time given twice is a jump.
Inputs = Mapping[str, tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Grid:
    """A run as arrays: at `time[k]` the inputs take `value[k]` and then move with `slope[k]`.

    Attributes:
        names: the inputs, in the order of the columns
        time: communication points (n)
        value, slope: (n - 1, inputs)
        rows_before, rows_after: rows to read at each point, before and after its inputs are set (n)
        row_time: time of each row
    """

    names: tuple[str, ...]
    time: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    rows_before: np.ndarray
    rows_after: np.ndarray
    row_time: np.ndarray


def grid(
    inputs: Inputs, begin: float, stop: float, step: float, output_times: Sequence[float] | np.ndarray | None
) -> Grid:
    """Lay out a run; communication points stand every `step`, on every row and on every point of the inputs.

    Args:
        inputs: name -> (times [s], values in SI), linear between the points, a time given twice is a jump
        begin: start of the run [s]
        stop: its end [s]
        step: communication step [s]
        output_times: times of the rows [s], not decreasing; when None every communication point, and both sides of
            every jump

    Raises:
        FmuError: times or values that make no sense
    """
    columns = {n: (np.asarray(t, dtype=float), np.asarray(v, dtype=float)) for n, (t, v) in inputs.items()}
    if problems := _problems(columns, begin, stop, step, output_times):
        raise FmuError(problems)
    regular = begin + step * np.arange(int((stop - begin) / step * (1 + 1e-12)) + 1)
    given = [t[(t > begin) & (t < stop)] for t, _ in columns.values()]
    wanted = regular if output_times is None else np.asarray(output_times, dtype=float)
    time = _merge_times([np.array([begin, stop]), *given, wanted, regular], 1e-9 * (1 + abs(stop) + abs(begin)))
    value = (
        np.array([_limit(t, v, time[:-1], "right") for t, v in columns.values()]).reshape(len(columns), len(time) - 1).T
    )
    end = np.array([_limit(t, v, time[1:], "left") for t, v in columns.values()]).reshape(len(columns), len(time) - 1).T
    slope = (end - value) / np.diff(time)[:, None]
    jumps = np.append((np.abs(value[1:] - end[:-1]) > 0).any(axis=1), False)
    row_time, before, after = _rows(time, np.append(False, jumps), wanted, output_times is None)
    contiguous = [np.ascontiguousarray(a) for a in (value, slope)]
    return Grid(tuple(columns), time, contiguous[0], contiguous[1], before, after, row_time)


def _problems(
    columns: Inputs, begin: float, stop: float, step: float, output_times: Sequence[float] | np.ndarray | None
) -> list[str]:
    problems = []
    if not (np.isfinite([begin, stop]).all() and stop > begin):
        problems.append(f"the run goes from {begin:g} s to {stop:g} s. Its end must lie after its start.")
    if not (np.isfinite(step) and step > 0):
        problems.append(f"the communication step is {step:g} s. It must be above 0 s.")
    elif not problems and (stop - begin) / step > MOST_STEPS:
        problems.append(
            f"{stop - begin:g} s in steps of {step:g} s are {(stop - begin) / step:.3g}, at most {MOST_STEPS:g} are"
            " taken. Give a longer step or a shorter run."
        )
    for name, (time, values) in columns.items():
        if len(time) != len(values) or not len(time):
            problems.append(f'input "{name}": {len(time)} times and {len(values)} values.')
        elif not np.isfinite(time).all() or (np.diff(time) < 0).any():
            problems.append(f'input "{name}": times must be finite and must not go back.')
    if output_times is not None:
        rows = np.asarray(output_times, dtype=float)
        if not len(rows) or not ((rows >= begin) & (rows <= stop)).all() or (np.diff(rows) < 0).any():
            problems.append(f"output times must lie in order between {begin:g} s and {stop:g} s, at least one.")
    return problems


def _merge_times(groups: list[np.ndarray], apart: float) -> np.ndarray:
    """All times in order; of times that only round-off keeps apart the one of the earliest group stays."""
    kept = np.unique(groups[0])
    for group in groups[1:]:
        fresh = np.unique(group)
        near = np.searchsorted(kept, fresh)
        left = np.abs(fresh - kept[np.maximum(near - 1, 0)])
        right = np.abs(fresh - kept[np.minimum(near, len(kept) - 1)])
        kept = np.sort(np.concatenate([kept, fresh[np.minimum(left, right) > apart]]))
    return kept


def _limit(time: np.ndarray, values: np.ndarray, at: np.ndarray, side: str) -> np.ndarray:
    """The piecewise linear function at `at`, behind ("right") or before ("left") a jump there."""
    upper = np.searchsorted(time, at, side="right") if side == "right" else np.searchsorted(time, at, side="left")
    a, b = np.clip(upper - 1, 0, len(time) - 1), np.clip(upper, 0, len(time) - 1)
    width = time[b] - time[a]
    part = np.divide(at - time[a], width, out=np.zeros_like(at), where=width > 0)
    part = np.clip(part, 0.0, 1.0)
    return np.where(part == 1.0, values[b], values[a] + part * (values[b] - values[a]))


def _rows(
    time: np.ndarray, jumps: np.ndarray, wanted: np.ndarray, both_sides: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows before and after the inputs are set at each point: after a jump, of a time given twice the first before."""
    last = len(time) - 1
    before, after = np.zeros(len(time), dtype=int), np.zeros(len(time), dtype=int)
    place = np.clip(np.searchsorted(time, wanted), 1, last)
    place = np.where(wanted - time[place - 1] <= time[place] - wanted, place - 1, place)
    for k in range(len(wanted)):
        twice = k + 1 < len(wanted) and wanted[k + 1] == wanted[k]
        first = place[k] == last or (twice and jumps[place[k]])
        (before if first else after)[place[k]] += 1
    if both_sides:
        before[jumps] = 1
        after[jumps] = 1
        before[last], after[last], after[0] = 1, 0, 1
    return np.repeat(time, before + after), before, after
