"""Logs that are watched while they grow: the diagnosis of all that has come, asked again with every window."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import DataError, GearheatError
from ...scenarios.csv_table import in_si, split_unit
from ...scenarios.given import scenario_of
from ...scenarios.measured.card import Card
from ...scenarios.measured.logs import SINCE_1970, parse_number
from ...scenarios.measured.table import Sensor
from ...scenarios.measured.times import BARE, NUMBERS, TwoDaysError, join_days, parse_time, time_column
from ...scenarios.write import rig_text
from ..diagnose.request import Request
from .sources import Row, Source
from .store import Cells, Machine, Store

#: Samples of a window, as the diagnosis has them.
WINDOW = 250
#: Samples are kept so long: a year in question, and a month [s].
KEPT = 396 * 86400.0
#: A source that is silent so long is told [s].
SILENCE = 3600.0
#: A time that is so far ahead of the clock is none [s].
AHEAD = 86400.0


#: What a judge is asked: machine, kind of its times, times [s] and samples.
Asked = tuple[str, str, Sequence[float], Sequence[Cells]]
#: What the samples say, or why they say nothing.
Answer = dict[str, Any] | str
Judge = Callable[..., dict[str, Any]]


def answer(judge: Judge, asked: Asked) -> Answer:
    """What a judge says, or why it says nothing."""
    try:
        return judge(*asked)
    except GearheatError as error:
        return str(error)


def one_by_one(judge: Judge, asked: Iterable[tuple[int, Asked]]) -> Iterator[tuple[int, Answer]]:
    """Answers with the numbers of what was asked, as they are there."""
    return ((number, answer(judge, one)) for number, one in asked)


class Watch:
    """Samples go in, events come out.

    Args:
        sensors: of rig and card
        card: its columns of time and of segments, and the unit of the former
        store: what has come and was said
        judge: what the samples of a machine say
        every: samples of a window
        clock: time now [s]
        spread: asks the judge about several machines
    """

    def __init__(
        self,
        sensors: Iterable[Sensor],
        card: Card,
        store: Store,
        judge: Judge,
        every: int,
        clock: Callable[[], float],
        spread: Callable[[Judge, Iterable[tuple[int, Asked]]], Iterator[tuple[int, Answer]]] = one_by_one,
    ) -> None:
        self.store, self.judge, self.every, self.clock, self.spread = store, judge, every, clock, spread
        self._known = {name for s in sensors for name in (s.column, split_unit(s.column)[0])}
        self._card, self._segment = card, card.columns.get("segment", "segment")

    def follow(self, source: Source) -> Iterator[None]:
        """Take what comes; yields after everything that was written.

        Args:
            source: of the samples
        """
        yield from self._answer(self.every + 1)
        heard = self.clock()
        for row in source.rows():
            if row is not None:
                self._take(row)
                heard = self.clock()
            elif self.clock() >= heard + SILENCE:
                heard = self.clock()
                now = datetime.fromtimestamp(heard, UTC)
                said = f"no sample has come for {SILENCE / 60:.0f} min, at {now:%Y-%m-%dT%H:%MZ}"
                self._warn(Machine("source", ""), said)
            if row is None or any(m.count > self.every for m in self.store.machines.values()):
                self.store.commit()
                source.kept()
                yield from self._answer(self.every + 1)
                yield
        self.store.commit()
        source.kept()
        yield from self._answer(self.every)  # no sample can come that belongs to a window before
        yield

    def waiting(self) -> Iterator[dict[str, Any]]:
        """What no window has yet, by machine: events without a number, as nothing has happened."""
        for m in (m for m in self.store.machines.values() if m.count):
            text = (
                f"the last {m.count} samples are fewer than a window has, {self.every}, and not diagnosed."
                " --state keeps them for the next run; --every sets the window"
            )
            yield {"event": "waiting", "machine": m.name, "samples": m.count, "every": self.every, "text": text}

    def _take(self, row: Row) -> None:
        """Add a row to what there is."""
        m = self.store.machines.get(row.machine)
        if row.source:
            self.store.move(row.source, row.place)
        try:
            if row.problem:
                raise DataError(row.problem)
            time, kind = self._time(row)
            if m is None:
                m = self.store.machines[row.machine] = Machine(row.machine, kind)
            if kind != m.kind:
                raise DataError(f"{row.where}: has {kind}, earlier samples {m.kind}; the row is left out")
        except GearheatError as error:
            self._warn(m or Machine(row.machine, ""), str(error))
            return
        cells: Cells = {}
        for column, cell in row.cells.items():
            if column == self._segment:
                cells[column] = str(cell)
            elif column in self._known or split_unit(column)[0] in self._known:
                try:
                    number = parse_number(cell)
                except (TypeError, ValueError):
                    self._warn(m, f'{row.where}: {column} is "{cell}", expected a number; it counts as missing')
                else:
                    cells |= {} if math.isnan(number) else {column: number}
        if not cells:
            self._warn(m, f"{row.where}: holds no column of a sensor; the row is left out")
        elif other := self.store.add(m, time, cells):
            self._warn(m, f"{row.where}: {', '.join(other)} at a time that is there with another value, which is kept")

    def _time(self, row: Row) -> tuple[float, str]:
        """Time [s] and kind of time of a row."""
        name = row.where.partition(" line ")[0]
        column = time_column(row.cells, self._card.columns.get("time", ""), name)
        cell = join_days({head: [cell] for head, cell in row.cells.items()}, column)[0]
        try:
            time, kind = parse_time(cell)
        except (TypeError, ValueError, OverflowError) as error:
            more = f". {error}" if isinstance(error, TwoDaysError) else ""
            raise DataError(f'{row.where}: its time is "{cell}"{more}; the row is left out') from None
        if kind == NUMBERS:
            unit = self._card.units.get(column, split_unit(column)[1])
            kind = NUMBERS if unit or time >= SINCE_1970 else BARE
            if kind == BARE and row.machine not in self.store.machines:
                said = f"{row.where}: {column} has no unit and is taken for seconds. The card may name another: [units]"
                self._warn(Machine(row.machine, ""), said)
            return float(in_si(np.array([time]), unit or "s", "s", name=f"{name} {column}")[0]), kind
        if time > self.clock() + AHEAD:
            raise DataError(f"{row.where}: its time, {stamp(time, kind)}, has not come yet; the row is left out")
        return time, kind

    def _answer(self, least: int) -> Iterator[None]:
        """Answer windows while there are so many samples, one of each machine after the other."""
        while full := [m for m in self.store.machines.values() if m.count >= least]:
            ends = [self.store.until(m, self.every) for m in full]
            asked = ((k, (m.name, m.kind, *self.store.rows(m, ends[k]))) for k, m in enumerate(full))
            for k, answer in self.spread(self.judge, asked):
                self._window(full[k], ends[k], answer)
                self.store.commit()
                yield

    def _window(self, m: Machine, until: float, answer: Answer) -> None:
        """Say what one window says."""
        when = {"machine": m.name, "from": stamp(self.store.until(m, 1), m.kind), "to": stamp(until, m.kind)}
        if isinstance(answer, str):
            self._warn(m, answer, **when)
        else:
            alarm = answer["verdict"] != "consistent"
            if alarm != (m.alarm is not None):
                m.alarm = when["to"] if alarm else None
                said = {"causes": answer["causes"], "verdict": answer["verdict"]} if alarm else {}
                self.store.say({"event": "alarm" if alarm else "cleared", **when, **said})
            self.store.say({"event": "window", **when, **answer, "alarm": m.alarm})
        self.store.answered(m, until, KEPT)

    def _warn(self, m: Machine, text: str, **more: Any) -> None:
        if self.store.first(m, text):
            self.store.say({"event": "warning", "machine": m.name, **more, "text": text})


def stamp(time: float, kind: str) -> str | float:
    """A time as events have it."""
    return time if kind in (NUMBERS, BARE) else f"{datetime.fromtimestamp(time, UTC):%Y-%m-%dT%H:%M:%SZ}"


def identity(request: Request) -> str:
    """What must not change while a state is gone on with: rig and files of a request, by what they hold."""
    digest = hashlib.sha256()
    if isinstance(rig := request.rig, str | Path):
        name, own = str(rig), [Path(rig)]
    else:
        name, own = scenario_of(rig).name, []
        digest.update(rig_text(scenario_of(rig)).encode())
    for path in (*own, *(path for _, path in request.files())):
        if path.is_file():
            digest.update(path.read_bytes())
    return f"{name} {digest.hexdigest()[:16]}"
