"""What the documentation inside an FMU shows of its machine: network, warm-up, ways of heat, equations of its parts."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
from matplotlib.figure import Figure

from ...fmu.documentation import PartText
from ...model.core.component import Component
from ...model.core.connect import Assembly
from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.errors import GearheatError
from ...model.run.result import Result
from ...model.run.steady import steady
from ...model.sources import recording
from ...model.units import text
from ..show.drawing import COLOURS, empty, legend, svg
from ..show.heat_paths import heat_flows, heat_paths
from ..show.sankey import sankey

#: A formula longer than this tells what it is made of instead.
LONG = 160
#: A shorter run shows no warm-up [s].
WARM_UP = 3600.0
#: Digits of a value that do not differ from one machine to another.
DIGITS = 6


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
    bodies = [q.name for q in flat.states if q.unit == "K"]
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
    return sankey(paths, temperatures, title) if paths else None


def text_of(part: Component) -> PartText:
    """Equations and laws of a part."""
    with recording() as uses:
        equations = [(e.name, f"{_side(part, e.lhs)} = {_side(part, e.rhs)}") for e in part.equations()]
    laws = dict.fromkeys(use.law.name for use in (*part.uses, *uses))
    doc = (inspect.getdoc(type(part)) or "").splitlines()[0]
    return PartText(part.name, f"{type(part).__name__}: {doc}", equations, tuple(laws))


def _side(part: Component, side: Any) -> str:
    """One side of an equation, or what it is a function of where it is long."""
    written = str(side).replace(f"{part.name}.", "")
    if len(written) <= LONG and "@" not in written:
        return _without_outer_brackets(written)
    return f"f({', '.join(s.name().removeprefix(f'{part.name}.') for s in ca.symvar(side))})"


def _without_outer_brackets(written: str) -> str:
    """A sum or product as it is read; brackets that do not belong to each other stay."""
    depth = 0
    for at, letter in enumerate(written):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and at < len(written) - 1:
            return written
    return written[1:-1] if written.startswith("(") else written
