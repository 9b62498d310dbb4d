"""Design: which values of freed parameters and inputs give outputs and states the values asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError, SolveError
from ..units import text
from .point import point, problem_of
from .result import Result
from .search import Range, Search, Tried
from .steady import Equilibrium, table

#: Points of a scan over one freed name.
SCAN = 25
#: Points that refine the scan between two of its points.
REFINED = 12
#: Starts tried where several names are free.
STARTS = 32

#: A target that varies less than this over a scan, relative, does not depend on the freed name.
UNMOVED = 1e-9

#: Where a range ends that keeps its sign, over where the search starts.
NEAR_ZERO = 1e-6

#: Above this condition number the freed names do nearly the same to the targets.
ALIKE = 1e6


@dataclass(frozen=True)
class Design:
    """Freed values that meet the targets.

    Attributes:
        values: the freed names with their values (SI)
        result: the steady state there
        sensitivity: d(freed)/d(target), a row per freed name, a column per target (SI)
        targets: the targets in the order of the columns
        residuals: target -> what is left of it (SI)
        condition: condition number of the targets' response to the freed values, both in their own sizes; large where
            freed names do nearly the same
        notes: what a user should know about the solution
    """

    values: Mapping[str, float]
    result: Result
    sensitivity: np.ndarray
    targets: tuple[str, ...]
    residuals: Mapping[str, float]
    condition: float
    notes: tuple[str, ...] = ()


def design(
    flat: FlatModel,
    free: Sequence[str],
    targets: Mapping[str, float],
    values: Mapping[str, float],
    *,
    guess: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
) -> Design:
    """Find values of freed parameters and inputs at which outputs or states take given steady values.

    States and freed values are solved for at once from the values given. Where that fails, one freed name is scanned
    over its range for a change of sign; for several the targets are continued from where they are, then other starts
    tried.

    Args:
        flat: the model
        free: parameters and inputs to find, as many as targets
        targets: outputs and states with the values they shall have (SI)
        values: parameters and inputs (SI); those of freed names are where the search starts
        guess: states to start from
        bounds: per freed name the range to search (SI); without it the quantity's own, or a wide one around its start

    Raises:
        ScenarioError: unknown names, names of the wrong kind, values out of range, counts that differ
        SolveError: no solution; the text says what can be reached
    """
    if problems := _problems(flat, free, targets, bounds or {}):
        raise ScenarioError(problems)
    start = point(flat, values, guess, who="design")
    search = Search(flat, free, targets, start, bounds or {})
    try:
        begin = search.equilibrium(search.f)
    except SolveError:
        begin = Equilibrium(start.x, flat.starts("algebraic"))
    found = search.newton(begin, search.f, search.goal)
    if found is not None and (found[1] * search.f >= 0).all():
        return _design(search, *found)
    if sides := _sides(search, bounds or {}):  # a speed: a film at rest is no way to the other direction
        with suppress(SolveError):
            return design(flat, free, targets, values, guess=guess, bounds={**(bounds or {}), **sides})
    if found is not None:
        return _design(search, *found)
    return _by_scan(search, begin) if len(free) == 1 else _by_starts(search, begin)


def _sides(search: Search, bounds: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """Bounds that keep the sign of where the search starts, of the freed names without bounds of either sign."""
    named = zip(search.free, search.f, search.ranges, strict=True)
    free = [(name, float(f), r) for name, f, r in named if name not in bounds and r.low < 0 < r.high and f != 0]
    return {name: (NEAR_ZERO * f, r.high) if f > 0 else (r.low, NEAR_ZERO * f) for name, f, r in free}


def _problems(
    flat: FlatModel, free: Sequence[str], targets: Mapping[str, float], bounds: Mapping[str, tuple[float, float]]
) -> list[str]:
    found = [problem_of(flat, name, ("parameter", "input"), "design") for name in free]
    found += [problem_of(flat, name, ("output", "state"), "design") for name in targets]
    found += [f"design: {name} is free twice. Name it once." for name in dict.fromkeys(free) if free.count(name) > 1]
    found += [f"design: there are bounds for {name}, which is not free." for name in bounds if name not in free]
    found += [f"design: bounds of {n}: {a:g} is not below {b:g}." for n, (a, b) in bounds.items() if not a < b]
    found += [f"design: target {n} = {v} is not finite." for n, v in targets.items() if not np.isfinite(v)]
    if len(free) != len(targets) or not free:
        found.append(f"design: {len(free)} free values for {len(targets)} targets. Free one per target, at least one.")
    return [problem for problem in found if problem]


def _design(search: Search, found: Equilibrium, f: np.ndarray, notes: tuple[str, ...] = ()) -> Design:
    flat, n, m = search.flat, search.n, len(f)
    here = search.point(f)
    values, jacobian = search.at(found, f)
    right = np.vstack([np.zeros((n, m)), np.eye(m)])
    sensitivity = np.linalg.solve(jacobian, right)[n:]
    size = np.maximum(np.abs(f), [1e-3 * flat.quantity(name).nominal for name in search.free])
    condition = float(np.linalg.cond(sensitivity / size[:, None] * search.size))
    if condition > ALIKE:
        alike = " and ".join(search.free)
        notes = (*notes, f"{alike} do nearly the same to the targets (condition {condition:.1e}): free another one.")
    return Design(
        values=dict(zip(search.free, map(float, f), strict=True)),
        result=table(flat, [found], here.u[:, None], here.p[:, None]),
        sensitivity=sensitivity,
        targets=search.names,
        residuals=dict(zip(search.names, map(float, values[n:] - search.goal), strict=True)),
        condition=condition,
        notes=notes,
    )


def _by_scan(search: Search, begin: Equilibrium) -> Design:
    """Look for changes of sign over the range of the only freed name; the one nearest to the start wins."""
    scale, goal = search.ranges[0], float(search.goal[0])
    home = scale.share(float(search.f[0]))
    grid = np.linspace(0.0, 1.0, SCAN)
    tried = search.scan([s for s in grid if s >= home], begin)
    tried += search.scan([s for s in grid[::-1] if s < home], begin)
    tried.sort(key=lambda t: t.share)
    crossings = _crossings(tried, goal)
    if not crossings and any(t.at is not None for t in tried):
        tried = sorted(tried + search.scan(_refine(tried, goal), None), key=lambda t: t.share)
        crossings = _crossings(tried, goal)
    crossings.sort(key=lambda pair: abs(pair[0].share - home))
    for a, b in crossings:
        if (found := _between(search, a, b)) is not None:
            return _design(search, *found, notes=_others(search, crossings, (a, b)))
    raise SolveError(_out_of_reach(search, scale, tried))


def _crossings(tried: Sequence[Tried], goal: float) -> list[tuple[Tried, Tried]]:
    """Neighbours with the goal between them."""
    return [
        (a, b) for a, b in pairwise(tried) if a.at is not None and b.at is not None and (a.y - goal) * (b.y - goal) <= 0
    ]


def _refine(tried: Sequence[Tried], goal: float) -> list[float]:
    """More points around the one that comes nearest."""
    best = min((i for i, t in enumerate(tried) if t.at is not None), key=lambda i: abs(tried[i].y - goal))
    low, high = tried[max(best - 1, 0)].share, tried[min(best + 1, len(tried) - 1)].share
    return [float(s) for s in np.linspace(low, high, REFINED + 2)[1:-1]]


def _between(search: Search, a: Tried, b: Tried) -> tuple[Equilibrium, np.ndarray] | None:
    """Close in on a change of sign, then solve from there; None for a jump."""
    from scipy.optimize import brentq

    warm, goal = a.at, float(search.goal[0])

    def miss(share: float) -> float:
        nonlocal warm
        f = np.array([search.ranges[0].at(share)])
        warm = search.equilibrium(f, warm)
        return float(search.aims(warm, f)[0]) - goal

    try:
        share = brentq(miss, a.share, b.share, xtol=1e-10)
        miss(share)
    except (SolveError, ValueError):
        return None
    return search.newton(warm, np.array([search.ranges[0].at(share)]), search.goal) if warm is not None else None


def _others(search: Search, crossings: Sequence[tuple[Tried, Tried]], taken: tuple[Tried, Tried]) -> tuple[str, ...]:
    name, scale = search.free[0], search.ranges[0]
    unit = search.flat.quantity(name).unit
    return tuple(
        f"There is another solution with {name} between {text(scale.at(a.share), unit, 4)} "
        f"and {text(scale.at(b.share), unit, 4)}: narrow the bounds to find it."
        for a, b in crossings
        if (a, b) is not taken and (a.share, b.share) != (taken[0].share, taken[1].share)
    )


def _out_of_reach(search: Search, scale: Range, tried: Sequence[Tried]) -> str:
    flat, name, target = search.flat, search.free[0], search.names[0]
    unit, aim = flat.quantity(name).unit, flat.quantity(target).unit
    ends = f"{text(scale.low, unit, 4)} to {text(scale.high, unit, 4)}"
    solved = [t for t in tried if t.at is not None]
    if not solved and search.limits:
        return f"design: no {name} tried from {ends} fits the other parameters." + _limits(search)
    if not solved:
        return (
            f"design: there is no steady state at any {name} from {ends}. Check the loads, the cooling and the bounds."
        )
    low, high = min(t.y for t in solved), max(t.y for t in solved)
    if high - low <= UNMOVED * search.size[0] and not search.limits:
        return (
            f"design: {target} does not depend on {name}: it stays at {text(low, aim)} while {name} goes from {ends}.\n"
            "Free something else."
        )
    some = (
        "" if len(solved) == len(tried) else f" (where there is a steady state, {len(solved)} of {len(tried)} points)"
    )
    return (
        f"design: {target} reaches {text(low, aim)} ... {text(high, aim)} while {name} goes from {ends}{some}: "
        f"the target {text(float(search.goal[0]), aim)} is out of reach.\n"
        "Free something else, or within another range: NAME=LOW..HIGH." + _limits(search)
    )


def _limits(search: Search) -> str:
    """The relations between parameters that freed values ran into, in words."""
    return f"\nThe search was limited by {', '.join(search.limits)}." if search.limits else ""


def _by_starts(search: Search, begin: Equilibrium) -> Design:
    """Continue the targets from where they are, then try starts all over the ranges."""
    if (found := search.continued(begin, search.f)) is not None:
        return _design(search, *found)
    reached = []
    for f in search.spread(STARTS):
        try:
            begin = search.equilibrium(f)
        except SolveError:
            continue
        reached.append(search.aims(begin, f))
        if (found := search.newton(begin, f, search.goal)) is not None:
            return _design(search, *found)
    raise SolveError(_no_values(search, reached))


def _no_values(search: Search, reached: Sequence[np.ndarray]) -> str:
    flat = search.flat
    units = [flat.quantity(name).unit for name in search.names]
    aims = zip(search.names, search.goal, units, strict=True)
    wanted = ", ".join(f"{name} = {text(float(value), unit)}" for name, value, unit in aims)
    head = f"design: no values of {', '.join(search.free)} found that give {wanted}.\n"
    if not reached:
        nowhere = "There is no steady state anywhere in their ranges: check the loads, the cooling and the bounds."
        return head + nowhere + _limits(search)
    extremes = zip(search.names, np.min(reached, axis=0), np.max(reached, axis=0), units, strict=True)
    seen = [
        f"{name} stays at {text(float(a), unit)}"
        if b - a <= UNMOVED * max(abs(a), abs(b), 1e-300)
        else f"{name} reaches {text(float(a), unit)} ... {text(float(b), unit)}"
        for name, a, b, unit in extremes
    ]
    advice = "change the targets, or free something else or within other ranges, NAME=LOW..HIGH."
    return head + f"Over their ranges {', '.join(seen)}: {advice}" + _limits(search)
