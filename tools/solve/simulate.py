"""The commands `simulate` and `play`: time series from the model itself or from its FMU."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.described import Described, described, settable
from ...model.core.flat import FlatModel
from ...model.errors import FmuError, ScenarioError
from ...model.run.schedule import Schedule
from ...model.run.simulate import simulate
from ...model.units import from_si, shown, to_si
from ...scenarios.duty import duty_names, read_duty
from ...scenarios.load import load
from ...scenarios.scenario import Scenario
from ..show.columns import series
from ..show.console import answer, file_of, note, plottable, say, writable, write
from .settings import adjusted, flat_of
from .steady import outside_of, tell_outside
from .unchecked import print_unchecked, unchecked


def simulate_command(
    rig: str, duty: Path, out: Path, assignments: Sequence[str], json: str | None, *, plot: Path | None = None
) -> None:
    """Run a rig through a duty; temperatures that are not set start at the room's."""
    writable(out, file_of(json))
    plottable(plot)
    scenario = adjusted(load(rig), assignments, named=duty_names(duty))
    flat = flat_of(scenario)
    schedule = read_duty(duty, flat)
    result = simulate(flat, schedule, start=first_temperatures(scenario, flat, schedule))
    write(out, series(result.index, result.columns, result.units))
    _plot(plot, f"{scenario.name}, {duty.stem}", result.index, result.columns, result.units)
    found = {
        "schema": "gearheat.simulate/1",
        "rig": scenario.name,
        "out": str(out),
        "plot": plot and str(plot),
        **_summary(result.index, result.columns, result.units),
        "energy_residual": result.audit.residual,
        "outside": outside_of(result),
        "laws": list(result.laws),
        "unchecked": unchecked(scenario, flat),
    }

    def human() -> None:
        _print(found)
        tell_outside(found["outside"])
        print_unchecked(found["unchecked"])

    answer(found, json, human)


def _plot(
    plot: Path | None, title: str, time: np.ndarray, columns: Mapping[str, np.ndarray], units: Mapping[str, str]
) -> None:
    if plot is not None:
        from ..show.courses import courses
        from ..show.plotting import plotted

        plotted(plot, courses(title, time, columns, units))
        note(f"wrote {plot}")


def first_temperatures(scenario: Scenario, flat: FlatModel, schedule: Schedule | None) -> dict[str, float]:
    """Start temperatures: as set, else that of the room at the beginning of the schedule, or at the operating point."""
    room = scenario.room
    if room is None:
        return {}
    given = schedule is not None and room in schedule.values
    T = float(schedule.values[room][0]) if schedule is not None and given else flat.quantity(room).start
    own = {f"{part.name}.{key}" for part in scenario.spec.parts for key in part.values}
    return {q.name: T for q in flat.states if q.unit == "K" and q.name not in own}


def play_command(
    fmu: Path,
    duty: Path,
    out: Path,
    step: str,
    assignments: Sequence[str],
    json: str | None,
    *,
    trust: bool = False,
    plot: Path | None = None,
) -> None:
    """Play an FMU over a duty; one that was not made here only if it is trusted."""
    from ...fmu.play import Player
    from ...fmu.unpacking import trusted

    writable(out, file_of(json))
    plottable(plot)
    dt = to_si(step, "s", name="--step")
    told = described(fmu)
    made_by = told.description.generationTool or "an unknown tool"
    if not trusted(fmu):
        if not trust:
            raise FmuError(
                f"{fmu}: was not made by gearheat on this machine (but by {made_by}), and playing it runs native code"
                " of it with your rights. Add --trust if you trust its maker."
            )
        note(f"{fmu}: running native code of {made_by}")
    with Player(told) as player:
        schedule = read_duty(duty, told.quantities("input"))
        start = _start(told, assignments)
        first = start | {name: float(values[0]) for name, values in schedule.values.items()}
        start = _at_room(told, first) | start
        inputs = {name: (schedule.time, values) for name, values in schedule.values.items()}
        played = player.run(inputs, schedule.stop, dt, begin=schedule.start, start=start)
    units = {name: q.unit for name, q in told.quantities("input", "output").items()}
    columns = {name: played.values[:, k] for k, name in enumerate(played.names)}
    write(out, series(played.time, columns, units))
    _plot(plot, f"{fmu.stem}, {duty.stem}", played.time, columns, units)
    found = {
        "schema": "gearheat.play/1",
        "fmu": str(fmu),
        "out": str(out),
        "plot": plot and str(plot),
        **_summary(played.time, columns, units),
    }
    answer(found, json, lambda: _print(found))


def _print(found: Mapping[str, Any]) -> None:
    say(f"{found['out']}: {found['rows']} rows to {found['stop_s']:g} s")


def _at_room(told: Described, first: Mapping[str, float]) -> dict[str, float]:
    """Start temperatures of an FMU of gearheat that are its room's, where the run gives the room another one.

    Args:
        told: description of the FMU
        first: what the run sets, and the first value of what it gives
    """
    if not (told.description.generationTool or "").startswith("gearheat"):
        return {}
    warm = [v for v in told.variables.values() if v.unit == "K" and v.start and settable(v)]
    rooms = {float(v.start): first[v.name] for v in warm if v.causality == "input" and v.name in first}
    states = [v for v in warm if v.causality in ("output", "local") and float(v.start) in rooms]
    return {v.name: rooms[float(v.start)] for v in states}


def _start(told: Described, assignments: Sequence[str]) -> dict[str, float]:
    """Start values from texts NAME=VALUE, in SI. Raises ScenarioError with all problems at once."""
    from ...model.errors import GearheatError, suggestion

    known, shown, wholes = told.quantities("start"), told.quantities("output"), told.wholes()
    values: dict[str, float] = {}
    problems: list[str] = []
    for text in assignments:
        name, _, written = (part.strip() for part in text.partition("="))
        try:
            if name in wholes:
                values[name] = _whole(name, written, wholes[name])
            elif name in known:
                values[name] = to_si(written, known[name].unit, name=name)
            else:
                every = [*known, *wholes]
                why = f" It is calculated: {shown[name].doc}." if name in shown else suggestion(name, every)
                problems.append(f'{told.path.name}: "{name}" cannot be set.{why}')
        except GearheatError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    return values


def _whole(name: str, written: str, items: Mapping[str, int]) -> int:
    """A whole number, or that of an item by its name."""
    if written in items:
        return items[written]
    if items:
        raise ScenarioError(f'{name} = "{written}" is not known. Choose one of: {", ".join(items)}.')
    try:
        return int(written)
    except ValueError:
        raise ScenarioError(f'{name} = "{written}" is no whole number.') from None


def _summary(time: np.ndarray, columns: Any, units: Any) -> dict[str, Any]:
    """How long a time series is, and where it ends, in the units shown to a person."""
    return {
        "rows": len(time),
        "stop_s": float(time[-1]),
        "final": {name: from_si(float(column[-1]), units[name]) for name, column in columns.items()},
        "units": {name: shown(units[name]) for name in columns},
    }
