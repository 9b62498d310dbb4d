"""Standard deviations of an FMU beside Monte Carlo over a warm-up, and what they cost: one run.

Drawn are all uncertain parameters of the rig, as `gearheat sweep --vary uncertainty` draws them, so that what is not
linear in them shows as a difference, beside what the FMU leaves out.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.batch import Batch, Status
from ...fmu.export import export
from ...fmu.leading import Uncertain
from ...fmu.play import play
from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError
from ...model.run.schedule import Schedule
from ...scenarios.load import load
from ..solve.sampling import collect_uncertain, draw_sample as drawn, draw_values, shares
from ..solve.settings import adjust, flat_of
from ..solve.simulate import first_temperatures
from .costs import run_in_rhs

#: The warm-up.
DURATION = 14_400.0
#: How often it is looked at.
EVERY = 300.0
#: The communication step of the FMU [s].
STEP = 60.0
#: Rows that are drawn at a time, which bounds the memory.
BLOCK = 1000
#: The same seed draws the same.
SEED = 0
#: Fewest draws that have a scatter, and a standard error of it.
FEWEST = 10
#: Of the table: deviations at the end; the largest difference, relative to the draws' scatter; its standard error.
HEAD = ("way", "output", "FMU", "draws", "differ by [%]", "at [min]", "error of draws [%]")
#: A scatter below this part of the nominal value is none.
NOTHING = 1e-9


#: Ways to standard deviations.
WAYS = ("linear", "mixture")


def measure(rig: str, draws: int = 10_000, ways: Sequence[str] = WAYS) -> dict[str, Any]:
    """The standard deviations of the FMU and of the draws, and what a run with them costs.

    Args:
        rig: name or path
        draws: rows of Monte Carlo
        ways: to the deviations, of `WAYS`

    Returns:
        per way and output the difference of the FMU from the scatter, relative to that, where it is largest, and the
        standard error of the scatter there; the cost of a run without deviations and with those of each way, in
        right-hand sides, each taken by turns with these

    Raises:
        ScenarioError: too few draws, nothing is uncertain, too few of the drawn rows have a result
    """
    if draws < FEWEST:
        raise ScenarioError(f"--draws {draws}: too few for a scatter. Give at least {FEWEST}.")
    scenario = adjust(load(rig))
    flat = flat_of(scenario)
    what, start = collect_uncertain(scenario, flat), first_temperatures(scenario, flat, None)
    times = EVERY * np.arange(1, round(DURATION / EVERY) + 1)
    found = np.concatenate(list(_draws(flat, what, start, times, draws)))
    if len(found) < max(FEWEST, draws // 2):
        raise ScenarioError(f"{scenario.name}: {len(found)} of {draws} drawn rows have a result: no scatter.")
    with tempfile.TemporaryDirectory() as folder:
        plain = export(flat, Path(folder) / "plain.fmu", start=start)
        outputs, costs = [], {"plain": run_in_rhs(plain, Path(folder) / "plain")}
        for way in ways:
            full = export(
                flat, Path(folder) / f"{way}.fmu", start=start, uncertain=replace(what, mixture=way == "mixture")
            )
            names = [f"{name}.sd" for name in what.shown]
            run = play(full, {}, DURATION, STEP, record=names, output_times=times)
            outputs += [{"way": way} | row for row in _compare(flat, what.shown, run.values, found, times)]
            costs[way] = run_in_rhs(full, Path(folder) / way)
    told = {"rig": scenario.name, "draws": draws, "failed": draws - len(found), "outputs": outputs}
    return told | {"cost": {f"{way}_rhs": cost for way, cost in costs.items()}}


def _draws(
    flat: FlatModel, what: Uncertain, start: Mapping[str, float], times: np.ndarray, draws: int
) -> Iterator[np.ndarray]:
    """What is shown of the rows that have a result, block by block (rows, times, shown)."""
    batch, duty = Batch(flat), Schedule(np.array([0.0, DURATION]), {})
    sizes = drawn(shares(what.reasons), draws, "monte-carlo", SEED)
    axes, values = draw_values(what.reasons, flat, sizes)
    for first in range(0, draws, BLOCK):
        block = values[first : first + BLOCK]
        rows = batch.warmup(
            duty,
            *batch.vectors({**start, **{axis.name: block[:, k] for k, axis in enumerate(axes)}}),
            times=times,
        )
        yield np.stack([rows[name] for name in what.shown], axis=2)[rows.status == Status.OK]


def _compare(
    flat: FlatModel, shown: tuple[str, ...], told: np.ndarray, found: np.ndarray, times: np.ndarray
) -> list[dict[str, Any]]:
    """Each output that scatters where the FMU (times, shown) differs most from the draws (rows, times, shown).

    The standard error of a scatter is that of its square, which the fourth moment tells, halved.
    """
    n, middle = len(found), found.mean(axis=0)
    scatter = found.std(axis=0, ddof=1)
    fourth = ((found - middle) ** 4).mean(axis=0)
    least = NOTHING * np.array([flat.quantity(name).nominal for name in shown])
    there = np.maximum(scatter, least)
    error = np.sqrt(np.maximum(fourth / there**4 - 1, 0) / (4 * n))
    apart = (told - scatter) / there
    worst = np.abs(apart).argmax(axis=0)
    return [
        {
            "name": name,
            "unit": flat.quantity(name).unit,
            "fmu_sd": float(told[-1, k]),
            "drawn_sd": float(scatter[-1, k]),
            "worst_difference": float(apart[at, k]),
            "worst_time_s": float(times[at]),
            "standard_error": float(error[at, k]),
        }
        for k, (name, at) in enumerate(zip(shown, worst, strict=True))
        if (scatter[:, k] > least[k]).any()
    ]


def rows(found: Mapping[str, Any]) -> list[tuple[object, ...]]:
    """The table, under `HEAD`."""
    return [
        (
            o["way"],
            f"{o['name']} [{o['unit']}]",
            o["fmu_sd"],
            o["drawn_sd"],
            round(100 * o["worst_difference"], 1),
            round(o["worst_time_s"] / 60),
            round(100 * o["standard_error"], 1),
        )
        for o in found["outputs"]
    ]
