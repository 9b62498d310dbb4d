"""What goes with an FMU: parameter sets of the rig and of every oil, a reference result, its own check, its figures."""

from __future__ import annotations

import inspect
import math
import tempfile
from collections.abc import Collection, Container, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from matplotlib.figure import Figure

from ...fmu.compiling import store
from ...fmu.documentation import PartText
from ...fmu.export import export
from ...fmu.parameter_set import parameter_set
from ...fmu.play import Player
from ...fmu.related import TOLERANCE, Experiment, results, stimuli, write_reference
from ...fmu.variables import STORED, SUPPLIED, THROUGHPUT, tidy
from ...model.core.component import Component
from ...model.core.connect import Assembly
from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.errors import GearheatError
from ...model.run.result import Result
from ...model.run.schedule import Schedule, join_phases
from ...model.run.simulate import simulate
from ...model.run.steady import steady
from ...model.sources import recording
from ...model.units import text
from ...scenarios.entries import catalogue
from ...scenarios.scenario import Scenario
from ...scenarios.values import oil_values
from ..show.drawing import COLOURS, empty, legend, svg
from ..show.heat_paths import heat_flows, heat_paths
from ..show.sankey import sankey

#: Communication step of the reference result of a model driven by speed [s].
STEP = 60.0
#: The same of a model driven by torques [s].
SHORT_STEP = 0.5

#: What is below this is round-off, which differs between machines.
_ROUND_OFF = 5e-13
#: A formula longer than this tells what it is made of instead.
LONG = 160
#: A shorter run shows no warm-up [s].
WARM_UP = 3600.0
#: Digits of a value that do not differ from one machine to another.
DIGITS = 6


def reference_duty(flat: FlatModel, start: Mapping[str, float], shafts: Container[str]) -> Schedule:
    """The duty of the reference result, with every input in it.

    With a given speed: two hours at the operating point, then two hours at half of its speed and torque. With torques
    alone: a minute at the operating point, the middle third with 0.5 % more of the larger torque. Inputs jump and do
    not ramp, so that an importer without slopes of inputs gets the same.
    """
    values = {q.name: float(start.get(q.name, q.start)) for q in flat.inputs}
    driven = [q for q in flat.inputs if q.name in shafts]
    if any(q.unit == "rad/s" for q in driven) or not driven:
        return join_phases([(7200.0, values), (7200.0, {q.name: values[q.name] / 2 for q in driven})])
    first = max((q.name for q in driven), key=lambda name: abs(values[name]))
    return join_phases([(20.0, values), (20.0, {first: 1.005 * values[first]}), (20.0, {first: values[first]})])


def step_of(duty: Schedule) -> float:
    """Time between the rows of the reference result [s]."""
    return STEP if duty.stop > 3600 else SHORT_STEP


def reference_run(flat: FlatModel, duty: Schedule, start: Mapping[str, float]) -> Result | GearheatError:
    """The reference run of the model itself, or why there is none.

    Args:
        flat: the model
        duty: of the reference result
        start: start values that are not those of the model
    """
    states = {q.name: start[q.name] for q in flat.states if q.name in start}
    times = duty.even(step_of(duty))
    try:
        return simulate(flat, duty, start=states, times=times)
    except GearheatError as error:
        return error


def experiment(flat: FlatModel, duty: Schedule, run: Result | GearheatError) -> Experiment | None:
    """The reference run as an importer can repeat it: temperatures and speeds, by another method than the FMU's.

    Args:
        flat: the model
        duty: of the reference result
        run: of `reference_run`
    """
    if isinstance(run, GearheatError):
        return None
    names = [q.name for q in flat.states]
    doc = f"{duty.stop:g} s with steps of the load, states as CVODES integrates the model that the FMU was made of"
    values = np.stack([run[name] for name in names], axis=1)
    inputs = stimuli(_inputs(duty), duty.stop)
    return Experiment("reference", doc, duty.stop, step_of(duty), TOLERANCE, inputs, results(names, run.index, values))


