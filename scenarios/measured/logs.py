"""Logs of a running machine: samples in uninterrupted stretches, from CSV, gzipped CSV or Parquet files."""

from __future__ import annotations

import csv
import gzip
import math
import zlib
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from itertools import chain, islice
from pathlib import Path
from typing import IO, Any, cast

import numpy as np

from ...model.errors import DataError, Problems
from ...model.files import reading
from ..csv_cells import fold, is_nothing, ragged_rows, two_readings
from ..csv_table import header_problems, in_si, plain, raise_all, split_unit, take_units, tells_sign, written
from ..scenario import Scenario
from .card import Card
from .checks import COLDEST, HOTTEST
from .log_checks import check_log, find_unseen
from .read import place_sensor
from .sensors import SI, sensors_of, si_of
from .shafts import torques
from .table import Sensed, Sensor
from .times import find_days, find_times, join_days, seconds, time_column

#: A gap of more than so many samples starts a new stretch.
GAP = 1.5
#: By which clocks are put back in autumn [s].
HOUR = 3600.0
#: Least step of a log [s].
SHORTEST = 1e-3
#: Largest step of a log [s].
LONGEST = 86400.0
#: A single sample further than all of these from both its neighbours is a gross reading: standard deviations of steps.
SPIKE_SD = 12.0
#: [K].
SPIKE_K = 8.0
#: Numbers of at least this are seconds since 1970, whose unit is plain [s].
SINCE_1970 = 1e8
#: Share of temperatures that cannot be above which they have another unit.
IMPOSSIBLE = 0.02
#: Rows that are read at a time: as many as stay in a processor's own memory.
BLOCK = 300
#: Times what one sample in a thousand exceeds.
SPIKE_TAIL = 2.5


@dataclass(frozen=True)
class Gross:
    """A reading that is set aside: its line in the file, its column, what it shows and what its neighbours say [SI]."""

    line: int
    column: str
    shown: float
    expected: float
    size_sd: float


@dataclass(frozen=True, eq=False)
class Log(Sensed):
    """Samples of one machine.

    Args:
        name: of the file
        sensors: what was logged
        values: sensor -> column in SI with the signs of the column (n,), NaN where a reading is missing or set aside
        time: end of each sample [s] (n,), since 1970 where the file has time stamps
        stretch: number of each row's stretch (n,), never falling; within one all steps are alike
        step: time from sample to sample [s]
        lines: line of each row in the file (n,)
        dated: whether the time is that of a calendar
        gross: readings that were set aside
        warnings: what the user should know of the file
    """

    name: str
    sensors: tuple[Sensor, ...]
    values: dict[str, np.ndarray]
    time: np.ndarray
    stretch: np.ndarray
    step: float
    lines: np.ndarray
    dated: bool
    gross: tuple[Gross, ...] = field(default=())
    warnings: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(self.time)

    def rows(self, keep: np.ndarray, name: str = "") -> Log:
        """Some of the rows; a hole ends a stretch.

        Args:
            keep: which rows (n,) bool
            name: of the log they make; that of this one if empty
        """
        kept = np.flatnonzero(keep)
        breaks = np.append(True, (np.diff(kept) > 1) | (np.diff(self.stretch[kept]) != 0))
        values = {sensor: column[kept] for sensor, column in self.values.items()}
        stretch, named = np.cumsum(breaks) - 1, name or self.name
        return replace(self, name=named, values=values, time=self.time[kept], stretch=stretch, lines=self.lines[kept])


def read_log(path: Path, scenario: Scenario, card: Card) -> Log:
    """A log of a rig.

    Args:
        path: CSV, CSV.gz or Parquet, one row a sample; columns that no sensor has are not used
        scenario: the rig
        card: its columns, units and sensors

    Raises:
        DataError: everything wrong with the file, at once
    """
    segment, problems = card.columns.get("segment", "segment"), Problems()

    def used(header: Sequence[str]) -> Collection[str]:
        sensors, wrong = _columns(header, scenario, card, path.name)
        problems.extend(wrong)
        times = find_times(header, card.columns.get("time", ""))
        return {segment, *times, *find_days(header), *(s.column for s in sensors)}

    cells, lines = read_columns(path, used, problems)
    return log_of(path.name, cells, lines, scenario, card, problems)


