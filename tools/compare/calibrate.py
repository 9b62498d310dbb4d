"""Parameters fitted to the measured oil temperatures of one grid by playing the FMU."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from ...fmu.export import export
from ...fmu.play import Player
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import DataError, Problems, SolveError
from ...model.units import from_si, show_unit
from ...scenarios.frames import Table
from ...scenarios.given import RigLike, Settings, listed, pairs_of, range_of, scenario_of
from ...scenarios.measured.study import Measured, read_study
from ..show.console import note
from ..show.display import Answer
from ..solve.settings import adjust, flat_of
from . import campaign

#: Correlation of two values from which on readings do not tell them apart.
ALIKE = 0.99
#: Relative step of the difference quotients; well above what the FMU's own tolerance leaves.
STEP = 1e-3


@dataclass(frozen=True)
class Fit:
    """Fitted values in SI with their standard errors and correlations, and the errors before and after [K].

    A value that ended at its bound has neither standard error nor correlation (NaN): the readings ask for more than the
    bound allows.
    """

    names: tuple[str, ...]
    start: np.ndarray
    values: np.ndarray
    standard_errors: np.ndarray
    correlation: np.ndarray
    readings: int
    rmse_before: float
    rmse_after: float


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Answer):
    """Parameters fitted to measured oil temperatures.

    Attributes:
        fit: values in SI with standard errors and correlations
    """

    fit: Fit


def calibrate(
    rig: RigLike,
    free: str | Sequence[str],
    *,
    grid: str | None = None,
    bounds: str | Sequence[str] | Mapping[str, Any] = (),
    set: Settings = (),
    data: Table | None = None,
    card: str | Path | None = None,
) -> Calibration:
    """Fit parameters to the measured oil temperatures of a table, or of one of its grids.

    Args:
        rig: name, file or rig
        free: parameters to fit
        grid: value of the table's `mounting` or `grid` column to fit; all if None
        bounds: ranges of free parameters, such as {"cooling.A": (0.4, 1.2)} or "cooling.A=0.4 m2..1.2 m2"
        set: values by name: texts with units, quantities of pint, or numbers in SI
        data: measured table, file or DataFrame; the rig's own if None
        card: how that table was taken

    Raises:
        GearheatError: all that is wrong with what is asked; the readings do not determine the parameters

    Example:
        >>> import gearheat as gh
        >>> gh.calibrate("planetary", ["cooling.A"], grid="PAOR-16")  # doctest: +SKIP
    """
    free = listed(free)
    scenario = adjust(scenario_of(rig), set, named=free)
    study = read_study(scenario, data, card)
    if study is None:
        raise DataError(f"{scenario.name}: there are no measured data to fit to. Give them as --data FILE.")
    scenario = study.scenario
    flat = flat_of(scenario)
    quantities = _parse_bounds(_check_free(flat, free), bounds)
    chosen = _of_grid(study, campaign.runs_of(scenario, flat, study), grid)
    fit = fit_parameters(study, flat, quantities, chosen)
    found: dict[str, Any] = {
        "schema": "gearheat.calibrate/1",
        "rig": scenario.name,
        "grid": grid,
        "readings": fit.readings,
        "free": {
            q.name: {
                "value": from_si(float(fit.values[i]), q.unit),
                "standard_error": float(fit.standard_errors[i]) * (from_si(1.0, q.unit) - from_si(0.0, q.unit)),
                "start": from_si(float(fit.start[i]), q.unit),
                "unit": show_unit(q.unit),
                "at_bound": bool(np.isnan(fit.standard_errors[i])),
            }
            for i, q in enumerate(quantities)
        },
        "correlation": {
            a: dict(zip(fit.names, line.tolist(), strict=True))
            for a, line in zip(fit.names, fit.correlation, strict=True)
        },
        "notes": (notes := alike(fit)),
        "rmse_before_K": fit.rmse_before,
        "rmse_after_K": fit.rmse_after,
    }
    for said in notes:
        note(said)
    heading = f"{scenario.name}: fitted to {fit.readings} oil temperatures of {grid or 'all tests'}"
    rows = [(n, f["value"], f["standard_error"], f["unit"], f["start"]) for n, f in found["free"].items()]
    return Calibration(found, fit, heading=heading, shown=(("name", "value", "standard error", "unit", "before"), rows))


def alike(fit: Fit) -> list[str]:
    """Pairs of parameters that the readings do not tell apart, in words."""
    pairs = combinations(range(len(fit.names)), 2)
    found = [(fit.names[i], fit.names[k]) for i, k in pairs if abs(fit.correlation[i, k]) > ALIKE]
    return [f"these data do not tell {a} from {b}: free one of them" for a, b in found]


def _check_free(flat: FlatModel, free: Sequence[str]) -> list[Quantity]:
    problems = Problems()
    for name in free:
        with problems:
            if flat.locate(name)[0] != "parameter":
                problems.append(f"{name} is no parameter and cannot be fitted. `gearheat show` lists the parameters.")
            elif flat.quantity(name).whole:
                problems.append(f"{name} is a whole number and cannot be fitted. Free a size.")
    if len(set(free)) < len(free):
        problems.append("A parameter is free twice. Name each once.")
    problems.check()
    return [flat.quantity(name) for name in free]


def _parse_bounds(quantities: Sequence[Quantity], bounds: Any) -> list[Quantity]:
    """The quantities with the ranges given by name, or by texts such as "cooling.A=0.4 m2..1.2 m2"."""
    found = {q.name: q for q in quantities}
    problems = Problems()
    for one in pairs_of(bounds):
        name, ends = [part.strip() for part in one.split("=", 1)] if isinstance(one, str) and "=" in one else (one, "")
        name, ends = (name, ends) if isinstance(one, str) else one
        if name not in found or not ends:
            ranges = " or ".join(f"{known}=LOW..HIGH" for known in found)
            problems.append(f'--bounds "{name}": is no range of a free parameter. Write {ranges}, both with units.')
            continue
        with problems:
            low, high = range_of(ends, found[name], f"--bounds {name}")
            found[name] = replace(found[name], low=low, high=high)
    problems.check()
    return list(found.values())


def _of_grid(study: Measured, runs: Sequence[campaign.Run], grid: str | None) -> list[campaign.Run]:
    """The tests of one mounting or grid of the table, all of them where none is named."""
    mountings = study.campaign.mounting
    found = [run for run, mounting in zip(runs, mountings, strict=True) if grid in (None, mounting)]
    if not found:
        known = ", ".join(dict.fromkeys(name for name in mountings if name)) or "none"
        raise DataError(f'There is no grid "{grid}". Grids: {known}.')
    return found


def fit_parameters(
    study: Measured, flat: FlatModel, quantities: Sequence[Quantity], runs: Sequence[campaign.Run]
) -> Fit:
    """Least squares on the first thermometer, that of the oil where there is one, over the readings of the tests.

    Raises:
        SolveError: the readings do not determine the parameters
    """
    start = np.array([q.start for q in quantities])
    scale = np.where(start != 0, np.abs(start), [q.nominal for q in quantities])
    if (sensor := study.oil_sensor) is None:
        raise DataError(f"{study.campaign.name}: no temperature of the gearbox was read to fit to.")
    column = study.campaign.values[sensor.name][[row for run in runs for row in run.rows]]
    measured = column[known := np.isfinite(column)]  # cells may be empty
    if len(measured) <= len(start):
        raise SolveError(f"{len(measured)} readings cannot determine {len(start)} parameters. Free fewer.")
    with tempfile.TemporaryDirectory() as folder, Player(export(flat, Path(folder) / "rig.fmu")) as player:

        def errors(z: np.ndarray) -> np.ndarray:
            values = {q.name: float(v) for q, v in zip(quantities, z * scale, strict=True)}
            simulated = [_make_simulation(player, study, run, sensor.reads, values) for run in runs]
            return np.asarray(np.concatenate(simulated)[known] - measured)

        low, high = (np.array([getattr(q, side) for q in quantities]) / scale for side in ("low", "high"))
        first = errors(start / scale)
        begin = np.clip(start / scale, low + 1e-6 * (1 + np.abs(low)), high)
        found = least_squares(errors, begin, bounds=(low, high), diff_step=STEP, xtol=1e-6, ftol=1e-9)
    note(f"{found.nfev} evaluations of {len(runs)} tests: {found.message}")
    inside = found.active_mask == 0
    _, sizes, _ = np.linalg.svd(found.jac[:, inside])
    if sizes.size and sizes[-1] < 1e-8 * sizes[0]:
        raise SolveError("The readings do not tell the free parameters apart. Free fewer.")
    variance = (found.fun @ found.fun) / (len(measured) - inside.sum())
    covariance = np.full((len(start), len(start)), np.nan)
    covariance[np.ix_(inside, inside)] = np.linalg.inv(found.jac[:, inside].T @ found.jac[:, inside]) * variance
    deviation = np.sqrt(np.diag(covariance))
    return Fit(
        names=tuple(q.name for q in quantities),
        start=start,
        values=found.x * scale,
        standard_errors=deviation * scale,
        correlation=covariance / np.outer(deviation, deviation),
        readings=len(measured),
        rmse_before=float(np.sqrt(np.mean(first**2))),
        rmse_after=float(np.sqrt(np.mean(found.fun**2))),
    )


def _make_simulation(
    player: Player, study: Measured, run: campaign.Run, path: str, values: Mapping[str, float]
) -> np.ndarray:
    """The oil temperature at every reading of a test [K], with other values of parameters."""
    start = {**run.start, **(_find_start(study, run, values) if study.campaign.steady else {}), **values}
    stop, moments = run.schedule.stop, list(run.moments)
    return player.run(run.inputs, stop, 60.0, start=start, record=[path], output_times=moments).values[:, 0]


def _find_start(study: Measured, run: campaign.Run, values: Mapping[str, float]) -> dict[str, float]:
    """The steady state with other parameters that a test begins with; nothing where there is none."""
    states = {q.name for q in study.nominal.flat.states}
    known = {name: value for name, value in run.start.items() if name not in states}
    known |= {name: float(course[0]) for name, course in run.schedule.values.items()}
    found = study.nominal.at({**known, **values}) or {}
    return {name: found[name] for name in states & found.keys() & run.start.keys()}
