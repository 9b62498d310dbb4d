"""One measured test played through the FMU and kept on disk: what a worker process does.

Imports neither CasADi nor the rig files: a worker is an FMU player and nothing else.
"""

from __future__ import annotations

import hashlib
import json
import signal
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing.util import Finalize
from pathlib import Path

import numpy as np

from ...fmu.play import Player
from ..show.columns import series
from ..show.console import as_json, write

SCHEMA = "gearheat.test/1"


@dataclass(frozen=True)
class Job:
    """One test: what drives the FMU, when it is read, and where the result goes.

    Attributes:
        inputs: path -> (times [s], values), SI
        start: start values of parameters and states, SI
        moments: times of the readings [s], at the end of each half
        record: path -> SI unit, the variables that are kept
        audit: variables with the energy that came in, the throughput, and the energy stored, since the start [J]
        folder: where the result is kept; None keeps nothing
    """

    test: int
    fmu: Path
    digest: str
    inputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    start: Mapping[str, float]
    moments: Sequence[float]
    step: float
    record: Mapping[str, str]
    audit: tuple[str, str, str]
    folder: Path | None = None

    def key(self) -> str:
        """Hash of all that the result depends on."""
        parts = [SCHEMA, self.digest, repr(float(self.step)), repr([float(m) for m in self.moments])]
        parts += [f"{name} {value!r}" for name, value in sorted(self.start.items())]
        parts += [f"{name} {unit}" for name, unit in self.record.items()]
        for name, (time, values) in sorted(self.inputs.items()):
            parts.append(f"{name} {np.asarray(time, float).tolist()} {np.asarray(values, float).tolist()}")
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def place(self, suffix: str) -> Path:
        """File of this test's result."""
        return (self.folder or Path()) / f"test-{self.test:02d}.{suffix}"


def ready() -> None:
    """Prepare a worker: the parent alone answers Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def finished(job: Job) -> list[dict[str, float]] | None:
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
    time, columns = time_series(job)
    readings = [at(time, columns, moment) for moment in job.moments]
    before = at(time, columns, float(time[0]))
    for reading in readings:
        reading["energy_residual"] = imbalance(before, reading, job.audit)
        before = reading
    if job.folder is not None:
        write(job.place("csv"), series(time, columns, job.record))
        kept = {"schema": SCHEMA, "key": job.key(), "test": job.test, "moments_s": list(job.moments)}
        write(job.place("json"), as_json({**kept, "units": job.record, "readings": readings}))
    return readings


def time_series(job: Job) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The recorded variables of a test over time [s], SI; a time given twice is a jump."""
    stop = max(float(time[-1]) for time, _ in job.inputs.values())
    played = _player(job.fmu, job.digest).run(job.inputs, stop, job.step, start=job.start, record=list(job.record))
    return played.time, {name: played.values[:, k] for k, name in enumerate(played.names)}


def at(time: np.ndarray, columns: Mapping[str, np.ndarray], moment: float) -> dict[str, float]:
    """All columns at a moment, before the jump if there is one."""
    row = int(np.argmin(np.abs(time - moment)))
    return {name: float(column[row]) for name, column in columns.items()}


def imbalance(before: Mapping[str, float], after: Mapping[str, float], audit: tuple[str, str, str]) -> float:
    """Energy that came in between two moments and was not stored, relative to the throughput."""
    supplied, throughput, stored = (after[name] - before[name] for name in audit)
    return abs(supplied - stored) / throughput if throughput else 0.0


@lru_cache(maxsize=2)
def _player(fmu: Path, digest: str) -> Player:
    """The FMU, loaded once per process for all tests; `digest` tells files of the same name apart."""
    player = Player(fmu)
    Finalize(None, player.close, exitpriority=1)  # worker processes run these at their end, and not `atexit`
    return player
