"""How many rows of a batch are solved in a second: figures for the bench, all of one run."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from ...fmu import batch_library
from ...fmu.batch import Batch
from ...model.core.flat import FlatModel
from ...model.run.schedule import Schedule, join_phases
from ...model.run.simulate import simulate
from ...scenarios.load import load
from ..solve.settings import adjust, flat_of
from ..solve.sweep import sweep
from .costs import STAGE, STAGES
from .harness import timed

#: What varies from row to row: the load by this much of its value.
LOAD = (0.2, 1.08)
#: The room by this much [K].
ROOM = (-15.0, 10.0)

#: Tolerance of the run that errors are measured against.
REFERENCE = 1e-11
#: How often the rows are looked at for that [s].
EVERY = 600.0


def measure(
    rig: str = "planetary",
    *,
    rows: int = 50_000,
    warmups: int = 500,
    swept: int = 100_000,
    threads: Sequence[int] = (1, 2),
    repeats: int = 3,
) -> dict[str, Any]:
    """Throughput of steady states, of warm-ups of 330 min, and of a whole sweep into a file.

    Args:
        rig: a rig with a torque among its inputs, and a room
        rows, warmups: rows of one measurement
        swept: rows of the sweep; 0 leaves it out
        threads: numbers of threads
        repeats: measurements, of which the fastest counts

    Returns:
        per kind `rows_per_s` on each number of threads and `rows_per_core_s`, by the time of the processor, which
        other work on the machine does not lengthen; for the warm-ups `error_K`, the largest deviation of a temperature
        from a run of the same model with a tolerance of 1e-11
    """
    scenario = adjust(load(rig))
    flat = flat_of(scenario)
    batch = Batch(flat)
    load_name = next(q.name for q in flat.inputs if q.name.endswith(".tau"))
    room = f"{scenario.spec.of_type('Room')[0]}.T"
    random = np.random.default_rng(0)
    values = {
        load_name: flat.quantity(load_name).start * random.uniform(*LOAD, rows),
        room: flat.quantity(room).start + random.uniform(*ROOM, rows),
    }
    arrays = batch.vectors(values)
    few = tuple(a[:warmups] if a.ndim == 2 else a for a in arrays)
    duty = _duty(flat)
    with patch.object(batch_library, "LITTLE", 0):  # the optimised code, as for many rows
        steady = _time(lambda n: batch.steady(*arrays, threads=n), rows, threads, repeats)
        warmup = _time(lambda n: batch.warmup(duty, *few, threads=n), warmups, threads, repeats)
    warmup["error_K"] = _error(batch, flat, duty)
    found = {"rig": scenario.name, "steady": steady, "warmup_330_min": warmup}
    return found if not swept else {**found, "sweep": _sweep(rig, load_name, room, values, swept)}


def _duty(flat: FlatModel) -> Schedule:
    speeds = [q for q in flat.inputs if q.name.endswith(".w")]
    return join_phases((STAGE, {q.name: part * q.start for q in speeds}) for part in STAGES)


def _time(run: Callable[[int], Any], rows: int, threads: Sequence[int], repeats: int) -> dict[str, Any]:
    """Rows in a second, by the clock and by the processor."""
    steps = float(run(1).iterations.mean())  # and the code is compiled
    speeds: dict[str, float] = {}
    best = 0.0
    for n in threads:
        for _ in range(repeats):
            clock, processor = time.perf_counter(), time.process_time()
            run(n)
            clock, processor = time.perf_counter() - clock, time.process_time() - processor
            speeds[str(n)] = max(speeds.get(str(n), 0.0), rows / clock)
            best = max(best, rows / processor)
    return {"rows": rows, "rows_per_s": speeds, "rows_per_core_s": best, "iterations": steps}


def _error(batch: Batch, flat: FlatModel, duty: Schedule) -> float:
    """Largest deviation of a temperature at the model's own inputs [K]."""
    times = np.arange(0.0, duty.stop + 1.0, EVERY)
    ours = batch.warmup(duty, times=times)
    exact = simulate(flat, duty, times=times, tolerance=REFERENCE)
    return max(float(np.abs(ours[q.name][0] - exact[q.name]).max()) for q in flat.states if q.unit == "K")


def _sweep(rig: str, load_name: str, room: str, values: dict[str, np.ndarray], rows: int) -> dict[str, Any]:
    """The command `sweep` from the rig file to the table."""
    units = {load_name: "N.m", room: "K"}
    ends = {name: (float(values[name].min()), float(values[name].max())) for name in units}
    vary = [f"{name}={ends[name][0]!r}..{ends[name][1]!r} {unit}" for name, unit in units.items()]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "rows.csv"
        seconds, _ = timed(lambda: sweep(rig, vary, out=out, sample=rows), time.perf_counter)
        return {"rows": rows, "seconds": seconds, "rows_per_s": rows / seconds, "MB": out.stat().st_size / 1e6}
