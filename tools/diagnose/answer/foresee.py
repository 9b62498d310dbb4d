"""Readings that are left out, foreseen: the search anew without them where nothing acts, all its fits averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..infer.evidence import split_error
from ..infer.fit import Fit, prior_precision
from ..infer.problem import Aside, Problem
from ..infer.weigh import Options, Weighing
from ..model.formula import Formula
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


def foresee(problem: Problem, formulas: Sequence[Formula], held: np.ndarray, options: Options) -> Foreseen:
    """Everything anew without some readings, and how far it is off there.

    Args:
        problem: of all data
        formulas: all forms of all causes
        held: entries of readings that are left out (k,)
        options: how hypotheses are weighed; the prior odds are those of all data

    Raises:
        SolveError: the model cannot be run without a cause
    """
    without = problem.without(problem.aside | {Aside(int(i)) for i in held})
    found = temper(Weighing(without, formulas, options).glance())
    kept = np.setdiff1d(np.arange(found.problem.m), found.problem.entries_aside)
    counted = [(h.fit, p) for h, p in zip(found.hypotheses, found.probabilities, strict=True) if p > COUNTS]
    errors = np.array([left(found.problem, fit, kept, held) for fit, _ in counted])
    after = np.average(errors, axis=0, weights=[p for _, p in counted])
    before, leading = (left(found.problem, fit, kept, held) for fit in (found.null, found.hypotheses[0].fit))
    return Foreseen(held, before, after, leading, found.hypotheses[0].causes)


def left(problem: Problem, fit: Fit, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What a fit leaves of held entries: by what lasts, and by what passes with a test or mounting, too (2, k)."""
    look = fit.look
    S = fit.noise.covariance + look.jacobian / prior_precision(problem, look.acting) @ look.jacobian.T
    r = problem.measured - look.shown + look.jacobian @ look.x
    return split_error(S, fit.noise.passing, r, kept, held)
