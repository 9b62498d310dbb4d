"""Logs that cannot be: blocks that are there twice, readings that hang, means that no measured table would have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from ...model.errors import DataError
from ..csv_table import raise_all
from ..scenario import Scenario
from .checks import check
from .nominal import Nominal, drive_by, unmeasured
from .placeholders import placeholders
from .table import Campaign, Sensor

#: Means of a log that are judged.
BLOCKS = 12
#: A block of this length lasts for steady states, near enough [s].
DAY = 86400.0
#: Samples in a row that no second block repeats.
ALIKE = 24
#: A reading that hangs stays the same for so many times as long as it does otherwise,
HANGS = 5
#: while a quantity that drives the rig moves over this share of its range in the log.
MOVES = 0.3
#: What drives the rig is not known where it is missing for longer than this [s], and than so many times its usual gap.
LONG = 1800.0
USUAL = 2.0
#: Odd number by which the rows of a block are told apart modulo 2^64: 2^64 over the golden ratio.
MULTIPLIER = np.uint64(11400714819323198485)


def check_log(
    name: str,
    sensors: Sequence[Sensor],
    values: Mapping[str, np.ndarray],
    lines: np.ndarray,
    step: float,
    scenario: Scenario,
) -> tuple[str, ...]:
    """Refuse a log that cannot be one of a rig; what the user should know of it.

    Args:
        name: of the file
        sensors: what was logged
        values: sensor -> column in SI (n,)
        lines: line of each row in the file (n,)
        step: from sample to sample [s]
        scenario: the rig

    Raises:
        DataError: all that cannot be
    """
    if (begin := _repeated([values[s.name] for s in sensors])) is not None:
        later, earlier = (lines[k] for k in begin)
        raise DataError(
            f"{name} line {later}: {ALIKE} rows and more are those from line {earlier} on. Keep one of the blocks."
        )
    raise_all(list(placeholders(name, sensors, values, lines)), name)
    nominal = Nominal(drive_by(scenario, sensors))
    check(_as_campaign(name, sensors, values, lines, step), nominal, {})
    return (*unmeasured(nominal, name, sensors), *_hanging(name, sensors, values, lines))


def find_unseen(
    name: str, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], lines: np.ndarray, step: float
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Rows in which it is not known what drives the rig (n,) bool, and what the user should know of them.

    Args:
        name, sensors, values, lines, step: as of `check_log`
    """
    unseen, said = np.zeros(len(lines), dtype=bool), []
    for s in (s for s in sensors if s.role == "given"):
        known = np.flatnonzero(np.isfinite(values[s.name]))
        most = max(LONG / step, USUAL * float(np.median(np.diff(known))) if len(known) > 1 else 0.0)
        ends = np.concatenate([[-1], known, [len(lines)]])
        holes = [(a + 1, b) for a, b in pairwise(ends) if b - a - 1 > most]
        for begin, end in holes:
            unseen[begin:end] = True
        if holes:
            (begin, end), many = holes[0], sum(b - a for a, b in holes)
            said.append(
                f"{name}: {s.column}, which drives the rig, is missing in {many} rows, first in lines {lines[begin]} to"
                f" {lines[end - 1]}. These rows are left out."
            )
    return unseen, tuple(said)


def _hanging(
    name: str, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], lines: np.ndarray
) -> Iterator[str]:
    """Readings that stay the same far longer than they do otherwise, while what drives the rig moves."""
    driving = [values[s.name] for s in sensors if s.role == "given"]
    for s in (s for s in sensors if s.role == "read"):
        rows = np.flatnonzero(np.isfinite(values[s.name]))
        shown = values[s.name][rows]
        begins = np.flatnonzero(np.diff(shown, prepend=np.nan) != 0)
        lengths = np.diff(np.append(begins, len(rows)))
        *_, second, longest = np.append([0, 0], np.sort(lengths))
        if longest < max(ALIKE, HANGS * second):
            continue
        at = begins[lengths.argmax()]
        same = rows[at : at + longest]
        if any(_span(column[same]) > MOVES * _span(column) for column in driving):
            yield (
                f"{name} lines {lines[same[0]]} to {lines[same[-1]]}: {s.column} is always the same, while what drives"
                " the rig moves. It hangs, or was filled in. Leave these cells empty; else they count as readings."
            )


def _repeated(columns: Sequence[np.ndarray]) -> tuple[int, int] | None:
    """Begin of the first block of rows of columns (n,) that is there twice, and of the first one; None without."""
    if len(columns[0]) < 2 * ALIKE:
        return None
    row = np.zeros(len(columns[0]), dtype=np.uint64)
    for column in columns:
        row = (row ^ (np.nan_to_num(column) + 0.0).view(np.uint64)) * MULTIPLIER  # no zero is negative
        row ^= row >> np.uint64(32)
    blocks = len(row) - ALIKE + 1
    block = np.zeros(blocks, dtype=np.uint64)
    for k in range(ALIKE):
        block = block * MULTIPLIER + row[k : k + blocks]
    changes = np.append(0, np.cumsum(row[1:] != row[:-1]))
    _, first, number = np.unique(block, return_index=True, return_inverse=True)
    earlier = first[number.ravel()]
    moving = changes[ALIKE - 1 :] - changes[:blocks] >= ALIKE // 2  # a machine at rest repeats itself
    found = np.flatnonzero(moving & (np.arange(blocks) - earlier >= ALIKE))
    return (int(found[0]), int(earlier[found[0]])) if len(found) else None


def _as_campaign(
    name: str, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], lines: np.ndarray, step: float
) -> Campaign:
    """Means of blocks of a log, a test each."""
    blocks = np.array_split(np.arange(len(lines)), min(BLOCKS, len(lines)))
    n, first = len(blocks), np.array([block[0] for block in blocks])
    span = len(lines) // n * step
    means = {sensor: np.array([_mean(column[block]) for block in blocks]) for sensor, column in values.items()}
    dwell = np.full(n, np.inf if span >= DAY else span)
    name = f"{name} (means of {len(lines) // n} rows)" if len(lines) > n else name
    return Campaign.of(name, sensors, means, np.arange(n), order=np.arange(n), dwell=dwell, lines=lines[first])


def _span(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if len(known) else 0.0


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else np.nan
