"""The commands `map` and `rating`: a rig over speed and torque, and the power that it carries for ever."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...model.errors import ScenarioError, SolveError
from ...model.run.design import design
from ...model.units import from_si, shown, text
from ...scenarios.load import load
from ...scenarios.scenario import Scenario, parse_assignments
from ..show.columns import table_text
from ..show.console import answer, file_of, note, plottable, say, table, writable, write
from . import sampling
from .settings import adjusted, flat_of
from .steady import conditions, told
from .sweep import Request, planned
from .sweep_rows import local

#: Ranges where none is given, as shares of the operating point.
USUAL = (0.2, 1.2)
#: Torque up to which a rating is looked for, in those of the operating point.
MOST_LOAD = 20.0


def driving(scenario: Scenario) -> tuple[str, str]:
    """Paths of the speed and of the torque that are given.

    Raises:
        ScenarioError: one of them is not
    """
    given = [f"{end}.{quantity}" for end, quantities in scenario.given.items() for quantity in quantities]
    found = [next((path for path in given if path.endswith(f".{quantity}")), "") for quantity in ("w", "tau")]
    if not all(found):
        what = "speed" if not found[0] else "torque"
        raise ScenarioError(f"{scenario.name}: no {what} is given at a shaft end, see [drive] of the rig file.")
    return found[0], found[1]


def usual(scenario: Scenario, path: str) -> str:
    """A range about the value of the operating point, as it is written on the command line."""
    value = scenario.operating_point[path]
    low, high = (from_si(share * value, "rad/s" if path.endswith(".w") else "N.m") for share in USUAL)
    return f"{min(low, high):.4g}..{max(low, high):.4g} {'rpm' if path.endswith('.w') else 'N.m'}"


def map_command(
    rig: str,
    out: Path,
    ranges: Mapping[str, str | None],
    grid: str,
    plot: Path | None,
    outputs: Sequence[str],
    assignments: Sequence[str],
    json: str | None,
) -> None:
    """Oil temperatures, losses and efficiencies over speed and torque, as a table and a picture."""
    writable(out, file_of(json))
    plottable(plot)
    scenario = load(rig)
    paths = driving(scenario)
    vary = [f"{path}={ranges[key] or usual(scenario, path)}" for path, key in zip(paths, ("w", "tau"), strict=True)]
    shows = list(outputs) or told(scenario)
    plan = planned(Request(rig, vary, out, grid=grid, assignments=assignments, outputs=shows), scenario)
    rows = np.concatenate([found for _, found in sorted(local(plan.job, enumerate([plan.values]), 0))])
    rows[rows[:, len(shows)] != 0, : len(shows)] = np.nan
    if np.isnan(rows[:, : len(shows)]).all():
        raise SolveError(
            f"{plan.rig}: none of {len(rows)} points has a steady state. Run one of them with `gearheat steady` to see"
            " why, and choose other ranges."
        )
    names = [*paths, *shows]
    columns = [*plan.values.T, *rows[:, : len(shows)].T]
    found = {n: _shown(c, plan.flat.quantity(n).unit) for n, c in zip(names, columns, strict=True)}
    units = {n: shown(plan.flat.quantity(n).unit) for n in names}
    write(out, table_text([f"{n} [{units[n]}]" for n in names], list(found.values())))
    if plot is not None:
        from ..show.fields import Field, fields
        from ..show.plotting import plotted

        drawn = [Field(n, units[n], c) for n, c in found.items()]
        plotted(plot, fields(f"{plan.rig}: {paths[0]} and {paths[1]}", drawn[:2], drawn[2:]))
    payload = {
        "schema": "gearheat.map/1",
        "rig": plan.rig,
        "out": str(out),
        "plot": plot and str(plot),
        "rows": len(plan.values),
        "without_result": int(np.isnan(found[names[2]]).sum()),
        "ranges": {n: {"unit": units[n], "low": np.nanmin(c), "high": np.nanmax(c)} for n, c in found.items()},
    }
    answer(payload, json, lambda: _print_map(payload))


def _shown(values: np.ndarray, unit: str) -> np.ndarray:
    """SI values in the unit they are shown in."""
    return np.asarray(from_si(cast(Any, values), unit))


def _print_map(found: Mapping[str, Any]) -> None:
    rows = [(name, r["low"], r["high"], r["unit"]) for name, r in found["ranges"].items()]
    table(f"{found['rig']}: map of {found['rows']} points", ("name", "low", "high", "unit"), rows)
    if found["without_result"]:
        say(f"{found['without_result']} points have no steady state; their cells are nan")
    print(", ".join(filter(None, (found["out"], found["plot"]))))


def rating_command(
    rig: str,
    limit: str,
    ranges: Mapping[str, str | None],
    grid: str,
    out: Path | None,
    assignments: Sequence[str],
    json: str | None,
) -> None:
    """Thermal power: what the rig carries for ever with an oil that just keeps to a limit, over room and speed."""
    writable(out, file_of(json))
    scenario = load(rig)
    (speed, torque), room = driving(scenario), scenario.room
    if room is None:
        raise ScenarioError(f"{scenario.name}: has no room, so no heat leaves it.")
    varied = sampling.read(
        [f"{room}={ranges['room'] or '0..40 degC'}", f"{speed}={ranges['w'] or usual(scenario, speed)}"]
    )
    setting = adjusted(scenario, assignments, named=[room, speed])
    flat = flat_of(setting)
    aim = parse_assignments(flat, [limit])
    axes = sampling.axes(varied, {name: flat.quantity(name) for name in (room, speed)})
    values = sampling.gridded(axes, grid)
    powers, torques = np.full(len(values), np.nan), np.full(len(values), np.nan)
    load_ = abs(scenario.operating_point[torque])
    side = -1.0 if scenario.operating_point[torque] < 0 else 1.0
    bounds = {torque: (0.0, MOST_LOAD * load_) if side > 0 else (-MOST_LOAD * load_, 0.0)}
    why: dict[str, str] = {}
    for k, (T, w) in enumerate(values):
        given = {**conditions(setting, flat), room: float(T), speed: float(w), torque: side * load_}
        try:
            found = design(flat, [torque], aim, given, bounds=bounds)
        except SolveError as error:
            why[f"{text(float(T), 'K')}, {text(float(w), 'rad/s')}"] = error.problems[0].splitlines()[0]
            continue
        torques[k] = found.values[torque]
        powers[k] = abs(float(found.result[f"{torque.partition('.')[0]}.P"][0]))
    if np.isnan(powers).all():
        raise SolveError([f"{place}: {reason}" for place, reason in list(why.items())[:3]])
    shown_values = [_shown(values[:, k], unit) for k, unit in enumerate(("K", "rad/s"))]
    columns: list[np.ndarray] = [*shown_values, torques, powers / 1000]
    head = [f"{room} [degC]", f"{speed} [rpm]", f"{torque} [N.m]", "power [kW]"]
    if out is not None:
        write(out, table_text(head, columns))
    payload = {
        "schema": "gearheat.rating/1",
        "rig": scenario.name,
        "limit": limit,
        "out": out and str(out),
        "rows": [dict(zip(head, map(float, row), strict=True)) for row in zip(*columns, strict=True)],
        "without_result": why,
    }
    answer(payload, json, lambda: _print_rating(payload, columns, room, speed))


def _print_rating(found: Mapping[str, Any], columns: Sequence[np.ndarray], room: str, speed: str) -> None:
    rooms, speeds = (np.unique(column) for column in columns[:2])
    powers = columns[3].reshape(len(rooms), len(speeds))
    head = (f"{room} [degC]", *(f"{w:.4g} rpm" for w in speeds))
    title = f"{found['rig']}: thermal power [kW] at {found['limit']}"
    table(title, head, [(float(T), *map(float, row)) for T, row in zip(rooms, powers, strict=True)])
    for place, reason in found["without_result"].items():
        note(f"{place}: {reason}")
