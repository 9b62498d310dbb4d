"""Designs: what would have to change for an output to be as asked, and which alternative is best."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from ...model.core.flat import FlatModel, Quantity
from ...model.errors import Problems, ScenarioError, SolveError, suggestion
from ...model.run.design import Design
from ...model.run.least import Target, evaluate_unchanged, least_change, rank
from ...model.units import from_si, show_unit
from ...scenarios.given import RigLike, Settings, assignments_of, pairs_of, range_of, scenario_of, spell
from ...scenarios.scenario import Scenario, parse_assignments
from ..show.display import HEAD, Answer, Quantities
from .settings import adjust, find_unchecked, flat_of
from .steady import conditions, first_of, point_of

#: Name of all entries of a catalogue that fit.
ALL = "all"


@dataclass(frozen=True)
class _Case:
    """A rig as set, its model, and what is asked of it; `own` are values in the place of the model's."""

    setting: Scenario
    flat: FlatModel
    targets: tuple[Target, ...]
    free: tuple[str, ...]
    bounds: Mapping[str, tuple[float, float]]
    own: Mapping[str, float] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, float]:
        """What the search starts from: the inputs given, and the model's own values of what is free."""
        own = {name: self.flat.quantity(name).start for name in self.free}
        return {**own, **conditions(self.setting, self.flat), **self.own}

    def filled(self, part: str, name: str) -> _Case | None:
        """The same with a part filled from another entry, where that changes no more than parameters of the model."""
        own = self.setting.following(self.setting.entry_values(part, name))
        if any(self.flat.index.get(path, ("", 0))[0] != "parameter" for path in own):
            return None
        return replace(self, setting=adjust(self.setting, [f"{part}={name}"], named=self.free), own=own)


@dataclass(frozen=True, eq=False, repr=False)
class DesignAnswer(Quantities, Answer):
    """What has to change for outputs to be as asked, or the alternatives of a catalogue, the best first.

    Attributes:
        setting: the rig as set
        flat: its model
        state: values of free names and of the steady state there in SI; empty where alternatives were asked for
    """

    setting: Scenario
    flat: FlatModel
    state: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        """Value of a free name, a state, input or output in SI. Raises ScenarioError for an unknown name."""
        if name not in self.state:
            raise ScenarioError(f'{self.setting.name}: the design has no "{name}".{suggestion(name, self.state)}')
        return self.state[name]

    def __iter__(self) -> Iterator[str]:
        """Names of its values."""
        return iter(self.state)

    @property
    def title(self) -> str:
        """The rig and what is shown."""
        return f"{self.setting.name}: {'alternatives, the best first' if 'among' in self.found else 'design'}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Free names and targets, or a row for each alternative."""
        found = self.found
        if "among" not in found:
            return HEAD, self.rows([*found["free"], *found["targets"]])
        solved = [a for a in found["alternatives"] if "problems" not in a]
        names = list(dict.fromkeys(name for a in solved for name in (*a["targets"], *a["free"])))
        units = {name: unit for a in solved for name, unit in a["units"].items()}
        values = [(a, a["free"] | a["values"]) for a in solved]
        rows = [(a[found["among"]], "yes" if a["met"] else "no", *map(held.get, names)) for a, held in values]
        return (found["among"], "met", *(f"{name} [{units[name]}]" for name in names)), rows

    @property
    def first(self) -> list[str]:
        """What a first answer holds of the steady state."""
        return first_of(self.setting, self.flat, self.found["values"])


