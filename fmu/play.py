"""Playing an FMU for co-simulation: inputs over time in, named columns out."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..model.errors import FmuError, suggestion
from .described import Described, describe, is_real, is_whole, settable
from .grid import Grid, Inputs, grid
from .slave import Slave, Slave2, Slave3
from .web_slave import WebSlave


@dataclass(frozen=True)
class Played:
    """A run of an FMU: `values[i, k]` is the variable `names[k]` at `time[i]`; a time given twice is a jump."""

    time: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        """The column of a variable. Raises FmuError with suggestions for one that was not recorded."""
        if name not in self.names:
            raise FmuError(f'"{name}" was not recorded.{suggestion(name, self.names)}')
        return self.values[:, self.names.index(name)]


def play(fmu: Path | str | Described, inputs: Inputs, stop: float, step: float, **options: Any) -> Played:
    """Load an FMU and run it once.

    Args:
        fmu: the file, or its description where that has been read
        inputs: name -> (times [s], values in SI)
        stop: end of the run [s]
        step: communication step [s]
        options: of `Player.run`: begin, start, record, output_times, tolerance

    Raises:
        FmuError: as `Player` and `Player.run`
    """
    with Player(fmu) as player:
        return player.run(inputs, stop, step, **options)


class Player:
    """An FMU loaded once for any number of runs, each as from a fresh instance. A context manager."""

    def __init__(self, fmu: Path | str | Described) -> None:
        """Load the FMU.

        Args:
            fmu: the file, or its description where that has been read

        Raises:
            FmuError: the file is no FMU for co-simulation of FMI 2.0 or 3.0, or holds no binary for this machine
        """
        self.described = fmu if isinstance(fmu, Described) else describe(Path(fmu))
        self._path = self.described.path
        self._description = self.described.description
        self._variables = self.described.variables
        self._folder = tempfile.mkdtemp(prefix="gearheat-")
        try:
            with zipfile.ZipFile(self._path) as file:
                file.extractall(self._folder)
            self._slave: Slave | None = self._instance()
            self._fresh = True
        except BaseException:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Free the instance and forget the extracted files."""
        if self._slave is not None:
            self._slave.free()
            self._slave = None
            shutil.rmtree(self._folder, ignore_errors=True)

    def run(
        self,
        inputs: Inputs,
        stop: float,
        step: float,
        *,
        begin: float = 0.0,
        start: Mapping[str, float] | None = None,
        record: Sequence[str] | None = None,
        output_times: Sequence[float] | np.ndarray | None = None,
        tolerance: float | None = None,
        alive: Callable[[], object] = int,
    ) -> Played:
        """Run from `begin` to `stop` [s] with communication points every `step` and on every point of the inputs.

        Args:
            inputs: name -> (times, values), linear between the points, a time given twice is a jump; beyond its points
                an input keeps its first or last value, and inputs not named keep their start value
            stop: end of the run [s]
            step: communication step [s]
            begin: start of the run [s]
            start: start values of inputs, parameters and states (SI); the numbers of items that are chosen
            record: variables to record; all outputs and inputs when not given
            output_times: times of the rows, not decreasing; a row at a jump shows the inputs behind it, a time given
                twice both sides. When not given: every communication step, and both sides of every jump
            tolerance: of the FMU's solver; its own when not given
            alive: called before each step

        Raises:
            FmuError: unknown names, times that make no sense, or a call the FMU refuses, with its own message
        """
        columns = self._list_recorded(record)
        self._check(inputs, dict(start or {}))
        points = grid(inputs, begin, stop, step, output_times)
        self._check_steps(points, step)
        slave = self._initialise(dict(start or {}), points, tolerance)
        values = self._walk(slave, points, [self._variables[name].valueReference for name in columns], alive)
        return Played(points.row_time, tuple(columns), values)

    def _instance(self) -> Slave:
        native = Slave2 if self._description.fmiVersion == "2.0" else Slave3
        kind = WebSlave if self.described.web else native
        return kind(self._path, self._description, self._folder)

    def _list_recorded(self, record: Sequence[str] | None) -> list[str]:
        known = self._variables
        if record is None:
            return [n for n, v in known.items() if v.causality in ("output", "input") and is_real(v)]
        problems = [f'unknown variable "{n}".{suggestion(n, known)}' for n in record if n not in known]
        others = [known[n] for n in record if n in known and not is_real(known[n])]
        problems += [f'"{v.name}" is of type {v.type}. Only scalar real variables are recorded.' for v in others]
        if problems:
            raise FmuError(f"{self._path.name}: {problem}" for problem in problems)
        return list(record)

    def _check(self, inputs: Inputs, start: Mapping[str, float]) -> None:
        """All names of inputs and start values at once."""
        real = {n: v for n, v in self._variables.items() if is_real(v)}
        known = {n for n, v in real.items() if v.causality == "input"}
        possible_start = {n for n, v in self._variables.items() if (n in real or is_whole(v)) and settable(v)}
        problems = []
        reasons = (("input", inputs, known, "is no input."), ("start value", start, possible_start, "is calculated."))
        for what, given, possible, reason in reasons:
            for name in sorted(set(given) - possible):
                why = reason if name in self._variables else f"is unknown.{suggestion(name, possible)}"
                if name in self._variables and name not in real:
                    why = f"is of type {self._variables[name].type}. It cannot be given."
                problems.append(f'{self._path.name}: {what} "{name}" {why}')
        if problems:
            raise FmuError(problems)

    def _check_steps(self, points: Grid, step: float) -> None:
        """Some FMUs take communication steps of one length only."""
        steps = np.diff(points.time)
        if self._description.coSimulation.canHandleVariableCommunicationStepSize or np.ptp(steps) <= 1e-6 * step:
            return
        odd = points.time[1:][np.abs(steps - step) > 1e-6 * step][0]
        raise FmuError(
            f"{self._path.name}: this FMU takes communication steps of one length only, and the one to {odd:g} s is "
            f"not {step:g} s long. Choose a step of which all times of the duty are multiples."
        )

    def _initialise(self, start: Mapping[str, float], points: Grid, tolerance: float | None) -> Slave:
        """The instance in step mode, at the first point."""
        slave = self._renew()
        self._begin_with(slave, start)
        slave.begin(tolerance, points.time[0], points.time[-1])
        self._set(slave, points.names, points.value[0])
        slave.initialized()
        return slave

    def _renew(self) -> Slave:
        """An instance as new: reset, or where an FMU cannot do that, another one."""
        slave = self._slave
        if slave is None:
            raise FmuError(f"{self._path.name}: the player is closed.")
        slave.said()
        if not self._fresh:
            try:
                slave.reset()
            except FmuError:
                slave.free()
                self._slave = slave = self._instance()
        self._fresh = False
        return slave

    def _set(self, slave: Slave, names: Sequence[str], values: np.ndarray) -> None:
        if names:
            references = np.array([self._variables[n].valueReference for n in names], dtype=np.uint32)
            slave.set(references.ctypes.data, len(names), values.ctypes.data)

    def _begin_with(self, slave: Slave, start: Mapping[str, float]) -> None:
        """Set start values of any type."""
        for kind in dict.fromkeys(self._variables[name].type for name in start):
            names = [name for name in start if self._variables[name].type == kind]
            references = np.array([self._variables[n].valueReference for n in names], dtype=np.uint32)
            slave.put(kind, references, [start[n] for n in names])

    def _walk(self, slave: Slave, points: Grid, recorded: list[int], alive: Callable[[], object]) -> np.ndarray:
        """Step from communication point to communication point, and read the rows."""
        do_step, get, set_values, set_slopes = slave.step, slave.get, slave.set, slave.slopes
        known = np.array([self._variables[n].valueReference for n in points.names], dtype=np.uint32)
        wanted, order = np.array(recorded, dtype=np.uint32), np.ones(len(known), dtype=np.int32)
        rows = np.empty((len(points.row_time), len(recorded)))
        inputs, outputs, n, m = known.ctypes.data, wanted.ctypes.data, len(known), len(recorded)
        value, slope, row = points.value.ctypes.data, points.slope.ctypes.data, rows.ctypes.data
        turns = np.append(True, (np.diff(points.slope, axis=0) != 0).any(axis=1)).tolist()
        time, steps = points.time.tolist(), np.diff(points.time).tolist()
        before, after = points.rows_before.tolist(), points.rows_after.tolist()
        last = len(steps)
        for k in range(last + 1):
            for _ in range(before[k]):
                get(outputs, m, row)
                row += 8 * m
            if k == last:
                break
            if n:
                set_values(inputs, n, value + 8 * n * k)
                if set_slopes is not None and turns[k]:
                    set_slopes(inputs, n, order.ctypes.data, slope + 8 * n * k)
            for _ in range(after[k]):
                get(outputs, m, row)
                row += 8 * m
            alive()
            do_step(time[k], steps[k])
        return rows
