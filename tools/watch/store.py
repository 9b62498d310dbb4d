"""What a watch has received and said: one SQLite file, written in transactions; an end at any moment is safe."""

from __future__ import annotations

import itertools
import json
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...model.errors import DataError

#: Samples of one machine nearer than this share of the step are one sample.
NEAR = 0.5
#: Samples of a column that tell the step.
FIRST = 10
#: Layout of the file.
VERSION = 1
TABLES = """
create table about (key text primary key, value text);
create table machines (machine text primary key, kind text, step real, answered real, count integer, alarm);
create table rows (machine text, time real, cells text, primary key (machine, time)) without rowid;
create table places (source text primary key, place text);
create table events (number integer primary key, kind text, machine text, text text);
create table told (machine text, answered real, text text, primary key (machine, answered, text)) without rowid;
"""

#: Column -> what is in it; without those that are empty.
Cells = dict[str, float | str]


@dataclass
class Machine:
    """Where a machine stands.

    Args:
        name: of it
        kind: of its times, see `parse_time`
        step: from sample to sample [s], 0 while it is not known
        answered: time of the last sample of the last window that was answered [s]
        count: samples after it
        alarm: since when there is an alarm, None without
    """

    name: str
    kind: str
    step: float = 0.0
    answered: float = float("-inf")
    count: int = 0
    alarm: str | float | None = None


class Store:
    """Samples, places in sources and events.

    Args:
        path: file; nothing is kept without
        about: what must be alike for a state to be gone on with, such as the rig

    Raises:
        DataError: the file is no state, or that of another watch
    """

    def __init__(self, path: Path | None, about: str) -> None:
        self.base = _opened(path, about)
        self.machines = {row[0]: Machine(*row) for row in self.base.execute("select * from machines order by machine")}

    def commit(self) -> None:
        """Make all that was written last."""
        for m in self.machines.values():
            values = (m.name, m.kind, m.step, m.answered, m.count, m.alarm)
            self.base.execute("insert or replace into machines values (?, ?, ?, ?, ?, ?)", values)
        self.base.commit()

    def place(self, source: str) -> Any:
        """Where a source has been read to; None if it has not been read."""
        found = self.base.execute("select place from places where source = ?", [source]).fetchone()
        return json.loads(found[0]) if found else None

    def move(self, source: str, place: Any) -> None:
        """Note where a source has been read to."""
        self.base.execute("insert or replace into places values (?, ?)", [source, json.dumps(place)])

    def add(self, m: Machine, time: float, cells: Cells) -> list[str]:
        """Add a sample, or what it has more than one that is there.

        Args:
            m: its machine
            time: of it [s]
            cells: of the sample

        Returns:
            columns that are there with another value; that one stays
        """
        near = NEAR * m.step
        query = "select time, cells from rows where machine = ? and time between ? and ? order by abs(time - ?) limit 1"
        there = self.base.execute(query, [m.name, time - near, time + near, time]).fetchone()
        if there is None:
            self.base.execute("insert into rows values (?, ?, ?)", [m.name, time, json.dumps(cells)])
            m.count += time > m.answered
            if not m.step and m.count >= FIRST and (step := self._step(m)):
                m.step, m.count, known = step, 0, zip(*self.rows(m, float("inf")), strict=True)
                self.base.execute("delete from rows where machine = ?", [m.name])
                for early in known:  # cells that came one by one make samples now
                    self.add(m, *early)
            return []
        old: Cells = json.loads(there[1])
        if cells.keys() - old:
            values = [json.dumps(cells | old), m.name, there[0]]
            self.base.execute("update rows set cells = ? where machine = ? and time = ?", values)
        return [column for column in cells if old.get(column, cells[column]) != cells[column]]

    def _step(self, m: Machine) -> float:
        """Time between samples of the column that came most often, 0 while it is not known."""
        times: dict[str, list[float]] = {}
        for time, cells in zip(*self.rows(m, float("inf")), strict=True):
            for column in cells:
                times.setdefault(column, []).append(time)
        most = max(times.values(), key=len)
        return sorted(b - a for a, b in itertools.pairwise(most))[(len(most) - 1) // 2] if len(most) >= FIRST else 0.0

    def until(self, m: Machine, samples: int) -> float:
        """Time of the last of so many samples after those that were answered, or of the last one there is [s]."""
        query = "select max(time) from (select time from rows where machine = ? and time > ? order by time limit ?)"
        return float(self.base.execute(query, [m.name, m.answered, samples]).fetchone()[0])

    def rows(self, m: Machine, until: float) -> tuple[list[float], list[Cells]]:
        """Times [s] and cells of the samples of a machine up to a time, in order."""
        query = "select time, cells from rows where machine = ? and time <= ? order by time"
        found = self.base.execute(query, [m.name, until]).fetchall()
        return [t for t, _ in found], [json.loads(cells) for _, cells in found]

    def answered(self, m: Machine, until: float, keep: float) -> None:
        """Note that all up to a time is answered, and drop samples that are older by more than `keep` [s]."""
        m.answered = until
        query = "select count(*) from rows where machine = ? and time > ?"
        m.count = self.base.execute(query, [m.name, until]).fetchone()[0]
        self.base.execute("delete from rows where machine = ? and time < ?", [m.name, until - keep])
        self.base.execute("delete from told where machine = ? and answered < ?", [m.name, until])

    def first(self, m: Machine, text: str) -> bool:
        """Whether a warning is the first of its kind in the window under way, which notes it."""
        return self.base.execute("insert or ignore into told values (?, ?, ?)", [m.name, m.answered, text]).rowcount > 0

    def say(self, event: dict[str, Any]) -> None:
        """Append an event with its `event` and `machine`; it gets the next number."""
        (last,) = self.base.execute("select coalesce(max(number), 0) from events").fetchone()
        text = json.dumps({"number": last + 1, **event}, ensure_ascii=False, allow_nan=False)
        self.base.execute("insert into events values (?, ?, ?, ?)", [last + 1, event["event"], event["machine"], text])

    def events(self, after: int) -> Iterator[tuple[int, str]]:
        """Numbers and JSON lines of the events after a number."""
        yield from self.base.execute("select number, text from events where number > ? order by number", [after])

    def last(self, machine: str, kind: str, n: int) -> list[dict[str, Any]]:
        """The last n events of a kind in order, of one machine or, if that is empty, of all."""
        query = "select text from events where kind = ? and ? in (machine, '') order by number desc limit ?"
        return [json.loads(text) for (text,) in self.base.execute(query, [kind, machine, n])][::-1]


def _opened(path: Path | None, about: str) -> sqlite3.Connection:
    """The file, made where it is not there."""
    try:
        base = sqlite3.connect(":memory:" if path is None else path)
        if not base.execute("select count(*) from sqlite_master").fetchone()[0]:
            base.execute("pragma journal_mode = wal")
            base.executescript(TABLES)
            base.execute(f"pragma user_version = {VERSION}")
            base.execute("insert into about values ('watch', ?)", [about])
            base.commit()
        base.execute("pragma synchronous = normal")
        (known,) = base.execute("select value from about where key = 'watch'").fetchone()
    except sqlite3.Error as error:
        raise DataError(f"--state {path}: is no state of a watch ({error}). Give another file.") from None
    if known != about:
        raise DataError(f"--state {path}: is that of another rig, card or options. Give another file.")
    return base
