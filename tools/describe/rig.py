"""What is shipped, and what a rig consists of: the commands `list` and `show`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from ...model.core.declare import Choice, Parameter, declared
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import SolveError
from ...model.run.result import Result
from ...model.run.steady import steady
from ...model.sources import LawInfo, sources
from ...model.units import from_si, in_unit, shown, text
from ...scenarios.load import load
from ...scenarios.scenario import Scenario
from ..show.console import answer, say, table
from ..show.stacked import stacked
from ..solve.settings import flat_of
from ..solve.steady import conditions, outside_of, tell_outside
from ..solve.unchecked import print_unchecked, unchecked
from .overview import print_overview

#: SI units of what everyone reads in degC and rpm, however it is written.
TEMPERATURE_AND_SPEED = ("K", "rad/s")


def show_command(rig: str, errata: bool, json: str | None, everything: bool = False) -> None:
    """What a rig is, or everything its file says, parameters in the units of the file; in JSON in those of all, too."""
    scenario = load(rig)
    flat, types = flat_of(scenario), scenario.spec.types
    rest, no_steady_state = _at_the_operating_point(scenario, flat)
    found = {
        "schema": "gearheat.show/1",
        "rig": scenario.name,
        "doc": scenario.doc,
        "reproduces": scenario.reproduces,
        "kind": scenario.kind,
        "parts": [{"name": p.name, "type": p.type, "doc": _doc(types[p.type])} for p in scenario.spec.parts],
        "parameters": [_parameter(scenario, flat, q) for q in every_parameter(scenario, flat)],
        "choices": choices(scenario),
        "inputs": [{**_line(q), "source": source_of(scenario, q.name)} for q in flat.inputs],
        "states": [_line(q) for q in flat.states],
        "outputs": [_output(q) for q in flat.outputs if q.name not in flat.derived],
        "sensors": dict(scenario.sensors),
        "laws": laws(flat),
        "outside": outside_of(rest) if rest is not None else [],
        "no_steady_state": no_steady_state,
        "unchecked": unchecked(scenario, flat),
        "errata": errata_of(scenario),
    }

    def human() -> None:
        if errata:
            _print_errata(found)
        else:
            _print(found, None if everything else lambda: print_overview(scenario, flat, found, rest))

    answer(found, json, human)


def _at_the_operating_point(scenario: Scenario, flat: FlatModel) -> tuple[Result | None, list[str]]:
    """Where the rig is at rest with its surroundings, or why there is no such point."""
    try:
        return steady(flat, conditions(scenario, flat)), []
    except SolveError as error:
        return None, list(error.problems)


def source_of(scenario: Scenario, path: str) -> str:
    """Where the value of a path is from: a source, or what the part itself says where no file gives it."""
    if path in scenario.value_sources:
        return scenario.value_sources[path]
    part, _, key = path.rpartition(".")
    parameter = declared(scenario.spec.types[scenario.spec.part(part).type], Parameter).get(key)
    return "follows from the other values" if parameter is not None and parameter.derived else "default"


def parameters(scenario: Scenario, flat: FlatModel) -> tuple[tuple[str, str, str], ...]:
    """Name, value with unit and source of every parameter."""
    every = every_parameter(scenario, flat)
    return tuple((q.name, text(q.start, q.unit), source_of(scenario, q.name)) for q in every)


def every_parameter(scenario: Scenario, flat: FlatModel) -> list[Quantity]:
    """All parameters, those that follow from others among them, part by part."""
    order = {part.name: i for i, part in enumerate(scenario.spec.parts)}
    every = (*flat.parameters, *(flat.quantity(name) for name in flat.derived))
    return sorted(every, key=lambda q: order[q.name.rpartition(".")[0]])


def choices(scenario: Scenario) -> list[dict[str, Any]]:
    """The structural choices of all parts, with what is chosen."""
    found = []
    for part in scenario.spec.parts:
        for key, choice in declared(scenario.spec.types[part.type], Choice).items():
            value = part.values.get(key, choice.default)
            value = str(value) if choice.also is not None and isinstance(value, choice.also) else value
            found.append({"name": f"{part.name}.{key}", "value": value, "options": choice.options, "doc": choice.doc})
    return found


def cited(flat: FlatModel) -> tuple[LawInfo, ...]:
    """The laws a model uses, each once."""
    return tuple({(law.name, law.source, law.where): law for law in flat.laws}.values())


def laws(flat: FlatModel) -> list[dict[str, Any]]:
    """The laws a model uses with what they cite, and whether a golden row from print verifies them."""
    known = sources()
    return [
        {
            "law": law.name,
            "source": known[law.source].cited,
            "where": law.where,
            "valid": law.valid,
            "verified": law.verified,
        }
        for law in cited(flat)
    ]


def errata_of(scenario: Scenario) -> list[dict[str, str]]:
    """The places where the rig's sources are wrong."""
    return [
        {"place": e.place, "says": e.says, "should_be": e.should_be, "evidence": e.evidence} for e in scenario.errata
    ]