def check_fmu(fmu: Path, flat: FlatModel, duty: Schedule, own: Result | GearheatError) -> tuple[tuple[str, str], ...]:
    """What was checked with this FMU, and the result: it is played over the reference duty beside the model's own run.

    Results are bounds, the next power of ten above what was found, so that the same model gives the same text.
    """
    if not _plays_here(fmu):
        return ()
    try:
        if isinstance(own, GearheatError):
            raise own
        with Player(fmu) as player:
            audit = [name for name in (SUPPLIED, STORED, THROUGHPUT) if SUPPLIED in player.described.variables]
            names = [*(q.name for q in flat.states), *audit]
            moments = np.unique(own.index)
            played = player.run(_inputs(duty), duty.stop, step_of(duty), record=names, output_times=moments)
    except GearheatError as error:
        return (("reference run of this FMU against the model, integrated by another method", f"failed: {error}"),)
    rows = []
    what = f"largest difference over the reference run of {duty.stop:g} s, this FMU against CVODES at 1e-8"
    for unit, word in (("K", "temperature"), ("rad/s", "speed")):
        apart = [np.abs(played[q.name] - own[q.name]).max() for q in flat.states if q.unit == unit]
        if apart:
            rows.append((f"{word}: {what}", f"below {_bound_above(max(apart))} {unit}"))
    if not audit:
        return tuple(rows)
    gained = played[STORED] - played[STORED][0]
    residual = np.abs(played[SUPPLIED] - gained).max() / played[THROUGHPUT][-1]
    return (
        *rows,
        ("energy in less energy stored over that run, relative to the throughput", f"below {_bound_above(residual)}"),
    )


def _inputs(duty: Schedule) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    return {name: (duty.time, column) for name, column in duty.values.items()}


def _plays_here(fmu: Path) -> bool:
    import fmpy

    return fmpy.platform in fmpy.supported_platforms(str(fmu))


def _bound_above(value: float) -> str:
    """The next power of ten above a value."""
    return f"1e{math.floor(math.log10(max(value, _ROUND_OFF))) + 1}"


def write_extras(
    fmu: Path,
    folder: Path,
    scenario: Scenario,
    flat: FlatModel,
    duty: Schedule,
    start: Mapping[str, float],
    sources: Mapping[str, str] | None,
    hidden: Collection[str] = (),
) -> list[Path]:
    """Write what goes beside an FMU.

    Args:
        fmu: the FMU; the files have its name
        folder: where to write
        scenario: the rig as exported
        flat: its model, with the parameters of the FMU
        duty: of the reference result
        start: start values of the FMU that are not those of the model
        sources: parameter -> where its value is from; None tells neither that nor how uncertain values are
        hidden: parameters that are constants of the model

    Returns:
        NAME.ssv, oils/OIL.ssv for every oil that gives all the rig's oil has, NAME_in.csv, NAME_ref.csv, NAME_ref.opt
    """
    chosen = [replace(q, start=tidy(q.start)) for q in flat.parameters]
    sd = None if sources is None else scenario.standard_uncertainties
    own = parameter_set(scenario.name, chosen, doc=scenario.doc, sources=sources, uncertainties=sd)
    files = {folder / f"{fmu.stem}.ssv": own}
    for oil, content in sets_of_oils(scenario, flat, told=sources is not None, hidden=hidden).items():
        files[folder / "oils" / f"{oil.replace(' ', '_')}.ssv"] = content
    for path, content in files.items():
        store(path, content)
    with tempfile.TemporaryDirectory() as place:
        played = fmu if _plays_here(fmu) else export(flat, Path(place) / fmu.name, start=start)
        reference = write_reference(played, _inputs(duty), duty.stop, step_of(duty), folder=folder)
    return [*files, *reference]


def sets_of_oils(scenario: Scenario, flat: FlatModel, *, told: bool, hidden: Collection[str] = ()) -> dict[str, bytes]:
    """A set for every oil of the catalogue that gives the oil baths all that oils can give this model.

    Args:
        scenario: the rig
        flat: its model
        told: whether the sets say where their values are from
        hidden: parameters that are constants of the model; there is no set where one is an oil's
    """
    oils = {name: oil_values(name) for name in catalogue("oil")}
    given = {key for values in oils.values() for key in values}
    paths = {f"{bath}.{key}": key for bath in scenario.spec.of_type("OilBath") for key in given}
    filled = [q for q in flat.parameters if q.name in paths]
    sets: dict[str, bytes] = {}
    for name, values in oils.items() if filled and not paths.keys() & hidden else ():
        if all(paths[q.name] in values for q in filled):
            entry = catalogue("oil")[name]
            chosen = [replace(q, start=values[paths[q.name]]) for q in filled]
            sources = {q.name: entry.sources[paths[q.name]] for q in filled if told}
            sets[name] = parameter_set(name, chosen, doc=f"{entry.doc}, for {scenario.name}", sources=sources)
    return sets