def log_of(
    name: str,
    cells: dict[str, Sequence[Any]],
    lines: np.ndarray,
    scenario: Scenario,
    card: Card,
    known: Sequence[str] | None = None,
) -> Log:
    """A log of a rig from its columns.

    Args:
        name: of the file
        cells: header -> cells (n,); those of the time and of segments are taken out
        lines: line of each row in the file (n,)
        scenario: the rig
        card: its columns, units and sensors
        known: problems of its header and rows; None where nothing has looked for them

    Raises:
        DataError: everything wrong with them, at once
    """
    sensors, wrong = _columns(list(cells), scenario, card, name)
    problems = Problems(wrong if known is None else known)
    values = {s.name: _values(cells[s.column], s, name, lines, problems) for s in sensors}
    with problems:
        time, dated, stretch, step, said = _timed(cells, name, lines, card)
    raise_all(problems, name)
    sensors, values = torques(scenario, sensors, values, name)
    values, gross = _remove_outliers(name, values, sensors, stretch, lines)
    unseen, left_out = find_unseen(name, sensors, values, lines, step)
    warnings = (*said, *check_log(name, sensors, values, lines, step, scenario), *left_out)
    return Log(name, sensors, values, time, stretch, step, lines, dated, gross, warnings).rows(~unseen)


def _columns(header: Sequence[str], scenario: Scenario, card: Card, name: str) -> tuple[tuple[Sensor, ...], Problems]:
    """The sensors that a log has, and what is wrong with their columns."""
    sensors, problems = place_sensor(sensors_of(scenario, card), header, card, name)
    if not any(s.role == "read" for s in sensors):
        problems.append(f"{name} line 1: no column of a sensor that is compared. Name yours in the card: columns.")
    return sensors, problems


def _timed(
    cells: dict[str, Sequence[Any]], name: str, lines: np.ndarray, card: Card
) -> tuple[np.ndarray, bool, np.ndarray, float, tuple[str, ...]]:
    """Time [s] (n,), whether it is a calendar's, stretch of each row (n,), step [s], and warnings.

    The columns of time and of segments are taken out. Raises DataError where there are no such times.
    """
    column, problems = time_column(cells, card.columns.get("time", ""), f"{name} line 1"), Problems()
    unit = card.units.get(column, split_unit(column)[1])
    time, dated = seconds(join_days(cells, column), column, name, lines, problems, unit)
    raise_all(problems, name)
    del cells[column]
    stretch, step = _stretches(time, cells.pop(card.columns.get("segment", "segment"), None), name, lines)
    bare = not (dated or unit) and time[0] < SINCE_1970
    said = (
        f"{name}: {column} has no unit and is taken for seconds, {step:.4g} s from sample to sample. If it is another,"
        ' write it behind the name, "time [min]", or in the card\'s table [units].'
    )
    return time, dated, stretch, step, (said,) if bare else ()


def read_columns(
    path: Path, used: Callable[[Sequence[str]], Collection[str]], problems: list[str] | None = None
) -> tuple[dict[str, Sequence[Any]], np.ndarray]:
    """Used columns by header, the line of each row; cells as numbers, block by block, where they are nothing else.

    Args:
        path: CSV, CSV.gz or Parquet
        used: which columns of a header
        problems: take what is wrong with the header, and rows of other lengths, which are then left out

    Raises:
        DataError: it cannot be read, or its rows are not those of a table
    """
    odd: list[tuple[int, list[str]]] = []
    try:
        if path.suffix in (".parquet", ".pq"):
            return _parquet(path, used)
        text, sign = _open(path)
        with text as file:
            header, rows = read_head(path.name, csv.reader(file, delimiter=sign), problems)
            kept, lines = used(list(dict.fromkeys(header))), list[np.ndarray]()
            parts: dict[str, list[Sequence[Any]]] = {h: [] for h in header if h in kept}
            while block := list(islice(rows, BLOCK)):
                if sign != "," and not lines and (problem := two_readings(path.name, block)):
                    raise DataError(problem)
                if any(len(row) != len(header) for _, row in block):
                    odd += [(line, row) for line, row in block if len(row) != len(header)]
                    block = [(line, row) for line, row in block if len(row) == len(header)]
                lines.append(np.array([line for line, _ in block], dtype=int))
                columns = list(zip(*(row for _, row in block), strict=True))
                for h, k in zip(parts, map(header.index, parts), strict=True):
                    parts[h].append(_compact(plain(columns[k] if block else (), sign)))
    except FileNotFoundError:
        raise DataError([f"{path}: there is no such file. Check the path."]) from None
    except (OSError, EOFError, ValueError, zlib.error, csv.Error):
        raise DataError([f"{path}: cannot be read. Give a CSV, CSV.gz or Parquet file."]) from None
    ragged = ragged_rows(path.name, header, odd)
    if problems is None:
        raise_all(ragged, path.name)
    else:
        problems += ragged
    if not lines:
        raise DataError([f"{path.name}: holds no samples."])
    return {h: _join(part) for h, part in parts.items()}, np.concatenate(lines)


