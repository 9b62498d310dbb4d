"""What no cause of the library makes: a discrepancy without a name, alone or beside a named cause.

It is a Gaussian process in the readings of the acting campaign, in some of the channels: smooth in the conditions, or
one number per test.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import logsumexp

from .problem import Linear, Problem

if TYPE_CHECKING:
    from .hypothesis import Hypothesis

#: Sizes of the discrepancy in the temperatures [K] and in the loss torque [N.m]; none in either is no discrepancy.
WARM, LOSS = (0.0, 0.6, 1.5, 4.0), (0.0, 1.5, 4.0, 10.0)
#: Named hypotheses beside which a discrepancy is weighed.
BESIDE = 4


class Unnamed:
    """Log evidence of a discrepancy beside the leading hypotheses."""

    def __init__(self, problem: Problem) -> None:
        self.problem, c = problem, problem.data
        part = problem.place(c)
        self.inside = np.arange(part.start, part.stop)
        self.outside = np.setdiff1d(np.arange(len(problem.measured)), self.inside)
        rows, which = c.model.rows, c.channels.rows
        conditions = [(rows.w - 18.0) / 4.0, (rows.tau - 2100.0) / 400.0, rows.direction, 2 * rows.order]
        features = np.stack([*conditions, rows.share / 0.3], axis=1)[which]
        kind = np.concatenate([np.full(len(c.channels.holds[n]), k) for k, n in enumerate(c.channels.names)])
        alike = kind[:, None] == kind
        near = np.exp(-0.5 * ((features[:, None, :] - features[None, :, :]) ** 2).sum(axis=2))
        test = rows.test[which]
        same = (test[:, None] == test) & (rows.direction[which][:, None] == rows.direction[which])
        self.kernels = (near * alike, same * 1.0 * alike)
        self.warm = c.channels.warm() * 1.0
        self.loss = np.concatenate([np.full(len(c.channels.holds[n]), n == "loss") for n in c.channels.names]) * 1.0
        self.probe = (
            np.concatenate(
                [np.full(len(c.channels.holds[n]), n[:5] == "T_oil" and n != "T_oil2") for n in c.channels.names]
            )
            * 1.0
        )

    def evidence(self, hypotheses: Sequence[Hypothesis], null: Linear) -> float:
        """Log evidence, its prior left out, of a discrepancy beside nothing or beside one of the leading hypotheses."""
        named = [h for h in hypotheses if h.causes]
        leading = named[:BESIDE] + [h for h in hypotheses if not h.causes]
        return float(logsumexp([h.log_posterior + self._gain(h, h.scattered(null)) for h in leading]))

    def _gain(self, h: Hypothesis, linear: Linear) -> float:
        """Log ratio of the likelihood with a discrepancy to that without, at the hypothesis' best parameters."""
        residual, V = linear.residual - h.effect, linear.covariance
        a, b = self.inside, self.outside
        r, C = residual[a], V[np.ix_(a, a)]
        if len(b):
            factor = cho_factor(V[np.ix_(b, b)])
            cross = V[np.ix_(a, b)]
            r = r - cross @ cho_solve(factor, residual[b])
            C = C - cross @ cho_solve(factor, cross.T)
        without = _log_density(r, C)
        logs = []
        for kernel in self.kernels:
            for warm, loss in product(WARM, LOSS):
                for probes in (self.warm, self.probe) if warm else (self.warm,):
                    size = warm * probes + loss * self.loss
                    if warm or loss:
                        logs.append(_log_density(r, C + kernel * np.outer(size, size)) - without)
        return float(logsumexp(logs) - np.log(len(logs)))


def _log_density(r: np.ndarray, C: np.ndarray) -> float:
    L, lower = cho_factor(C, lower=True)
    return float(-0.5 * r @ cho_solve((L, lower), r) - np.log(np.diag(L)).sum())
