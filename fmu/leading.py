"""The directions in which uncertain parameters move the results most, and how states and outputs move along them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..model.core.eliminate import Factors
from ..model.core.flat import FlatModel
from ..model.errors import FmuError, SolveError
from ..model.run.algebra import algebra
from ..model.run.schedule import Schedule
from ..model.run.simulate import simulate
from .description import EXPERIMENT
from .equations import Equations, full
from .variables import Table, Variable

#: Diagonal coefficient of the L-stable method of two stages, order 2 (Kennedy and Carpenter 2016, NASA/TM-2016-219173).
GAMMA = 1 - 0.5**0.5

_POINT = ["x", "z", "u", "p", "c", "p_dot", "c_dot"]
#: Share by which a standard deviation may come out too small for the directions left out.
SHORTFALL = 0.01
#: Intervals of the run in which the directions are weighed, each longer than the one before by one factor.
_INTERVALS = 80
#: End of the first interval, as a share of the run: fast states settle early.
_FIRST = 1e-4
#: Outer nodes of Gauss and Hermite's rule for three points [standard deviations].
_NODES = (-(3**0.5), 3**0.5)
#: Weights of its nodes, the middle one first.
_WEIGHTS = (2 / 3, 1 / 6, 1 / 6)
#: Why there is no mixture.
_NO_MIXTURE = "{}: the default experiment fails{}: no mixture. Take --uncertainty linear."
#: Part of its largest value in the run below which a standard deviation is not compared.
_SMALL = 0.01
#: Part of its nominal value below which it is not.
_NOTHING = 1e-6
#: Digits of a direction: what follows is round-off, which differs between machines.
_DIGITS = 9


@dataclass(frozen=True)
class Sensitivities:
    """The linear equations ds/dt = J s + F of the states' sensitivities along some directions.

    Attributes:
        model: the equations; the states of its audit have no sensitivities
        directions: how many directions there are
        moving: positions of the parameters that some direction moves
        shown: positions, among the states and behind them the outputs, of what has a standard deviation
    """

    model: Equations
    directions: int
    moving: tuple[int, ...]
    shown: tuple[int, ...]

    @cached_property
    def move(self) -> Any:
        """(x, z, u, p, c, p_dot, c_dot, h, s) -> s_new: a step of size h with J and F of the step's middle.

        Two solves of one matrix for each direction; the algebraic variables follow within.
        """
        found, _, _, _ = self.model.hoisted
        n, k, h = self._n, self.model.z.shape[0], ca.SX.sym("h")
        jacobian, own = self._moved(ca.vertcat(found["ode"][:n], found["residual"]))
        pure = ca.horzcat(ca.SX.eye(n), ca.SX(n, k))
        factors = Factors(ca.vertcat(pure - GAMMA * h * jacobian[:n, :], jacobian[n:, :]))
        s, added, rest = self._dots[2], GAMMA * h * own[:n, :], -own[n:, :]
        first = factors.solve(ca.vertcat(s + added, rest))[:n, :]
        ahead = s + (1 / GAMMA - 1) * (first - s)
        second = factors.solve(ca.vertcat(ahead + added, rest))[:n, :]
        return full("move", [*self._point, h, s], [second], [*_POINT, "h", "s"], ["s_new"])

    @cached_property
    def slopes(self) -> Any:
        """(x, z, u, p, c, p_dot, c_dot, s) -> y_dot: what is shown along each direction (shown, directions)."""
        return full("slopes", [*self._point, self._dots[2]], [self._slopes], [*_POINT, "s"], ["y_dot"])

    @cached_property
    def deviations(self) -> Any:
        """(x, z, u, p, c, p_dot, c_dot, s) -> sd: standard deviation of what is shown."""
        sd = ca.sqrt(ca.sum2(self._slopes**2))
        return full("deviations", [*self._point, self._dots[2]], [sd], [*_POINT, "s"], ["sd"])

    @property
    def functions(self) -> tuple[Any, ...]:
        """The functions that the C code needs beside those of the equations."""
        return (self.move, self.deviations)

    @property
    def _n(self) -> int:
        return int(self.model.x.shape[0]) - 2 * self.model.audit

    @cached_property
    def _dots(self) -> tuple[Any, Any, Any]:
        """Symbols of the directions: of the parameters, of the constants that follow, of the states."""
        _, c, _, _ = self.model.hoisted
        sizes = {"p_dot": self.model.p.shape[0], "c_dot": c.shape[0], "s": self._n}
        p_dot, c_dot, s = (ca.SX.sym(name, size, self.directions) for name, size in sizes.items())
        return p_dot, c_dot, s

    @property
    def _point(self) -> list[Any]:
        model = self.model
        return [model.x, model.z, model.u, model.p, model.hoisted[1], *self._dots[:2]]

    def _moved(self, values: Any) -> tuple[Any, Any]:
        """Jacobian of values by states and algebraic variables, and how they move with the parameters alone."""
        _, c, constants, _ = self.model.hoisted
        moving = list(self.moving)
        follow = sorted(set(ca.jacobian_sparsity(constants, self.model.p[moving]).get_triplet()[0]))
        dots = ca.vertcat(self._dots[0][moving, :], self._dots[1][follow, :])
        own = ca.mtimes(ca.jacobian(values, ca.vertcat(self.model.p[moving], c[follow])), dots)
        return ca.jacobian(values, ca.vertcat(self.model.x[: self._n], self.model.z)), own

    @cached_property
    def _slopes(self) -> Any:
        found, _, _, _ = self.model.hoisted
        shown = ca.vertcat(self.model.x, found["y"])[list(self.shown)]
        n, m, s = self._n, len(self.shown), self._dots[2]
        jacobian, own = self._moved(ca.vertcat(shown, found["residual"]))
        z_dot = Factors(jacobian[m:, n:]).solve(-ca.mtimes(jacobian[m:, :n], s) - own[m:, :])
        return ca.mtimes(jacobian[:m, :n], s) + ca.mtimes(jacobian[:m, n:], z_dot) + own[:m, :]


@dataclass(frozen=True)
class Uncertainty:
    """One reason why results are uncertain, independent of all others.

    Attributes:
        name: in words
        changes: path of a parameter, or of a state for its start -> what it changes by at one standard deviation (SI)
    """

    name: str
    changes: Mapping[str, float]


@dataclass(frozen=True)
class Uncertain:
    """What an FMU with standard deviations is asked for.

    Attributes:
        reasons: why results are uncertain
        shown: states and outputs that get a standard deviation
        mixture: whether the model itself runs at three nodes along the leading direction, and is linear about each
        tell: called with the directions that are found
    """

    reasons: tuple[Uncertainty, ...]
    shown: tuple[str, ...]
    mixture: bool = False
    tell: Callable[[Directions], None] = lambda found: None


@dataclass(frozen=True)
class Side:
    """A node of a mixture along the leading direction: parameters are there p * factors + shifts.

    Attributes:
        node: where it lies [standard deviations]
        factors, shifts: of the parameters (parameters,); those that are zero are shifted, as none are
        states: change of the states' starts (states,)
    """

    node: float
    factors: np.ndarray
    shifts: np.ndarray
    states: np.ndarray


@dataclass(frozen=True)
class Directions:
    """The leading directions of some uncertainties, independent of each other: one standard deviation along each.

    Attributes:
        parameters: change of the parameters along each direction (parameters, directions)
        states: change of the states' starts (states, directions)
        reasons: what they combine
        shortfall: share by which a standard deviation comes out too small for what is left out, at most, at any time of
            the default experiment; None where that run fails and nothing is left out
        off: largest difference of a linear standard deviation from that of the mixture there, relative to the latter;
            None where that is not known
        sides: of a mixture its other nodes; their direction is none of `parameters` and `states`
    """

    parameters: np.ndarray
    states: np.ndarray
    reasons: tuple[Uncertainty, ...]
    shortfall: float | None
    off: float | None = None
    sides: tuple[Side, ...] = ()

    @property
    def count(self) -> int:
        """How many directions there are."""
        return int(self.parameters.shape[1])

    @property
    def moving(self) -> tuple[int, ...]:
        """Positions of the parameters that some direction moves; the first where states alone are uncertain."""
        return tuple(np.flatnonzero(self.parameters.any(axis=1)).tolist()) or (0,)


def locate_deviations(table: Table) -> tuple[int, ...]:
    """Positions, among the states of a table and behind them the outputs, of what has a standard deviation."""
    states, inputs = len(table.of("state")), len(table.of("input"))
    places = [v.of for v in table.of("deviation") if v.of is not None]
    return tuple(place if place < states else place - inputs for place in places)


def leading(flat: FlatModel, model: Equations, table: Table, what: Uncertain) -> Directions:
    """The fewest directions that show the standard deviations.

    The sensitivities to all uncertainties are integrated over the default experiment, at the inputs' start values.
    Their singular vectors are the directions; each deviation counts alike at each time. The model runs at the nodes of
    the mixture, too, which tells how far linear deviations are off.

    Args:
        flat: the model, with the parameters of the FMU
        model: its equations
        table: its variables with their start values
        what: is uncertain

    Raises:
        FmuError: none of it moves a parameter or a state of the model; the model does not run at a node of the mixture
    """
    parameters, states = table.of("parameter"), table.of("state")[: len(flat.states)]
    known = {v.name for v in (*parameters, *states)}
    reasons = tuple(r for r in what.reasons if any(change and path in known for path, change in r.changes.items()))
    if not reasons:
        raise FmuError(f"{flat.name}: no parameter with an uncertainty has an effect: no standard deviations.")
    full = Directions(_changes(parameters, reasons), _changes(states, reasons), reasons, None)
    try:
        middle = _run(flat, model, table, full, _side(table, full, np.zeros(len(reasons)), 0.0))
    except SolveError:
        if what.mixture:
            raise FmuError(_NO_MIXTURE.format(flat.name, "")) from None
        return full
    deviations = np.sqrt((middle[1] ** 2).sum(axis=2))  # (times, shown)
    scaled = middle[1] / np.maximum(deviations, 1e-300)[:, :, None]
    turned = np.linalg.svd(scaled.reshape(-1, full.count), full_matrices=False)[2].T
    turned = turned * np.sign(turned[np.abs(turned).argmax(axis=0), range(turned.shape[1])])  # either sign would do
    short = 1 - np.sqrt(np.cumsum((scaled @ turned) ** 2, axis=2)[deviations > 0].min(axis=0))
    count = int(np.argmax(short <= SHORTFALL)) + 1
    sides = tuple(_side(table, full, turned[:, 0], node) for node in _NODES)
    try:
        mixed = _mix([middle, *(_run(flat, model, table, full, side) for side in sides)], turned[:, 0])
    except SolveError:
        if what.mixture:
            at = f" with parameters at {_NODES[1]:.3g} standard deviations"
            raise FmuError(_NO_MIXTURE.format(flat.name, at)) from None
        off = None
    else:
        least = _SMALL * mixed.max(axis=0) + _NOTHING * np.array([v.quantity.nominal for v in table.of("deviation")])
        off = float((np.abs(deviations - mixed) / np.maximum(mixed, least)).max())
    kept = turned[:, what.mixture : count]
    if not kept.size:  # the code has one at least
        kept = np.zeros((full.count, 1))
    return Directions(
        _round(full.parameters @ kept),
        _round(full.states @ kept),
        reasons,
        max(float(short[count - 1]), 0.0),
        off,
        sides if what.mixture else (),
    )


def _side(table: Table, full: Directions, direction: np.ndarray, node: float) -> Side:
    """A node along a direction (reasons,). Logarithms of parameters are normal; one that is zero is so itself."""
    start = np.array([v.start or 0.0 for v in table.of("parameter")])
    moved, scale = node * full.parameters @ direction, np.where(start, start, 1.0)
    return Side(
        node,
        _round(np.where(start, np.exp(moved / scale), 1.0)),
        _round(np.where(start, 0.0, moved)),
        _round(node * full.states @ direction),
    )


def _mix(nodes: Sequence[tuple[np.ndarray, np.ndarray]], direction: np.ndarray) -> np.ndarray:
    """Standard deviations (times, shown) of a mixture from values and slopes at its nodes along a direction."""
    weights = np.array(_WEIGHTS)[:, None, None]
    values = np.array([y for y, _ in nodes])
    across = [((slopes - (slopes @ direction)[:, :, None] * direction) ** 2).sum(axis=2) for _, slopes in nodes]
    apart = (values - (weights * values).sum(axis=0)) ** 2
    return np.asarray(np.sqrt((weights * (np.array(across) + apart)).sum(axis=0)))


def _changes(variables: Sequence[Variable], reasons: Sequence[Uncertainty]) -> np.ndarray:
    """Change of each variable for each reason (variables, reasons)."""
    changes = [[r.changes.get(v.name, 0.0) for r in reasons] for v in variables]
    return np.array(changes).reshape(len(variables), len(reasons))


def _round(matrix: np.ndarray) -> np.ndarray:
    return np.array([float(f"{value:.{_DIGITS}g}") for value in matrix.ravel()]).reshape(matrix.shape)


def _run(
    flat: FlatModel, model: Equations, table: Table, full: Directions, side: Side
) -> tuple[np.ndarray, np.ndarray]:
    """What is shown (times, shown), and along each direction (times, shown, directions), in the default experiment."""
    stop = float(EXPERIMENT["stopTime"])
    edges = np.append(0.0, stop * np.geomspace(_FIRST, 1.0, _INTERVALS))
    times = np.sort(np.append(edges, (edges[1:] + edges[:-1]) / 2))
    parameters, inputs, states = table.of("parameter"), table.of("input"), table.of("state")[: len(flat.states)]
    start, u = (np.array([v.start or 0.0 for v in group]) for group in (parameters, inputs))
    p = np.clip(start * side.factors + side.shifts, *np.array([v.bounds for v in parameters]).T)
    begin = {v.name: (v.start or 0.0) + change for v, change in zip(states, side.states.tolist(), strict=True)}
    values = {v.name: v.start or 0.0 for v in inputs} | dict(zip((v.name for v in parameters), p.tolist(), strict=True))
    run = simulate(flat, Schedule(np.array([0.0, stop]), {}), start=begin, values=values, times=times)
    x = np.array([run[name] for name in begin])
    z = algebra(flat).solve_rows(x, np.tile(u[:, None], len(times)), np.tile(p[:, None], len(times)), None)
    x = np.vstack([x, np.zeros((2 * table.audit, len(times)))])
    linear = Sensitivities(model, full.count, full.moving, locate_deviations(table))
    c = model.constants(p)
    p_dot, s = full.parameters * np.where(start, p / np.where(start, start, 1.0), 1.0)[:, None], full.states
    c_dot = np.hstack([model.constants_directional(p, column).full() for column in p_dot.T])
    rows = []
    for k, length in enumerate(np.diff(edges)):
        middle, end = 2 * k + 1, 2 * k + 2
        s = linear.move(x[:, middle], z[:, middle], u, p, c, p_dot, c_dot, length, s).full()
        rows.append(linear.slopes(x[:, end], z[:, end], u, p, c, p_dot, c_dot, s).full())
    of = {v.reference: v.name for v in table}
    shown = np.array([run[of[v.of]][2::2] for v in table.of("deviation") if v.of is not None]).T
    return shown, np.array(rows)
