"""A measured campaign played through the FMU: one job per test, over the cores, kept on disk as it goes."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from ..fmu.effective import effective
from ..fmu.variables import STORED, SUPPLIED, THROUGHPUT
from ..model.core.flat import FlatModel
from ..model.errors import ScenarioError
from ..model.run.point import point
from ..model.run.result import Outside
from ..model.run.rows import evaluate, outside
from ..model.run.schedule import Schedule, stepped
from ..scenarios.measured import Campaign, Reading, schedule_of
from ..scenarios.scenario import Scenario
from . import playing, readings
from .console import note
from .losses import oil_values
from .playing import Job

#: How long a rig without measured data is run at its operating point [s].
HOLD = 8 * 3600.0

#: Variables of every FMU for the energy balance.
AUDIT = (SUPPLIED, THROUGHPUT, STORED)


@dataclass(frozen=True)
class Run:
    """One test of a campaign, or the operating point of a rig without one: what drives the model, what was read."""

    test: int
    oil: str
    schedule: Schedule
    start: Mapping[str, float]
    moments: tuple[float, ...]
    readings: tuple[Reading, ...]

    @property
    def inputs(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """What drives the model: name -> (times [s], values in SI)."""
        return {name: (self.schedule.time, values) for name, values in self.schedule.values.items()}


def runs_of(scenario: Scenario, flat: FlatModel, tests: str | None = None) -> tuple[Run, ...]:
    """What is to be played.

    Args:
        scenario: the rig
        flat: its model
        tests: numbers of the tests, such as "1,13,22-26"; all if left out

    Raises:
        ScenarioError: tests that the campaign does not have
    """
    if (campaign := scenario.campaign) is None:
        return (_held(scenario, flat),)
    wanted = _wanted(tests, campaign)
    played = effective(flat)  # the FMU lacks what has no effect
    return tuple(_run_of(scenario, played, campaign, test) for test in campaign.tests() if test.number in wanted)


def _run_of(scenario: Scenario, flat: FlatModel, campaign: Campaign, test: Any) -> Run:
    run = schedule_of(campaign, test)
    assert campaign.protocol is not None  # schedule_of has refused it
    oil = oil_values(scenario, campaign.protocol, test.oil)
    start = run.start(flat) | {name: value for name, value in oil.items() if name in flat.index}
    return Run(test.number, test.oil, run.schedule, start, run.moments, test.halves)


def _held(scenario: Scenario, flat: FlatModel) -> Run:
    """The operating point held from a start at room temperature."""
    from .transients import first_temperatures

    inputs = {q.name: q.start for q in flat.inputs if q.name in scenario.operating_point}
    oil = next((entry for kinds in scenario.entries.values() for kind, entry in kinds.items() if kind == "oil"), "")
    return Run(1, oil, stepped([(HOLD, inputs)]), first_temperatures(scenario, flat, None), (HOLD,), ())


def _wanted(tests: str | None, campaign: Campaign) -> set[int]:
    """Numbers in a text such as "1,13,22-26"."""
    known = {test.number for test in campaign.tests()}
    if tests is None:
        return known
    wanted: set[int] = set()
    for part in tests.split(","):
        if (match := re.fullmatch(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", part)) is None:
            raise ScenarioError(f'--tests {tests}: "{part}" is no number and no range. Write for example 1,13,22-26.')
        wanted |= set(range(int(match[1]), int(match[2] or match[1]) + 1))
    if missing := sorted(wanted - known):
        raise ScenarioError(
            f"--tests {tests}: {campaign.name} has no test {', '.join(str(m) for m in missing)}; "
            f"it has {min(known)} to {max(known)}."
        )
    return wanted


def recorded(scenario: Scenario, flat: FlatModel) -> dict[str, str]:
    """What is kept of a played test, path -> SI unit: states, what drives it, what is compared, losses, the audit."""
    names = [q.name for q in flat.states]
    names += [q.name for q in flat.inputs if q.name in scenario.operating_point or q.name in _inputs(scenario)]
    names += readings.sources(scenario).values()
    names += [path for paths in scenario.losses.values() for path in paths]
    return {name: flat.quantity(name).unit for name in dict.fromkeys(names)} | dict.fromkeys(AUDIT, "J")


def _inputs(scenario: Scenario) -> tuple[str, ...]:
    protocol = scenario.campaign.protocol if scenario.campaign else None
    return (*protocol.inputs, protocol.room) if protocol else ()


def jobs(
    found: Iterable[Run], fmu: Path, digest: str, step: float, record: Mapping[str, str], folder: Path | None
) -> tuple[Job, ...]:
    """The jobs of the worker processes."""
    return tuple(
        Job(
            test=run.test,
            fmu=fmu,
            digest=digest,
            inputs=run.inputs,
            start=run.start,
            moments=run.moments,
            step=step,
            record=record,
            audit=AUDIT,
            folder=folder,
        )
        for run in found
    )


@contextmanager
def crew(workers: int) -> Iterator[ProcessPoolExecutor | None]:
    """Worker processes, started at once so that they load while the parent prepares; None for a single one.

    Args:
        workers: how many; 0 for one per core
    """
    count = (
        workers or len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else workers or os.cpu_count() or 1
    )
    if count == 1:
        yield None
        return
    pool = ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=playing.ready)
    try:
        for _ in range(count):
            pool.submit(int)
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def play_all(todo: Sequence[Job], pool: ProcessPoolExecutor | None) -> dict[int, list[dict[str, float]]]:
    """The readings of every test; tests that were finished before with the same inputs are not played again."""
    done = {job.test: kept for job in todo if job.folder is not None and (kept := playing.finished(job)) is not None}
    if done:
        note(f"{len(done)} of {len(todo)} tests were finished before")
    left = [job for job in todo if job.test not in done]
    for k, (job, found) in enumerate(_played(left, pool), start=len(done) + 1):
        done[job.test] = found
        note(f"played test {job.test} ({k} of {len(todo)})")
    return {job.test: done[job.test] for job in todo}


def _played(left: Sequence[Job], pool: ProcessPoolExecutor | None) -> Iterator[tuple[Job, list[dict[str, float]]]]:
    if pool is None:
        for job in left:
            yield job, playing.play(job)
        return
    futures: dict[Future[list[dict[str, float]]], Job] = {pool.submit(playing.play, job): job for job in left}
    for future in as_completed(futures):
        yield futures[future], future.result()


def rows(
    scenario: Scenario, found: Sequence[Run], played: Mapping[int, list[dict[str, float]]]
) -> list[dict[str, Any]]:
    """One row per reading, in the order of the measured table, simulated and measured."""
    made = []
    for run in found:
        for k, (moment, values) in enumerate(zip(run.moments, played[run.test], strict=True)):
            result = readings.simulated(scenario, values)
            result |= {"time_s": moment, "energy_residual": values["energy_residual"]}
            if run.readings:
                made.append(readings.row(run.readings[k], result))
            else:
                made.append({"point": k + 1, "test": run.test, "direction": 1, "oil": run.oil, **result})
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