def _line(q: Quantity) -> dict[str, Any]:
    return {"name": q.name, "value": from_si(q.start, q.unit), "unit": shown(q.unit), "doc": q.doc}


def _output(q: Quantity) -> dict[str, Any]:
    return {"name": q.name, "unit": shown(q.unit), "doc": q.doc}


def _kind(scenario: Scenario, flat: FlatModel, path: str) -> str:
    """Whether a value is given, derived from others, or a default of the numerics."""
    if path in flat.derived:
        return "derived"
    part, _, key = path.rpartition(".")
    return "given" if key in scenario.spec.part(part).values else "default"


def _parameter(scenario: Scenario, flat: FlatModel, q: Quantity) -> dict[str, Any]:
    """A parameter with its standard uncertainty, in the unit shown, where the rig states one."""
    sd = scenario.standard_uncertainties.get(q.name)
    known = sd if sd is None or q.unit == "K" else from_si(sd, q.unit)  # degC and K have the same differences
    kind, source = _kind(scenario, flat, q.name), source_of(scenario, q.name)
    own = q.name.rpartition(".")[0] + "."
    if follows := ", ".join(path.removeprefix(own) for path in flat.derived.get(q.name, ())):
        source = f"follows from {follows}"
    unit = scenario.units.get(q.name, "") if q.unit not in TEMPERATURE_AND_SPEED else ""
    written = [in_unit(v, unit) if unit and v is not None else v for v in (q.start, sd)]
    as_written = {"value": written[0], "uncertainty": written[1], "unit": unit} if unit else None
    return {**_line(q), "kind": kind, "uncertainty": known, "source": source, "written": as_written}


def _doc(cls: type) -> str:
    return (cls.__doc__ or "").strip().splitlines()[0]


def _print(found: dict[str, Any], short: Callable[[], None] | None) -> None:
    """Print the rig: in short, or everything."""
    say(f"{found['rig']}: {found['doc']}\n")
    if found["reproduces"]:
        say(f"Reproduces: {found['reproduces']}\n")
    (short or partial(_print_everything, found))()
    tell_outside(found["outside"])
    for problem in found["no_steady_state"]:
        say(f"no steady state at the operating point: {problem}")
    print_unchecked(found["unchecked"])
    if found["errata"]:
        say(f"{len(found['errata'])} corrections to the sources: gearheat show {found['rig']} --errata")


def _print_everything(found: dict[str, Any]) -> None:
    valued = ("name", "value", "unit", "doc")
    stacked("Parts", ("name", "type", "doc"), _rows(found["parts"], ("name", "type", "doc")), 1)
    known = ("name", "value", "kind", "uncertainty", "unit", "doc", "source")
    stacked("Parameters", known, _rows([{**p, **(p["written"] or {})} for p in found["parameters"]], known), 2)
    stacked("Choices", ("name", "value", "doc"), _rows(found["choices"], ("name", "value", "doc")), 1)
    stacked("Inputs", (*valued, "source"), _rows(found["inputs"], (*valued, "source")), 2)
    stacked("States (with start value)", valued, _rows(found["states"], valued), 1)
    stacked("Outputs", ("name", "unit", "doc"), _rows(found["outputs"], ("name", "unit", "doc")), 1)
    keys = ("law", "verified", "where", "valid", "source")
    stacked("Laws", keys, _rows(found["laws"], keys), 3)


def _print_errata(found: dict[str, Any]) -> None:
    keys = ("place", "says", "should_be", "evidence")
    if not found["errata"]:
        say(f"{found['rig']}: no corrections to its sources are known.")
        return
    table(
        f"{found['rig']}: corrections to the sources",
        ("place", "says", "should be", "evidence"),
        _rows(found["errata"], keys),
    )


def _rows(lines: Iterable[dict[str, Any]], keys: tuple[str, ...]) -> list[list[Any]]:
    return [[line[key] for key in keys] for line in lines]
