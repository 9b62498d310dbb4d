"""Steady states: where nothing changes any more, found from any sensible start and checked for stability."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import cast

import casadi as ca
import numpy as np

from ..core.flat import FlatModel
from ..errors import SolveError
from ..units import text
from .fast import Fast
from .newton import Box, Root, System, growth, newton, relax
from .point import Point, point
from .result import Audit, Result
from .rows import evaluate, result

#: Places on the way from a start to a balance that are looked at.
WAY = (0.0, 0.25, 0.5, 0.75)

#: Inputs named in a message.
SHOWN = 6

#: What to do about a state that finds no balance, by its unit.
REMEDIES = {
    "K": "The loss grows faster than the cooling: check the cooling (areas, air speed) and the load.",
    "rad/s": "The torques balance at no speed: check the torques at the shaft ends, or give a speed.",
}


def steady(flat: FlatModel, values: Mapping[str, float], *, guess: Mapping[str, float] | None = None) -> Result:
    """The steady state at given inputs and parameters.

    Newton's method from the guess; where that fails, ends where the machine would not stay or takes a way on which the
    machine would run away, the machine is followed to rest; where that fails too, the inputs are led from the model's
    own to the given ones.

    Args:
        flat: the model
        values: parameters and inputs by path (SI); what is not named keeps the model's own value
        guess: states to start from, by path (SI); it decides where there are several stable balances

    Returns:
        one row; the audit holds the power balance [W]

    Raises:
        ScenarioError: unknown names and values out of range
        SolveError: no steady state, or one that nothing holds
    """
    return steady_table(flat, [values], guess=guess)


def steady_table(
    flat: FlatModel, rows: Iterable[Mapping[str, float]], *, guess: Mapping[str, float] | None = None
) -> Result:
    """Steady states at many points, each started from the one before; one row per point.

    Args:
        flat: the model
        rows: parameters and inputs by path (SI), per point
        guess: states to start the first point from

    Raises:
        ScenarioError: unknown names and values out of range
        SolveError: all points without a steady state
    """
    points = [(point(flat, values, guess, who="steady"), tuple(values)) for values in rows]
    if not points:
        raise SolveError("steady: there is no point to solve. Give at least one.")
    problems, found = [], []
    before: np.ndarray | None = None
    for number, (here, named) in enumerate(points):
        try:
            before = balance(flat, here, before, named)
            found.append(before)
        except SolveError as error:
            where = f"point {number + 1}: " if len(points) > 1 else ""
            problems += [where + problem for problem in error.problems]
    if problems:
        raise SolveError(problems)
    x = np.array(found).T.reshape(len(flat.states), len(points))
    u = np.array([here.u for here, _ in points]).T.reshape(len(flat.inputs), len(points))
    p = np.array([here.p for here, _ in points]).T.reshape(len(flat.parameters), len(points))
    return table(flat, x, u, p)


def table(flat: FlatModel, x: np.ndarray, u: np.ndarray, p: np.ndarray) -> Result:
    """The result of steady states that are known, a column per point."""
    evaluated = evaluate(flat, x, u, p)
    supply, throughput = evaluated["supply"][0], evaluated["throughput"][0]
    audits = [Audit(float(s), 0.0, float(t)) for s, t in zip(supply, throughput, strict=True)]
    worst = max(audits, key=lambda audit: audit.residual)
    return result(flat, "steady", np.arange(x.shape[1], dtype=float), x, u, evaluated, worst)


def balance(
    flat: FlatModel,
    here: Point,
    warm: np.ndarray | None = None,
    named: Iterable[str] = (),
    who: str = "steady",
    lead: bool = True,
) -> np.ndarray:
    """States of the stable balance at given inputs and parameters.

    Args:
        flat: the model
        here: inputs, parameters and the states to start from
        warm: states to try first
        named: the values given by the user, for the message
        who: the run that asks, for the message
        lead: whether to lead the inputs to the given ones as a last resort

    Raises:
        SolveError: there is none
    """
    search = _Search(flat, here)
    starts = [here.x] if warm is None else [warm, here.x]
    for start in starts:
        root = newton(search.system, start, search.box)
        if not search.accepts(root):
            continue
        if search.calm(start, root.z) or not search.accepts(relax(search.system, start, search.box)):
            return root.z
        return search.last
    if search.accepts(relax(search.system, here.x, search.box)) or (lead and search.accepts(search.led())):
        return search.last
    raise SolveError(f"{who}: {search.problem(tuple(named))}")


def rates(flat: FlatModel) -> Fast:
    """Compiled (x, u, p) -> derivatives of the states and their Jacobian in the states."""
    if "rates" not in flat.prepared:
        jacobian = ca.jacobian(flat.ode, flat.x)
        flat.prepared["rates"] = Fast("rates", [flat.x, flat.u, flat.p], [flat.ode, jacobian])
    return cast(Fast, flat.prepared["rates"])


def state_box(flat: FlatModel) -> Box:
    """Ranges and nominals of the states."""
    columns = [(q.low, q.high, q.nominal) for q in flat.states]
    low, high, nominal = np.array(columns).reshape(-1, 3).T
    return Box(low, high, nominal)


def stable(jacobian: np.ndarray) -> bool:
    """Whether a machine stays at a balance of this Jacobian."""
    return bool(np.isfinite(jacobian).all()) and growth(jacobian) == 0.0


class _Search:
    """One search for a balance: it remembers where it got to, for the message."""

    def __init__(self, flat: FlatModel, here: Point) -> None:
        self.flat, self.here = flat, here
        self.box, self.rates = state_box(flat), rates(flat)
        self.last = here.x
        self.steps = 0
        self.unstable: np.ndarray | None = None
        self.share = 0.0

    @property
    def system(self) -> System:
        """Derivatives of the states and their Jacobian at the inputs given."""
        return self._at(self.here.u)

    def _at(self, u: np.ndarray) -> System:
        def equations(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            rate, jacobian = self.rates(x, u, self.here.p)
            return rate, jacobian.reshape(len(rate), len(rate))

        return equations

    def accepts(self, root: Root) -> bool:
        """Note where a method ended; True for a stable balance."""
        self.steps += root.steps
        self.last = root.z
        if root.found and not stable(self.system(root.z)[1]):
            self.unstable = root.z
            return False
        return root.found

    def calm(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether nothing on the way would run away: else the machine decides by itself where it comes to rest."""
        return all(stable(self.system(start + s * (end - start))[1]) for s in WAY)

    def led(self) -> Root:
        """Lead the inputs from the model's own to those given, in steps that adapt."""
        own, asked = self.flat.starts("input"), self.here.u
        if (own == asked).all():
            return Root(self.last, False, 0)
        start = relax(self._at(own), self.here.x, self.box)
        if not start.found:
            return Root(self.last, False, start.steps)
        x, share, stride, steps = start.z, 0.0, 0.25, start.steps
        while share < 1.0 and stride > 1e-3:
            aim = min(1.0, share + stride)
            root = newton(self._at(own + aim * (asked - own)), x, self.box, most=15)
            steps += root.steps
            if root.found:
                x, share, stride = root.z, aim, 2 * stride
            else:
                stride /= 2
        self.share = share
        return Root(x, share >= 1.0, steps)

    def problem(self, named: tuple[str, ...]) -> str:
        """Why there is no balance, in words."""
        flat = self.flat
        rate, jacobian = self.system(self.last)
        if (loose := self._loose(jacobian)) is not None:
            return f"nothing holds {loose}: it keeps any value. Connect what drives or cools it, or give it a load."
        worst = int(np.argmax(np.abs(np.where(np.isfinite(rate), rate, np.inf)) / self.box.scale))
        if self.unstable is not None:
            worst = int(np.argmax(np.abs(self.unstable - self.here.x) / self.box.scale))
        q = flat.states[worst]
        reached = text(self.last[worst] if self.unstable is None else self.unstable[worst], q.unit, 4)
        if self.unstable is not None:
            reason = f"The only balance found, {q.name} = {reached}, is one the machine leaves by itself."
        else:
            reason = REMEDIES.get(q.unit, f"{q.name} finds no balance: check what drives it.")
        led = f" There are solutions up to {100 * self.share:.0f} % of these inputs." if self.share > 0 else ""
        last = f"(last {q.name} {reached} after {self.steps} steps)"
        return f"no solution at {conditions(flat, self.here.u, named)} {last}.\n{reason}{led}"

    def _loose(self, jacobian: np.ndarray) -> str | None:
        """The state a singular Jacobian says nothing about."""
        if not np.isfinite(jacobian).all():
            return None
        rows = np.abs(jacobian).max(axis=1, initial=0.0, keepdims=True)
        _, size, directions = np.linalg.svd(jacobian / np.where(rows > 0, rows, 1.0) * self.box.scale)
        if size[-1] > 1e-13 * max(size[0], 1e-300):
            return None
        return self.flat.states[int(np.argmax(np.abs(directions[-1])))].name


def conditions(flat: FlatModel, u: np.ndarray, named: tuple[str, ...]) -> str:
    """The inputs that matter, in the units they are shown in."""
    moved = [q for q, value in zip(flat.inputs, u, strict=True) if value != q.start]
    given = [q for q in flat.inputs if q.name in named] or moved
    chosen = (given or list(flat.inputs))[:SHOWN]
    written = [f"{q.name} = {text(u[flat.index[q.name][1]], q.unit, 4)}" for q in chosen]
    more = f" and {len(given) - SHOWN} more" if len(given) > SHOWN else ""
    return (", ".join(written) + more) or "the given values"
