"""The search behind a design: states and freed values at once, a scan of one freed name, starts spread over ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import casadi as ca
import numpy as np

from ..core.flat import FlatModel, Quantity
from ..errors import SolveError
from .fast import Fast
from .newton import Box, System, newton
from .point import Point
from .steady import balance, rates, stable, state_box

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
    """The range to scan: the one given, the declared one, or a wide one around a value."""
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
    """One value of the freed name: the states and the target there, none where there is no steady state."""

    share: float
    x: np.ndarray | None
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
        self.n = len(flat.states)
        self.where = [flat.locate(name) for name in self.free]
        quantities = [flat.quantity(name) for name in self.free]
        own = [float({"input": start.u, "parameter": start.p}[kind][i]) for kind, i in self.where]
        self.ranges = [span(q, f, bounds.get(q.name)) for q, f in zip(quantities, own, strict=True)]
        self.f = np.array([self._inside(f, q, bounds) for f, q in zip(own, quantities, strict=True)])
        self.start = start
        states = state_box(flat)
        ends = [bounds.get(q.name, (q.low, q.high)) for q in quantities]
        self.box = Box(
            np.append(states.low, [max(a, q.low) for (a, _), q in zip(ends, quantities, strict=True)]),
            np.append(states.high, [min(b, q.high) for (_, b), q in zip(ends, quantities, strict=True)]),
            np.append(states.scale, [0.1 * max(abs(f), 0.1 * q.nominal) for f, q in zip(own, quantities, strict=True)]),
        )
        self.compiled = self._compiled()
        self.limits: dict[str, None] = {}

    def _inside(self, value: float, q: Quantity, bounds: Mapping[str, tuple[float, float]]) -> float:
        """A start inside the range, away from its ends."""
        if q.name not in bounds:
            return value
        a, b = bounds[q.name]
        return float(np.clip(value, a + 0.01 * (b - a), b - 0.01 * (b - a)))

    def _compiled(self) -> Fast:
        """(x, u, p) -> derivatives and targets, and their Jacobian in states and freed values."""
        flat, key = self.flat, f"design {self.free} {self.names}"
        if key not in flat.prepared:
            vectors = {"state": flat.x, "output": flat.y, "input": flat.u, "parameter": flat.p}
            aims = [vectors[kind][i] for kind, i in map(flat.locate, self.names)]
            freed = [vectors[kind][i] for kind, i in self.where]
            equations = ca.vertcat(flat.ode, *aims)
            jacobian = ca.jacobian(equations, ca.vertcat(flat.x, *freed))
            flat.prepared[key] = Fast("design", [flat.x, flat.u, flat.p], [equations, jacobian])
        return cast(Fast, flat.prepared[key])

    def point(self, f: np.ndarray) -> Point:
        """Inputs and parameters with freed values put in."""
        u, p = self.start.u.copy(), self.start.p.copy()
        for value, (kind, i) in zip(f, self.where, strict=True):
            (u if kind == "input" else p)[i] = value
        return replace(self.start, u=u, p=p)

    def at(self, x: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives and targets, and their Jacobian in states and freed values."""
        here = self.point(f)
        values, jacobian = self.compiled(x, here.u, here.p)
        return values, jacobian.reshape(len(values), -1)

    def aims(self, x: np.ndarray, f: np.ndarray) -> np.ndarray:
        """The targets' quantities."""
        return self.at(x, f)[0][self.n :]

    def balance(self, f: np.ndarray, warm: np.ndarray | None = None) -> np.ndarray:
        """Steady states at freed values. Raises SolveError where there are none, or where parameters contradict."""
        here = self.point(f)
        if not self.allowed(here.p):
            raise SolveError("design: the parameters contradict each other.")
        return balance(self.flat, here, warm, self.free, "design", lead=False)

    def allowed(self, p: np.ndarray) -> bool:
        """Whether all relations between parameters hold; those that do not are remembered for the message."""
        broken = self.flat.contradictions(p)
        self.limits |= dict.fromkeys(f'{r.component}: "{r.name}"' for r in broken)
        return not broken

    def newton(self, x: np.ndarray, f: np.ndarray, goal: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """States and freed values at once by Newton's method; None if that ends nowhere a machine would stay."""
        root = newton(self._system(goal), np.append(x, f), self.box)
        x, f = root.z[: self.n], root.z[self.n :]
        here = self.point(f)
        if not root.found or (np.abs(self.aims(x, f) - goal) > MET * self.size).any() or not self.allowed(here.p):
            return None
        jacobian = rates(self.flat)(x, here.u, here.p)[1].reshape(self.n, self.n)
        return (x, f) if stable(jacobian) else None

    def _system(self, goal: np.ndarray) -> System:
        aim = np.append(np.zeros(self.n), goal)

        def equations(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            values, jacobian = self.at(z[: self.n], z[self.n :])
            return values - aim, jacobian

        return equations

    def led(self, x: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Lead the targets from their values at a steady state to those asked for."""
        begin = self.aims(x, f)
        share, stride = 0.0, 0.25
        while share < 1.0 and stride > 1e-3:
            aim = min(1.0, share + stride)
            found = self.newton(x, f, begin + aim * (self.goal - begin))
            if found is None:
                stride /= 2
            else:
                (x, f), share, stride = found, aim, 2 * stride
        return (x, f) if share >= 1.0 else None

    def scan(self, shares: Sequence[float], warm: np.ndarray | None) -> list[Tried]:
        """Steady states at some values of the only freed name, each from the one before, in the order given."""
        found = []
        for share in shares:
            f = np.array([self.ranges[0].at(share)])
            try:
                warm = self.balance(f, warm)
                found.append(Tried(share, warm, float(self.aims(warm, f)[0])))
            except SolveError:
                found.append(Tried(share, None, float("nan")))
        return found

    def spread(self, count: int) -> Iterator[np.ndarray]:
        """Starts spread evenly over the ranges (Halton 1960), the same every time."""
        bases = _primes(len(self.free))
        for k in range(1, count + 1):
            yield np.array([r.at(_reversed_digits(k, b)) for r, b in zip(self.ranges, bases, strict=True)])


def _primes(count: int) -> list[int]:
    found: list[int] = []
    candidate = 2
    while len(found) < count:
        if all(candidate % p for p in found):
            found.append(candidate)
        candidate += 1
    return found


def _reversed_digits(k: int, base: int) -> float:
    """The digits of k mirrored at the point."""
    value, place = 0.0, 1.0
    while k:
        k, digit = divmod(k, base)
        place /= base
        value += digit * place
    return value
