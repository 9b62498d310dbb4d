"""How far the Gaussian approximation of an evidence is off: importance sampling with smoothed weights.

Sizes and shapes are drawn, which the readings follow with a bend; nuisances follow them and are integrated linearly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import genpareto, norm, qmc

from .evidence import White
from .fit import Fit, prior_precision
from .problem import Problem

#: Draws of a hypothesis.
DRAWS = 32
#: How much wider than the fit says they are taken.
WIDER = 1.3
#: Draws are taken about where the fit would end by its slopes, unless it is less likely there by so much than where it
#: stands: a fit that stands at a bend goes nowhere by them.
MUCH = 1.0


@dataclass(frozen=True)
class Correction:
    """What importance sampling adds to a log evidence, and the standard error of that."""

    log: float
    error: float


def correction(problem: Problem, fit: Fit, seed: int) -> Correction:
    """The ratio of a hypothesis' evidence to that of its Gaussian approximation, by draws of the exact model.

    Args:
        problem: data and model
        fit: the hypothesis
        seed: of the draws
    """
    look, nz = fit.look, problem.nz
    if not look.acting:
        return Correction(0.0, 0.0)
    precision, scatter = prior_precision(problem, look.acting), fit.scatter(problem)
    narrow = White.of(scatter)
    J, e = narrow(look.jacobian), narrow(problem.measured - look.shown)
    covariance = np.linalg.inv(J.T @ J + np.diag(precision))
    likely = look.x + covariance @ (J.T @ e - precision * look.x)
    own, known = covariance[nz:, nz:], look.jacobian[:, :nz]
    white = White.of(scatter + known @ known.T)

    def log_joint(x: np.ndarray, shown: np.ndarray) -> float:
        if not np.isfinite(shown).all():
            return -np.inf
        e = white(problem.measured - shown + known @ x[:nz])
        return float(-0.5 * e @ e - 0.5 * precision[nz:] @ x[nz:] ** 2)

    root = np.linalg.cholesky(own)
    along = covariance[:, nz:] @ np.linalg.solve(own, root)
    highest = log_joint(likely, look.shown + look.jacobian @ (likely - look.x))
    normal = norm.ppf(np.clip(qmc.Sobol(len(own), seed=seed).random(DRAWS), 1e-6, 1 - 1e-6))
    logs = []
    middle = likely
    if log_joint(likely, problem.shown(*fit.split(problem, likely))) < log_joint(look.x, look.shown) - MUCH:
        middle = look.x
    for u in WIDER * normal:
        x = middle + along @ u
        log = log_joint(x, problem.shown(*fit.split(problem, x))) - highest
        logs.append(log + 0.5 * (u / WIDER) @ (u / WIDER) + len(u) * np.log(WIDER))
    found = smoothed(np.array(logs))
    return Correction(found.log + fit.short, found.error)


def smoothed(logs: np.ndarray) -> Correction:
    """Mean of importance weights whose largest are replaced by quantiles of a Pareto tail (Vehtari and others, 2024).

    Args:
        logs: logarithms of the weights (n,), -inf where the model cannot be run
    """
    n = len(logs)
    order = np.argsort(logs)
    tail = order[-max(int(min(0.2 * n, 3 * n**0.5)), 5) :]
    top = float(logs[order[-1]])
    if not np.isfinite(top):  # none of them can be run
        return Correction(-float(np.log(n)), 1.0)
    weights = np.exp(logs - top)
    cut = float(weights[order[-len(tail) - 1]])
    excess = weights[tail] - cut
    if excess.max() > 1e-12:
        shape, _, scale = genpareto.fit(np.maximum(excess, 1e-15), floc=0.0)
        ranks = (np.arange(len(tail)) + 0.5) / len(tail)
        weights[tail] = np.minimum(cut + genpareto.ppf(ranks, min(shape, 0.9), scale=scale), 1.0)
    mean = float(weights.mean())
    return Correction(top + float(np.log(mean)), float(weights.std(ddof=1) / mean / n**0.5))
