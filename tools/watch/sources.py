"""Where samples come from: growing files, folders of them, and standard input."""

from __future__ import annotations

import csv
import sys
import time
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import IO, Any, Protocol

from ...model.errors import DataError
from ...scenarios.csv_cells import two_readings
from ...scenarios.csv_table import plain, written
from ...scenarios.measured.logs import BLOCK, read_columns, read_head

#: Between two looks at files that may have grown [s].
POLL = 1.0
#: Endings of files of samples; those of the second kind are read anew as a whole when they have changed.
GROWING = (".csv",)
WHOLE = (".csv.gz", ".parquet", ".pq")
#: Column that names the machine of a row.
MACHINE = "machine"
#: What a stream gives last.
END = "end"
#: Encodings whose letters have two bytes, and their ends of lines, by the mark that they begin with.
WIDE = {BOM_UTF16_LE: ("utf-16-le", b"\n\0"), BOM_UTF16_BE: ("utf-16-be", b"\0\n")}


@dataclass(frozen=True)
class Row:
    """A sample as it came.

    Args:
        machine: name
        cells: column -> what is in it
        where: file and line, for people
        source, place: how far the source has been read with this row, None where it keeps that itself
        problem: what is wrong with it, which has no cells then
    """

    machine: str
    cells: Mapping[str, Any]
    where: str
    source: str = ""
    place: Any = None
    problem: str = ""


class Source(Protocol):
    """Samples in the order in which they come."""

    def rows(self) -> Iterator[Row | None]:
        """Samples; None where there is none at the moment. It ends where no more can come."""

    def kept(self) -> None:
        """All rows that were given are in safety."""


@dataclass
class Files:
    """A file that grows, or a folder whose files and sub-folders are a machine each.

    Args:
        root: of them
        place: where a file, by its path below the root, has been read to
        once: whether the end of the files is the end
    """

    root: Path
    place: Callable[[str], Any]
    once: bool = False
    _seen: dict[Path, tuple[int, int]] = field(default_factory=dict)

    def rows(self) -> Iterator[Row | None]:
        """Rows that have been added, file by file in the order of their names."""
        while True:
            for machine, path in self._files():
                whole = path.name.endswith(WHOLE)
                yield from self._changed(machine, path) if whole else self._added(machine, path)
            if self.once:
                return
            yield None
            time.sleep(POLL)

    def kept(self) -> None:
        """The store has the places."""

    def _files(self) -> list[tuple[str, Path]]:
        if self.root.is_file():
            return [(stem(self.root.name), self.root)]
        found = [path for path in self.root.rglob("*") if path.name.endswith(GROWING + WHOLE)]
        return [(stem(path.relative_to(self.root).parts[0]), path) for path in sorted(found)]

    def _name(self, path: Path) -> str:
        """Of a file, by which its place is kept."""
        return path.relative_to(self.root).as_posix() if path != self.root else path.name

    def _added(self, machine: str, path: Path) -> Iterator[Row]:
        """Whole lines after the last one that was read."""
        name = self._name(path)
        place = self.place(name)
        if place and path.stat().st_size < place[0]:  # made anew: what is known counts once
            place = None
        with path.open("rb") as file:
            yield from samples(file, machine, path.name, self.once, name, place)

    def _changed(self, machine: str, path: Path) -> Iterator[Row]:
        """Rows after the last one that was read, of a file that has been written anew."""
        state = path.stat()
        if self._seen.get(path) == (state.st_mtime_ns, state.st_size):
            return
        self._seen[path] = state.st_mtime_ns, state.st_size
        name, odd = self._name(path), list[str]()
        try:
            columns, lines = read_columns(path, lambda header: header, odd)
        except DataError as error:
            yield Row(machine, {}, path.name, problem=str(error))
            return
        yield from (Row(machine, {}, path.name, problem=problem) for problem in odd)
        begun = self.place(name) or 0
        for k in range(begun if begun <= len(lines) else 0, len(lines)):
            cells = [column[k] for column in columns.values()]
            yield _row(machine, list(columns), cells, f"{path.name} line {lines[k]}", name, k + 1)


