"""Readings that are left out, foreseen: the same terms and the same search, with all sets averaged to first order.

A leading set bends: the problem is linearised where it is fitted exactly, and all sets are weighed anew there.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ....model.errors import SolveError
from ..model.formula import Formula
from .evidence import split_error
from .fit import Fit, prior_precision
from .problem import Aside, Problem
from .weigh import Options, Weighing

#: What is looked for, for a progress that nobody is told.
STAGE = "sets of causes"
#: Probability from which a set counts.
COUNTS = 0.003


@dataclass(frozen=True)
class Foreseen:
    """Errors of what is foreseen (2, k): by what lasts, and by what passes with a test or mounting, too.

    Args:
        held: entries that are left out (k,)
        before: as calibrated, without a cause
        after: all sets averaged
        leading: the likeliest set, fitted exactly
        causes: of that set
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
    own = Weighing(problem.without(problem.aside | {Aside(int(i)) for i in held}), formulas, options)
    own.ask_alarm()
    own.keep_null()
    found, linear = own.search(own.null, own.first, STAGE, 0.0), own.linear
    own.fit_sets(found, own.null, 0.0, 1)
    if (near := own.leader().fit) is not own.null:
        with suppress(SolveError):
            found = own.search(near, own.screened(near, own.problem), STAGE, 0.0)
            linear = own.linear
            own.fit_sets(found, near, 0.0, 1)
    logs = np.array([s.log for s in found])
    p = np.exp(logs - logs.max())
    p = np.where(p > COUNTS * p.sum(), p, 0.0)
    kept = np.setdiff1d(np.arange(own.problem.m), own.problem.entries_aside)
    after = sum(share * linear.left(s, kept, held) for s, share in zip(found, p / p.sum(), strict=True) if share)
    leader = own.leader()
    before, leading = (left(own.problem, fit, kept, held) for fit in (own.null, leader.fit))
    return Foreseen(held, before, np.asarray(after), leading, leader.causes)


def left(problem: Problem, fit: Fit, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What a fit leaves of held entries: by what lasts, and by what passes with a test or mounting, too (2, k)."""
    look = fit.look
    S = fit.noise.covariance + look.jacobian / prior_precision(problem, look.acting) @ look.jacobian.T
    r = problem.measured - look.shown + look.jacobian @ look.x
    return split_error(S, fit.noise.passing, r, kept, held)
