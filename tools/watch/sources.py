"""Where samples come from: growing files, folders of them, and standard input."""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import IO, Any, Protocol

from ...model.errors import DataError
from ...scenarios.csv_table import plain, written
from ...scenarios.measured.logs import read_columns

#: Between two looks at files that may have grown [s].
POLL = 1.0
#: Endings of files of samples; those of the second kind are read anew as a whole when they have changed.
GROWING = (".csv",)
WHOLE = (".csv.gz", ".parquet", ".pq")
#: Column that names the machine of a row.
MACHINE = "machine"


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
            return [(_stem(self.root.name), self.root)]
        found = [path for path in self.root.rglob("*") if path.name.endswith(GROWING + WHOLE)]
        return [(_stem(path.relative_to(self.root).parts[0]), path) for path in sorted(found)]

    def _name(self, path: Path) -> str:
        """Of a file, by which its place is kept."""
        return path.relative_to(self.root).as_posix() if path != self.root else path.name

    def _added(self, machine: str, path: Path) -> Iterator[Row]:
        """Whole lines after the last one that was read."""
        name = self._name(path)
        offset, number = self.place(name) or (0, 1)
        with path.open("rb") as file:
            head = file.readline()
            if not head.endswith(b"\n"):
                return
            if offset < len(head) or path.stat().st_size < offset:  # made anew: what is known counts once
                offset, number = len(head), 1
            how = written(head)
            header = _cells_of(head, *how)
            file.seek(offset)
            for raw in file:
                if not (raw.endswith(b"\n") or self.once):
                    return
                offset, number = offset + len(raw), number + 1
                if raw.strip():
                    cells = _cells_of(raw, *how)
                    yield _row(machine, header, cells, f"{path.name} line {number}", name, [offset, number])

    def _changed(self, machine: str, path: Path) -> Iterator[Row]:
        """Rows after the last one that was read, of a file that has been written anew."""
        state = path.stat()
        if self._seen.get(path) == (state.st_mtime_ns, state.st_size):
            return
        self._seen[path] = state.st_mtime_ns, state.st_size
        name = self._name(path)
        try:
            columns, lines = read_columns(path, lambda header: header)
        except DataError as error:
            yield Row(machine, {}, path.name, problem=str(error))
            return
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
        queue: Queue[bytes] = Queue(10_000)
        Thread(target=self._read, args=[queue], daemon=True).start()
        header, how = list[str](), written(b"")
        number = 0
        for raw in queued(queue):
            if raw == b"":
                return
            number += raw is not None
            if raw is None or not raw.strip():
                yield None
            elif not header:
                how = written(raw)
                header = _cells_of(raw, *how)
            else:
                yield _row(self.machine, header, _cells_of(raw, *how), f"line {number}", "", None)

    def kept(self) -> None:
        """A stream comes once."""

    def _read(self, queue: Queue[bytes]) -> None:
        for raw in self.file:
            queue.put(raw)
        queue.put(b"")


def queued(queue: Queue[Any]) -> Iterator[Any]:
    """What another thread puts into a queue; None where there is nothing for a while."""
    while True:
        try:
            yield queue.get(timeout=POLL)
        except Empty:
            yield None


def _stem(name: str) -> str:
    return next((name.removesuffix(end) for end in (*WHOLE, *GROWING) if name.endswith(end)), name)


def _cells_of(raw: bytes, encoding: str, sign: str) -> list[str]:
    return plain(next(csv.reader([raw.decode(encoding, errors="replace")], delimiter=sign), []), sign)


def _row(machine: str, header: list[str], cells: list[Any], where: str, source: str, place: Any) -> Row:
    if len(cells) != len(header):
        said = f"{where}: has {len(cells)} cells, the header has {len(header)}; the row is left out"
        return Row(machine, {}, where, source, place, said)
    named = dict(zip((h.strip() for h in header), cells, strict=True))
    return Row(str(named.pop(MACHINE, "")) or machine, named, where, source, place)
