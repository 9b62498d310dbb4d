"""A first look at all causes: effects to first order at one linearisation, and what each would explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from scipy.special import ndtri

from ..library.cause import Mostly
from ..model.formula import Formula
from .evidence import White, log_bayes_factors
from .prior import Prior
from .problem import PACES, Acting, Look, Problem, priors

#: Start points of a form with no shape, one, two, and more.
POINTS = (1, 4, 5, 6)
#: Start points along a threshold, whose fits may each have an optimum of their own: of physics, two usual widths apart,
#: and of instruments.
THRESHOLDS = (12, 8)
#: Places of a shape that mostly stands at its bound: there, between, and at the other bound. Of several such shapes all
#: combinations.
MOSTLY = (0.0, 0.6, 0.8, 1.2)
#: Places of a change in the running order at most.
PLACES = 40
#: Draws of the alarm's null.
DRAWS = 1000


@dataclass(frozen=True)
class Start:
    """A cause about to join a fit, and its effect (M,) to first order."""

    acting: Acting
    effect: np.ndarray


@dataclass(frozen=True)
class Screen:
    """All forms of all causes at one linearisation.

    Args:
        candidates: forms with their shapes, at size zero or at that up to which they are judged
        owner: number of each candidate's formula (k,)
        effects: of one prior half width (M, k)
        white: the same, whitened by what the fit leaves uncertain (M, k)
        log_bf: log Bayes factor of each candidate beside what acts (k,)
        sizes: their most likely sizes, in prior half widths (k,)
    """

    candidates: tuple[Acting, ...]
    owner: np.ndarray
    effects: np.ndarray
    white: np.ndarray
    log_bf: np.ndarray
    sizes: np.ndarray

    @staticmethod
    def of(
        candidates: tuple[Acting, ...], owner: np.ndarray, effects: np.ndarray, linear: tuple[White, np.ndarray]
    ) -> Screen:
        """By whitening and the residual in it."""
        white, e = linear
        g, prior = white(effects), priors(candidates)
        s, q = g.T @ e, (g**2).sum(axis=0)
        log_bf = log_bayes_factors(s, q, *prior)
        return Screen(candidates, owner, effects, g, log_bf, np.clip(s / (q + 0.1), *prior[:2]))

    def beside(self, linear: tuple[White, np.ndarray]) -> Screen:
        """What the same effects would explain beside another hypothesis."""
        return Screen.of(self.candidates, self.owner, self.effects, linear)

    def weights(self, prior: Prior) -> np.ndarray:
        """Log prior weight of each candidate, all together 1 (k,)."""
        counts = np.bincount(self.owner)
        shares = [c.formula.form.weight / counts[k] for c, k in zip(self.candidates, self.owner, strict=True)]
        return np.asarray(np.log(shares) + [prior.share[c.id] for c in self.candidates])

    def by_form(self, n: int) -> np.ndarray:
        """Log Bayes factor of each of n formulas: mean over its candidates (n,)."""
        found = np.full(n, -np.inf)
        np.logaddexp.at(found, self.owner, self.log_bf)
        return found - np.log(np.bincount(self.owner))

    def start(self, formula: int) -> Start:
        """Where a fit of a formula begins: at the best of its candidates."""
        own = np.flatnonzero(self.owner == formula)
        k = int(own[np.argmax(self.log_bf[own])])
        acting = self.candidates[k].started(self.sizes[k])
        return Start(acting, acting.t[0] * self.effects[:, k])


@lru_cache(maxsize=1)  # they are the same for all folds
def samples(formulas: tuple[Formula, ...], orders: tuple[float, ...]) -> tuple[tuple[Acting, ...], np.ndarray]:
    """Candidates spread over the prior of each formula's shapes, the middle first, and their owners.

    Args:
        orders: places in the running order between two tests, each of which a change may have
    """
    found, owner = [], []
    between = ndtri(orders)
    for k, formula in enumerate(formulas):
        shapes = [shape.name for shape in formula.form.shapes]
        d = len(shapes)
        if "threshold" in shapes:
            since = formula.form.regime.get("quantity") == "order above" and len(orders)
            inside = THRESHOLDS[not formula.paths]
            places = between if since else ndtri((np.arange(inside) + 0.5) / inside)
            points = np.zeros((len(places), d))
            points[:, shapes.index("threshold")] = places
        else:
            mostly = [isinstance(shape, Mostly) for shape in formula.form.shapes]
            grid = list(product(MOSTLY, repeat=sum(mostly)))
            points = spread(max(POINTS[min(d, len(POINTS) - 1)], len(grid)), d)
            points[:, mostly] = np.resize(grid, (len(points), sum(mostly)))
        sizes = PACES if formula.paced else (0.0,)
        for size, u in product(sizes, points):
            found.append(Acting(formula, np.r_[size, u]))
            owner.append(k)
    return tuple(found), np.array(owner)


def changes(problem: Problem) -> tuple[float, ...]:
    """Places in the running order between two tests, of many tests some."""
    order = np.unique(problem.data.campaign.progress)
    found = (order[1:] + order[:-1]) / 2
    kept = np.linspace(0, len(found) - 1, min(len(found), PLACES)).astype(int)
    return tuple(found[kept].tolist())


def spread(n: int, d: int) -> np.ndarray:
    """n points of a standard normal in d dimensions, evenly spread (additive golden ratio), the middle first."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (d + 1))
    shares = (0.5 + np.arange(n)[:, None] * ratio ** -np.arange(1.0, d + 1)) % 1.0
    return np.asarray(ndtri(np.clip(shares, 0.03, 0.97)))


def screened(problem: Problem, near: Look, linear: tuple[White, np.ndarray], forms: Sequence[Formula]) -> Screen:
    """What every form would explain near a fitted hypothesis: in a whitening by all that is uncertain there."""
    candidates, owner = samples(tuple(forms), changes(problem))
    effects = problem.tangents(near, candidates)
    effects[:, ~np.isfinite(effects).all(axis=0)] = 0.0
    return Screen.of(candidates, owner, effects, linear)


def null_draws(found: Screen, weights: np.ndarray, seed: int) -> np.ndarray:
    """Log Bayes factors of any cause against none on data of the null (draws,), by log prior weights of candidates."""
    e = np.random.default_rng(seed).standard_normal((len(found.white), DRAWS))
    logs = log_bayes_factors((found.white.T @ e).T, (found.white**2).sum(axis=0), *priors(found.candidates))
    return np.asarray(np.logaddexp.reduce(logs + weights, axis=1))
