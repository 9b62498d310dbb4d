"""The command `design`: what would have to change for an output to be as asked, and which alternative is best."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from ...model.core.flat import FlatModel
from ...model.errors import GearheatError, ScenarioError, SolveError
from ...model.run.design import Design
from ...model.run.least import Target, least_change, rank, unchanged
from ...model.units import from_si, shown
from ...scenarios.load import load
from ...scenarios.scenario import Scenario, parse_assignments
from ..show.console import answer, say, table
from .settings import adjusted, flat_of
from .steady import HEAD, conditions, first_of, point_of, print_point, tell_outside
from .unchecked import print_unchecked, unchecked

#: Name of all entries of a catalogue that fit.
ALL = "all"


@dataclass(frozen=True)
class _Case:
    """A rig as set, its model, and what is asked of it; `own` are values in the place of the model's."""

    setting: Scenario
    flat: FlatModel
    targets: tuple[Target, ...]
    free: tuple[str, ...]
    own: Mapping[str, float] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, float]:
        """What the search starts from: the inputs given, and the model's own values of what is free."""
        own = {name: self.flat.quantity(name).start for name in self.free}
        return {**own, **conditions(self.setting, self.flat), **self.own}

    def filled(self, part: str, name: str) -> _Case | None:
        """The same with a part filled from another entry, where that changes no more than parameters of the model."""
        own = self.setting.entry_values(part, name)
        if any(self.flat.index.get(path, ("", 0))[0] != "parameter" for path in own):
            return None
        return replace(self, setting=adjusted(self.setting, [f"{part}={name}"], named=self.free), own=own)


def design_command(
    rig: str,
    free: Sequence[str],
    targets: Sequence[str],
    assignments: Sequence[str],
    among: Sequence[str],
    json: str | None,
    *,
    everything: bool = False,
) -> None:
    """Values of the freed names at which the targets hold, for each alternative of `among` where there is one."""
    scenario = load(rig)
    part, names = _alternatives(scenario, among)
    found: dict[str, Any] = {"schema": "gearheat.design/1", "rig": scenario.name}
    if part is None:
        case = _case(scenario, free, targets, assignments)
        solution = least_change(case.flat, case.free, case.targets, case.values)
        found |= _solution(case, solution)
        shown_first = None if everything else first_of(case.setting, case.flat)
        answer(found, json, lambda: _print_design(case.flat, found, shown_first))
        return
    solved: list[tuple[tuple[float, ...], dict[str, Any]]] = []
    unsolved: list[dict[str, Any]] = []
    base = _case(scenario, free, targets, assignments)
    for name in names:
        case = base.filled(part, name) or _case(scenario, free, targets, [*assignments, f"{part}={name}"])
        try:
            search = least_change(case.flat, case.free, case.targets, case.values) if free else None
            solution = search or unchanged(case.flat, case.targets, case.values)
        except SolveError as error:
            unsolved.append({part: name, "problems": list(error.problems)})
            continue
        solved.append((rank(case.flat, solution, case.targets, case.values), {part: name, **_solution(case, solution)}))
    if not solved:
        raise SolveError([f"{part} = {a[part]}: {p}" for a in unsolved for p in a["problems"]])
    best_first = [told for _, told in sorted(solved, key=lambda pair: pair[0])]
    found |= {"among": part, "alternatives": [*best_first, *unsolved]}
    answer(found, json, lambda: _print_alternatives(found))


def _alternatives(scenario: Scenario, among: Sequence[str]) -> tuple[str | None, list[str]]:
    """Part and catalogue names of texts such as "oil=PAOR,MINR", or "oil=all" for every entry that fits."""
    if not among:
        return None, []
    if len(among) > 1:
        raise ScenarioError("--among can be given once. Write all names behind it, for example oil=PAOR,MINR,PAGD.")
    part, _, text = (word.strip() for word in among[0].partition("="))
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not part or not names:
        raise ScenarioError(f'"{among[0]}" names no alternatives. Write for example oil=PAOR,MINR,PAGD, or oil=all.')
    return part, list(scenario.alternatives(part)) if names == [ALL] else names


