"""Readings that are left out, foreseen: the search anew without them where nothing acts, all its fits averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..infer.evidence import split_error
from ..infer.fit import Fit, Vector
from ..infer.found import Extra, Found
from ..infer.problem import Aside, Problem
from ..infer.terms import remainders, spreads
from ..infer.weigh import Options, Weighing
from .decide import temper

#: Probability from which a hypothesis counts.
COUNTS = 0.003


@dataclass(frozen=True)
class Foreseen:
    """Errors of what is foreseen (2, k): by what lasts, and by what passes with a test or mounting, too.

    Args:
        held: entries that are left out (k,)
        before: as calibrated, without a cause
        after: all hypotheses averaged
        leading: by the likeliest one
        causes: of that one
    """

    held: np.ndarray
    before: np.ndarray
    after: np.ndarray
    leading: np.ndarray
    causes: tuple[str, ...]


def foresee(whole: Found, held: np.ndarray, options: Options) -> Foreseen:
    """Everything anew without some readings, and how far it is off there.

    Args:
        whole: the search of all data; its problem, forms and gross readings are used
        held: entries of readings that are left out (k,)
        options: how hypotheses are weighed; the prior odds are those of all data

    Raises:
        SolveError: the model cannot be run without a cause
    """
    problem = whole.problem
    kept = np.setdiff1d(np.arange(problem.m), held)
    found = temper(Weighing(problem.only(kept), whole.formulas, options).glance())
    aside = frozenset(a if a.sensor else Aside(int(kept[a.number])) for a in found.problem.aside)
    left = _Left(problem.without(aside), found, held)
    leader, weights = found.hypotheses[0], np.where(found.probabilities > COUNTS, found.probabilities, 0.0)
    counted = [(h, w) for h, w in zip(found.hypotheses, weights, strict=True) if w or h is leader]  # the leader first
    errors = np.array([left.by(h.fit, h.extras) for h, _ in counted])
    after = np.average(errors, axis=0, weights=[w for _, w in counted])
    return Foreseen(held, left.by(found.null, ()), after, errors[0], leader.causes)


class _Left:
    """What fits without some entries leave of them.

    Args:
        problem: with these entries
        found: the search without them
        held: their numbers (k,)
    """

    def __init__(self, problem: Problem, found: Found, held: np.ndarray) -> None:
        self.problem, self.held = problem, held
        self.kept = np.setdiff1d(np.arange(problem.m), [*held, *problem.entries_aside])
        scattering = {e.of.formula for h in found.hypotheses for e in h.extras}
        spread, look = [f for f in found.formulas if f in scattering], problem.look(found.null.look.z)
        self.terms = {t.label: t for t in (*spreads(problem, look, spread, found.prior), *remainders(problem))}

    def by(self, fit: Fit, extras: Sequence[Extra]) -> np.ndarray:
        """By what lasts, and by what passes with a test or mounting, too (2, k)."""
        own = [Extra(self.terms[e.of.label], e.size) for e in extras if e.of.label in self.terms]
        look = self.problem.look(fit.look.z, fit.look.acting)
        noise = self.problem.beside(tuple(e.term for e in own)).noise(look, fit.noise.scales)
        S = noise.covariance + look.jacobian / Vector(self.problem, look.acting).precision @ look.jacobian.T
        r = self.problem.measured - look.shown + look.jacobian @ look.x
        return split_error(S, noise.passing, r, self.kept, self.held)
