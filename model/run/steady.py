"""Steady states: where nothing changes any more, found from any sensible start and checked for stability."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.sparse import csc_matrix, issparse

from ..core.flat import FlatModel
from ..errors import SolveError
from ..units import text
from .algebra import algebra
from .fast import Fast, once
from .newton import STRIDE, Box, Matrix, Root, System, homotopy, newton, pseudo_transient, reduce_jacobian, stable
from .point import Point, point
from .result import Audit, Result
from .rows import evaluate, result

#: Places between a start and an equilibrium that are looked at.
BETWEEN = (0.0, 0.25, 0.5, 0.75)

#: Unknowns up to which a Jacobian is an array: below, sparse elimination takes longer than a dense one.
DENSE = 150

#: Inputs named in a message.
SHOWN = 6

#: What to do about a state that finds no equilibrium, by its unit.
REMEDIES = {
    "K": "The loss grows faster than the cooling: check the cooling (areas, air speed) and the load.",
    "rad/s": "The torques balance at no speed: check the torques at the shaft ends, or give a speed.",
}


def steady(flat: FlatModel, values: Mapping[str, float], *, guess: Mapping[str, float] | None = None) -> Result:
    """The steady state at given inputs and parameters.

    Newton's method from the guess; where that fails, ends where the machine would not stay or passes where it would
    run away, a pseudo-transient; where that fails too, a continuation from the model's own inputs to the given ones.

    Args:
        flat: the model
        values: parameters and inputs by path (SI); what is not named keeps the model's own value
        guess: states to start from, by path (SI); it decides where there are several stable equilibria

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
    problems: list[str] = []
    found: list[Equilibrium] = []
    for number, (here, named) in enumerate(points):
        try:
            found.append(equilibrium(flat, here, found[-1] if found else None, named))
        except SolveError as error:
            where = f"point {number + 1}: " if len(points) > 1 else ""
            problems += [where + problem for problem in error.problems]
    if problems:
        raise SolveError(problems)
    u = np.array([here.u for here, _ in points]).T.reshape(len(flat.inputs), len(points))
    p = np.array([here.p for here, _ in points]).T.reshape(len(flat.parameters), len(points))
    return table(flat, found, u, p)


@dataclass(frozen=True)
class Equilibrium:
    """States and algebraic variables at which nothing changes."""

    x: np.ndarray
    z: np.ndarray

    @property
    def w(self) -> np.ndarray:
        """Both in one vector."""
        return np.append(self.x, self.z)


def table(flat: FlatModel, found: Sequence[Equilibrium], u: np.ndarray, p: np.ndarray) -> Result:
    """The result of steady states that are known.

    Args:
        flat: the model
        found: the equilibria
        u, p: inputs and parameters, a column per equilibrium

    Raises:
        SolveError: the audit finds a fault
    """
    x = np.array([e.x for e in found]).T.reshape(len(flat.states), len(found))
    z = np.array([e.z for e in found]).T.reshape(len(flat.algebraic), len(found))
    evaluated = evaluate(flat, x, u, p, z)
    supply, throughput = evaluated["supply"][0], evaluated["throughput"][0]
    audits = [Audit(float(s), 0.0, float(t)) for s, t in zip(supply, throughput, strict=True)]
    worst = max(audits, key=lambda audit: audit.residual)
    return result(flat, "steady", np.arange(x.shape[1], dtype=float), x, u, evaluated, worst)


def equilibrium(
    flat: FlatModel,
    here: Point,
    warm: Equilibrium | None = None,
    named: Iterable[str] = (),
    who: str = "steady",
    continued: bool = True,
) -> Equilibrium:
    """The stable equilibrium at given inputs and parameters.

    Args:
        flat: the model
        here: inputs, parameters and the states to start from
        warm: an equilibrium to try first
        named: the values given by the user, for the message
        who: the run that asks, for the message
        continued: whether to continue from the model's own inputs to the given ones as a last resort

    Raises:
        SolveError: there is none, or an implicit block has no solution at the start
    """
    try:
        z = algebra(flat).solve(here.x, here.u, here.p, None if warm is None else warm.z)
    except SolveError as error:
        raise SolveError(f"{who}: {conditions(flat, here.u, tuple(named))}: {error}") from None
    search = _Search(flat, here, np.append(here.x, z))
    for start in [search.start] if warm is None else [warm.w, search.start]:
        root = newton(search.system, start, search.box)
        if not search.accepts(root):
            continue
        if search.steady_between(start, root.z) or not search.accepts(search.pseudo_transient(start)):
            return search.at(root.z)
        return search.at(search.last)
    if search.accepts(search.pseudo_transient(search.start)) or (continued and search.accepts(search.continued())):
        return search.at(search.last)
    raise SolveError(f"{who}: {search.problem(tuple(named))}")


class Rates:
    """(x, z, u, p) -> derivatives and algebraic residuals, and their Jacobian in x and z, sparse where it is large.

    Args:
        flat: the model
    """

    def __init__(self, flat: FlatModel) -> None:
        equations = ca.vertcat(flat.ode, flat.residual)
        jacobian = ca.jacobian(equations, ca.vertcat(flat.x, flat.z))
        entries = ca.vertcat(ca.SX(0, 1), *jacobian.nonzeros())
        self._values = Fast("rates", flat.point, [equations, entries])
        self._row, self._first, self.n = jacobian.row(), jacobian.colind(), jacobian.shape[0]

    def __call__(self, *values: np.ndarray) -> tuple[np.ndarray, Matrix]:
        """Both at some values."""
        rate, entries = self._values(*values)
        matrix = csc_matrix((entries.ravel(), self._row, self._first), (self.n, self.n))
        return rate.ravel(), matrix if self.n > DENSE else matrix.toarray()


