"""Targets that need not be met exactly: the least change of freed values that keeps to all of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError, SolveError
from ..units import text
from .design import Design, design
from .point import problem_of
from .steady import steady

#: A target is met within this share of its size.
CLOSE = 1e-6
#: What is said where nothing has to change.
MET = "met already: nothing has to change"
#: Problems of a search that a message tells.
TOLD = 3


@dataclass(frozen=True)
class Target:
    """What an output or a state shall be: equal to a value in SI, at most, or at least as large."""

    name: str
    sign: Literal["=", "<", ">"]
    value: float

    def margin(self, found: float) -> float:
        """How far a value lies on the wrong side, negative on the right one."""
        over = found - self.value
        return abs(over) if self.sign == "=" else over if self.sign == "<" else -over


def least_change(
    flat: FlatModel,
    free: Sequence[str],
    targets: Sequence[Target],
    values: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]] | None = None,
) -> Design:
    """The fewest and, of as many, the smallest changes of freed values that meet all targets.

    A limit that holds without a change needs none. Of the others each is met exactly, by as many of the freed names;
    every choice of them is tried, and the one with the smallest change wins, see `change`.

    Args:
        flat: the model
        free: parameters and inputs that may change
        targets: equalities need a freed name each, limits one where they do not hold
        values: parameters and inputs (SI), those of freed names are what they change from
        bounds: freed name -> lowest and highest value that it may have (SI)

    Raises:
        ScenarioError: unknown names, names of the wrong kind, too few of them free
        SolveError: no solution, or none that meets all targets
    """
    equal = {t.name: t.value for t in targets if t.sign == "="}
    limits = [t for t in targets if t.sign != "="]
    if not limits:
        return design(flat, free, equal, values, bounds=bounds)
    problems: list[str] = []
    near: list[Design] = []
    for size in range(len(limits) + 1):
        groups = list(combinations(limits, size))
        found: list[Design] = []
        for one in _solve_groups(flat, free, targets, equal, groups, values, bounds or {}, problems):
            (found if all(_meets(flat, t, one) for t in targets) else near).append(one)
        if found:
            best, *others = sorted(found, key=lambda d: change(flat, d, values))
            return replace(best, notes=(*best.notes, *(_describe(flat, d) for d in others)))
    if near := [one for one in near if one.values]:
        raise SolveError(
            [_describe_near(flat, targets, min(near, key=lambda d: change(flat, d, values))), *problems][:TOLD]
        )
    if not problems:
        there = evaluate_unchanged(flat, targets, values)
        missed = ", ".join(_describe_miss(flat, t, there) for t in targets if not _meets(flat, t, there))
        if not missed:
            return replace(there, notes=(MET,))
        raise ScenarioError(f"design: {missed}. Free more with --free: a parameter or an input that may change.")
    raise SolveError(list(dict.fromkeys(problems))[:TOLD])


def evaluate_unchanged(flat: FlatModel, targets: Sequence[Target], values: Mapping[str, float]) -> Design:
    """The steady state as it is, whether it meets the targets or not.

    Args:
        flat: the model
        targets: what is asked
        values: parameters and inputs (SI)

    Raises:
        ScenarioError: unknown names, names of the wrong kind
        SolveError: there is no steady state
    """
    if problems := [p for t in targets if (p := problem_of(flat, t.name, ("output", "state"), "design"))]:
        raise ScenarioError(problems)
    result = steady(flat, values)
    left = {t.name: float(result[t.name][0]) - t.value for t in targets}
    return Design({}, result, np.zeros((0, 0)), (), left, 1.0)


def change(flat: FlatModel, found: Design, values: Mapping[str, float]) -> float:
    """How much a design changes: the sum of the shares by which its values move, a temperature's in nominals.

    Args:
        flat: the model
        found: the design
        values: parameters and inputs before (SI)
    """
    total = 0.0
    for name, value in found.values.items():
        quantity = flat.quantity(name)
        before = values.get(name, quantity.start)
        size = quantity.nominal if quantity.unit == "K" or before == 0 else abs(before)
        total += abs(value - before) / size
    return total


def rank(flat: FlatModel, found: Design, targets: Sequence[Target], values: Mapping[str, float]) -> tuple[float, ...]:
    """Sorts designs, the best first: those that meet the targets, by their change, then by what they have in hand.

    Args:
        flat: the model
        found: the design
        targets: what is asked
        values: parameters and inputs before (SI)
    """
    margins = [t.margin(float(found.result[t.name][0])) / _size(flat, t) for t in targets]
    missed = sum(m for m in margins if m > CLOSE)
    return missed, change(flat, found, values), sum(margins)


def _solve_groups(
    flat: FlatModel,
    free: Sequence[str],
    targets: Sequence[Target],
    equal: Mapping[str, float],
    limits: Sequence[Sequence[Target]],
    values: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
    problems: list[str],
) -> Iterator[Design]:
    """The designs with all equalities and one of these groups of limits met exactly; what fails is a problem."""
    for group in limits:
        aims = {**equal, **{t.name: t.value for t in group}}
        for chosen in combinations(free, len(aims)):
            own = {name: bounds[name] for name in chosen if name in bounds}
            try:
                found = (
                    design(flat, chosen, aims, values, bounds=own)
                    if aims
                    else evaluate_unchanged(flat, targets, values)
                )
            except SolveError as error:
                problems += error.problems if aims else ()
                continue
            yield found if aims else replace(found, notes=(MET,))


def _size(flat: FlatModel, target: Target) -> float:
    return max(abs(target.value), flat.quantity(target.name).nominal)


def _meets(flat: FlatModel, target: Target, found: Design) -> bool:
    return target.margin(float(found.result[target.name][0])) <= CLOSE * _size(flat, target)


def _describe(flat: FlatModel, found: Design) -> str:
    """Another way to meet the targets, in words."""
    ways = (f"{name} = {text(value, flat.quantity(name).unit)}" for name, value in found.values.items())
    return f"or with a larger change: {', '.join(ways)}"


def _describe_near(flat: FlatModel, targets: Sequence[Target], found: Design) -> str:
    """What a design that meets some of the targets leaves unmet, in words."""
    ways = ", ".join(f"{name} = {text(value, flat.quantity(name).unit)}" for name, value in found.values.items())
    held = ", ".join(
        f"{t.name} {t.sign} {text(t.value, flat.quantity(t.name).unit)}" for t in targets if _meets(flat, t, found)
    )
    missed = ", ".join(_describe_miss(flat, t, found) for t in targets if not _meets(flat, t, found))
    return f"design: {ways} gives {held}; there {missed}. Free more with --free, or ease that limit."


def _describe_miss(flat: FlatModel, target: Target, found: Design) -> str:
    unit = flat.quantity(target.name).unit
    value = text(float(found.result[target.name][0]), unit)
    return f"{target.name} is {value}, which is not {target.sign} {text(target.value, unit)}"
