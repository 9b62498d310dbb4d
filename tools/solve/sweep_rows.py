"""The rows of a sweep: what a worker does with a block of them.

A work file keeps finished blocks beyond an interruption; what is left in the end is a table.

Imports neither CasADi nor the rig files: a worker compiles C and calls it.
"""

from __future__ import annotations

import hashlib
import os
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import numpy as np

from ...fmu.batch import Batch, Status
from ...model.errors import DataError
from ...model.files import replacing
from ...model.run.schedule import Schedule
from ...model.units import from_si, show_unit
from ..show.columns import cell_text
from ..show.console import note

#: First bytes of a work file.
MARK = b"gearheat sweep work file 1 "

#: Number of the block, its rows, and the checksum of its bytes.
_HEAD = struct.Struct("<qqI")

SUFFIXES = (".csv", ".parquet")

SCHEMA = "gearheat.sweep.rows/1"

#: What stands behind the outputs of a row.
TELLING = ("status", "iterations", "energy_residual", "outside")

Block = tuple[int, np.ndarray]


def work_file(out: Path) -> Path:
    """Where the finished blocks of a sweep are kept until its table is written."""
    return out.with_name(f"{out.name}.part")


class Store:
    """Finished blocks of rows in a file; a block is there whole or not at all.

    Args:
        path: the file, made if it is not there
        key: what the rows depend on; blocks kept under another key are dropped
        width: numbers of a row

    Raises:
        DataError: the file is something else, is in use, or cannot be written
    """

    def __init__(self, path: Path, key: str, width: int) -> None:
        self.path, self.width = path, width
        self.places: dict[int, tuple[int, int]] = {}
        head = MARK + f"{key} {width}\n".encode()
        try:
            self._file: BinaryIO = path.open("r+b" if path.exists() else "w+b")
        except OSError as error:
            raise DataError(f"{path}: cannot be written ({error.strerror}). Choose another place with -o.") from None
        try:
            self._lock()
            found = self._file.read(len(head))
            if found and not found.startswith(MARK[: len(found)]):
                raise DataError(f"{path}: is no work file of a sweep. Move it away, or choose another place with -o.")
            if found == head:
                self._read()
            elif found:
                note(f"{path}: the rows kept there belong to another sweep and are dropped")
        except BaseException:
            self._file.close()
            raise
        if not self.places:
            self._file.seek(0)
            self._file.truncate()
            self._file.write(head)
            self._file.flush()

    def _lock(self) -> None:
        """Keep other processes out, where the system can."""
        try:
            import fcntl
        except ImportError:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise DataError(
                f"{self.path}: another sweep is writing there. Wait for it, or choose another -o."
            ) from None

    def _read(self) -> None:
        """Find the blocks; what an interruption left half-written is cut off."""
        end, whole = self._file.tell(), os.fstat(self._file.fileno()).st_size
        while len(head := self._file.read(_HEAD.size)) == _HEAD.size:
            number, rows, checksum = _HEAD.unpack(head)
            size = 8 * rows * self.width
            if not 0 <= size <= whole - end - _HEAD.size or zlib.crc32(self._file.read(size)) != checksum:
                break
            self.places[number] = (end + _HEAD.size, rows)
            end += _HEAD.size + size
        self._file.truncate(end)

    def put(self, number: int, block: np.ndarray) -> None:
        """Keep a finished block (rows, width)."""
        data = np.ascontiguousarray(block, dtype="<f8").tobytes()
        place = self._file.seek(0, os.SEEK_END)
        try:
            self._file.write(_HEAD.pack(number, len(block), zlib.crc32(data)) + data)
            self._file.flush()
        except OSError as error:
            raise DataError(f"{self.path}: cannot be written ({error.strerror}). The finished rows are kept.") from None
        self.places[number] = (place + _HEAD.size, len(block))

    def get(self, number: int) -> np.ndarray:
        """A finished block."""
        place, rows = self.places[number]
        self._file.seek(place)
        data = self._file.read(8 * rows * self.width)
        return np.frombuffer(data, dtype="<f8").reshape(rows, self.width)

    def remove(self) -> None:
        """Delete the file, which is not needed any more."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, _: TracebackType | None) -> None:
        self._file.close()


@dataclass(frozen=True)
class Column:
    """A column of the table: its name and SI unit; without a unit it holds whole numbers, or the words of such ones."""

    name: str
    unit: str | None = None
    words: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """The name with the unit shown to a person."""
        return self.name if self.unit is None else f"{self.name} [{show_unit(self.unit)}]"

    def values(self, numbers: np.ndarray) -> np.ndarray:
        """Numbers in SI as the table shows them."""
        return numbers if self.unit is None else from_si(numbers, self.unit)

    def cells(self, numbers: np.ndarray) -> list[Any]:
        """Cells of the table for numbers in SI."""
        return [self.words[int(n)] for n in numbers] if self.words else list(self.values(numbers).tolist())


#: The name of each status, by its number.
WORDS = tuple({int(s): s.name.lower() for s in Status}.get(k, "") for k in range(max(map(int, Status)) + 1))


def refuse_other(out: Path, columns: Sequence[Column]) -> None:
    """Refuse to replace a CSV file that is no table of this kind: it may be a duty, or written by hand.

    Args:
        out: where the table goes
        columns: of the table

    Raises:
        DataError: another file is there
    """
    if out.suffix == ".csv" and out.is_file():
        with out.open(encoding="utf-8", errors="replace") as file:
            header = file.readline().rstrip("\n")
        if header and header != _header(columns):
            raise DataError(
                f"{out}: is there, with other columns than this sweep. Move it away, or choose another place with -o."
            )


def _header(columns: Sequence[Column]) -> str:
    return ",".join(cell_text(c.title) for c in columns)


def write_table(out: Path, columns: Sequence[Column], blocks: Iterator[Sequence[np.ndarray]]) -> None:
    """Write the table block by block beside its place, and move it there.

    Args:
        out: the file; its ending says what it is
        columns: the columns
        blocks: for each block an array per column, SI

    Raises:
        DataError: it cannot be written
    """
    try:
        with replacing(out) as path:
            (_write_parquet if out.suffix == ".parquet" else _write_csv)(path, columns, blocks)
    except OSError as error:
        raise DataError(f"{out}: cannot be written ({error.strerror}). The finished rows are kept.") from None


def _write_csv(path: Path, columns: Sequence[Column], blocks: Iterator[Sequence[np.ndarray]]) -> None:
    formats = ["%s" if c.words else "%d" if c.unit is None else "%.9g" for c in columns]
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(_header(columns) + "\n")
        line = ",".join(formats) + "\n"
        for block in blocks:
            cells = [c.cells(numbers) for c, numbers in zip(columns, block, strict=True)]
            file.write("".join([line % row for row in zip(*cells, strict=True)]).replace("nan", ""))


def _write_parquet(path: Path, columns: Sequence[Column], blocks: Iterator[Sequence[np.ndarray]]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    kinds: Mapping[bool, Any] = {True: pa.int64(), False: pa.float64()}
    fields = [pa.field(c.title, pa.string() if c.words else kinds[c.unit is None]) for c in columns]
    schema = pa.schema(fields)
    with parquet.ParquetWriter(path, schema) as writer:
        for block in blocks:
            cells = [pa.array(c.cells(n), f.type) for c, n, f in zip(columns, block, fields, strict=True)]
            writer.write_table(pa.Table.from_arrays(cells, schema=schema))


@dataclass(frozen=True)
class Job:
    """All that the rows of a sweep share.

    Attributes:
        varied: paths of what is varied, in the order of the columns of the values
        outputs: paths of the states and outputs that are kept
        start: path of a state -> its value at the beginning, or the varied path whose value it takes
        schedule: the duty of a warm-up; None for steady states
        times: output times of a warm-up [s]
    """

    batch: Batch
    varied: tuple[str, ...]
    outputs: tuple[str, ...]
    start: Mapping[str, float | str]
    schedule: Schedule | None = None
    times: tuple[float, ...] = ()

    def key(self, values: np.ndarray, size: int) -> str:
        """Hash of all that the rows with these values, in blocks of some size, depend on."""
        batch, schedule = self.batch, self.schedule
        groups = (batch.states, batch.inputs, batch.parameters, batch.outputs)
        text = repr(
            [SCHEMA, size, [[q.name for q in g] for g in groups], self.varied, self.outputs, self.start, self.times]
        )
        code = batch.steady_source if schedule is None else batch.warmup_source
        digest = hashlib.sha256(f"{text}\0{code}\0{batch.relations_source}\0".encode())
        for array in (*batch.vectors({}), values):
            digest.update(f"{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
        if schedule is not None:
            digest.update(schedule.time.tobytes())
            for name, column in schedule.values.items():
                digest.update(name.encode() + np.asarray(column, dtype=float).tobytes())
        return digest.hexdigest()

    def rows(self, values: np.ndarray, threads: int = 0) -> np.ndarray:
        """Kept outputs and what tells of each row: (rows times output times, outputs and TELLING).

        Args:
            values: what is varied (rows, varied), SI
            threads: threads to use, 0 for one per core
        """
        columns = dict(zip(self.varied, np.ascontiguousarray(values.T), strict=True))
        given: dict[str, Any] = {name: columns[v] if isinstance(v, str) else v for name, v in self.start.items()}
        arrays = self.batch.vectors({**given, **columns})
        if self.schedule is None:
            rows = self.batch.steady(*arrays, threads=threads)
        else:
            rows = self.batch.warmup(self.schedule, *arrays, times=self.times, threads=threads)
        telling = np.column_stack([rows.status, rows.iterations, rows.residual, rows.outside])
        if self.schedule is not None:
            telling = np.repeat(telling, len(self.times), axis=0)
        return np.column_stack([*(rows[name].ravel() for name in self.outputs), telling])


def local(job: Job, blocks: Iterable[Block], threads: int) -> Iterator[Block]:
    """The finished blocks, solved on this machine."""
    for number, values in blocks:
        yield number, job.rows(values, threads)