def read_head(
    name: str, reader: Any, problems: list[str] | None = None
) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """Header with the units of a row under it, and the line and cells of the other rows; one row is read ahead.

    Args:
        name: of the file
        reader: rows of cells, as that of `csv`
        problems: take what is wrong with the header

    Raises:
        DataError: what is wrong with it, where nothing takes it
    """
    first: list[str] = next(reader, [])
    names: list[str] = next(reader, []) if tells_sign(first) else first
    header = [h.strip() for h in names]
    wrong = header_problems(name, header)
    rows = ((reader.line_num, row) for row in reader if any(row) and row != names)
    if ahead := list(islice(rows, 1)):
        header, ahead, more = take_units(name, header, ahead)
        wrong += more
    if problems is None:
        raise_all(wrong, name)
    else:
        problems += wrong
    return header, chain(ahead, rows)


def _compact(cells: Sequence[str]) -> Sequence[Any]:
    """Cells as an array of numbers, NaN where one is empty; as they are where one is anything else."""
    try:
        found = np.fromiter(map(float, [cell or "nan" for cell in cells]), float, len(cells))
    except ValueError:
        return cells
    plain = np.isfinite(found).sum() + cells.count("") == len(cells) and "_" not in "".join(cells)
    return cast(Sequence[Any], found) if plain else cells


def _join(parts: Sequence[Sequence[Any]]) -> Sequence[Any]:
    """Blocks of a column as one, an array where all of them are."""
    if all(isinstance(part, np.ndarray) for part in parts):
        return cast(Sequence[Any], np.concatenate(parts))
    return list(chain.from_iterable(parts))


def _open(path: Path) -> tuple[IO[str], str]:
    """A table as text, and what separates its columns; below its head there are numbers, alike in all encodings."""
    opened = gzip.open if reading(path).suffix == ".gz" else open
    with opened(path, "rb") as file:
        encoding, sign = written(b"".join(islice(file, 3)))
    return cast(IO[str], opened(path, "rt", encoding=encoding, errors="replace")), sign


def _parquet(
    path: Path, used: Callable[[Sequence[str]], Collection[str]]
) -> tuple[dict[str, Sequence[Any]], np.ndarray]:
    try:
        table = import_module("pyarrow.parquet").read_table(reading(path))
        kept = used(table.column_names)
    except ImportError:
        raise DataError([f'{path.name}: Parquet files need pyarrow: pip install "gearheat[parquet]".']) from None
    columns = {name: table.column(name).to_pylist() for name in table.column_names if name in kept}
    return columns, np.arange(1, table.num_rows + 1)


def parse_number(cell: Any) -> float:
    """A cell as a number, NaN where it is empty. Raises TypeError or ValueError where it is none."""
    if cell is None or (isinstance(cell, str) and is_nothing(cell)):
        return math.nan
    if math.isinf(number := float(cell)) or isinstance(cell, bool) or (isinstance(cell, str) and "_" in cell):
        raise ValueError
    return number


def _values(cells: Sequence[Any], sensor: Sensor, name: str, lines: np.ndarray, problems: Problems) -> np.ndarray:
    """A column in SI (n,), NaN where a cell is empty."""
    whole = isinstance(cells, np.ndarray)
    found = np.array(cells) if whole else np.full(len(cells), np.nan)
    wrong = []
    for k, cell in enumerate([] if whole else cells):
        try:
            found[k] = parse_number(cell)
        except (TypeError, ValueError):
            wrong.append((lines[k], f'{sensor.column} is "{cell}", expected a number or nothing.'))
    problems += fold(name, wrong)
    if not np.isfinite(found).any():
        problems.append(f"{name}: column {sensor.column} holds no number. Give what was read, or take it out.")
    with problems:
        found = in_si(found, sensor.unit, si_of(sensor), name=f"{name} {sensor.column}")
    return found


