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

from dataclasses import dataclass, replace

import numpy as np

from . import stencil
from .case import Array
from .grid import Grid
from .krylov import fgmres
from .multigrid import Cycle, linearise
from .reynolds import Reynolds

#: Residual of the linear equations, over that before, at which a Newton step is good enough.
FORCING = 3e-2
#: Largest number of products in a Newton step.
PRODUCTS = 40
#: Largest change of pressure in a Newton step [1].
LARGEST = 0.5

#: Mass that arrives, in units of pressure, above which touching surfaces come apart [1].
RELEASED = 1e-9
TINY = 1e-300


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
    """

    def __init__(self, problem: Problem, state: State) -> None:
        grid, p = problem.grid, state.p
        self._k_0 = float(grid.deformation.near[0, 0])
        inner = np.zeros(p.shape, dtype=bool)
        inner[1:-1, 1:-1] = True
        film = problem.film(state)
        h = np.maximum(film, problem.floor)
        r = problem.reynolds.residual(p, h)
        layers = problem.reynolds.linear(p, h)
        scale = 1 / (np.abs(layers[0][stencil.CENTRE]) + np.abs(layers[1][stencil.CENTRE]) * self._k_0 + TINY)
        arrives = r * scale > RELEASED
        self.touching = inner & ((film < problem.floor) | (state.touching & (p > 0) & ~arrives))
        active = self.touching | (inner & ((p > 0) | (r > 0)))
        self.linear = linearise(grid, layers, active, self.touching)
        self._scale = np.where(active, np.where(self.touching, 1 / self._k_0, scale), 1.0)
        self._scale_load = grid.n / problem.load
        right = np.where(self.touching, film - problem.floor, np.where(active, -r, 0.0))
        self.right = self._joined(right, problem.load - self.linear.load(p))
        self.norm = float(np.linalg.norm(self.right)) / grid.n
        self._cycle = lambda: Cycle(self.linear, problem.reynolds, p, h)
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
        cycle = self._cycle()

        def precondition(v: Array) -> Array:
            p, h_0 = cycle(v[:-1].reshape(self._scale.shape) / self._scale, float(v[-1]) / self._scale_load)
            return np.append(p.ravel(), h_0)

        x, products = fgmres(self._product, precondition, self.right, FORCING, PRODUCTS)
        return x[:-1].reshape(self._scale.shape), float(x[-1]), products


def newton(problem: Problem, start: State, tolerance: float, steps: int) -> State:
    """Pressure and approach on a grid; the last of `residuals` says how well they hold.

    Args:
        problem: what has to hold
        start: where to begin
        tolerance: scaled residual at which it stops [1]
        steps: largest number of Newton steps
    """
    import os

    state = start
    norms: list[float] = []
    work = start.work
    for it in range(steps):
        step = Step(problem, state)
        norms.append(step.norm)
        if step.norm < tolerance:
            break
        p, h_0, products = step.solved()
        work += products
        share = min(1.0, LARGEST / float(np.abs(p).max()))
        if os.environ.get("EHLV"):
            print(
                f"  n={problem.grid.n} it={it} res={step.norm:.2e} k={products} dp={np.abs(p).max():.2e} touch={step.touching.sum()} hmin={step.h.min():.3e} pmax={state.p.max():.3f}"
            )
        state = State(np.maximum(state.p + share * p, 0.0), state.h_0 + share * h_0, step.touching)
    return replace(state, residuals=tuple(norms), work=work)