def design(
    rig: RigLike,
    free: str | Sequence[str] | Mapping[str, Any] = (),
    target: Settings = (),
    *,
    set: Settings = (),
    among: str | None = None,
) -> DesignAnswer:
    """Find parameters or inputs for which outputs reach their targets, for each alternative of a catalogue if asked.

    Args:
        rig: name, file or rig
        free: parameters or inputs that may change, one for each value to reach; with a range where it is bounded:
            {"cooling.A": ("0.1 m2", "2 m2")}, or "cooling.A=0.1 m2..2 m2"
        target: values to reach by name, or texts such as "oil.T=80 degC", "oil.T<80 degC"
        set: values by name: texts with units, quantities of pint, or numbers in SI
        among: alternatives from a catalogue, such as "oil=PAOR,MINR" or "oil=all"

    Raises:
        ScenarioError: all that is wrong with what is asked
        SolveError: there is no solution

    Example:
        >>> import gearheat as gh
        >>> small = gh.design("planetary", ["cooling.A"], {"oil.T": "80 degC"})
        >>> small.to("oil.T", "degC")  # doctest: +SKIP
        80.0
    """
    scenario = scenario_of(rig)
    part, names = _alternatives(scenario, among)
    freed, assignments = pairs_of(free), assignments_of(set, scenario.settable)
    known = scenario.readable()
    targets = [one if isinstance(one, str) else _format_target(*one, known.get(one[0])) for one in pairs_of(target)]
    found: dict[str, Any] = {"schema": "gearheat.design/1", "rig": scenario.name}
    case = _case(scenario, freed, targets, assignments)
    if part is None:
        solution = least_change(case.flat, case.free, case.targets, case.values, case.bounds)
        state = {name: float(column[0]) for name, column in solution.result.columns.items()} | dict(solution.values)
        return DesignAnswer(found | _solution(case, solution), case.setting, case.flat, state)
    solved: list[tuple[tuple[float, ...], dict[str, Any]]] = []
    unsolved: list[dict[str, Any]] = []
    for name in names:
        other = case.filled(part, name) or _case(scenario, freed, targets, [*assignments, f"{part}={name}"])
        try:
            search = least_change(other.flat, other.free, other.targets, other.values, other.bounds) if freed else None
            solution = search or evaluate_unchanged(other.flat, other.targets, other.values)
        except SolveError as error:
            unsolved.append({part: name, "problems": list(error.problems)})
            continue
        order = rank(other.flat, solution, other.targets, other.values)
        solved.append((order, {part: name, **_solution(other, solution)}))
    if not solved:
        raise SolveError([f"{part} = {a[part]}: {p}" for a in unsolved for p in a["problems"]])
    best_first = [answer for _, answer in sorted(solved, key=lambda pair: pair[0])]
    return DesignAnswer(found | {"among": part, "alternatives": [*best_first, *unsolved]}, case.setting, case.flat)


def _format_target(name: str, value: Any, quantity: Quantity | None) -> str:
    """A target as the command line has it."""
    text = spell(value, quantity, name)
    return f"{name}{text}" if text[:1] in "<>" else f"{name}={text}"


def _alternatives(scenario: Scenario, among: str | None) -> tuple[str | None, list[str]]:
    """Part and catalogue names of a text such as "oil=PAOR,MINR", or "oil=all" for every entry that fits."""
    if among is None:
        return None, []
    part, _, text = (word.strip() for word in among.partition("="))
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not part or not names:
        raise ScenarioError(f'"{among}" names no alternatives. Write for example oil=PAOR,MINR,PAGD, or oil=all.')
    return part, list(scenario.alternatives(part)) if names == [ALL] else names


def _case(scenario: Scenario, freed: Sequence[Any], targets: Sequence[str], assignments: Sequence[str]) -> _Case:
    """One design, with the problems of everything given at once."""
    split = [one.partition("=")[::2] if isinstance(one, str) else one for one in freed]
    ranges = {name.strip(): given for name, given in split}
    free, bounds = [name.strip() for name, _ in split], dict[str, tuple[float, float]]()
    several = [name for name in free if "," in name]
    problems = Problems(f"--free {name}: is more than one name. Repeat --free for each." for name in several)
    setting = scenario
    with problems:
        setting = adjust(scenario, assignments, named=free)
    flat = flat_of(setting)
    aims: list[Target] = []
    for text in targets:
        with problems:
            aims.append(_target(flat, text))
    limited = [(aim.name, sign) for aim in aims for sign in (aim.sign, *(("<", ">") if aim.sign == "=" else ()))]
    twice = {name for name, sign in limited if limited.count((name, sign)) > 1}
    problems += [
        f"--target: {name} is to be two things at once. Give it one value, or a range." for name in sorted(twice)
    ]
    for name in (name for name in free if name not in several):
        with problems:
            flat.locate(name)
            if ranges[name] not in ("", None):
                bounds[name] = range_of(ranges[name], flat.quantity(name), f"--free {name}")
    problems.check()
    return _Case(setting, flat, tuple(aims), tuple(free), bounds)


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
    units = {name: show_unit(flat.quantity(name).unit) for name in (*solution.values, *(t.name for t in case.targets))}
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
        "unchecked": find_unchecked(case.setting, flat),
    }