@once
def rates(flat: FlatModel) -> Rates:
    """The rates of a model, made once."""
    return Rates(flat)


def unknowns_box(flat: FlatModel) -> Box:
    """Ranges and nominals of states and algebraic variables."""
    columns = [(q.low, q.high, q.nominal, STRIDE) for q in flat.states]
    columns += [(-np.inf, np.inf, q.nominal, np.inf) for q in flat.algebraic]
    return Box(*np.array(columns).reshape(-1, 4).T)


class _Search:
    """One search for an equilibrium: it remembers where it got to, for the message."""

    def __init__(self, flat: FlatModel, here: Point, start: np.ndarray) -> None:
        self.flat, self.here, self.start = flat, here, start
        self.box, self.rates, self.n = unknowns_box(flat), rates(flat), len(flat.states)
        self.last = start
        self.steps = 0
        self.unstable: np.ndarray | None = None
        self.share = 0.0

    @property
    def system(self) -> System:
        """Derivatives and algebraic residuals with their Jacobian at the inputs given."""
        return self._at(self.here.u)

    def _at(self, u: np.ndarray) -> System:
        return lambda w: self.rates(w[: self.n], w[self.n :], u, self.here.p)

    def at(self, w: np.ndarray) -> Equilibrium:
        """Unknowns as an equilibrium."""
        return Equilibrium(w[: self.n], w[self.n :])

    def accepts(self, root: Root) -> bool:
        """Note where a method ended; True for a stable equilibrium."""
        self.steps += root.steps
        self.last = root.z
        if root.found and not self._stable(root.z):
            self.unstable = root.z
            return False
        return root.found

    def _stable(self, w: np.ndarray) -> bool:
        return stable(reduce_jacobian(self.system(w)[1], self.n))

    def steady_between(self, start: np.ndarray, end: np.ndarray) -> bool:
        """Whether nothing between two points would run away: else the machine decides by itself where it settles."""
        return all(self._stable(start + s * (end - start)) for s in BETWEEN)

    def pseudo_transient(self, start: np.ndarray) -> Root:
        """Where the machine settles from a start."""
        return pseudo_transient(self.system, start, self.box, self.n)

    def continued(self) -> Root:
        """Continue the equilibrium from the model's own inputs to those given."""
        own, asked = self.flat.starts("input"), self.here.u
        if (own == asked).all():
            return Root(self.last, False, 0)
        begin = pseudo_transient(self._at(own), self.start, self.box, self.n)
        if not begin.found:
            return Root(self.last, False, begin.steps)
        root = homotopy(lambda share: self._at(own + share * (asked - own)), begin.z, self.box)
        self.share = root.share
        return Root(root.z, root.found, begin.steps + root.steps)

    def problem(self, named: tuple[str, ...]) -> str:
        """Why there is no equilibrium, in words."""
        flat, n = self.flat, self.n
        rate, jacobian = self.system(self.last)
        jacobian = jacobian.toarray() if issparse(jacobian) else jacobian
        if (loose := self._loose(reduce_jacobian(jacobian, n))) is not None:
            return f"nothing holds {loose}: it keeps any value. Connect what drives or cools it, or give it a load."
        scale = self.box.scale[:n]
        worst = int(np.argmax(np.abs(np.where(np.isfinite(rate[:n]), rate[:n], np.inf)) / scale))
        if self.unstable is not None:
            worst = int(np.argmax(np.abs(self.unstable[:n] - self.here.x) / scale))
        q = flat.states[worst]
        reached = text(self.last[worst] if self.unstable is None else self.unstable[worst], q.unit, 4)
        if self.unstable is not None:
            reason = f"The only equilibrium found, {q.name} = {reached}, is one the machine leaves by itself."
        else:
            reason = REMEDIES.get(q.unit, f"{q.name} finds no equilibrium: check what drives it.")
        partly = f" There are solutions up to {100 * self.share:.0f} % of these inputs." if self.share > 0 else ""
        last = f"(last {q.name} {reached} after {self.steps} steps)"
        return f"no solution at {conditions(flat, self.here.u, named)} {last}.\n{reason}{partly}"

    def _loose(self, jacobian: np.ndarray) -> str | None:
        """The state a singular Jacobian says nothing about."""
        if not np.isfinite(jacobian).all():
            return None
        rows = np.abs(jacobian).max(axis=1, initial=0.0, keepdims=True)
        _, size, directions = np.linalg.svd(jacobian / np.where(rows > 0, rows, 1.0) * self.box.scale[: self.n])
        if size[-1] > 1e-13 * max(size[0], 1e-300):
            return None
        return self.flat.states[int(np.argmax(np.abs(directions[-1])))].name


def conditions(flat: FlatModel, u: np.ndarray, named: tuple[str, ...]) -> str:
    """The inputs that matter, in the units they are shown in.

    Args:
        flat: the model
        u: inputs (m), SI
        named: paths of those to tell
    """
    moved = [q for q, value in zip(flat.inputs, u, strict=True) if value != q.start]
    given = [q for q in flat.inputs if q.name in named] or moved
    chosen = (given or list(flat.inputs))[:SHOWN]
    written = [f"{q.name} = {text(u[flat.index[q.name][1]], q.unit, 4)}" for q in chosen]
    more = f" and {len(given) - SHOWN} more" if len(given) > SHOWN else ""
    return (", ".join(written) + more) or "the given values"
