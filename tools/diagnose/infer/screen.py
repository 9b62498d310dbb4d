"""A first look at all causes: effects to first order at one linearisation, and what each would explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp, ndtri

from ..model.formula import Formula
from .evidence import White, log_bayes_factors
from .fit import Fit, bounds
from .problem import Acting, Problem

#: Samples of a form: one in the middle of its shapes, and so many more for the first shape and for each further one; of
#: one with a threshold, of which each place may have a best fit of its own, so many: of physics, and of instruments.
FIRST, FURTHER, MOST, THRESHOLDS = 3, 1, 6, (6, 8)
#: Draws of the alarm's null.
DRAWS = 1000


@dataclass(frozen=True)
class Look:
    """All forms of all causes at one linearisation.

    Args:
        candidates: forms with their shapes, size zero
        owner: number of each candidate's formula (k,)
        effects: of one prior half width (M, k)
        log_bf: log Bayes factor of each candidate beside what acts (k,)
        sizes: their most likely sizes, in prior half widths (k,)
    """

    candidates: tuple[Acting, ...]
    owner: np.ndarray
    effects: np.ndarray
    white: np.ndarray
    log_bf: np.ndarray
    sizes: np.ndarray

    def by_form(self, n: int) -> np.ndarray:
        """Log Bayes factor of each of n formulas: mean over its candidates (n,)."""
        found = np.full(n, -np.inf)
        for k in np.unique(self.owner):
            own = self.log_bf[self.owner == k]
            found[k] = logsumexp(own) - np.log(len(own))
        return found

    def start(self, formula: int) -> Acting:
        """Where a fit of a formula begins: at the best of its candidates."""
        own = np.flatnonzero(self.owner == formula)
        best = int(own[np.argmax(self.log_bf[own])])
        candidate = self.candidates[best]
        low, high = bounds(candidate)
        size = float(np.clip(self.sizes[best], low[0], high[0]))
        least = 0.1 if high[0] > 0.1 else -0.1
        return replace(candidate, t=np.r_[size if abs(size) > 0.1 else least, candidate.t[1:]])


def samples(formulas: Sequence[Formula]) -> tuple[tuple[Acting, ...], np.ndarray]:
    """Candidates spread over the prior of each formula's shapes, the middle first, and their owners."""
    found, owner = [], []
    for k, formula in enumerate(formulas):
        d = formula.size - 1
        n = min(1 + (FIRST + FURTHER * (d - 1) if d else 0), MOST)
        if any(shape.name == "threshold" for shape in formula.form.shapes):
            n = THRESHOLDS[not formula.paths]
        for u in spread(n, d):
            found.append(Acting(formula, np.r_[0.0, u]))
            owner.append(k)
    return tuple(found), np.array(owner)


def spread(n: int, d: int) -> np.ndarray:
    """n points of a standard normal in d dimensions, evenly spread (additive golden ratio), the middle first."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (d + 1))
    shares = (0.5 + np.arange(n)[:, None] * ratio ** -np.arange(1.0, d + 1)) % 1.0
    return np.asarray(ndtri(np.clip(shares, 0.03, 0.97)))


def look(problem: Problem, fit: Fit, formulas: Sequence[Formula]) -> Look:
    """What every form would explain beside a fitted hypothesis."""
    candidates, owner = samples(formulas)
    effects = problem.tangents(fit.look.z, fit.look.acting, candidates)
    effects[:, ~np.isfinite(effects).all(axis=0)] = 0.0
    white, e = fit.linear(problem)
    return judged(candidates, owner, effects, white, e)


def judged(candidates: tuple[Acting, ...], owner: np.ndarray, effects: np.ndarray, white: White, e: np.ndarray) -> Look:
    """Effects weighed against a whitened residual."""
    g = white(effects)
    s, q = g.T @ e, (g**2).sum(axis=0)
    low, high = _limits(candidates)
    sizes = np.clip(s / (q + 0.1), low, high)
    return Look(candidates, owner, effects, g, log_bayes_factors(s, q, low, high), sizes)


def _limits(candidates: Sequence[Acting]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest sizes of candidates, in prior half widths (k,)."""
    sizes = [c.formula.cause.size for c in candidates]
    return np.array([s.low / s.sd for s in sizes]), np.array([s.high / s.sd for s in sizes])


def null_draws(found: Look, weights: np.ndarray, seed: int) -> np.ndarray:
    """Log Bayes factors of any cause against none on data of the null (draws,).

    Args:
        found: a look at the null
        weights: log prior weight of each candidate, all together 1
        seed: of the draws
    """
    rng = np.random.default_rng(seed)
    E = rng.standard_normal((found.white.shape[0], DRAWS))
    S = (found.white.T @ E).T
    q = (found.white**2).sum(axis=0)
    low, high = _limits(found.candidates)
    return np.asarray(logsumexp(log_bayes_factors(S, q, low, high) + weights, axis=1))
