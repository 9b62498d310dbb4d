"""A hypothesis fitted: nuisances, sizes and shapes of its causes together, by damped Gauss-Newton to convergence."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from ....model.errors import SolveError
from ..model.noise import law_shares
from .evidence import White, log_bayes_factor
from .problem import Acting, Look, Noise, Problem, priors

#: Steps at most.
STEPS = 12
#: Tries of each with more damping.
TRIES = 5
#: Gain in log likelihood that the last step brings or a further one promises.
LITTLE = 0.2
#: The share of what was promised that a step must bring if the next one is to be damped less.
TRUSTED = 0.7
#: Rounds of point and scatter in turn at most.
ROUNDS = 4
#: A fit whose slopes promise more than this has stalled at a bend or a bound, and what they promise does not come.
STALLED = 0.5
#: Log odds, a rule, of a machine that is as far from its rules as they leave open against one that is as near as what
#: else a rig file says.
OPEN = 1.15
#: Longest step of a nuisance.
LONGEST = 1.5
#: A size (or that share of it).
LONGEST_SIZE = 1.0
#: A shape.
LONGEST_SHAPE = 0.8
#: Share of the variance of what a form leaves that all channels have together; each has the rest for itself.
TOGETHER = 0.5
#: Standard deviations of what a form leaves of a true effect, as shares of it, and their probabilities.
FORM = ((0.01, 0.25), (0.03, 0.25), (0.06, 0.25), (0.12, 0.18), (0.24, 0.07))


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis: where it is, its scatter, and what it is worth.

    Args:
        look: readings and Jacobian at the most likely point
        noise: scatter with its most likely scales
        evidence: log of the marginal likelihood, without the prior of the hypothesis and what slopes promise where the
            fit has stalled
        form: standard deviation of what the forms leave, the most likely of `FORM`; 0 without a cause
        effects: of its causes on the data (m, k)
    """

    look: Look
    noise: Noise
    evidence: float
    form: float
    effects: np.ndarray

    @property
    def causes(self) -> tuple[str, ...]:
        """Ids of its causes."""
        return tuple(a.id for a in self.look.acting)

    def moved(self, problem: Problem, effect: np.ndarray) -> tuple[np.ndarray, tuple[Acting, ...]]:
        """Nuisances and causes where they go, to first order, as something with an effect (M,) joins."""
        vector, white = Vector(problem, self.look), White.of(self.noise.covariance)
        J = white(self.look.jacobian)
        change = np.linalg.solve(J.T @ J + np.diag(vector.precision), J.T @ white(effect))
        return vector.split(np.clip(self.look.x - change, vector.low, vector.high))

    def scatter(self, problem: Problem) -> np.ndarray:
        """Covariance (M, M) of the readings' scatter and of what the forms leave of the causes' effects."""
        return self.noise.covariance + self.form**2 * _rough(problem, self.effects)

    def linear(self, problem: Problem) -> tuple[White, np.ndarray]:
        """The linearised problem beside this hypothesis: whitening by all that is uncertain, and the residual in it.

        Nuisances, shapes and sizes of the hypothesis are uncertain by their priors, sizes by the widest.
        """
        J = self.look.jacobian
        wide = J / np.sqrt(Vector(problem, self.look).precision)
        white = White.of(self.scatter(problem) + wide @ wide.T)
        return white, white(problem.measured - self.look.shown + J @ self.look.x)


def _rough(problem: Problem, effects: np.ndarray) -> np.ndarray:
    """Covariance of what forms leave of the effects of their causes (m, k), as a smooth share of them (M, M).

    A form may bring a body more of its heat than it gets: that share differs from channel to channel.
    """
    alike = problem.alike * (TOGETHER + (1 - TOGETHER) * problem.same)
    rough = np.zeros((problem.m, problem.m))
    rough[problem.own, problem.own] = (effects @ effects.T) * alike
    return rough


@dataclass(frozen=True)
class Begin:
    """Where a fit begins.

    Args:
        z: nuisances
        scales: logarithms of the scales of the loose terms of its scatter; None: as stated
        laws: what laws leave open, as of `Look`; None: nothing
    """

    z: np.ndarray
    scales: np.ndarray | None = None
    laws: np.ndarray | None = None