def _case(scenario: Scenario, free: Sequence[str], targets: Sequence[str], assignments: Sequence[str]) -> _Case:
    """One design, with the problems of everything given at once."""
    problems: list[str] = []
    setting = scenario
    try:
        setting = adjusted(scenario, assignments, named=free)
    except GearheatError as error:
        problems += error.problems
    flat = flat_of(setting)
    aims: list[Target] = []
    for written in targets:
        try:
            aims.append(_target(flat, written))
        except GearheatError as error:
            problems += error.problems
    for name in free:
        try:
            flat.locate(name)
        except GearheatError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    return _Case(setting, flat, tuple(aims), tuple(free))


def _target(flat: FlatModel, written: str) -> Target:
    """A target from a text such as "oil.T=80 degC" or "oil.T<80 degC"; a limit may be reached."""
    match = re.fullmatch(r"([^=<>]*)([<>]?)=?([^=<>]*)", written)
    if match is None:
        raise ScenarioError(f'--target "{written}" is no target. Write for example "oil.T=80 degC" or "oil.T<80 degC".')
    name, sign, value = match.groups()
    ((path, number),) = parse_assignments(flat, [f"{name}={value}"]).items()
    return Target(path, cast(Any, sign or "="), number)


def _solution(case: _Case, solution: Design) -> dict[str, Any]:
    flat = case.flat

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
    units = {name: shown(flat.quantity(name).unit) for name in (*solution.values, *(t.name for t in case.targets))}
    missed = rank(flat, solution, case.targets, case.values)[0]
    return {
        "free": {name: from_si(value, flat.quantity(name).unit) for name, value in solution.values.items()},
        "targets": {t.name: point["values"][t.name] for t in case.targets},
        "met": missed == 0,
        "sensitivity": slopes,
        "condition": solution.condition,
        "notes": list(solution.notes),
        **point,
        "units": point["units"] | units,
        "unchecked": unchecked(case.setting, flat),
    }


def _print_design(flat: FlatModel, found: Mapping[str, Any], first: Container[str] | None) -> None:
    units = found["units"]
    if body := [[n, v, units[n], flat.quantity(n).doc] for n, v in found["free"].items()]:
        table(f"{found['rig']}: found", HEAD, body)
        aims = next(iter(found["sensitivity"].values()))
        slopes = [[n, *found["sensitivity"][n].values()] for n in found["free"]]
        head = ("change of", *(f"per {units[t] if units[t] != 'degC' else 'K'} of {t}" for t in aims))
        table("Sensitivity", head, slopes)
    for note in found["notes"]:
        say(note)
    print_point(f"{found['rig']}: steady state there", flat, found, first)


def _print_alternatives(found: Mapping[str, Any]) -> None:
    part = found["among"]
    solved = [a for a in found["alternatives"] if "problems" not in a]
    names = list(dict.fromkeys(name for a in solved for name in (*a["targets"], *a["free"])))
    units = {name: unit for a in solved for name, unit in a["units"].items()}
    rows = [
        (a[part], "yes" if a["met"] else "no", *(a["values"].get(n, a["free"].get(n)) for n in names)) for a in solved
    ]
    head = (part, "met", *(f"{name} [{units[name]}]" for name in names))
    table(f"{found['rig']}: alternatives, the best first", head, rows)
    for alternative in solved:
        if alternative["outside"]:
            say(f"{part} = {alternative[part]}:")
            tell_outside(alternative["outside"])
    for alternative in found["alternatives"]:
        for problem in alternative.get("problems", ()):
            say(f"{part} = {alternative[part]}: {problem}")
    print_unchecked({line["entry"]: line for a in solved for line in a["unchecked"]}.values())
