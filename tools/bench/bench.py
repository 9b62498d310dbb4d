"""The command `bench`: time and memory of the main job, beside SciPy's LSODA on the same equations in the same run."""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.export import export
from ...fmu.play import Player
from ...model.core.flat import FlatModel
from ...model.run.simulate import simulate
from ...scenarios.load import load
from ...scenarios.measured.study import read_study
from ..compare import campaign
from ..show.console import answer, note, say, table
from ..solve.settings import flat_of
from . import contact, fmu as bench_fmu, pages, replays, scale, throughput, uncertainty as bench_uncertainty
from .costs import rhs_s
from .harness import PROGRAM, rows, timed

#: Tolerances at which LSODA runs; the cheapest one that is as accurate as the FMU is what the FMU is compared with.
TOLERANCES = (1e-6, 1e-8, 1e-9)

#: Tolerance of the run that errors are measured against.
REFERENCE = 1e-10

#: Communication step of the FMU [s].
STEP = 60.0

#: How often the memory of the whole job is looked at [s].
EVERY = 0.02


def command(rig: str, tests: str | None, json: str | None, what: str = "job", draws: int = 10_000) -> None:
    """Measure and print.

    Args:
        rig: name or path
        tests: of the main job
        json: file of the JSON object, "-" for stdout
        what: "job", the main job; "fmu", the FMU against its peers, and the batch; "batch" alone; "uncertainty", the
            FMU's standard deviations beside those of rows that are drawn; "contact", the contact solver; "scale", how
            time and memory grow; "watch", replays of measured years; "page",
            pages of rigs
        draws: rows that are drawn
    """
    measures: dict[str, tuple[Callable[[], dict[str, Any]], Callable[[dict[str, Any]], None]]] = {
        "job": (lambda: _job(rig, tests), _print),
        "fmu": (lambda: _fmu(rig), _print_fmu),
        "batch": (lambda: _batch(rig), _print_batch),
        "uncertainty": (lambda: bench_uncertainty.measure(rig, draws), _print_uncertainty),
        "contact": (contact.measure, _print_contact),
        "scale": (scale.measure, _print_scale),
        "watch": (replays.measure, _print_watch),
        "page": (pages.measure, _print_page),
    }
    load(rig)  # a rig that is none is told before other programs are started with it
    measure, show = measures[what]
    found = {"schema": "gearheat.bench/1", **measure()}
    answer(found, json, lambda: show(found))


def _job(rig: str, tests: str | None) -> dict[str, Any]:
    note("gearheat --help")
    helped = min(timed(lambda: _gearheat("--help"), time.perf_counter)[0] for _ in range(3))
    note(f"gearheat run {rig}, warm cache")
    job = _main_job(rig, tests)
    return {
        "machine": {"cores": os.cpu_count(), "python": platform.python_version(), "system": platform.system()},
        "help_s": helped,
        "help_imports_casadi": _imports("casadi"),
        "run_s": job[0],
        "run_peak_memory_MB": job[1],
        **_integration(rig, tests),
    }


def _fmu(rig: str) -> dict[str, Any]:
    note("the FMU, its peers and the batch; this installs PythonFMU in an environment of its own")
    return {**bench_fmu.measure(rig), "batch": throughput.measure(rig)}


def _batch(rig: str) -> dict[str, Any]:
    return {"rhs_s": rhs_s(flat_of(load(rig))), "batch": throughput.measure(rig, threads=(1,), swept=0)}


