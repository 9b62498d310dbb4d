"""Sheets "logs" and "lone_logs": units of `gearheat new` in operation, logged; something changes from a moment on.

Machines, faults and what is uncertain are those of the sheet "machines", without courses of the factors. Samples are
moments or means, of 10 s to 10 min; speed and load go in steps or wander, with stops between. On the sheet "logs" a log
of the same machine when healthy is there too, and the fault may be there from the first sample on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gearheat.fmu.batch import Rows, Status
from gearheat.model.run.schedule import Schedule, join_phases

from .machines import HOT, LEAST, SMALL, Change, Machine, write_table

#: Step of a log [s] -> its shortest and longest duration [h].
LENGTHS: Mapping[float, tuple[float, float]] = {10.0: (6.0, 10.0), 60.0: (24.0, 48.0), 600.0: (96.0, 240.0)}
#: Phases of a log, fewest and most, and the share of them in which the machine stands.
PHASES = (12, 40)
STOPS = 0.2
#: Speed and load of a stop, of those of the name plate.
STOPPED = 0.02
#: Machines that are run together.
TOGETHER = 8
#: Samples of which a mean is made.
PARTS = 4
#: What is hidden moves a channel by so many repeatabilities or more, root mean square of the samples that have it.
MOVES = 3.0
#: Rows to which the readings are averaged where distances are measured, of each log.
ROWS = 60
#: The hall over a day, and from day to day [K].
DAILY, EACH_DAY = 3.0, 2.0
DAY = 86400.0


@dataclass(frozen=True)
class Log:
    """A log before it is run: what is given until something changes and from there on, and its step [s]."""

    stretches: tuple[Schedule, ...]
    changed: tuple[bool, ...]
    step: float
    parts: int

    @property
    def samples(self) -> list[int]:
        """Of each stretch."""
        return [round(s.stop / self.step) for s in self.stretches]


class Logged(Machine):
    """A true machine in operation."""

    def __init__(self, referenced: bool, path: Path, rng: np.random.Generator) -> None:
        self.referenced = referenced
        super().__init__(path, rng)

    def lay_out(self, rng: np.random.Generator) -> None:
        """Draw what is run: a log, and one of the same step before it."""
        step = float(rng.choice(list(LENGTHS)))
        parts = int(rng.choice([1, PARTS]))
        wander, first = rng.random() < 0.3, self.referenced and rng.random() < 0.5
        duration = 3600.0 * rng.uniform(*LENGTHS[step])
        ends = [duration] if first else [duration * rng.uniform(0.4, 0.6), duration * rng.uniform(0.4, 0.6)]
        self.room = rng.uniform(8.0, 24.0)
        stretches = tuple(self._stretch(rng, end, step, wander) for end in ends)
        self.logs = [Log(stretches, (True,) if first else (False, True), step, parts)]
        if self.referenced:
            self.logs.insert(0, Log((self._stretch(rng, duration, step, wander),), (False,), step, parts))
        self.asked = slice(-sum(self.logs[-1].samples), None)
        changed = [np.full(n, c) for log in self.logs for n, c in zip(log.samples, log.changed, strict=True)]
        #: Samples of all logs from which on something may be wrong.
        self.ill = np.concatenate(changed)

    def _stretch(self, rng: np.random.Generator, duration: float, step: float, wander: bool) -> Schedule:
        """Speed, load and hall over a time of whole steps."""
        shares = rng.uniform(0.4, 1.6, int(rng.integers(*PHASES)))
        durations = shares * duration / shares.sum()
        durations[-1] += -duration % step
        phases, now, last = [], 0.0, (0.7, 0.6)
        n, load_ = self.nominal.value("input.w"), self.nominal.value("output.load")
        level = self.room + EACH_DAY * rng.standard_normal()
        for d in durations:
            ends = float(rng.uniform(0.35, 1.0)), float(rng.uniform(0.2, 1.0))
            if rng.random() < STOPS:
                ends = STOPPED, STOPPED
            (n0, n1), (l0, l1) = zip(last if wander else ends, ends, strict=True)
            begin, end = (level + DAILY * np.sin(2 * np.pi * t / DAY) + 273.15 for t in (now, now + d))
            given = {"input.w": (n0 * n, n1 * n), "output.load": (l0 * load_, l1 * load_), "room.T": (begin, end)}
            phases.append((d, given))
            now, last = now + d, ends
        return join_phases(phases)

    def _loss(self) -> float:
        """Mean of the samples [W]."""
        state = self._run([({}, {})])[0]
        powers = [state[f"{end}.w"] * state[f"{end}.tau"] for end in ("input", "output")]
        return float(max(np.mean(np.abs(powers[0]) - np.abs(powers[1])), 1.0))

    def _run(self, changes: Sequence[tuple[Change, Change]]) -> list[dict[str, np.ndarray]]:
        """Everything (samples of all logs,), with values from the start on and from the change on, of some machines."""
        if len(changes) > TOGETHER:
            return self._run(changes[:TOGETHER]) + self._run(changes[TOGETHER:])
        true = {n: float(np.exp(level)) for n, (level, _) in self.unequal.items()}
        own = [{n: true[n] * always.get(n, self.healthy[n]) for n in true} for always, _ in changes]
        later = [{n: true.get(n, 1.0) * v for n, v in changed.items()} for _, changed in changes]
        found: list[dict[str, list[np.ndarray]]] = [{} for _ in changes]
        for log in self.logs:
            x = None
            for schedule, ill in zip(log.stretches, log.changed, strict=True):
                times = np.arange(0.0, schedule.stop - 1e-6 * log.step, log.step / log.parts)
                given = {n: np.interp(times + 1e-6, schedule.time, v) for n, v in schedule.values.items()}
                here = [o | c if ill else o for o, c in zip(own, later, strict=True)]
                rows = self._through(schedule, here, x, [*times, schedule.stop])
                x = rows.x[:, -1]
                for k, columns in enumerate(found):
                    states = {n: rows[n][k, :-1] for n in rows.columns}
                    for name, column in {**states, **given}.items():
                        columns.setdefault(name, []).append(column.reshape(-1, log.parts).mean(axis=1))
        return [{name: np.concatenate(parts) for name, parts in columns.items()} for columns in found]

    def _through(self, schedule: Schedule, values: Sequence[Change], x: Any, times: Sequence[float]) -> Rows:
        """Machines of different values through a stretch, from states or as warm as the hall."""
        names = sorted({name for one in values for name in one})
        varied = {n: np.array([one.get(n, self.healthy[n]) for one in values]) for n in names}
        u, p, start = self.batch.vectors(varied | dict.fromkeys(self.nominal.flat.bodies, schedule.values["room.T"][0]))
        rows = self.batch.warmup(schedule, u, p, start if x is None else x, times=times)
        if (rows.status != Status.OK).any() or not (rows["oil.T"] < HOT + 273.15).all():
            raise ArithmeticError("no course, or too hot")
        return rows

    def read(
        self, changed: Change, errors: Change, points: Sequence[tuple[float, float, float]] | None = None
    ) -> np.ndarray:
        """Readings without noise (samples of all logs, sensors)."""
        return self._shown(self._run([({}, changed)])[0], errors)

    def _shown(self, state: Mapping[str, np.ndarray], errors: Change) -> np.ndarray:
        return np.where(self.ill[:, None], self.wrong(state, errors), self.wrong(state, {}))

    def effects(self, changes: Sequence[tuple[Change, Change]]) -> list[np.ndarray]:
        """What values and errors do to all readings."""
        states = self._run([({}, changed) for changed, _ in changes])
        return [self._moved(state, errors) for state, (_, errors) in zip(states, changes, strict=True)]

    def deviations(self) -> list[np.ndarray]:
        """What a standard deviation of each reason does to all readings, to first order."""
        states = self._run([(change, {}) for change in self.slightly()])
        return [self._moved(state, {}) / SMALL for state in states]

    def _moved(self, state: Mapping[str, np.ndarray], errors: Change) -> np.ndarray:
        return self.in_repeatabilities(self._shown(state, errors) - self.sound)

    def unsteady(self) -> list[np.ndarray]:
        """Nothing besides: factors are constant, and the hall is logged."""
        return []

    def in_repeatabilities(self, change: np.ndarray) -> np.ndarray:
        """A change of all readings (samples, sensors) as a vector, of means of many samples."""
        relative = change / [s.repeat_sd for s in self.sensors]
        many = -(-len(relative) // (ROWS * len(self.logs)))
        sums = np.add.reduceat(relative, np.arange(0, len(relative), many), axis=0)
        return np.asarray((sums / np.sqrt(many)).ravel())

    def hides(self, change: np.ndarray) -> float | None:
        """How far a change of all readings is from nothing [sigma]; None if it is too little to hide."""
        relative = change[self.ill] / [s.repeat_sd for s in self.sensors]
        size = self.size(change)
        return size if size >= LEAST and np.sqrt(np.mean(relative**2, axis=0)).max() >= MOVES else None

    def write(self, case: Path, table: np.ndarray) -> None:
        """Readings into the files of a case."""
        names, first = ["REFLOG.csv", "LOG.csv"][-len(self.logs) :], 0
        for name, log in zip(names, self.logs, strict=True):
            n = sum(log.samples)
            times = [["time_s"], *([f"{log.step * k:g}"] for k in range(n))]
            write_table(case / name, self.sensors, table[first : first + n], times)
            first += n
