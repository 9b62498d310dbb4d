"""Sets of terms drawn at random by their probability: another coding of the search, which shares terms and priors.

Slots hold a term with a width each, or none. One slot after the other is emptied, and drawn anew from all terms at all
widths, with what the others hold as part of the covariance. Between them the scales of the scatter take random steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from gearheat.tools.diagnose.infer import sets
from gearheat.tools.diagnose.infer.terms import Linear, Term, TermSet
from scipy.linalg import solve_triangular
from scipy.special import ndtr

#: Terms that may act together.
SLOTS = 14
#: Random steps of each scale after each round, and their standard deviation.
STEPS, STEP = 3, 0.3
#: Share of the rounds that are forgotten.
BEGINNING = 1 / 3


def shares(linear: Linear, seed: int, rounds: int) -> dict[str, float]:
    """Name of a term -> share of the draws in which it acts, in any form."""
    draws = list(Sampler(linear, seed).draws(rounds))[round(BEGINNING * rounds) :]
    return _by_name(linear, draws, np.ones(len(draws)))


def likely(linear: Linear, found: Sequence[TermSet]) -> dict[str, float]:
    """Name of a term -> probability that it acts, by the sets of the search."""
    return _by_name(linear, [s.terms for s in found], np.exp([s.log - found[0].log for s in found]))


def _by_name(linear: Linear, drawn: Sequence[Sequence[int]], weights: np.ndarray) -> dict[str, float]:
    """Name of a term -> share of the sets in which it acts, by their weights."""
    names = [{linear.terms[k].name for k in own} for own in drawn]
    return {n: float(np.average([n in own for own in names], weights=weights)) for n in sorted(set().union(*names))}


class Sampler:
    """A chain that begins with nothing."""

    def __init__(self, linear: Linear, seed: int) -> None:
        self.linear, self.rng, self.table = linear, np.random.default_rng(seed), sets.Table(linear)
        self.scales = np.zeros(len(linear.noise.loose))
        #: The residual, and columns of all terms, which end there.
        self.columns = np.concatenate([linear.residual[:, None], *(t.columns for t in linear.terms)], axis=1)
        self.ends = np.cumsum([t.columns.shape[1] for t in linear.terms])[:-1]
        self.slots: list[tuple[int, float] | None] = [None] * SLOTS

    def draws(self, rounds: int) -> Iterator[list[int]]:
        """Numbers of the terms that act after each round."""
        for _ in range(rounds):
            for i in self.rng.permutation(SLOTS):
                self.slots[i] = None
                self.slots[i] = self._drawn()
            for j in np.tile(np.arange(len(self.scales)), STEPS):
                self._step(j)
            yield self._acting

    @property
    def _acting(self) -> list[int]:
        return [slot[0] for slot in self.slots if slot]

    def _drawn(self) -> tuple[int, float] | None:
        """A term and its width for an empty slot, or none."""
        terms, others = self.linear.terms, self._acting
        root = np.linalg.cholesky(self._covariance(self.scales))
        white = solve_triangular(root, self.columns, lower=True)
        e, columns = white[:, 0], np.split(white[:, 1:], self.ends, axis=1)
        prior = self.table.log_priors(others) - self.table.log_prior(others)
        gains = [gain(t, C, e) + log for t, C, log in zip(terms, columns, prior, strict=True)]
        logs = np.concatenate([*gains, [np.log(SLOTS - len(others))]])  # a set has one arrangement for each free slot
        p = np.exp(logs - logs.max())
        number = int(self.rng.choice(len(p), p=p / p.sum()))
        for k, own in enumerate(gains):
            if number < len(own):
                return k, float(terms[k].widths[number])
            number -= len(own)
        return None

    def _step(self, j: int) -> None:
        """A random step of a scale, taken with the odds of its density."""
        tried = self.scales.copy()
        tried[j] += STEP * self.rng.standard_normal()
        if np.log(self.rng.random()) < self._log_density(tried) - self._log_density(self.scales):
            self.scales = tried

    def _covariance(self, scales: np.ndarray) -> np.ndarray:
        """Of the residual with all that acts (M, M)."""
        V = self.linear.at(scales.tolist()).covariance + self.linear.known
        for k, width in filter(None, self.slots):
            V = V + width**2 * self.linear.terms[k].columns @ self.linear.terms[k].columns.T
        return np.asarray(V)

    def _log_density(self, scales: np.ndarray) -> float:
        root = np.linalg.cholesky(self._covariance(scales))
        e = solve_triangular(root, self.linear.residual, lower=True)
        log_prior = self.linear.at(scales.tolist()).log_prior
        return float(-0.5 * e @ e - np.log(np.diag(root)).sum() + log_prior)


def gain(term: Term, columns: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Log Bayes factor of a term at each of its widths, a size's with their shares; all is whitened.

    Columns are (M, k). The prior of what scatters is that of one of its widths.
    """
    q, turn = np.linalg.eigh(columns.T @ columns)
    s, q, v = turn.T @ (columns.T @ e), np.maximum(q, 0.0), np.asarray(term.widths)[:, None] ** 2
    post = v / (1 + v * q)
    logs = (0.5 * s**2 * post - 0.5 * np.log1p(v * q)).sum(axis=1)
    if not term.scatters:
        logs -= np.log(len(v))
        logs += log_inside(term, post @ turn[0] * s, np.sqrt(post[:, 0])) - log_inside(term, 0 * logs, term.widths)
    return np.asarray(logs)


def log_inside(term: Term, mean: np.ndarray, sd: np.ndarray) -> np.ndarray:
    """Log probability that a size is inside its bounds."""
    return np.asarray(np.log(np.maximum(ndtr((term.high - mean) / sd) - ndtr((term.low - mean) / sd), 1e-300)))