class Stream:
    """Rows of a CSV stream, its header first.

    Args:
        file: the stream
        machine: whose rows they are
    """

    def __init__(self, file: IO[bytes] | None = None, machine: str = "stdin") -> None:
        self.file, self.machine = file or sys.stdin.buffer, machine

    def rows(self) -> Iterator[Row | None]:
        """Rows as they come."""
        queue: Queue[Row | str] = Queue(10_000)
        Thread(target=self._read, args=[queue], daemon=True).start()
        for row in queued(queue):
            if row == END:
                return
            yield row

    def kept(self) -> None:
        """A stream comes once."""

    def _read(self, queue: Queue[Row | str]) -> None:
        try:
            for row in samples(self.file, self.machine, "stdin"):
                queue.put(row)
        finally:
            queue.put(END)


@dataclass
class _Lines:
    """Whole lines as rows of cells, and how far they have been read.

    Args:
        file: at its begin
        ended: whether no more can come, so that the last line is whole without an end
    """

    file: IO[bytes]
    ended: bool
    offset: int = 0
    line_num: int = 0

    def __iter__(self) -> Iterator[list[str]]:
        return self

    def __next__(self) -> list[str]:
        raw = more = self.file.readline()
        if not self.line_num:
            self._wide, self._end = WIDE.get(raw[:2], ("", b"\n"))
            self.sign = written(raw)[1]
        while more and self._wide and (len(raw) % 2 or not raw.endswith(self._end)):  # within a letter
            raw += (more := self.file.read(1) if len(raw) % 2 else self.file.readline())
        if not raw or not (self.ended or raw.endswith(self._end)):
            raise StopIteration
        self.offset, self.line_num = self.offset + len(raw), self.line_num + 1
        text = raw.decode(self._wide or written(raw)[0], errors="replace").removeprefix("\ufeff")
        return next(csv.reader([text], delimiter=self.sign), [])

    def skip(self, offset: int, line: int) -> None:
        """Go to the place behind a line."""
        if offset > self.offset:
            self.offset, self.line_num = self.file.seek(offset), line


def samples(
    file: IO[bytes], machine: str, name: str, ended: bool = True, source: str = "", place: Any = None
) -> Iterator[Row]:
    """Samples of a table, line by line; those whose decimals have two readings wait for one that decides.

    Args:
        file: the table, at its begin
        machine: whose samples they are, where no column says it
        name: of the file, for people
        ended: whether no more can come, so that the last line is whole without an end
        source: by which its place is kept
        place: how far it has been read
    """
    lines, held = _Lines(file, ended), list[tuple[int, list[str], int]]()
    try:
        header, rows = read_head(name, lines)
    except DataError as error:
        yield Row(machine, {}, name, problem=str(error))
        return
    offset, last, *signs = place or (0, 0)
    lines.skip(offset, last)
    sure, problem = set(signs), None
    for line, cells in rows:
        if line <= last:
            continue
        held.append((line, cells, lines.offset))
        problem = lines.sign != "," and two_readings(name, [one[:2] for one in held], sure)
        if problem and not sure and len(held) < BLOCK:
            continue
        for number, found, end in held:
            known = [end, number, *sorted(sure)]
            row = _row(machine, header, plain(found, lines.sign), f"{name} line {number}", source, known)
            yield replace(row, cells={}, problem=problem) if problem else row
        held.clear()
    if held and ended:
        yield Row(machine, {}, name, problem=str(problem))


def queued(queue: Queue[Any]) -> Iterator[Any]:
    """What another thread puts into a queue; None where there is nothing for a while."""
    while True:
        try:
            yield queue.get(timeout=POLL)
        except Empty:
            yield None


def stem(name: str) -> str:
    """Name of the machine whose file or folder has a name."""
    return next((name.removesuffix(end) for end in (*WHOLE, *GROWING) if name.endswith(end)), name)


def _row(machine: str, header: list[str], cells: list[Any], where: str, source: str, place: Any) -> Row:
    if len(cells) != len(header):
        said = f"{where}: has {len(cells)} cells, the header has {len(header)}; the row is left out"
        return Row(machine, {}, where, source, place, said)
    named = dict(zip((h.strip() for h in header), cells, strict=True))
    return Row(str(named.pop(MACHINE, "")) or machine, named, where, source, place)
