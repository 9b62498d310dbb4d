"""The commands `steady` and `design`: one operating point, and what would have to change for another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..model.core.declare import Port, State, declared
from ..model.core.flat import FlatModel
from ..model.core.flatten import flatten
from ..model.errors import GearheatError, ScenarioError, SolveError
from ..model.machines.spec import assemble
from ..model.run.design import Design, design
from ..model.run.result import Result
from ..model.run.steady import steady
from ..model.units import from_si, shown
from ..scenarios.scenario import Scenario, parse_assignments
from .console import answer, plottable, table
from .heat_paths import heat_flows, heat_paths
from .rigs import load
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


def steady_command(rig: str, assignments: Sequence[str], json: str | None, *, plot: Path | None = None) -> None:
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
    answer(found, json, lambda: _print(f"{scenario.name}: steady state", flat, found))


def _plot_heat(scenario: Scenario, flat: FlatModel, result: Result, plot: Path) -> None:
    """Draw where the heat of a steady state comes from and where it goes."""
    from .plotting import plotted
    from .sankey import heat_picture

    assembly = assemble(scenario.spec)
    told = flatten(assembly, flows=heat_flows(assembly))
    guess = {q.name: float(result[q.name][0]) for q in flat.states}
    there = steady(told, conditions(scenario, told), guess=guess)
    values = {name: float(column[0]) for name, column in there.columns.items()}
    plotted(plot, heat_picture(scenario.name, heat_paths(assembly, values), values))


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


def design_command(
    rig: str,
    free: Sequence[str],
    targets: Sequence[str],
    assignments: Sequence[str],
    among: Sequence[str],
    json: str | None,
) -> None:
    """Values of the freed names at which the targets hold, for each alternative of `among` where there is one."""
    scenario = load(rig)
    part, names = _alternatives(among)
    found: dict[str, Any] = {"schema": "gearheat.design/1", "rig": scenario.name}
    if part is None:
        setting, flat, solution = _design(scenario, free, targets, assignments)
        found |= {**_solution(flat, solution), "unchecked": unchecked(setting, flat)}
        answer(found, json, lambda: _print_design(flat, found))
        return
    found |= {"among": part, "alternatives": []}
    for name in names:
        try:
            setting, flat, solution = _design(scenario, free, targets, [*assignments, f"{part}={name}"])
            told = unchecked(setting, flat)
            found["alternatives"].append({part: name, **_solution(flat, solution), "unchecked": told})
        except SolveError as error:
            found["alternatives"].append({part: name, "problems": list(error.problems)})
    if all("problems" in a for a in found["alternatives"]):
        raise SolveError([f"{part} = {a[part]}: {p}" for a in found["alternatives"] for p in a["problems"]])
    answer(found, json, lambda: _print_alternatives(found))


def _alternatives(among: Sequence[str]) -> tuple[str | None, list[str]]:
    """Part and catalogue names of texts such as "oil=PAOR,MINR"."""
    if not among:
        return None, []
    if len(among) > 1:
        raise ScenarioError("--among can be given once. Write all names behind it, for example oil=PAOR,MINR,PAGD.")
    part, _, text = among[0].partition("=")
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not part.strip() or not names:
        raise ScenarioError(f'"{among[0]}" names no alternatives. Write for example oil=PAOR,MINR,PAGD.')
    return part.strip(), names


def _design(
    scenario: Scenario, free: Sequence[str], targets: Sequence[str], assignments: Sequence[str]
) -> tuple[Scenario, FlatModel, Design]:
    """The scenario of one design, its model and the solution, with the problems of everything given at once."""
    problems: list[str] = []
    setting = scenario
    try:
        setting = adjusted(scenario, assignments, named=free)
    except GearheatError as error:
        problems += error.problems
    flat = flat_of(setting)
    aims: dict[str, float] = {}
    try:
        aims = parse_assignments(flat, targets)
    except GearheatError as error:
        problems += error.problems
    for name in free:
        try:
            flat.locate(name)
        except GearheatError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    return setting, flat, design(flat, free, aims, conditions(setting, flat))


def _solution(flat: FlatModel, solution: Design) -> dict[str, Any]:
    def size(name: str) -> float:
        unit = flat.quantity(name).unit
        return from_si(1.0, unit) - from_si(0.0, unit)

    slopes = {
        name: {
            target: float(solution.sensitivity[i, k]) * size(name) / size(target)
            for k, target in enumerate(solution.targets)
        }
        for i, name in enumerate(solution.values)
    }
    point = point_of(flat, solution.result)
    units = {name: shown(flat.quantity(name).unit) for name in (*solution.values, *solution.targets)}
    return {
        "free": {name: from_si(value, flat.quantity(name).unit) for name, value in solution.values.items()},
        "targets": {name: point["values"][name] for name in solution.targets},
        "sensitivity": slopes,
        "condition": solution.condition,
        "notes": list(solution.notes),
        **point,
        "units": point["units"] | units,
    }


def _print(title: str, flat: FlatModel, found: Mapping[str, Any]) -> None:
    body = [[n, v, found["units"][n], flat.quantity(n).doc] for n, v in found["values"].items()]
    table(title, HEAD, body)
    print(f"power balance closed within {found['energy_residual']:.1e} of the throughput")
    tell_outside(found["outside"])
    print_unchecked(found["unchecked"])


def tell_outside(outside: Sequence[Mapping[str, Any]]) -> None:
    """Print a line for each law that was used outside its range, as `outside_of` lists them."""
    for o in outside:
        (least, most), (low, high) = o["met"], o["range"]
        met = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        there = f": {o['regime']}" if o["regime"] else ""
        print(f"outside its range: {o['part']}: {o['law']}, {o['argument']} = {met} (valid {low:g} to {high:g}){there}")


def _print_design(flat: FlatModel, found: Mapping[str, Any]) -> None:
    body = [[n, v, found["units"][n], flat.quantity(n).doc] for n, v in found["free"].items()]
    table(f"{found['rig']}: found", HEAD, body)
    aims = found["targets"]
    units = found["units"]
    slopes = [[n, *(found["sensitivity"][n][t] for t in aims)] for n in found["free"]]
    if slopes:
        head = ("change of", *(f"per {units[t] if units[t] != 'degC' else 'K'} of {t}" for t in aims))
        table("Sensitivity", head, slopes)
    for note in found["notes"]:
        print(note)
    _print(f"{found['rig']}: steady state there", flat, found)


def _print_alternatives(found: Mapping[str, Any]) -> None:
    part = found["among"]
    solved = [a for a in found["alternatives"] if "problems" not in a]
    names = [*solved[0]["free"], *solved[0]["targets"]]
    head = (part, *(f"{name} [{solved[0]['units'][name]}]" for name in names))
    table(
        f"{found['rig']}: alternatives",
        head,
        [[a[part], *(a["values"].get(n, a["free"].get(n)) for n in names)] for a in solved],
    )
    for alternative in solved:
        if alternative["outside"]:
            print(f"{part} = {alternative[part]}:")
            tell_outside(alternative["outside"])
    for alternative in found["alternatives"]:
        for problem in alternative.get("problems", ()):
            print(f"{part} = {alternative[part]}: {problem}")
    print_unchecked({line["entry"]: line for a in solved for line in a["unchecked"]}.values())
