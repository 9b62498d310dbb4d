"""A hypothesis fitted: nuisances, sizes and shapes of its causes together, by damped Gauss-Newton to convergence.

Every unknown is counted in standard deviations of its prior: a shape by the normal number that its share of the prior
stands for, a size in multiples of twice its half width.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import ndtr, ndtri

from ...model.errors import SolveError
from ..effects.cause import Cause, Theta
from .problem import Linear, Problem

#: Steps at most, and tries of each with more damping (Levenberg and Marquardt).
STEPS, TRIES = 10, 4
#: Length of a step of a nuisance, a size and a shape.
LONGEST = {"z": 1.5, "size": 0.75, "shape": 0.8}
#: A step that gains less than this in log likelihood is the last.
LITTLE = 0.1
#: Of the difference quotients by a shape, and by a size.
SHAPE_STEP, SIZE_STEP = 0.2, 0.05
#: Shapes stay inside so many standard deviations.
FAR = 2.4


@dataclass(frozen=True)
class Mode:
    """Where the shapes of a cause are most likely: shares of their priors, and covariance of the normal numbers."""

    shares: np.ndarray
    covariance: np.ndarray


@dataclass(frozen=True)
class Fit:
    """Most likely nuisances and parameters of causes, how well the shapes are known, and half the squared misfit."""

    z: np.ndarray
    theta: Mapping[str, Theta]
    modes: Mapping[str, Mode]
    cost: float
    sizes: Mapping[str, float]

    @property
    def start(self) -> dict[str, tuple[np.ndarray, float]]:
        """Where another fit may go on: cause -> shares of its shapes, and size."""
        return {name: (mode.shares, self.sizes[name]) for name, mode in self.modes.items()}


def fitted(problem: Problem, linear: Linear, start: Mapping[str, tuple[np.ndarray, float]], steps: int = STEPS) -> Fit:
    """Fit the causes of a linearisation.

    Args:
        problem: data and model
        linear: made with the causes acting; its nuisances are where the fit begins
        start: cause -> shares of its shapes, and size, where the fit begins
        steps: at most

    Raises:
        SolveError: the model cannot be run where the fit begins
    """
    return _Fitting(problem, linear, start).run(steps)


class _Fitting:
    def __init__(self, problem: Problem, linear: Linear, start: Mapping[str, tuple[np.ndarray, float]]) -> None:
        self.problem, self.linear, self.causes = problem, linear, list(linear.causes)
        self.n = len(linear.z)
        self.part = problem.place(problem.data)
        self.factor = cho_factor(linear.noise)
        self.choices = {c.id: start[c.id][0][c.choice] for c in self.causes if c.choice is not None}
        self.labels: list[tuple[str, Cause, int]] = []
        x = list(linear.z)
        for c in self.causes:
            shares, size = start[c.id]
            self.labels.append(("size", c, -1))
            x.append(size / (2 * c.size.sd))
            for k in self.free(c):
                self.labels.append(("shape", c, k))
                x.append(float(np.clip(ndtri(shares[k]), -FAR, FAR)))
        self.x = np.array(x)

    @staticmethod
    def free(cause: Cause) -> list[int]:
        """The shapes that are no choice."""
        return [k for k in range(len(cause.shapes)) if k != cause.choice]

    def shares(self, x: np.ndarray, cause: Cause) -> np.ndarray:
        """Shares of a cause's shapes."""
        found = np.full(len(cause.shapes), self.choices.get(cause.id, 0.5))
        for (kind, c, k), value in zip(self.labels, x[self.n :], strict=True):
            if kind == "shape" and c is cause:
                found[k] = float(ndtr(value))
        return found

    def theta(self, x: np.ndarray) -> dict[str, Theta]:
        """Parameters of all causes."""
        found: dict[str, Theta] = {}
        for (kind, c, _), value in zip(self.labels, x[self.n :], strict=True):
            if kind == "size":
                form = c.forms(self.shares(x, c)[None])[0]
                found[c.id] = {**form, c.size.name: 2 * c.size.sd * float(value)}
        return found

    def at(self, x: np.ndarray) -> tuple[Mapping[str, float], Mapping[str, Theta]]:
        """Values of the rig and parameters of the causes."""
        return self.problem.parameters.values(x[: self.n]), self.theta(x)

    def run(self, steps: int) -> Fit:
        shown, J, H = self.looked(self.x)
        cost = self.cost(self.x, shown)
        if not np.isfinite(cost):
            raise SolveError("the model cannot be run where the fit of its causes begins.")
        damping = 0.0
        for _ in range(steps):
            gradient = J.T @ cho_solve(self.factor, self.problem.measured - shown) - self.x
            for _ in range(TRIES):
                change = self.limited(np.linalg.solve(H + damping * np.diag(np.diag(H)), gradient))
                new = self.legal(self.x + change)
                found = self.looked(new)
                value = self.cost(new, found[0])
                if np.isfinite(value) and value <= cost + 1e-6:
                    break
                damping = max(5 * damping, 0.3)
            else:
                break
            gained, damping = cost - value, damping / 5
            self.x, cost, (shown, J, H) = new, value, found
            if gained < LITTLE:
                break
        theta = self.theta(self.x)
        sizes = {c.id: theta[c.id][c.size.name] for c in self.causes}
        return Fit(self.x[: self.n], theta, self.modes(np.linalg.inv(H)), cost, sizes)

    def cost(self, x: np.ndarray, shown: np.ndarray) -> float:
        """Half the squared misfit, priors included."""
        r = self.problem.measured - shown
        if not np.isfinite(r).all():
            return float("inf")
        return float(0.5 * r @ cho_solve(self.factor, r) + 0.5 * x @ x)

    def looked(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What all instruments show there, its Jacobian by all unknowns, and the Hessian of the cost."""
        xs, steps = [at], []
        for k, (kind, _, _) in enumerate(self.labels):
            x = at.copy()
            length = SHAPE_STEP if kind == "shape" else max(SIZE_STEP, 0.1 * abs(x[self.n + k]))
            steps.append(-length if x[self.n + k] > 0 else length)
            x[self.n + k] += steps[-1]
            xs.append(x)
        columns, base = np.zeros((len(self.problem.measured), len(steps))), np.zeros(len(self.problem.measured))
        for c in self.problem.campaigns:
            part = self.problem.place(c)
            there = self.problem.shown_at(c, [self.at(x) for x in (xs if c.acting else xs[:1])], self.causes)
            base[part] = there[:, 0]
            if c.acting:
                columns[part] = (there[:, 1:] - there[:, :1]) / np.array(steps)
        columns[:, ~np.isfinite(columns).all(axis=0)] = 0.0
        J = np.concatenate([self.linear.jacobian, columns], axis=1)
        return base, J, J.T @ cho_solve(self.factor, J) + np.eye(J.shape[1])

    def limited(self, change: np.ndarray) -> np.ndarray:
        """A change no longer than can be trusted."""
        longest = np.array([LONGEST["z"]] * self.n + [LONGEST[kind] for kind, _, _ in self.labels])
        for k, (kind, _, _) in enumerate(self.labels):
            if kind == "size":
                longest[self.n + k] = max(LONGEST["size"], 0.6 * abs(self.x[self.n + k]))
        return np.asarray(np.clip(change, -longest, longest))

    def legal(self, x: np.ndarray) -> np.ndarray:
        """Unknowns inside their bounds."""
        x = x.copy()
        for k, (kind, c, _) in enumerate(self.labels):
            low, high = (c.size.low, c.size.high) if kind == "size" else (-FAR, FAR)
            scale = 2 * c.size.sd if kind == "size" else 1.0
            x[self.n + k] = np.clip(x[self.n + k], low / scale, high / scale)
        return np.asarray(x)

    def modes(self, covariance: np.ndarray) -> dict[str, Mode]:
        """Where each cause's shapes are, and how far they may be off."""
        found = {}
        for c in self.causes:
            own = [self.n + k for k, (kind, other, _) in enumerate(self.labels) if kind == "shape" and other is c]
            found[c.id] = Mode(self.shares(self.x, c), covariance[np.ix_(own, own)])
        return found