def figures_of(
    assembly: Assembly, flat: FlatModel, start: Mapping[str, float], run: Result | GearheatError
) -> dict[str, str]:
    """Title -> SVG of the figures that there can be: a run may fail, a machine may have no steady state.

    Args:
        assembly: the machine
        flat: its model
        start: start values of the FMU that are not those of the model
        run: the reference run
    """
    found = {}
    if not isinstance(run, GearheatError) and run.index[-1] >= WARM_UP:
        found["Warm-up"] = svg(_warm_up(flat, run))
    if (heat := _heat(assembly, start)) is not None:
        found["Where the heat comes from and where it goes"] = svg(heat)
    return found


def _warm_up(flat: FlatModel, run: Result) -> Figure:
    """Temperatures of the bodies and the loss over the reference run."""
    bodies = flat.bodies
    loss = next((q.name for q in flat.outputs if q.name == "efficiency.P_loss"), None)
    figure, panels = empty(9.0, 5.0 if loss else 3.4, 2 if loss else 1, 1, sharex=True)
    changed = any(run[q.name][0] != run[q.name][-1] for q in flat.inputs)
    title = (
        "two hours at the initial inputs, then two at half of their speed and torque" if changed else "initial inputs"
    )
    panels[0].set(ylabel="temperature [°C]", title=title)
    for i, name in enumerate(bodies):
        panels[0].plot(run.index / 60, _round(run[name] - 273.15), color=COLOURS[i % len(COLOURS)], label=name)
    if loss:
        panels[1].plot(run.index / 60, _round(run[loss]), color=COLOURS[-1], label=loss)
        panels[1].set(ylabel="loss [W]", ylim=(0, None))
    panels[-1].set_xlabel("time [min]")
    legend(figure, panels[0])
    return figure


def _round(values: np.ndarray) -> list[float]:
    """Values to as many digits as do not differ from one machine to another."""
    return [float(f"{value:.{DIGITS}g}") for value in values]


def _heat(assembly: Assembly, start: Mapping[str, float]) -> Figure | None:
    """The heat of the steady state at the initial inputs, None where there is none."""
    told = flatten(assembly, flows=heat_flows(assembly))
    given = {q.name: start[q.name] for q in (*told.inputs, *told.parameters) if q.name in start}
    try:
        at = steady(told, given, guess={q.name: start[q.name] for q in told.states if q.name in start})
    except GearheatError:
        return None
    values = {name: float(column[0]) for name, column in at.columns.items()}
    paths = [replace(path, Q_flow=float(f"{path.Q_flow:.{DIGITS}g}")) for path in heat_paths(assembly, values)]
    places = {name for path in paths for name in (path.begins, path.ends)}
    temperatures = {name: text(values[f"{name}.T"], "K", 4) for name in places if f"{name}.T" in values}
    title = "steady state at the initial inputs"
    kinds = {part.name: part.role for part in assembly.parts}
    return sankey(paths, temperatures, title, kinds)[0] if paths else None


def text_of(part: Component, hidden: Collection[str] = ()) -> PartText:
    """Equations and laws of a part.

    Args:
        part: the part
        hidden: parameters that are not named
    """
    with recording() as uses:
        equations = [(e.name, f"{_side(part, e.lhs, hidden)} = {_side(part, e.rhs, hidden)}") for e in part.equations()]
    laws = dict.fromkeys(use.law.name for use in (*part.uses, *uses))
    doc = (inspect.getdoc(type(part)) or "").partition("\n")[0]
    return PartText(part.name, f"{type(part).__name__}: {doc}", equations, tuple(laws))


def _side(part: Component, side: Any, hidden: Collection[str]) -> str:
    """One side of an equation, or what it is a function of where it is long or names what is hidden."""
    names = [s.name() for s in ca.symvar(side)] if isinstance(side, ca.SX) else []
    written = str(side).replace(f"{part.name}.", "")
    if len(written) <= LONG and "@" not in written and not {*names} & {*hidden}:
        return _without_outer_brackets(written)
    return f"f({', '.join(n.removeprefix(f'{part.name}.') for n in names if n not in hidden)})"


def _without_outer_brackets(written: str) -> str:
    """A sum or product as it is read; brackets that do not belong to each other stay."""
    depth = 0
    for at, letter in enumerate(written):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and at < len(written) - 1:
            return written
    return written[1:-1] if written.startswith("(") else written
