"""Newton's method for one grid: pressure and approach, fluid film and touching surfaces in one system.

With the residual R of Reynolds' equation (mass that gathers at a node), pressure p and film h = h_0 + gap + K p, every
node is in one of three states:

    film:      R = 0,          p > 0,  h > h_floor
    cavity:    p = 0,          R <= 0: oil leaves faster than it arrives, and pressure cannot fall further
    touching:  h = h_floor,    R <= 0: oil leaves faster than it arrives, and the film cannot fall further

and the load fixes h_0. So where the film closes the deformed surfaces rest on one another, with a pressure that is
found from h = h_floor instead of from the oil (Holmes, Evans, Hughes and Snidle, J. Tribol. 127, 2005, take contact
nodes the same way); oil that arrives lifts them again. At rest the solution is Hertz's contact. Which state holds at a
node is guessed, the equations are solved, and the guess is corrected until it stays: an active-set Newton method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from . import stencil
from .case import Array
from .grid import Grid
from .multigrid import Cycle, linearise
from .reynolds import Reynolds

Map = Callable[[Array], Array]
#: Residual of the linear equations, over that before, at which a Newton step is good enough.
FORCING = 3e-2
#: Largest number of products in a Newton step.
PRODUCTS = 40
#: Largest change of pressure in a Newton step [1].
LARGEST = 0.5

#: Largest share of a film that closes in a Newton step [1].
CLOSING = 0.8
#: Mass that arrives, in units of pressure, above which touching surfaces come apart [1].
RELEASED = 1e-9
TINY = 1e-300
#: Newton steps that lift a film.
LIFTING = 2
#: Newton steps after which a step is held back like a step in time (pseudo-transient continuation, Kelley and Keyes,
#: SIAM J. Numer. Anal. 35, 1998), and how many nodes oil passes in it.
PATIENCE = 12
HELD = 4.0


def fgmres(apply: Map, precondition: Map, b: Array, tolerance: float, steps: int) -> tuple[Array, int]:
    """Solves A x = b from x = 0 (Saad, SIAM J. Sci. Comput. 14, 1993); also how many products were needed.

    Args:
        apply: x -> A x
        precondition: r -> roughly A^-1 r
        b: right side (n,)
        tolerance: norm of the residual over that of b at which it stops
        steps: largest number of products
    """
    beta = float(np.linalg.norm(b))
    if beta == 0:
        return np.zeros_like(b), 0
    v, z = np.empty((steps + 1, b.size)), np.empty((steps, b.size))
    h = np.zeros((steps + 1, steps))
    v[0] = b / beta
    for k in range(steps):
        z[k] = precondition(v[k])
        w = apply(z[k])
        for _ in range(2):  # orthogonalised twice
            share = v[: k + 1] @ w
            h[: k + 1, k] += share
            w = w - share @ v[: k + 1]
        h[k + 1, k] = np.linalg.norm(w)
        rhs = np.zeros(k + 2)
        rhs[0] = beta
        y = np.linalg.lstsq(h[: k + 2, : k + 1], rhs, rcond=None)[0]
        left = float(np.linalg.norm(rhs - h[: k + 2, : k + 1] @ y))
        if left <= tolerance * beta or h[k + 1, k] <= 1e-14 * beta:
            break
        v[k + 1] = w / h[k + 1, k]
    return np.asarray(y @ z[: k + 1]), k + 1


@dataclass(frozen=True)
class State:
    """Pressure (n, n) and approach, and how they were found.

    Args:
        p: pressure [1]
        h_0: film at the origin without deformation [1]
        touching: nodes where the surfaces touch (n, n)
        residuals: scaled residual before each step
        work: products with the operator
    """

    p: Array
    h_0: float
    touching: np.ndarray
    residuals: tuple[float, ...] = ()
    work: int = 0


@dataclass(frozen=True)
class Problem:
    """What has to hold on one grid.

    Args:
        grid: the grid
        reynolds: Reynolds' equation on it
        gap: gap of the undeformed bodies (n, n) [1]
        load: integral of the pressure [1]
        floor: smallest film, at which surfaces touch [1]
    """

    grid: Grid
    reynolds: Reynolds
    gap: Array
    load: float
    floor: float

    def film(self, state: State) -> Array:
        """Film of a state (n, n) [1]; below the floor where its pressure is not yet right."""
        return np.asarray(state.h_0 + self.gap + self.grid.deformation(state.p))


class Step:
    """The linear equations of one Newton step around a state.

    Args:
        problem: what has to hold
        state: pressure and approach
        slow: factor of a d(rho h)/dt that holds the film back, and vanishes as the steps do [1]
        least: film below which a first guess is lifted (n, n), in place of the smallest film [1]
    """

    def __init__(self, problem: Problem, state: State, slow: float = 0.0, least: Array | None = None) -> None:
        if problem.reynolds.kappa == 0:  # no oil: what does not touch bears nothing
            state = replace(state, p=np.where(state.touching | (problem.film(state) < problem.floor), state.p, 0.0))
        grid, p = problem.grid, state.p
        self.state = state
        self._k_0 = float(grid.deformation.near[0, 0])
        inner = np.zeros(p.shape, dtype=bool)
        inner[1:-1, 1:-1] = True
        film = problem.film(state)
        floor = problem.floor if least is None else np.maximum(least, problem.floor)
        h = np.maximum(film, floor)
        r = problem.reynolds.residual(p, h)
        moved = replace(problem.reynolds, squeeze=problem.reynolds.squeeze + slow)
        layers = moved.linear(p, h)
        scale = 1 / (np.abs(layers[0][stencil.CENTRE]) + np.abs(layers[1][stencil.CENTRE]) * self._k_0 + TINY)
        arrives = r * scale > RELEASED
        self.touching = inner & ((film < floor) | (state.touching & (p > 0) & ~arrives))
        active = self.touching | (inner & ((p > 0) | (r > 0)))
        self.linear = linearise(grid, layers, active, self.touching)
        self._scale = np.where(active, np.where(self.touching, 1 / self._k_0, scale), 1.0)
        self._scale_load = grid.n / problem.load
        right = np.where(self.touching, film - floor, np.where(active, -r, 0.0))
        self.right = self._joined(right, problem.load - self.linear.load(p))
        self.norm = float(np.linalg.norm(self.right)) / grid.n
        self._around = (moved, p, h)
        self.h = h

    def _joined(self, r: Array, load: float) -> Array:
        """One scaled vector of the equations at the nodes and of the load."""
        return np.append((r * self._scale).ravel(), load * self._scale_load)

    def _product(self, v: Array) -> Array:
        """Change of all equations with a change `v` of the unknowns."""
        p = v[:-1].reshape(self._scale.shape)
        return self._joined(self.linear(p, float(v[-1])), self.linear.load(p))

    def solved(self) -> tuple[Array, float, int]:
        """Changes of pressure and approach, and the number of products."""
        cycle = Cycle(self.linear, *self._around)

        def precondition(v: Array) -> Array:
            p, h_0 = cycle(v[:-1].reshape(self._scale.shape) / self._scale, float(v[-1]) / self._scale_load)
            return np.append(p.ravel(), h_0)

        x, products = fgmres(self._product, precondition, self.right, FORCING, PRODUCTS)
        return x[:-1].reshape(self._scale.shape), float(x[-1]), products

    def share(self, p: Array, h_0: float, floor: float) -> float:
        """How much of a change can be made: pressure changes little, films well above the floor do not close.

        Args:
            p: change of the pressure (n, n) [1]
            h_0: change of the approach [1]
            floor: smallest film [1]
        """
        thinner = -(self.linear.grid.deformation(p) + h_0)
        wide = (self.h > floor / (1 - CLOSING)) & (thinner > 0)
        closing = float(np.max(np.where(wide, thinner / self.h, 0.0))) / CLOSING
        return 1 / max(1.0, float(np.abs(p).max()) / LARGEST, closing)


def newton(problem: Problem, start: State, tolerance: float, steps: int, before: Array | None = None) -> State:
    """Pressure and approach on a grid; the last of `residuals` says how well they hold.

    Args:
        problem: what has to hold
        start: where to begin
        tolerance: scaled residual at which it stops [1]
        steps: largest number of Newton steps
        before: film on the coarser grid, at these nodes (n, n); where the pressure between its nodes would close it,
            the first steps lift it
    """
    state = start
    norms: list[float] = []
    work = start.work
    slow = 0.0
    for k in range(steps):
        least = before / 2 if before is not None and k < LIFTING else None
        step = Step(problem, state, slow, least)
        norms.append(step.norm)
        if step.norm < tolerance:
            break
        if k >= PATIENCE:
            slow = min(norms[-1] / norms[PATIENCE], 1.0) / (HELD * problem.grid.hx)
        p, h_0, products = step.solved()
        work += products
        share = step.share(p, h_0, problem.floor)
        now = step.state
        state = State(
            np.maximum(now.p + share * p, 0.0),
            now.h_0 + share * h_0,
            start.touching if least is not None else step.touching,
        )
    return replace(state, residuals=tuple(norms), work=work)
