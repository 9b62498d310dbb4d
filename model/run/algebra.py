"""The algebraic variables of a flat model: what its implicit blocks come to at given states, inputs and parameters."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterator

import casadi as ca
import numpy as np

from ..core.flat import FlatModel
from ..errors import SolveError
from ..units import text
from .fast import Fast, once
from .newton import CONTRACTION, CONVERGED, Box, System, homotopy, newton
from .result import outside

#: Where an iteration starts, in nominals from the model's own guess, when it finds no way from there.
GUESSES = (1.0, 10.0, 100.0, 1000.0)

#: Corrections of many points at once before each is left to its own damped iteration.
MOST_TOGETHER = 8


class Algebra:
    """The algebraic equations of one model, compiled.

    Args:
        flat: the model
    """

    def __init__(self, flat: FlatModel) -> None:
        self._flat = weakref.proxy(flat)
        self.quantities, self.blocks = flat.algebraic, flat.residual_names
        self.start = flat.starts("algebraic")
        nominal = np.array([q.nominal for q in flat.algebraic])
        self.box = Box(np.full(len(nominal), -np.inf), np.full(len(nominal), np.inf), nominal, np.inf)
        jacobian = ca.jacobian(flat.residual, flat.z)
        self._equations = Fast("algebra", flat.point, [flat.residual, jacobian])
        self._many = ca.Function("algebra", flat.point, [flat.residual, ca.densify(jacobian)], {"cse": True})

    def solve(self, x: np.ndarray, u: np.ndarray, p: np.ndarray, warm: np.ndarray | None = None) -> np.ndarray:
        """The algebraic variables at one point.

        Newton's method from the last solution, then from the model's guess and from larger ones, then along a
        homotopy from the guess.

        Args:
            x, u, p: states, inputs and parameters, SI
            warm: values to try first

        Raises:
            SolveError: no method converges; names the block
        """
        if not len(self.start):
            return self.start
        system = self.system(x, u, p)
        for guess in self._guesses(warm):
            root = newton(system, guess, self.box)
            if root.found:
                return root.z
        root = homotopy(self._from_guess(system), self.start, self.box)
        if root.found:
            return root.z
        raise SolveError(self._problem(system, root.z, (x, u, p)))

    def solve_rows(self, x: np.ndarray, u: np.ndarray, p: np.ndarray, warm: np.ndarray | None = None) -> np.ndarray:
        """The algebraic variables at many points, a column each: by full corrections of all, else point by point.

        Args:
            x, u, p: states, inputs and parameters by points, SI
            warm: values to begin with, by points

        Raises:
            SolveError: a point has no solution; names the block
        """
        n, rows = len(self.start), x.shape[1]
        z = np.tile(self.start[:, None], (1, rows)) if warm is None else warm.copy()
        if not n:
            return z
        easy, last = np.ones(rows, dtype=bool), np.full(rows, np.inf)
        for _ in range(MOST_TOGETHER):
            d = self._corrections(x, z, u, p)
            length = np.max(np.abs(d) / self.box.scale[:, None], axis=0)
            easy &= np.isfinite(length) & ((length <= CONTRACTION * last) | (length <= CONVERGED))
            z, last = np.where(easy, z + d, z), length
            if (length[easy] <= CONVERGED).all():
                break
        else:
            easy &= last <= CONVERGED
        for k in np.flatnonzero(~easy):
            z[:, k] = self.solve(x[:, k], u[:, k], p[:, k], None if warm is None else warm[:, k])
        return z

    def system(self, x: np.ndarray, u: np.ndarray, p: np.ndarray) -> System:
        """z -> residuals and their Jacobian in z at one point.

        Args:
            x: states (n), SI
            u: inputs (m), SI
            p: parameters, SI
        """
        n = len(self.start)

        def equations(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            residual, jacobian = self._equations(x, z, u, p)
            return residual, jacobian.reshape(n, n)

        return equations

    def _guesses(self, warm: np.ndarray | None) -> Iterator[np.ndarray]:
        if warm is not None and np.isfinite(warm).all():
            yield warm
        yield self.start
        yield from (self.start + factor * self.box.scale for factor in GUESSES)

    def _from_guess(self, system: System) -> Callable[[float], System]:
        """The equations less a falling share of what the guess leaves of them."""
        left, _ = system(self.start)

        def at(share: float) -> System:
            def equations(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
                residual, jacobian = system(z)
                return residual - (1 - share) * left, jacobian

            return equations

        return at

    def _corrections(self, x: np.ndarray, z: np.ndarray, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Newton's corrections at many points, a column each; infinite where there is none."""
        n, rows = z.shape
        residual, jacobian = (np.array(value) for value in self._many(x, z, u, p))
        matrices = jacobian.reshape(n, rows, n).transpose(1, 0, 2)
        sound = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(residual).all(axis=0)
        sound[sound] = np.abs(np.linalg.det(matrices[sound])) > 0
        d = np.full((n, rows), np.inf)
        d[:, sound] = np.linalg.solve(matrices[sound], -residual.T[sound][..., None])[..., 0].T
        return d

    def _problem(self, system: System, z: np.ndarray, point: tuple[np.ndarray, ...]) -> str:
        """Why there is no solution: what reigns where a law is left, else the equation that is farthest off."""
        residual, _ = system(z)
        worst = int(np.argmax(np.where(np.isfinite(residual), np.abs(residual), np.inf)))
        q, (x, u, p) = self.quantities[worst], point
        values = self._flat.function.call({"x": x, "z": z, "u": u, "p": p})
        there = outside(self._flat, {name: np.array(value) for name, value in values.items()})
        reasons = [f"{o.component}: {o.regime}." for o in there if o.regime]
        return (
            f'the equation "{self.blocks[worst]}" has no solution here '
            f"(last {q.name} {text(float(z[worst]), q.unit, 4)}).\n"
        ) + (" ".join(reasons) or "Check speeds, torques, temperatures and parameters of that part.")


@once
def algebra(flat: FlatModel) -> Algebra:
    """The algebraic equations of a model, compiled once."""
    return Algebra(flat)