class Vector:
    """The vector of a problem at a look: priors, those of sizes the widest, bounds, longest steps, places."""

    def __init__(self, problem: Problem, look: Look) -> None:
        self.acting, nz = look.acting, problem.nz
        counts = [a.formula.size for a in look.acting]
        #: Places of the sizes, and of the shapes.
        self.sizes = [nz + sum(counts[:k]) for k in range(len(counts))]
        self.shapes = np.setdiff1d(np.arange(nz, nz + sum(counts)), self.sizes)
        limits = [problem.data.limits[:, :nz], *(a.bounds for a in look.acting)]
        self.low, self.high = np.concatenate(limits, axis=1)
        self.precision = np.r_[look.sd**-2.0, np.ones(sum(counts))]
        self.precision[self.sizes] = [1 / a.widths[-1] ** 2 for a in look.acting]
        self.longest = np.r_[np.full(nz, LONGEST), np.full(sum(counts), LONGEST_SHAPE)]
        self.longest[self.sizes] = LONGEST_SIZE

    def split(self, x: np.ndarray) -> tuple[np.ndarray, tuple[Acting, ...]]:
        """Nuisances and causes."""
        z, *own = np.split(x, self.sizes)
        return z, tuple(replace(a, t=t) for a, t in zip(self.acting, own, strict=True))

    def step(self, x: np.ndarray, H: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        """The step that lowers a quadratic cost most, inside the bounds and not longer than is trusted."""
        longest = self.longest.copy()
        longest[self.sizes] = np.maximum(longest[self.sizes], 0.6 * np.abs(x[self.sizes]))
        low, high = np.maximum(self.low - x, -longest), np.minimum(self.high - x, longest)
        root = np.linalg.cholesky(H)
        wanted = solve_triangular(root, gradient, lower=True)
        return np.asarray(lsq_linear(root.T, wanted, (low, np.maximum(high, low + 1e-12)), method="bvls").x)


def fitted(problem: Problem, acting: Sequence[Acting], begun: Begin) -> Fit:
    """The most likely point of a hypothesis with the most likely scales of its scatter, and its evidence.

    Args:
        acting: its causes where the fit begins

    Raises:
        SolveError: the model cannot be run where the fit begins
    """
    look = _begun(problem, acting, begun)
    line, rules = _Line(problem, look), (problem.near < 1).any()
    noise = line.scattered(problem.noise(look, begun.scales))
    for k in range(ROUNDS):
        before, look = look, _settled(problem, look, noise)
        if k and look is not before:  # what scatters follows the point: whole ways go to and fro
            with suppress(SolveError):
                look = problem.look(*line.vector.split((before.x + look.x) / 2), look.sd, look.laws)
        line = _ruled(problem, look, noise) if rules else _Line(problem, look)
        if look is before and np.array_equal(line.look.sd, look.sd):
            break
        look, noise = line.look, line.scattered(noise)
        if rules and np.abs((laws := line.laws(noise)) - look.laws).max() > LITTLE:
            with suppress(SolveError):
                line = _Line(problem, look := problem.look(look.z, look.acting, look.sd, laws))
                noise = line.scattered(noise)
    return line.weighed(noise)


def _settled(problem: Problem, look: Look, noise: Noise) -> Look:
    """The look where damped Gauss-Newton converges at a given scatter."""
    vector, white = Vector(problem, look), White.of(noise.covariance)
    cost, damping = _cost(problem, vector, white, look), 0.0
    for _ in range(STEPS):
        J = white(look.jacobian)
        H = J.T @ J + np.diag(vector.precision)
        gradient = J.T @ white(problem.measured - look.shown) - vector.precision * look.x
        change = vector.step(look.x, H, gradient)
        if _promised(change, gradient, H) < LITTLE:
            break
        for _ in range(TRIES):
            if damping:
                change = vector.step(look.x, H + damping * np.diag(np.diag(H)), gradient)
            with suppress(SolveError):
                trial = problem.look(*vector.split(look.x + change), look.sd, look.laws)
                gain = cost - _cost(problem, vector, white, trial)
                if gain > -1e-9:
                    break
            damping = max(5 * damping, 0.3)
        else:
            break
        look, cost = trial, cost - gain
        if gain < LITTLE:
            break
        if gain > TRUSTED * _promised(change, gradient, H):
            damping /= 5
    return look


def _promised(change: np.ndarray, gradient: np.ndarray, H: np.ndarray) -> float:
    """By how much a step lowers the quadratic cost."""
    return float(change @ gradient - 0.5 * change @ H @ change)


def _begun(problem: Problem, acting: Sequence[Acting], begun: Begin) -> Look:
    """A look where the fit begins, nearer to the file where it cannot be run there."""
    z = np.clip(begun.z, *problem.data.limits[:, : problem.nz])

    def at(share: float) -> Look:
        smaller = [replace(a, t=np.r_[share * a.t[0], a.t[1:]]) for a in acting]
        return problem.look(share * z, smaller, None, begun.laws)

    for share in (1.0, 0.5, 0.2) if acting else ():
        with suppress(SolveError):
            return at(share)
    return at(0.05 if acting else 1.0)


def _cost(problem: Problem, vector: Vector, white: White, look: Look) -> float:
    """Half the squared misfit, priors included."""
    e = white(problem.measured - look.shown)
    return float(0.5 * e @ e + 0.5 * vector.precision @ look.x**2)


class _Line:
    """A problem linearised at a look: what is known but for the sizes, their effects, and the residual."""

    def __init__(self, problem: Problem, look: Look) -> None:
        self.problem, self.look, self.vector = problem, look, Vector(problem, look)
        vector, J = self.vector, look.jacobian
        known = look.by_sd[:, np.r_[np.arange(problem.nz), vector.shapes]]
        self.known, self.G = known @ known.T, J[:, vector.sizes]
        self.residual = problem.measured - look.shown + J @ look.x
        self.prior = low, high, _ = priors(look.acting)
        sizes = look.x[vector.sizes]
        self.free = (sizes > low) & (sizes < high)  # one that stands at its bound explains nothing more

    @property
    def wide(self) -> np.ndarray:
        """Covariance (M, M) of what is known, with sizes by their widest prior."""
        columns = (self.prior[2][-1] * self.G)[:, self.free]
        return np.asarray(self.known + columns @ columns.T)

    def scattered(self, noise: Noise) -> Noise:
        """The scatter here with its most likely scales, from those of a scatter."""
        return self.problem.noise(self.look, noise.scales).fitted(self.residual, self.wide)

    def laws(self, noise: Noise) -> np.ndarray:
        """How far the nuisances of each row are from their laws (nz, n), as the residual tells it."""
        problem, row = self.problem, self.problem.data.row
        a = White.of(noise.covariance + self.wide).back(self.residual)
        by = self.look.jacobian[:, : problem.nz] * law_shares(problem.data, self.look.sd) ** 2
        return np.asarray((problem.by_law[:, row] @ (by * a[:, None])).T)

    def by_rules(self) -> float:
        """Log prior of whether all rules hold."""
        return -float(((self.problem.near < 1) & (self.look.sd < 1)).sum()) * OPEN

    def weighed(self, noise: Noise) -> Fit:
        """The fit with a scatter, and its evidence."""
        V, look, residual = noise.covariance + self.known, self.look, self.residual
        prior = noise.log_prior + self.by_rules()
        effects = self._effects()
        rough = _rough(self.problem, effects)
        logs = []
        for share, weight in FORM:
            white = White.of(V + share**2 * rough)
            e, g = white(residual), white(self.G)
            logs.append(white.log_density(e) + log_bayes_factor(g, e, *self.prior) + np.log(weight))
        evidence = float(np.logaddexp.reduce(logs)) + prior - self._short(noise)
        return Fit(look, noise, evidence, FORM[int(np.argmax(logs))][0], effects)

    def _effects(self) -> np.ndarray:
        """What each cause does to the data beside the others (m, k): its slope times its size where none can be run."""
        look, own = self.look, self.problem.own
        found = (self.G * look.x[self.vector.sizes])[own]
        for k, a in enumerate(look.acting):
            without = self.problem.shown(look, [b for b in look.acting if b is not a])[own]
            if np.isfinite(without).all():
                found[:, k] = look.shown[own] - without
        return np.asarray(found)

    def _short(self, noise: Noise) -> float:
        """What the slopes promise of log likelihood beyond here, 0 where that is little; sizes stay at their bounds."""
        vector, white, x = self.vector, White.of(noise.covariance), self.look.x
        free = np.ones(len(x), dtype=bool)
        free[vector.sizes] = self.free
        J = white(self.look.jacobian)
        H = J.T @ J + np.diag(vector.precision)
        gradient = J.T @ white(self.problem.measured - self.look.shown) - vector.precision * x
        promised = 0.5 * gradient[free] @ np.linalg.solve(H[np.ix_(free, free)], gradient[free])
        return float(promised) if promised > STALLED else 0.0


def _ruled(problem: Problem, look: Look, noise: Noise) -> _Line:
    """The line at a look where all rules hold or none does, whichever is likelier."""

    def log(line: _Line) -> float:
        """Log density, up to a constant."""
        white = White.of(problem.noise(line.look, noise.scales).covariance + line.wide)
        return white.log_density(white(line.residual)) + line.by_rules()

    return max((_Line(problem, replace(look, sd=sd)) for sd in (np.ones(problem.nz), problem.near)), key=log)
