"""A measured campaign played through the FMU: one job per test, over the cores, kept on disk as it goes."""

from __future__ import annotations

import re
import signal
import tempfile
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context
from typing import Any

import numpy as np

from ...fmu.apart import begin_worker
from ...fmu.batch_library import cores
from ...fmu.equations import effective
from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError, SolveError
from ...model.run.point import point
from ...model.run.result import Outside, outside
from ...model.run.rows import evaluate
from ...model.run.schedule import join_phases
from ...scenarios.measured import readings
from ...scenarios.measured.study import Measured
from ...scenarios.scenario import Scenario
from ..show.console import note
from . import playing
from .playing import AUDIT, Job

Run = playing.Run

#: How long a rig without measured data is run at its operating point [s].
HOLD = 8 * 3600.0

#: Temperature where no room is measured [K].
START = 293.15

#: How long a steady state is held that a test begins with [s].
SETTLED = 3600.0
#: How long a steady state is held that a test comes to from another [s].
SETTLING = 72 * 3600.0


def runs_of(scenario: Scenario, flat: FlatModel, study: Measured | None, tests: str | None = None) -> tuple[Run, ...]:
    """What is to be played.

    Args:
        scenario: the rig
        flat: its model
        study: its measured readings, None for its operating point
        tests: numbers of the tests, such as "1,13,22-26"; all if left out

    Raises:
        ScenarioError: tests that the campaign does not have
    """
    if study is None:
        return (_hold(scenario, flat),)
    wanted = _parse_tests(tests, study)
    played = effective(flat)  # the FMU lacks what has no effect
    indices = range(study.campaign.n_tests)
    return tuple(_run_of(study, played, test) for test in indices if study.campaign.numbers[test] in wanted)


def _run_of(study: Measured, flat: FlatModel, test: int) -> Run:
    """The duty of one test: each row held for its dwell, a stop without load between rows, rooms as read."""
    c, oil = study.campaign, study.oil(test)
    rows = [int(row) for row in np.flatnonzero(c.test == test)]
    shafts, rooms = study.scenario.shaft_paths(), _rooms_at_start(study, test)
    T = c.T_start[test] if np.isfinite(c.T_start[test]) else next(iter(rooms.values()), START) + c.start_by_room
    start = dict.fromkeys(flat.bodies, float(T))
    if c.steady:  # from the state that is read
        state = study.nominal.at({**oil, **study.given(rows[0])}) or {}
        start = {name: state.get(name, value) for name, value in start.items()}
    phases: list[tuple[float, dict[str, float | tuple[float, float]]]] = []
    moments, now = [], 0.0
    for row in rows:
        dwell, given = float(c.dwell[row]), study.given(row)
        if c.steady:
            dwell = min(dwell, SETTLING if phases else SETTLED)
        if (stop := float(c.stop[row])) > 0 and phases:
            after = {p: T + (given[p] - T) * stop / (stop + dwell) for p, T in rooms.items()}
            still = {p: 0.0 for p in given if p in shafts} | {p: v for p, v in given.items() if p not in shafts}
            phases.append((stop, still | {p: (T, after[p]) for p, T in rooms.items()}))
            now, rooms = now + stop, after
        phases.append((dwell, given | {p: (given[p] if c.steady else T, given[p]) for p, T in rooms.items()}))
        now, rooms = now + dwell, {p: given[p] for p in rooms}
        moments.append(now)
    read = [k for k, row in enumerate(rows) if row in study.read_rows]
    kept = start | {name: value for name, value in oil.items() if name in flat.index}
    return Run(
        study.campaign.numbers[test],
        c.oil[test],
        join_phases(phases),
        kept,
        tuple(moments[k] for k in read),
        tuple(rows[k] for k in read),
    )


def _rooms_at_start(study: Measured, test: int) -> dict[str, float]:
    """Room inputs -> temperature at the start of a test [K]."""
    c = study.campaign
    first = int(np.flatnonzero(c.test == test)[0])
    stated = c.room_start[test]
    own = {s.reads: float(c.values[s.name][first]) for s in study.rooms}
    return {path: float(stated) if np.isfinite(stated) else T + c.room_begin for path, T in own.items()}


def _hold(scenario: Scenario, flat: FlatModel) -> Run:
    """The operating point held from a start at room temperature."""
    from ..solve.simulate import first_temperatures

    inputs = {q.name: q.start for q in flat.inputs if q.name in scenario.operating_point}
    oil = next((entry for kinds in scenario.entries.values() for kind, entry in kinds.items() if kind == "oil"), "")
    return Run(1, oil, join_phases([(HOLD, inputs)]), first_temperatures(scenario, flat, None), (HOLD,), ())


