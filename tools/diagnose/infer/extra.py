"""What may stand beside any hypothesis as scatter: sizes that differ from test to test, and a smooth remainder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import logsumexp

from ..model.formula import Formula
from ..model.noise import per_group, walk
from .evidence import White
from .fit import Fit
from .problem import Acting, Noise, Problem

#: Standard deviations of a spread, in half widths of the cause's prior.
SIZES = (0.25, 0.5, 1.0, 2.0, 4.0)
#: Standard deviations of a remainder, in those of one reading of its channel.
REMAINDERS = (2.0, 4.0, 8.0, 16.0)
#: How far behind the likeliest spread the scatter is fitted anew beside another one.
NEAR = 5.0


@dataclass(frozen=True)
class Extra:
    """A spread of a cause's size, or a remainder of some channels where `cause` is None.

    Args:
        cause: id
        form: name of its form
        size: most likely standard deviation, in half widths of the prior or standard deviations of a reading
        channels: sensors in which a remainder acts
        covariance: at that size (M, M)
    """

    cause: str | None
    form: str
    size: float
    channels: tuple[str, ...]
    covariance: np.ndarray


def extras(problem: Problem, fit: Fit, spreads: Sequence[Formula]) -> Iterator[tuple[Extra, float, Noise]]:
    """Each extra with the log of what it adds to the evidence, its own prior apart, and the scatter beside it."""
    views = fit.views(problem)
    without = views[0].white.log_density(views[0].e)
    r = views[0].white.L @ views[0].e
    scatters = [v.white.L @ v.white.L.T for v in views]
    found = []
    if spreads:
        own = [Acting(f, np.r_[float(f.paced), np.zeros(f.size - 1)]) for f in spreads]
        effects = problem.tangents(fit.look.z, fit.look.acting, own)
        for formula, effect in zip(spreads, effects.T, strict=True):
            columns = _columns(problem, formula, effect)
            if columns is None or not np.isfinite(columns).all():
                continue
            C = columns @ columns.T
            each = [
                [_log(W + size**2 * C, r) - without + view.prior for size in SIZES]
                for W, view in zip(scatters, views, strict=True)
            ]
            found.append((formula, C, logsumexp(each, axis=0) - np.log(len(views))))
    least = max((logs.max() for _, _, logs in found), default=0.0) - NEAR
    for formula, C, seen in found:
        logs, noise = seen, fit.noise
        if len(views) > 1 and seen.max() > least:
            anew, beside = _anew(fit, scatters[0], r, C, SIZES[int(np.argmax(seen))])
            if anew.max() - without > seen.max():
                logs, noise = anew - without, beside
        best = SIZES[int(np.argmax(logs))]
        gain = float(logsumexp(logs) - np.log(len(SIZES)) + np.log(formula.form.weight))
        yield Extra(formula.cause.id, formula.form.name, best, (), best**2 * C), gain, noise
    for extra, gain in _remainders(problem, scatters[0], r, without):
        yield extra, gain, fit.noise


def _anew(fit: Fit, V: np.ndarray, r: np.ndarray, C: np.ndarray, size: float) -> tuple[np.ndarray, Noise]:
    """Log density at each size with the scatter fitted anew, and that scatter: what a spread explains is none.

    Args:
        fit: the hypothesis, whose scales have grown
        V: covariance of the residual r without the spread (M, M)
        r: residual (M,)
        C: covariance of the spread at size 1 (M, M)
        size: at which the scatter is fitted
    """
    known = V - fit.noise.covariance
    noise = fit.noise.fitted(r, known + size**2 * C)
    V, prior = known + noise.covariance, noise.log_prior - fit.noise.log_prior
    return np.array([_log(V + size**2 * C, r) + prior for size in SIZES]), noise


def _columns(problem: Problem, formula: Formula, effect: np.ndarray) -> np.ndarray | None:
    o = problem.data
    test = o.campaign.test[o.row]
    if formula.form.spread == "test":
        own = per_group(effect[problem.own], test)
    elif formula.form.spread == "walk":
        own = walk(effect[problem.own], test)
    else:
        labels = np.unique(o.campaign.mounting, return_inverse=True)[1]
        if labels.max() == 0:
            return None
        own = per_group(effect[problem.own], labels[test])
    whole = np.zeros((problem.m, own.shape[1]))
    whole[problem.own] = own
    return whole


def _remainders(problem: Problem, V: np.ndarray, r: np.ndarray, without: float) -> Iterator[tuple[Extra, float]]:
    """A smooth remainder in the thermometers, in one of them, in the other channels, or in all."""
    o = problem.data
    warm = [i for i, s in enumerate(o.read) if s.kind.endswith("_temp")]
    other = [i for i in range(len(o.read)) if i not in warm]
    groups = [
        g
        for g in ([warm] + ([[i] for i in warm] if len(warm) > 1 else []) + ([other, warm + other] if other else []))
        if g
    ]
    sd = o.entries.repeat
    tests = o.campaign.test[o.row]
    kernels = {"smooth in the conditions": problem.alike * problem.same}
    if np.bincount(o.campaign.test).max() > 1 or len(np.unique(tests)) < o.campaign.n:
        kernels["from test to test"] = (tests[:, None] == tests) * problem.same
    found = []
    for group, (name, kernel) in product(groups, kernels.items()):
        mine = np.isin(o.entries.sensor, group) * sd
        C = np.zeros_like(V)
        C[problem.own, problem.own] = kernel * np.outer(mine, mine)
        logs = [_log(V + size**2 * C, r) - without for size in REMAINDERS]
        best = REMAINDERS[int(np.argmax(logs))]
        channels = tuple(o.read[i].name for i in group)
        found.append((Extra(None, name, best, channels, best**2 * C), float(logsumexp(logs) - np.log(len(logs)))))
    for extra, gain in found:
        yield extra, gain - float(np.log(len(found)))


def _log(V: np.ndarray, r: np.ndarray) -> float:
    white = White.of(V)
    return white.log_density(white(r))