def _gearheat(*arguments: str) -> None:
    subprocess.run([*PROGRAM, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _imports(module: str) -> bool:
    """Whether the program as started for its help loads a module."""
    code = f"import sys, gearheat.tools.cli.app; sys.exit({module!r} in sys.modules)"
    return bool(subprocess.run([sys.executable, "-c", code], check=False).returncode)


def _main_job(rig: str, tests: str | None) -> tuple[float, float]:
    """Wall time [s] and peak memory [MB] of the whole main job, the compiler's cache warm."""
    chosen = [] if tests is None else ["--tests", tests]
    with tempfile.TemporaryDirectory() as folder:
        _gearheat("run", rig, "--out", f"{folder}/cold", *chosen)
        command = [*PROGRAM, "run", rig, "--out", f"{folder}/warm", *chosen]
        began = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        peak = _Peak(process.pid)
        process.wait()
        return time.perf_counter() - began, peak.stop()


class _Peak:
    """Largest memory of a process and its children together while it runs.

    Where the system does not tell, the largest single process so far, from the operating system's account.
    """

    def __init__(self, pid: int) -> None:
        self._pid, self._peak, self._running = pid, 0.0, True
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while self._running:
            self._peak = max(self._peak, sum(_resident(pid) for pid in _family(self._pid)))
            time.sleep(EVERY)

    def stop(self) -> float:
        """Peak in MB."""
        self._running = False
        self._thread.join()
        return self._peak or resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def _family(pid: int) -> list[int]:
    """A process and all its descendants."""
    found = [pid]
    for child in found:
        try:
            tasks = list(Path(f"/proc/{child}/task").iterdir())
            found += [int(c) for task in tasks for c in (task / "children").read_text().split()]
        except (OSError, ValueError):
            continue
    return found


def _resident(pid: int) -> float:
    """Resident memory of a process [MB]; pages shared by several are counted in each."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, IndexError, ValueError):
        return 0.0
    return pages * resource.getpagesize() / 1e6


def _integration(rig: str, tests: str | None) -> dict[str, Any]:
    """Processor time of the integration alone: all tests through the FMU, and through LSODA, in one process."""
    scenario = load(rig)
    study = read_study(scenario)
    scenario = study.scenario if study else scenario
    flat = flat_of(scenario)
    runs = campaign.runs_of(scenario, flat, study, tests)
    states = [q.name for q in flat.states]
    note(f"{len(runs)} tests: reference")
    exact = _simulate(flat, runs, "idas", REFERENCE)
    fmu_s: list[float] = []
    lsoda: list[dict[str, float]] = []
    with tempfile.TemporaryDirectory() as folder, Player(export(flat, Path(folder) / "rig.fmu")) as player:
        values = _play(player, runs, states)
        fmu_error = _differ(values, exact)
        for tolerance in TOLERANCES:  # both by turns, so that a busy moment of the machine meets both
            note(f"FMU, then LSODA with tolerance {tolerance:g}")
            fmu_s += [timed(lambda: _play(player, runs, states))[0] for _ in range(3)]
            took, values = timed(partial(_simulate, flat, runs, "lsoda", tolerance))
            lsoda.append({"tolerance": tolerance, "s": took, "error_K": _differ(values, exact)})
    equal = [run for run in lsoda if run["error_K"] <= fmu_error] or lsoda[-1:]
    best = min(equal, key=lambda run: run["s"])
    middle = float(np.median(fmu_s))
    return {
        "tests": len(runs),
        "fmu_s": middle,
        "fmu_error_K": fmu_error,
        "lsoda": lsoda,
        "lsoda_s": best["s"],
        "lsoda_error_K": best["error_K"],
        "ratio": best["s"] / middle,
    }


def _simulate(flat: FlatModel, runs: Sequence[campaign.Run], method: str, tolerance: float) -> np.ndarray:
    """States at all readings."""
    names = {q.name for q in flat.states}
    found = []
    for run in runs:
        result = simulate(
            flat,
            run.schedule,
            start={n: v for n, v in run.start.items() if n in names},
            values={n: v for n, v in run.start.items() if n not in names},
            times=[run.schedule.start, *_both_sides(run)],
            tolerance=tolerance,
            method=method,
        )
        rows = [int(np.flatnonzero(result.index == moment)[0]) for moment in run.moments]
        found.append([[result[name][row] for name in sorted(names)] for row in rows])
    return np.concatenate(found)


def _play(player: Player, runs: Sequence[campaign.Run], states: Sequence[str]) -> np.ndarray:
    """States at all readings."""
    found = []
    for run in runs:
        times, stop = _both_sides(run), run.schedule.stop
        played = player.run(run.inputs, stop, STEP, start=run.start, record=sorted(states), output_times=times)
        rows = [int(np.flatnonzero(played.time == moment)[0]) for moment in run.moments]
        found.append(played.values[rows])
    return np.concatenate(found)


def _both_sides(run: campaign.Run) -> list[float]:
    """Times of the readings; twice where a jump follows, so that the first row shows the state before it."""
    return [m for m in run.moments for _ in range(2 if m < run.schedule.stop else 1)]


def _differ(values: np.ndarray, exact: np.ndarray) -> float:
    return float(np.max(np.abs(values - exact)))


def _print(found: dict[str, Any]) -> None:
    table("Benchmark", ("what", "value"), rows("job", found))


def _print_fmu(found: dict[str, Any]) -> None:
    body = [*rows("fmu", found), *rows("batch", found)]
    table("The FMU and its peers, one run", ("what", "value"), body, wrapped=True)


def _print_batch(found: dict[str, Any]) -> None:
    table(f"{found['batch']['rig']}: many rows in one call", ("what", "value"), rows("batch", found), wrapped=True)


def _print_contact(found: dict[str, Any]) -> None:
    title = "The contact solver and slippy, processor times of one core"
    table(title, ("what", "value"), rows("contact", found))


def _print_scale(found: dict[str, Any]) -> None:
    table("What grows, each row a process of its own", scale.HEAD, scale.rows_of(found), wrapped=True)


def _print_watch(found: dict[str, Any]) -> None:
    table("Years as they come, window by window", replays.HEAD, replays.rows_of(found), wrapped=True)
    table("Alarms and cost", replays.SUMS, replays.sums_of(found))


def _print_page(found: dict[str, Any]) -> None:
    table("Pages, their modules run by wasmtime, processor time without drawing", pages.HEAD, pages.rows_of(found))


def _print_uncertainty(found: dict[str, Any]) -> None:
    title = f"{found['rig']}: standard deviations, the FMU's beside those of {found['draws']} draws, over four hours"
    table(title, bench_uncertainty.HEAD, bench_uncertainty.rows(found))
    if found["failed"]:
        say(f"{found['failed']} of the draws have no result and are left out.")
    plain, linear, mixture = (found["cost"][f"{way}_rhs"] for way in ("plain", "linear", "mixture"))
    say(
        f"Four hours at 60 s from C, all outputs read: {plain:.0f} right-hand sides,"
        f" {linear:.0f} with linear standard deviations ({linear / plain:.2f} times as much),"
        f" {mixture:.0f} with those of a mixture ({mixture / plain:.2f} times)."
    )
