"""What a user sets and frees on the command line, turned into a scenario that is driven accordingly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...fmu.equations import effective
from ...model.core.declare import Choice, Parameter, list_declared
from ...model.core.flat import FlatModel
from ...model.errors import GearheatError, Problems, ScenarioError, suggestion
from ...model.laws.film_map import FilmMap
from ...model.machines.spec import Spec
from ...scenarios.film_map import find_map, names_map
from ...scenarios.given import Settings, assignments_of
from ...scenarios.housing import oil_problems
from ...scenarios.scenario import DRIVES, Scenario, check_drives, parse_assignments
from ...scenarios.write import SET

Drive = Mapping[str, tuple[str, ...]]


def adjust(
    scenario: Scenario,
    assignments: Settings = (),
    *,
    named: Iterable[str] = (),
    drive: Drive | None = None,
) -> Scenario:
    """The scenario with values set by the user, driven at the shaft ends as the names say.

    A shaft speed that is set or named takes the place of the rig's given speed, a torque that of its given torque. A
    parameter that follows from others and is set or named has a value of its own from then on, at first the one it had.

    Args:
        scenario: the rig
        assignments: values by name, or texts "NAME=VALUE": parameters, inputs, start values of states, choices
            ("gear_set.power_flow=ideal"), the end that "drives", and parts filled from a catalogue ("oil=MINR")
        named: further values that come from outside: sought by a design, varied by a sweep, or given by a duty
        drive: quantities given per shaft end, where that is known

    Raises:
        ScenarioError: all problems of all assignments at once
    """
    assignments = assignments_of(assignments, scenario.settable)
    for end in [text.partition("=")[2].strip() for text in assignments if _name(text) == DRIVES]:
        check_drives(f"{scenario.name}: {DRIVES}", end, scenario.spec.of_type("ShaftEnd"))
        scenario = replace(scenario, drives=end)
    choices, problems = _choices(scenario.spec, assignments)
    names = [_name(text) for text in assignments]
    twice = [name for name in dict.fromkeys(names) if name and names.count(name) > 1]
    problems += [f'"{name}" is set twice. Set it once.' for name in twice]
    values, others = dict[str, float](), {DRIVES, *choice_paths(scenario.spec)}
    with problems:
        values = parse_assignments(scenario, (a for a in assignments if _name(a) not in others))
    problems.check()
    shafts = scenario.shaft_paths()
    ends = [name for name in dict.fromkeys((*values, *named)) if name in shafts]
    driven = scenario.deduced_drive(ends) if drive is None else drive
    if idle := [name for name in ends if name.rpartition(".")[2] not in driven.get(name.rpartition(".")[0], ())]:
        raise ScenarioError([f"{name} is set, but it follows from what drives the rig. Take it out." for name in idle])
    set_up = scenario.with_values(values, SET).driven(driven)
    sources = {**set_up.value_sources, **_list_filled_sources(scenario, assignments)}
    entries = filled_from(scenario, assignments)
    set_up = replace(set_up, spec=set_up.spec.with_values(choices), value_sources=sources, entries=entries)
    Problems(oil_problems(set_up.spec)).check()
    return set_up.with_values(_derive_values(set_up.spec, named), SET)


def refuse_given(assignments: Settings, given: Iterable[str], duty: str) -> None:
    """Refuse what is set where a duty gives it over time.

    Args:
        assignments: values by name, or texts "NAME=VALUE"
        given: names in the header of the duty
        duty: its name

    Raises:
        ScenarioError: one problem for each such name
    """
    both = names_set(assignments) & set(given)
    Problems(f"{name} is set, and {duty} gives it over time. Take one of them out." for name in sorted(both)).check()


def flat_of(scenario: Scenario) -> FlatModel:
    """The flat model of a scenario."""
    return scenario.spec.flat()


def drive_at(scenario: Scenario, shaft: str | None, given: str) -> dict[str, tuple[str, ...]]:
    """The drive of an FMU.

    Args:
        scenario: the rig
        shaft: the shaft end that drives; the rig's own if None
        given: "speed": speed and torque of that shaft; "torque": the torques of all shaft ends

    Raises:
        ScenarioError: the rig has no such shaft end, neither is given
    """
    if given not in ("speed", "torque"):
        raise ScenarioError(f'given = "{given}" is neither "speed" nor "torque". Give one of them.')
    ends = scenario.spec.of_type("ShaftEnd")
    if shaft is not None and shaft not in ends:
        raise ScenarioError(
            f'{scenario.name}: "{shaft}" is no shaft end.{suggestion(shaft, ends)} Shaft ends: {", ".join(ends)}.'
        )
    if given == "torque":
        return {end: ("tau",) for end in ends}
    return dict(scenario.given) if shaft is None else {shaft: ("w", "tau")}


def choice_paths(spec: Spec) -> dict[str, Choice]:
    """Choices of all parts by path; those without options follow from the drive."""
    found = {f"{p.name}.{key}": c for p in spec.parts for key, c in list_declared(spec.types[p.type], Choice).items()}
    return {path: choice for path, choice in found.items() if choice.options}


def _derive_values(spec: Spec, named: Iterable[str]) -> dict[str, float]:
    """The values that named parameters have which follow from others."""
    following = [name for name in named if (d := parameter_of(spec, name)) is not None and d.derived is not None]
    if not following:
        return {}
    parts = {part.name: part for part in spec.assembly().parts}
    split = [(name, *name.rpartition(".")[::2]) for name in following]
    return {name: parts[part].values[key] for name, part, key in split if key in parts[part].derived}


def parameter_of(spec: Spec, path: str) -> Parameter | None:
    """The declaration of the parameter of a path, None where there is none."""
    part, _, key = path.rpartition(".")
    kinds = [p.type for p in spec.parts if p.name == part]
    return list_declared(spec.types[kinds[0]], Parameter).get(key) if kinds else None


def _choices(spec: Spec, assignments: Iterable[str]) -> tuple[dict[str, Any], Problems]:
    """The choices among the assignments, and what is wrong with them."""
    known = choice_paths(spec)
    values: dict[str, Any] = {}
    problems = Problems()
    for text in assignments:
        if (path := _name(text)) not in known:
            continue
        options = {str(option).lower(): option for option in known[path].options}
        written = text.partition("=")[2].strip()
        if written.lower() in options:
            values[path] = options[written.lower()]
        elif known[path].also is FilmMap and names_map(written):
            try:
                values[path] = find_map(written, Path())
            except GearheatError as error:
                problems += [f"{path}: {problem}" for problem in error.problems]
        else:
            close = suggestion(written.lower(), options)
            problems.append(f'{path} = "{written}" is not known.{close} Choose one of: {", ".join(options)}.')
    return values, problems


def _list_filled_sources(scenario: Scenario, assignments: Sequence[str]) -> dict[str, str]:
    """Sources of the values that parts filled from a catalogue have, but for those that are set one by one."""
    parts = {part.name for part in scenario.spec.parts}
    single = {_name(text) for text in assignments}
    found: dict[str, str] = {}
    for text in assignments:
        if (part := _name(text)) in parts:
            found |= scenario.entry_sources(part, text.partition("=")[2].strip(), SET)
    return {path: source for path, source in found.items() if path not in single}


def filled_from(scenario: Scenario, assignments: Sequence[str]) -> dict[str, Mapping[str, str]]:
    """Part -> kind of catalogue -> name of the entry it is filled from, with those that are set."""
    split = [(part.strip(), name.strip()) for part, _, name in (text.partition("=") for text in assignments)]
    set_ = {part: scenario.entry(part, name) for part, name in split if part in scenario.types}
    told = {part: {**scenario.entries.get(part, {}), found.kind: found.name} for part, found in set_.items()}
    return {**scenario.entries, **told}


def names_set(assignments: Settings) -> set[str]:
    """The names of what is set."""
    return {_name(text) for text in assignments_of(assignments, dict)}


def _name(assignment: str) -> str:
    return assignment.partition("=")[0].strip()


def find_unchecked(scenario: Scenario, flat: FlatModel, filled: Iterable[tuple[str, str]] = ()) -> list[dict[str, Any]]:
    """Catalogue entries in use with values that were never checked against a print; values without effect left out.

    Args:
        scenario: the rig as set
        flat: its model
        filled: part and name of further entries that a run fills parts with, such as the oils of a campaign
    """
    acting = {q.name for q in effective(flat).parameters}
    found = {entry: [p for p in paths if p in acting] for entry, paths in scenario.unchecked(filled).items()}
    return [{"catalogue": kind, "entry": name, "values": paths} for (kind, name), paths in found.items() if paths]
