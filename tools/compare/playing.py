"""One measured test played through the FMU and kept on disk: what a worker process does.

Imports neither CasADi nor the rig files: a worker is an FMU player and nothing else.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing.util import Finalize
from pathlib import Path

import numpy as np

from ...fmu.play import Player
from ...fmu.variables import STORED, SUPPLIED, THROUGHPUT
from ...model.run.schedule import Schedule
from ..show.columns import table_text, titled
from ..show.console import as_json, write

SCHEMA = "gearheat.test/1"
#: Variables of every FMU with the energy that came in, the throughput, and the energy stored, since the start [J].
AUDIT = (SUPPLIED, THROUGHPUT, STORED)


@dataclass(frozen=True)
class Run:
    """One test of a campaign, or the operating point of a rig without one: what drives the model, what was read.

    Attributes:
        start: start values of parameters and states, SI
        moments: times of the readings [s], at the end of each half
        rows: rows of the campaign that were read then
    """

    test: int
    oil: str
    schedule: Schedule
    start: Mapping[str, float]
    moments: tuple[float, ...]
    rows: tuple[int, ...]

    @property
    def inputs(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """What drives the model: name -> (times [s], values in SI)."""
        return {name: (self.schedule.time, values) for name, values in self.schedule.values.items()}


@dataclass(frozen=True)
class Job:
    """A run of the FMU and where its result goes.

    Attributes:
        step: communication step [s]
        record: path -> SI unit, the variables that are kept
        folder: where the result is kept
    """

    run: Run
    fmu: Path
    digest: str
    step: float
    record: Mapping[str, str]
    folder: Path

    def key(self) -> str:
        """Hash of all that the result depends on."""
        parts = [SCHEMA, self.digest, repr(float(self.step)), repr([float(m) for m in self.run.moments])]
        parts += [f"{name} {value!r}" for name, value in sorted(self.run.start.items())]
        parts += [f"{name} {unit}" for name, unit in self.record.items()]
        for name, (time, values) in sorted(self.run.inputs.items()):
            parts.append(f"{name} {np.asarray(time, float).tolist()} {np.asarray(values, float).tolist()}")
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def place(self, suffix: str) -> Path:
        """File of this test's result."""
        return self.folder / f"test-{self.run.test:02d}.{suffix}"


def reread(job: Job) -> list[dict[str, float]] | None:
    """The readings of a test that was played before with the same inputs and FMU; None if it has to be played."""
    try:
        kept = json.loads(job.place("json").read_text(encoding="utf-8"))
        same = kept["key"] == job.key() and job.place("csv").is_file()
        return list(kept["readings"]) if same else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def play(job: Job) -> list[dict[str, float]]:
    """Play a test and keep it: the time series as CSV first, then the readings with their key as JSON.

    Returns:
        one mapping per reading: path -> value, SI, and "energy_residual": what the time since the reading before (or
        the start) leaves of the energy balance, relative to the throughput
    """
    run, record = job.run, list(job.record)
    played = _player(job.fmu, job.digest).run(run.inputs, run.schedule.stop, job.step, start=run.start, record=record)
    columns = {name: played.values[:, k] for k, name in enumerate(played.names)}

    def at(moment: float) -> dict[str, float]:
        """All columns at a moment, before the jump if there is one."""
        row = int(np.argmin(np.abs(played.time - moment)))
        return {name: float(column[row]) for name, column in columns.items()}

    before, readings = at(float(played.time[0])), [at(moment) for moment in run.moments]
    for reading in readings:
        supplied, throughput, stored = (reading[name] - before[name] for name in AUDIT)
        reading["energy_residual"] = abs(supplied - stored) / throughput if throughput else 0.0
        before = reading
    write(job.place("csv"), table_text({"time [s]": played.time, **titled(columns, job.record)}))
    kept = {"schema": SCHEMA, "key": job.key(), "test": run.test, "moments_s": list(run.moments)}
    write(job.place("json"), as_json({**kept, "units": job.record, "readings": readings}))
    return readings


@lru_cache(maxsize=2)
def _player(fmu: Path, digest: str) -> Player:
    """The FMU, loaded once per process for all tests; `digest` tells files of the same name apart."""
    player = Player(fmu)
    Finalize(None, player.close, exitpriority=1)  # worker processes run these at their end, and not `atexit`
    return player
