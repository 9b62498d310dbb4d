"""The command `steady`: one operating point, and what other commands tell of one."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any

from ...model.core.declare import Port, State, declared
from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.machines.spec import assemble
from ...model.run.result import Result
from ...model.run.steady import steady
from ...model.units import from_si, shown
from ...scenarios.load import load
from ...scenarios.scenario import Scenario
from ..show.console import answer, note, plottable, say, table
from ..show.heat_paths import heat_flows, heat_paths
from .settings import adjusted, flat_of
from .unchecked import print_unchecked, unchecked

#: Words of a table of values.
HEAD = ("name", "value", "unit", "meaning")


def told(scenario: Scenario) -> list[str]:
    """What a picture shows of a rig: the temperature of its oil, or of its first body; losses and efficiencies."""
    warm = [p for p in scenario.spec.parts if "T" in declared(scenario.spec.types[p.type], State)]
    warm.sort(key=lambda p: "lubricant" not in declared(scenario.spec.types[p.type], Port))
    meters = scenario.spec.of_type("Efficiency")
    return [*(f"{p.name}.T" for p in warm[:1]), *(f"{name}.{key}" for name in meters for key in ("P_loss", "eta"))]


def steady_command(
    rig: str, assignments: Sequence[str], json: str | None, *, plot: Path | None = None, everything: bool = False
) -> None:
    """Temperatures and losses of a rig at rest with its surroundings."""
    plottable(plot)
    scenario = adjusted(load(rig), assignments)
    flat = flat_of(scenario)
    result = steady(flat, conditions(scenario, flat))
    found = {
        "schema": "gearheat.steady/1",
        "rig": scenario.name,
        "plot": plot and str(plot),
        **point_of(flat, result),
        "unchecked": unchecked(scenario, flat),
    }
    if plot is not None:
        _plot_heat(scenario, flat, result, plot)
    first = None if everything else first_of(scenario, flat)
    answer(found, json, lambda: print_point(f"{scenario.name}: steady state", flat, found, first))


def _plot_heat(scenario: Scenario, flat: FlatModel, result: Result, plot: Path) -> None:
    """Draw where the heat of a steady state comes from and where it goes."""
    from ..show.plotting import plotted
    from ..show.sankey import heat_picture

    assembly = assemble(scenario.spec)
    told = flatten(assembly, flows=heat_flows(assembly))
    guess = {q.name: float(result[q.name][0]) for q in flat.states}
    there = steady(told, conditions(scenario, told), guess=guess)
    values = {name: float(column[0]) for name, column in there.columns.items()}
    plotted(plot, heat_picture(scenario.name, heat_paths(assembly, values), values))
    note(f"wrote {plot}")


def conditions(scenario: Scenario, flat: FlatModel) -> dict[str, float]:
    """The inputs that the scenario gives, as the model has them, to be named in messages."""
    return {q.name: q.start for q in flat.inputs if q.name in scenario.operating_point}


def point_of(flat: FlatModel, result: Result) -> dict[str, Any]:
    """A steady result as an object: values by path in the units shown to a person, and how far it can be trusted."""
    return {
        "values": {name: from_si(float(column[0]), result.units[name]) for name, column in result.columns.items()},
        "units": {name: shown(unit) for name, unit in result.units.items()},
        "inputs": [q.name for q in flat.inputs],
        "states": [q.name for q in flat.states],
        "energy_residual": result.audit.residual,
        "outside": outside_of(result),
        "laws": list(result.laws),
    }


def outside_of(result: Result) -> list[dict[str, Any]]:
    """The laws a result used outside their range."""
    return [
        {
            "part": o.component,
            "law": o.law,
            "argument": o.argument,
            "range": [o.low, o.high],
            "met": [o.lowest, o.highest],
            "regime": o.regime,
        }
        for o in result.outside
    ]


def first_of(scenario: Scenario, flat: FlatModel) -> set[str]:
    """What a first answer holds of a point: states, what is given, shafts, losses, heat to rooms, efficiencies."""
    told = {q.name for q in flat.states} | set(scenario.operating_point) | scenario.shaft_paths()
    told |= {f"{room}.Q_flow" for room in scenario.spec.of_type("Room")}
    return told | {q.name for q in flat.outputs if q.name.rpartition(".")[2].startswith(("P_loss", "eta"))}


def print_point(title: str, flat: FlatModel, found: Mapping[str, Any], first: Container[str] | None = None) -> None:
    """Print a steady state.

    Args:
        title: above it
        flat: the model
        found: the state, as `point_of` gives it
        first: the values that are printed; all if None
    """
    told = [n for n in found["values"] if first is None or n in first]
    table(title, HEAD, [[n, found["values"][n], found["units"][n], flat.quantity(n).doc] for n in told])
    if more := len(found["values"]) - len(told):
        say(f"{more} more values with --all")
    say(f"power balance closed within {found['energy_residual']:.1e} of the throughput")
    tell_outside(found["outside"])
    print_unchecked(found["unchecked"])


def tell_outside(outside: Sequence[Mapping[str, Any]]) -> None:
    """Print a line for each law that was used outside its range, as `outside_of` lists them."""
    for o in outside:
        (least, most), (low, high) = o["met"], o["range"]
        met = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        there = f": {o['regime']}" if o["regime"] else ""
        say(f"outside its range: {o['part']}: {o['law']}, {o['argument']} = {met} (valid {low:g} to {high:g}){there}")