def _parse_tests(tests: str | None, study: Measured) -> set[int]:
    """Numbers in a text such as "1,13,22-26"."""
    known = set(study.campaign.numbers)
    if tests is None:
        return known
    wanted: set[int] = set()
    for part in tests.split(","):
        if (match := re.fullmatch(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", part)) is None:
            raise ScenarioError(f'--tests {tests}: "{part}" is no number and no range. Write for example 1,13,22-26.')
        wanted |= set(range(int(match[1]), int(match[2] or match[1]) + 1))
    if missing := sorted(wanted - known):
        raise ScenarioError(
            f"--tests {tests}: {study.campaign.name} has no test {', '.join(str(m) for m in missing)}; "
            f"it has {min(known)} to {max(known)}."
        )
    return wanted


def list_kept(scenario: Scenario, flat: FlatModel, study: Measured | None) -> dict[str, str]:
    """What is kept of a played test, path -> SI unit: states, what drives it, what is compared, losses, the audit."""
    given = {s.reads for s in study.campaign.given} if study else set()
    names = [q.name for q in flat.states]
    names += [q.name for q in flat.inputs if q.name in scenario.operating_point or q.name in given]
    names += readings.sources(scenario, study.warm if study else ()).values()
    names += [path for paths in scenario.losses.values() for path in paths]
    return {name: flat.quantity(name).unit for name in dict.fromkeys(names)} | dict.fromkeys(AUDIT, "J")


@contextmanager
def _deaf() -> Iterator[None]:
    """Without Ctrl-C for a moment: processes that start in it inherit that, and the parent alone answers."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, heard)


@contextmanager
def crew(workers: int) -> Iterator[ProcessPoolExecutor | None]:
    """Worker processes, started at once so that they load while the parent prepares; None for a single one.

    Args:
        workers: how many; 0 for one per core
    """
    count = workers or cores()
    if count == 1:
        yield None
        return
    pool = ProcessPoolExecutor(
        count, mp_context=get_context("spawn"), initializer=begin_worker, initargs=(tempfile.tempdir,)
    )
    try:
        with _deaf():
            for _ in range(count):
                pool.submit(int)
        yield pool
    except BrokenProcessPool:
        raise SolveError(
            "a process of its own for each core could not be started. In a script, put what runs under"
            ' if __name__ == "__main__":, or run one test at a time with jobs=1.'
        ) from None
    except KeyboardInterrupt:
        for worker in active_children():  # what they have finished is kept
            worker.kill()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def play_all(todo: Sequence[Job], pool: ProcessPoolExecutor | None) -> dict[int, list[dict[str, float]]]:
    """The readings of every test; tests that were finished before with the same inputs are not played again."""
    done = {job.run.test: kept for job in todo if (kept := playing.reread(job)) is not None}
    if done:
        note(f"{len(done)} of {len(todo)} tests were finished before")
    left = [job for job in todo if job.run.test not in done]
    for k, (job, found) in enumerate(_play_jobs(left, pool), start=len(done) + 1):
        done[job.run.test] = found
        note(f"played test {job.run.test} ({k} of {len(todo)})")
    return {job.run.test: done[job.run.test] for job in todo}


def _play_jobs(left: Sequence[Job], pool: ProcessPoolExecutor | None) -> Iterator[tuple[Job, list[dict[str, float]]]]:
    if pool is None:
        for job in left:
            yield job, playing.play(job)
        return
    futures: dict[Future[list[dict[str, float]]], Job] = {pool.submit(playing.play, job): job for job in left}
    for future in as_completed(futures):
        yield futures[future], future.result()


def rows(
    scenario: Scenario, study: Measured | None, found: Sequence[Run], played: Mapping[int, list[dict[str, float]]]
) -> list[dict[str, Any]]:
    """One row per reading, in the order of its number, simulated and measured."""
    made = []
    paths = readings.sources(scenario, study.warm if study else ())
    read = readings.measured_rows(study) if study else []
    for run in found:
        for k, (moment, values) in enumerate(zip(run.moments, played[run.test], strict=True)):
            result = readings.convert_results(scenario, paths, values)
            result |= {"time_s": moment, "energy_residual": values["energy_residual"]}
            if study is None:
                made.append({"point": k + 1, "test": run.test, "direction": 1, "oil": run.oil, **result})
            else:
                made.append({**readings.about(study, run.rows[k]), **result, **read[run.rows[k]]})
    return sorted(made, key=lambda row: row["point"])


def outside_of(
    flat: FlatModel, found: Sequence[Run], played: Mapping[int, list[dict[str, float]]]
) -> tuple[Outside, ...]:
    """The laws that were used outside their range at any of the readings."""
    states = {q.name for q in flat.states}
    given = {q.name for q in flat.inputs}
    points = []
    for run in found:
        settings = {name: value for name, value in run.start.items() if name not in states}
        for values in played[run.test]:
            inputs = {name: value for name, value in values.items() if name in given}
            points.append(
                point(flat, settings | inputs, {n: v for n, v in values.items() if n in states}, who="readings")
            )
    x, u, p = (np.array([getattr(here, kind) for here in points]).T for kind in "xup")
    return outside(flat, evaluate(flat, x, u, p))
