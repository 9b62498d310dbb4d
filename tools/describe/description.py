"""What a rig consists of, how it is driven, and which parameters matter most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.core.declare import Choice, Parameter, list_declared
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import SolveError
from ...model.parts.ports import Flange, HeatPort
from ...model.run.result import Result
from ...model.run.search import sensitivities
from ...model.run.steady import steady
from ...model.sources import LawInfo
from ...model.units import from_si, in_unit, show_unit, text
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.scenario import Scenario
from ..show.console import cell
from ..show.display import Answer
from ..show.picture import Picture
from ..solve.settings import find_unchecked, flat_of
from ..solve.steady import conditions, leading_outputs, outside_of
from .parts import first_line, law_line

#: SI units of what everyone reads in degC and rpm, however it is written.
TEMPERATURE_AND_SPEED = ("K", "rad/s")
#: Number of parameters in the table.
FIRST = 12
#: Share of its value by which each is changed [1].
SHARE = 0.1
#: Below this share of the largest effect of all a parameter does not matter.
LEAST = 1e-2


@dataclass(frozen=True, eq=False, repr=False)
class Description(Answer):
    """What a rig is.

    Attributes:
        scenario: the rig
        flat: its model
        rest: its steady state at the operating point, where there is one
    """

    scenario: Scenario
    flat: FlatModel
    rest: Result | None

    def drawing(self) -> Picture:
        """The machine: its shafts, teeth, bearings, seals, oil and housing, in the colours of its temperatures."""
        from ..show.machine import end_words, machine_picture

        bodies = self.flat.bodies if self.rest is not None else ()
        values = {name: float(c[0]) for name, c in self.rest.columns.items()} if self.rest is not None else {}
        return machine_picture(
            self.scenario.spec.assembly(),
            self.scenario.entries,
            {name.removesuffix(".T"): values[name] for name in bodies if name in values},
            self.scenario.name,
            end_words(self.scenario.spec.of_type("ShaftEnd"), values),
        )

    def effects(self) -> tuple[str, Sequence[str], list[list[Any]]] | None:
        """Title, head and rows of the parameters that matter most; None without a steady state or an effect."""
        if self.rest is None:
            return None
        return _effects_table(self.scenario, self.flat, self.found["parameters"], self.rest)

    @property
    def main_outputs(self) -> list[str]:
        """Oil temperature, losses, efficiencies and the heat to the rooms, as far as they are no states."""
        rooms = [f"{name}.Q_flow" for name in self.scenario.spec.of_type("Room")]
        states = {q.name for q in self.flat.states}
        names = (*leading_outputs(self.scenario), *rooms)
        return [name for name in names if name in self.flat.index and name not in states]


def show(rig: RigLike) -> Description:
    """What a rig is made of: parts, parameters with sources, inputs, states, outputs, laws, errata.

    Args:
        rig: name, file or rig

    Raises:
        ScenarioError: all that is wrong with the rig

    Example:
        >>> import gearheat as gh
        >>> len(gh.show("planetary").found["errata"]) > 0
        True
    """
    scenario = scenario_of(rig)
    flat, types = flat_of(scenario), scenario.spec.types
    rest, no_steady_state = _at_the_operating_point(scenario, flat)
    found: dict[str, Any] = {
        "schema": "gearheat.show/1",
        "rig": scenario.name,
        "doc": scenario.doc,
        "reproduces": scenario.reproduces,
        "kind": scenario.kind,
        "parts": [{"name": p.name, "type": p.type, "doc": first_line(types[p.type])} for p in scenario.spec.parts],
        "parameters": [_parameter(scenario, flat, q) for q in every_parameter(scenario, flat)],
        "choices": choices(scenario),
        "inputs": [{**_line(q), "source": source_of(scenario, q.name)} for q in flat.inputs],
        "states": [_line(q) for q in flat.states],
        "outputs": [
            {"name": q.name, "unit": show_unit(q.unit), "doc": q.doc}
            for q in flat.outputs
            if q.name not in flat.derived
        ],
        "sensors": dict(scenario.sensors),
        "laws": laws(flat),
        "outside": outside_of(rest) if rest is not None else [],
        "no_steady_state": no_steady_state,
        "unchecked": find_unchecked(scenario, flat),
        "errata": [e.model_dump() for e in scenario.errata],
    }
    head = ("name", "value", "unit", "doc", "source")
    lines = [{**p, **(p["written"] or {})} for p in found["parameters"]]
    shown = head, [[line[key] for key in head] for line in lines]
    return Description(found, scenario, flat, rest, heading=f"{scenario.name}: {scenario.doc}", shown=shown)


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
    parameter = list_declared(scenario.spec.types[scenario.spec.part(part).type], Parameter).get(key)
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
        for key, choice in list_declared(scenario.spec.types[part.type], Choice).items():
            value = part.values.get(key, choice.default)
            value = str(value) if choice.also is not None and isinstance(value, choice.also) else value
            found.append({"name": f"{part.name}.{key}", "value": value, "options": choice.options, "doc": choice.doc})
    return found


def cite_laws(flat: FlatModel) -> tuple[LawInfo, ...]:
    """The laws a model uses, each once."""
    return tuple({(law.name, law.source, law.where): law for law in flat.laws}.values())


def laws(flat: FlatModel) -> list[dict[str, Any]]:
    """The laws a model uses with what they cite, and whether a golden row from print verifies them."""
    return [{**law_line(law), "verified": law.verified} for law in cite_laws(flat)]


def _line(q: Quantity) -> dict[str, Any]:
    return {"name": q.name, "value": from_si(q.start, q.unit), "unit": show_unit(q.unit), "doc": q.doc}


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


def _effects_table(
    scenario: Scenario, flat: FlatModel, parameters: Sequence[Mapping[str, Any]], rest: Result
) -> tuple[str, Sequence[str], list[list[Any]]] | None:
    """Title, head and rows of the parameters that change oil temperature and loss the most, None where none does."""
    of = [name for name in leading_outputs(scenario) if name in flat.index and not name.endswith(".eta")][:2]
    ranked = _effects(scenario, flat, of, parameters, rest)
    if not ranked:
        return None
    units = [flat.quantity(name).unit for name in of]
    body = []
    for line, changes in ranked:
        own = {**line, **(line["written"] or {})}
        shows = [c if unit == "K" else from_si(c, unit) for c, unit in zip(changes, units, strict=True)]
        body.append([own["name"], own["value"], own["unit"], *map(_format_change, shows), own["doc"], own["source"]])
    keys = [name.rpartition(".")[2] for name in of]
    heads = [f"{key} [{unit if unit == 'K' else show_unit(unit)}]" for key, unit in zip(keys, units, strict=True)]
    title = f"Parameters that matter most: what {100 * SHARE:g} % more of each does to {' and '.join(of)}"
    return title, ("name", "value", "unit", *heads, "doc", "source"), body


def _effects(
    scenario: Scenario, flat: FlatModel, of: Sequence[str], parameters: Sequence[Mapping[str, Any]], rest: Result
) -> list[tuple[Mapping[str, Any], list[float]]]:
    """The parameters with the largest effect on some states or outputs, and what each changes in SI.

    Those that the rig gives and that are no temperatures. Left out is what the drawing fixes: numbers of things, and
    lengths and angles of all parts but those that only carry heat.
    """
    thermal = {p.name for p in scenario.spec.parts if _thermal(scenario.spec.types[p.type])}
    own = {line["name"]: line for line in parameters if line["kind"] == "given"}
    free = [q for q in flat.parameters if q.name in own and q.unit != "K" and not q.whole]
    free = [q for q in free if q.unit not in ("m", "rad") or q.name.rpartition(".")[0] in thermal]
    if not free or not of:
        return []
    guess = {q.name: float(rest[q.name][0]) for q in flat.states}
    try:
        slopes = sensitivities(flat, of, [q.name for q in free], conditions(scenario, flat), guess=guess)
    except (SolveError, np.linalg.LinAlgError):
        return []
    change = SHARE * slopes * np.array([q.start for q in free])
    place = {q.name: k for k, q in enumerate(free)}
    for path, followed in reversed(list(scenario.references.items())):  # what follows moves with what it refers to
        if path in place and followed in place:
            change[:, place[followed]] += change[:, place[path]]
    largest = np.abs(change).max(axis=1, keepdims=True)
    weight = (np.abs(change) / np.where(largest > 0, largest, 1.0)).max(axis=0)
    order = sorted((k for k in range(len(free)) if weight[k] > LEAST), key=lambda k: (-float(f"{weight[k]:.6g}"), k))
    return [(own[free[k].name], [float(c) for c in change[:, k]]) for k in order[:FIRST]]


def _thermal(cls: type) -> bool:
    return bool(list_declared(cls, HeatPort)) and not list_declared(cls, Flange)


def _format_change(value: float) -> str:
    return f"+{cell(value)}" if value > 0 else cell(value)
