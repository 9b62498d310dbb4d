"""How states and outputs move with the parameters along a run: a linear step beside each step of the solver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from ..model.core.eliminate import Factors
from .equations import Equations, full

#: Diagonal coefficient of the L-stable method of two stages, order 2 (Kennedy and Carpenter 2016, NASA/TM-2016-219173).
GAMMA = 1 - 0.5**0.5

_POINT = ["x", "z", "u", "p", "c", "p_dot", "c_dot"]


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