def _gone_back(by: float, step: float) -> str:
    """What is said of a time that does not go on: by how much it moves, and the usual step [s]."""
    if by == 0:
        return "it has the time of the line above. Keep one of the two."
    if step < HOUR and abs(by - step + HOUR) < 0.5 * step:
        return "time goes back an hour, as clocks do in autumn. Write times in UTC, or with a zone, 02:00+01:00."
    return "time does not go on. Sort the samples by time."


def _stretches(
    time: np.ndarray, segments: Sequence[Any] | None, name: str, lines: np.ndarray
) -> tuple[np.ndarray, float]:
    """Stretch of each row (n,), and the step [s]: a new segment, a gap or another step begins a stretch."""
    if len(time) < 3:
        raise DataError([f"{name}: holds {len(time)} samples. Give at least three."])
    named = (
        np.zeros(len(time))
        if segments is None
        else np.asarray(segments, None if isinstance(segments, np.ndarray) else str)
    )
    other = np.diff(np.unique(named, return_inverse=True)[1]) != 0
    steps = np.diff(time)
    back = np.flatnonzero((steps <= 0) & ~other)
    step = float(np.median(np.abs(steps[steps != 0]))) if (steps != 0).any() else 0.0
    raise_all(fold(name, ((lines[k + 1], _gone_back(steps[k], step)) for k in back)), name)
    step = float(np.median(steps[(steps > 0) & ~other]))
    if not SHORTEST <= step <= LONGEST:
        raise DataError([f"{name}: there are {step:g} s from sample to sample. Check the unit of its time."])
    breaks = other | (np.abs(steps - step) > (GAP - 1) * step)
    return np.concatenate([[0], np.cumsum(breaks)]), step


def _remove_outliers(
    name: str, values: dict[str, np.ndarray], sensors: Sequence[Sensor], stretch: np.ndarray, lines: np.ndarray
) -> tuple[dict[str, np.ndarray], tuple[Gross, ...]]:
    """Single spikes and impossible temperatures are found and become missing."""
    cleaned, gross = dict(values), []
    for sensor in (s for s in sensors if SI[s.kind] == "K"):
        column = values[sensor.name]
        wrong = ~((column > COLDEST) & (column < HOTTEST)) & np.isfinite(column)
        if wrong.sum() > IMPOSSIBLE * np.isfinite(column).sum():
            raise DataError(
                f"{name} line {lines[wrong.argmax()]}: {sensor.column} is {column[wrong][0] - 273.15:.4g} degC, and"
                f" such in {wrong.sum()} rows. Check its unit, which is taken for {sensor.unit or 'K'}."
            )
        before, after = (np.roll(np.where(wrong, np.nan, column), shift) for shift in (1, -1))
        inside = np.zeros(len(column), dtype=bool)
        inside[1:-1] = (stretch[2:] == stretch[1:-1]) & (stretch[:-2] == stretch[1:-1])
        off = np.where(inside, np.minimum(np.abs(column - before), np.abs(column - after)), np.nan)
        off = np.where(np.sign(column - before) == np.sign(column - after), off, 0.0)
        steps = np.abs(np.diff(column[np.isfinite(column)]))  # over gaps: a slow channel has no two readings in a row
        sd = 1.4826 * float(np.median(steps) if len(steps) else 0.0) + 0.05
        usual = SPIKE_TAIL * float(np.nanquantile(off, 0.999))
        spiked = wrong | (off > max(SPIKE_SD * sd, SPIKE_K, usual))
        expected = np.where(np.isfinite(before + after), (before + after) / 2, np.nanmedian(column))
        gross += [
            Gross(int(lines[k]), sensor.column, float(column[k]), float(expected[k]), abs(column[k] - expected[k]) / sd)
            for k in np.flatnonzero(spiked)
        ]
        cleaned[sensor.name] = np.where(spiked, np.nan, column)
    return cleaned, tuple(gross)
