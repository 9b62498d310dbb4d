"""The search behind a design: states and freed values at once, a scan of one freed name, starts spread over ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import casadi as ca
import numpy as np

from ..core.flat import FlatModel, Quantity
from ..errors import ScenarioError, SolveError
from .fast import Fast, once
from .newton import FIRST_STRIDE, LEAST_STRIDE, STRIDE, Box, System, newton, reduce_jacobian, stable
from .point import Point, point, problem_of
from .steady import Equilibrium, equilibrium, rates, unknowns_box

#: How well a target is met, relative to its size or its nominal.
MET = 1e-8


#: How far an unbounded range goes to both sides of a value, in sizes, and how it is stretched: dense near the value.
FAR = 20.0
STRETCH = float(np.arcsinh(FAR))


@dataclass(frozen=True)
class Range:
    """Values of one freed name, by a share from 0 to 1 of the way from low to high.

    `spacing` is "linear", "logarithmic", or "stretched": dense in the middle, wide at both ends.
    """

    low: float
    high: float
    spacing: str = "linear"

    def at(self, share: float) -> float:
        """Value at a share."""
        if self.spacing == "logarithmic":
            return float(self.low * (self.high / self.low) ** share)
        if self.spacing == "stretched":
            share = 0.5 + 0.5 * float(np.sinh(STRETCH * (2 * share - 1))) / FAR
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """Share of a value, cut to the range."""
        value = min(max(value, self.low), self.high)
        if self.spacing == "logarithmic":
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        share = (value - self.low) / (self.high - self.low)
        if self.spacing == "stretched":
            share = 0.5 + 0.5 * float(np.arcsinh(FAR * (2 * share - 1))) / STRETCH
        return share


def span(q: Quantity, value: float, given: tuple[float, float] | None) -> Range:
    """The range to scan: the one given, the declared one, or a wide one around a value.

    Args:
        q: the quantity that is freed
        value: where the search begins, SI
        given: lowest and highest value a user has given, SI
    """
    size = max(abs(value), q.nominal)
    if given is not None:
        low, high = max(given[0], q.low), min(given[1], q.high)
    elif np.isfinite(q.low) and np.isfinite(q.high):
        low, high = q.low, q.high
    elif q.unit == "K":
        low, high = max(q.low, value - 100), min(q.high, value + 100)
    elif q.low >= 0:
        base = value if value > q.low else q.nominal
        low, high = max(q.low, base / 100), min(q.high, base * 100)
    else:
        return Range(value - FAR * size, value + FAR * size, "stretched")
    inset = 1e-6 * (high - low)
    low, high = low + inset * (q.low_open and low == q.low), high - inset * (q.high_open and high == q.high)
    return Range(low, high, "logarithmic" if low > 0 and high > 20 * low else "linear")


@dataclass(frozen=True)
class Tried:
    """One value of the freed name: the equilibrium and the target there, none where there is no steady state."""

    share: float
    at: Equilibrium | None
    y: float


class Search:
    """Values of freed names that give targets their values, and the steady states there.

    Args:
        flat: the model
        free: parameters and inputs to find
        targets: outputs and states with their values
        start: where to begin
        bounds: ranges of freed names
    """

    def __init__(
        self,
        flat: FlatModel,
        free: Sequence[str],
        targets: Mapping[str, float],
        start: Point,
        bounds: Mapping[str, tuple[float, float]],
    ) -> None:
        self.flat, self.free, self.names = flat, tuple(free), tuple(targets)
        self.goal = np.array(list(targets.values()), dtype=float)
        self.size = np.array([max(abs(v), flat.quantity(n).nominal) for n, v in targets.items()])
        self.n = len(flat.states) + len(flat.algebraic)
        self.where = [flat.locate(name) for name in self.free]
        quantities = [flat.quantity(name) for name in self.free]
        own = [float({"input": start.u, "parameter": start.p}[kind][i]) for kind, i in self.where]
        self.ranges = [span(q, f, bounds.get(q.name)) for q, f in zip(quantities, own, strict=True)]
        self.f = np.array([self._inside(f, q, bounds) for f, q in zip(own, quantities, strict=True)])
        self.start = start
        own_box = unknowns_box(flat)
        scales = [0.1 * max(abs(f), 0.1 * q.nominal) for f, q in zip(own, quantities, strict=True)]
        ends = [bounds.get(q.name, (q.low, q.high)) for q in quantities]
        self.box = Box(
            np.append(own_box.low, [max(a, q.low) for (a, _), q in zip(ends, quantities, strict=True)]),
            np.append(own_box.high, [min(b, q.high) for (_, b), q in zip(ends, quantities, strict=True)]),
            np.append(own_box.scale, scales),
            np.append(own_box.stride, [STRIDE] * len(own)),
        )
        self.compiled = compiled(flat, self.free, self.names)
        self.limits: dict[str, None] = {}

    def _inside(self, value: float, q: Quantity, bounds: Mapping[str, tuple[float, float]]) -> float:
        """A start inside the range, away from its ends."""
        if q.name not in bounds:
            return value
        a, b = bounds[q.name]
        return float(np.clip(value, a + 0.01 * (b - a), b - 0.01 * (b - a)))

    def point(self, f: np.ndarray) -> Point:
        """Inputs and parameters with freed values put in."""
        u, p = self.start.u.copy(), self.start.p.copy()
        for value, (kind, i) in zip(f, self.where, strict=True):
            (u if kind == "input" else p)[i] = value
        return replace(self.start, u=u, p=p)

    def at(self, found: Equilibrium, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives, algebraic residuals and targets, and their Jacobian in x, z and freed values.

        Args:
            found: states and algebraic variables
            f: freed values (m), SI
        """
        here = self.point(f)
        values, jacobian = self.compiled(found.x, found.z, here.u, here.p)
        return values, jacobian.reshape(len(values), -1)

    def aims(self, found: Equilibrium, f: np.ndarray) -> np.ndarray:
        """The targets' quantities.

        Args:
            found: states and algebraic variables
            f: freed values (m), SI
        """
        return self.at(found, f)[0][self.n :]

    def equilibrium(self, f: np.ndarray, warm: Equilibrium | None = None) -> Equilibrium:
        """The steady state at freed values.

        Args:
            f: freed values (m), SI
            warm: a steady state nearby to begin with

        Raises:
            SolveError: there is none, or parameters contradict
        """
        here = self.point(f)
        if not self.allowed(here.p):
            raise SolveError("design: the parameters contradict each other.")
        return equilibrium(self.flat, here, warm, self.free, "design", continued=False)

    def allowed(self, p: np.ndarray) -> bool:
        """Whether all relations between parameters hold; those that do not are remembered for the message."""
        broken = self.flat.contradictions(p)
        self.limits |= dict.fromkeys(f'{r.component}: "{r.name}"' for r in broken)
        return not broken

    def newton(self, start: Equilibrium, f: np.ndarray, goal: np.ndarray) -> tuple[Equilibrium, np.ndarray] | None:
        """Steady state and freed values at once by Newton's method; None if that ends nowhere a machine would stay.

        Args:
            start: steady state to begin with
            f: freed values (m), SI, to begin with
            goal: values of the targets (m), SI
        """
        root = newton(self._system(goal), np.append(start.w, f), self.box)
        found, f = self._split(root.z)
        here = self.point(f)
        if not root.found or (np.abs(self.aims(found, f) - goal) > MET * self.size).any() or not self.allowed(here.p):
            return None
        jacobian = rates(self.flat)(found.x, found.z, here.u, here.p)[1]
        return (found, f) if stable(reduce_jacobian(jacobian, len(found.x))) else None

    def _split(self, z: np.ndarray) -> tuple[Equilibrium, np.ndarray]:
        n = len(self.flat.states)
        return Equilibrium(z[:n], z[n : self.n]), z[self.n :]

    def _system(self, goal: np.ndarray) -> System:
        aim = np.append(np.zeros(self.n), goal)

        def equations(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            values, jacobian = self.at(*self._split(z))
            return values - aim, jacobian

        return equations

    def continued(self, start: Equilibrium, f: np.ndarray) -> tuple[Equilibrium, np.ndarray] | None:
        """Continue the targets from their values at a steady state to those asked for.

        Args:
            start: a steady state
            f: freed values (m), SI, that belong to it
        """
        begin, found = self.aims(start, f), (start, f)
        share, stride = 0.0, FIRST_STRIDE
        while share < 1.0 and stride > LEAST_STRIDE:
            aim = min(1.0, share + stride)
            there = self.newton(*found, begin + aim * (self.goal - begin))
            if there is None:
                stride /= 2
            else:
                found, share, stride = there, aim, 2 * stride
        return found if share >= 1.0 else None

    def scan(self, shares: Sequence[float], warm: Equilibrium | None) -> list[Tried]:
        """Steady states at some values of the only freed name, each from the one before, in the order given.

        Args:
            shares: places in the range of the freed name, 0 to 1
            warm: a steady state near the first
        """
        found = []
        for share in shares:
            f = np.array([self.ranges[0].at(share)])
            try:
                warm = self.equilibrium(f, warm)
                found.append(Tried(share, warm, float(self.aims(warm, f)[0])))
            except SolveError:
                found.append(Tried(share, None, float("nan")))
        return found

    def spread(self, count: int) -> Iterator[np.ndarray]:
        """Starts spread evenly over the ranges (Halton 1960), the same every time."""
        from scipy.stats.qmc import Halton

        for shares in Halton(len(self.free), scramble=False).random(count + 1)[1:]:
            yield np.array([r.at(float(share)) for r, share in zip(self.ranges, shares, strict=True)])


@once
def compiled(flat: FlatModel, free: tuple[str, ...], targets: tuple[str, ...]) -> Fast:
    """(x, z, u, p) -> derivatives, algebraic residuals and targets, and their Jacobian in x, z and freed values.

    Args:
        flat: the model
        free: parameters and inputs
        targets: outputs and states
    """
    vectors = {"state": flat.x, "output": flat.y, "input": flat.u, "parameter": flat.p}
    aims, freed = ([vectors[kind][i] for kind, i in map(flat.locate, names)] for names in (targets, free))
    equations = ca.vertcat(flat.ode, flat.residual, *aims)
    return Fast("design", flat.point, [equations, ca.jacobian(equations, ca.vertcat(flat.x, flat.z, *freed))])


def sensitivities(
    flat: FlatModel,
    outputs: Sequence[str],
    names: Sequence[str],
    values: Mapping[str, float],
    *,
    guess: Mapping[str, float] | None = None,
) -> np.ndarray:
    """d(output)/d(name) at a steady state, by the implicit function theorem.

    Args:
        flat: the model
        outputs: outputs and states, one row each
        names: parameters and inputs, one column each
        values: parameters and inputs by path (SI)
        guess: states to start from

    Raises:
        ScenarioError: unknown names, names of the wrong kind, values out of range
        SolveError: no steady state
    """
    problems = [problem_of(flat, name, ("output", "state"), "sensitivities") for name in outputs]
    problems += [problem_of(flat, name, ("parameter", "input"), "sensitivities") for name in names]
    if wrong := [problem for problem in problems if problem]:
        raise ScenarioError(wrong)
    here = point(flat, values, guess, who="sensitivities")
    at = equilibrium(flat, here, None, tuple(values), "sensitivities")
    n, m = len(at.w), len(outputs)
    _, slopes = compiled(flat, tuple(names), tuple(outputs))(at.x, at.z, here.u, here.p)
    jacobian = slopes.reshape(n + m, n + len(names))
    answer = np.linalg.solve(jacobian[:n, :n], -jacobian[:n, n:])
    return cast(np.ndarray, jacobian[n:, n:] + jacobian[n:, :n] @ answer)
