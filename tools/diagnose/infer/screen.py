"""A first look at all causes: effects to first order at one linearisation, and what each would explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import ndtri

from ..library.cause import Mostly
from ..model.formula import Formula
from .evidence import View, log_bayes_factors
from .problem import PACES, Acting, Look, Problem, limits

#: Start points of a form for its first shape, beside the one in the middle.
FIRST = 3
#: Start points for each further shape.
FURTHER = 1
#: Start points of a form at most, but for those combinations.
MOST = 6
#: Start points along a threshold, whose fits may each have an optimum of their own: of physics, of instruments.
THRESHOLDS = (6, 8)
#: Places of a shape that mostly stands at its bound: there, between, and at the other bound. Of several such shapes all
#: combinations.
MOSTLY = (0.0, 0.6, 0.8, 1.2)
#: Places of a change in the running order at most.
PLACES = 40
#: Draws of the alarm's null.
DRAWS = 500


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
        views: scatter as found and as stated
        log_bf: log Bayes factor of each candidate beside what acts (k,)
        sizes: their most likely sizes, in prior half widths (k,)
    """

    candidates: tuple[Acting, ...]
    owner: np.ndarray
    effects: np.ndarray
    white: np.ndarray
    views: tuple[View, ...]
    log_bf: np.ndarray
    sizes: np.ndarray

    @property
    def weights(self) -> np.ndarray:
        """Log share of each candidate in its cause (k,)."""
        counts = np.bincount(self.owner)
        shares = [c.formula.form.weight / counts[k] for c, k in zip(self.candidates, self.owner, strict=True)]
        return np.asarray(np.log(shares))

    def by_form(self, n: int) -> np.ndarray:
        """Log Bayes factor of each of n formulas: mean over its candidates (n,)."""
        found = np.full(n, -np.inf)
        for k in np.unique(self.owner):
            own = self.log_bf[self.owner == k]
            found[k] = np.logaddexp.reduce(own) - np.log(len(own))
        return found

    def start(self, formula: int) -> Start:
        """Where a fit of a formula begins: at the best of its candidates."""
        own = np.flatnonzero(self.owner == formula)
        k = int(own[np.argmax(self.log_bf[own])])
        acting = self.candidates[k].started(self.sizes[k])
        return Start(acting, acting.t[0] * self.effects[:, k])


def samples(formulas: Sequence[Formula], orders: np.ndarray) -> tuple[tuple[Acting, ...], np.ndarray]:
    """Candidates spread over the prior of each formula's shapes, the middle first, and their owners.

    Args:
        formulas: forms
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
            n = min(1 + (FIRST + FURTHER * (d - 1) if d else 0), MOST)
            points = spread(max(n, len(grid)), d)
            points[:, mostly] = np.resize(grid, (len(points), sum(mostly)))
        sizes = PACES if formula.paced else (0.0,)
        for size, u in product(sizes, points):
            found.append(Acting(formula, np.r_[size, u]))
            owner.append(k)
    return tuple(found), np.array(owner)


def changes(problem: Problem) -> np.ndarray:
    """Places in the running order between two tests, of many tests some."""
    order = np.unique(problem.data.campaign.progress)
    found = (order[1:] + order[:-1]) / 2
    kept = np.linspace(0, len(found) - 1, min(len(found), PLACES)).astype(int)
    return np.asarray(found[kept])


def spread(n: int, d: int) -> np.ndarray:
    """n points of a standard normal in d dimensions, evenly spread (additive golden ratio), the middle first."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (d + 1))
    shares = (0.5 + np.arange(n)[:, None] * ratio ** -np.arange(1.0, d + 1)) % 1.0
    return np.asarray(ndtri(np.clip(shares, 0.03, 0.97)))


def screened(problem: Problem, near: Look, views: Sequence[View], formulas: Sequence[Formula]) -> Screen:
    """What every form would explain beside a fitted hypothesis.

    Args:
        problem: data and model
        near: where it was fitted
        views: the problem linearised there, by scatter as found and as stated
        formulas: forms of causes
    """
    candidates, owner = samples(formulas, changes(problem))
    effects = problem.tangents(near.z, near.acting, candidates)
    effects[:, ~np.isfinite(effects).all(axis=0)] = 0.0
    return judged(candidates, owner, effects, views)


def judged(candidates: tuple[Acting, ...], owner: np.ndarray, effects: np.ndarray, views: Sequence[View]) -> Screen:
    """Effects weighed against a whitened residual, by scatter as found or as stated."""
    low, high = limits(candidates)
    white = [view.white(effects) for view in views]
    logs, sizes = [], []
    for g, view in zip(white, views, strict=True):
        s, q = g.T @ view.e, (g**2).sum(axis=0)
        logs.append(view.log + log_bayes_factors(s, q, low, high))
        sizes.append(np.clip(s / (q + 0.1), low, high))
    best = np.argmax(logs, axis=0)
    log_bf = np.logaddexp.reduce(logs, axis=0) - np.log(len(views))
    return Screen(candidates, owner, effects, white[0], tuple(views), log_bf, np.choose(best, sizes))


def null_draws(found: Screen, weights: np.ndarray, seed: int) -> np.ndarray:
    """Log Bayes factors of any cause against none on data of the null (draws,).

    Args:
        found: all causes beside none
        weights: log prior weight of each candidate, all together 1
        seed: of the draws
    """
    rng = np.random.default_rng(seed)
    drawn = rng.standard_normal((len(found.effects), DRAWS))
    E, none = found.views[0].white.L @ drawn, found.views[0].white.log_densities(drawn)
    low, high = limits(found.candidates)
    logs = []
    for view in found.views:
        g, e = view.white(found.effects), view.white(E)
        own = log_bayes_factors((g.T @ e).T, (g**2).sum(axis=0), low, high) + weights
        logs.append(np.logaddexp.reduce(own, axis=1) + view.white.log_densities(e) - none + view.prior)
    return np.asarray(np.logaddexp.reduce(logs, axis=0) - np.log(len(logs)))
