"""What the causes gain on readings that were left out: in each fold the whole inference runs without them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ....model.errors import SolveError
from ..infer.evidence import White
from ..infer.fit import Fit, prior_precision
from ..infer.found import Extra, Found
from ..infer.problem import Aside, Problem
from ..infer.weigh import weigh
from . import channels
from .decide import temper
from .findings import Gain
from .folds import schemes
from .rivals import RIVALS

#: Draws of the bootstrap.
DRAWS = 2000
#: Probability from which a hypothesis of a fold counts.
COUNTS = 0.01


@dataclass(frozen=True)
class _Fold:
    """Errors (2, k) before and after on the entries `held` (k,), and the causes chosen."""

    held: np.ndarray
    before: np.ndarray
    after: np.ndarray
    chosen: tuple[str, ...]


def gains(found: Found, seed: int, progress: Callable[[float], None] = lambda share: None) -> list[Gain]:
    """All schemes that the data allow, all compared sensors, thermometers of the oil first.

    Args:
        found: the answer of all data; only its settings and its gross readings are used
        seed: of all draws
        progress: called with the share done
    """
    plans = schemes(found.problem.data.campaign)
    total, done, told = sum(len(folds) for folds in plans.values()), 0, []
    for scheme, folds in plans.items():
        errors = []
        for rows in folds:
            with suppress(SolveError):
                errors.append(_fold(found, rows, seed))
            done += 1
            progress(done / total)
        if errors:
            told += [
                g for i in range(len(found.problem.data.read)) if (g := _gain(found, scheme, folds, errors, i, seed))
            ]
    oil = [s.name for s in found.problem.data.read if s.kind == "oil_temp"]
    return sorted(told, key=lambda g: g.channel not in oil)


def _fold(found: Found, rows: np.ndarray, seed: int) -> _Fold:
    """Everything anew without the readings of some rows, and what it says of them."""
    gross = {a.number for a in found.problem.aside if not a.sensor}
    held = np.array([i for i in np.flatnonzero(np.isin(found.problem.data.row, rows)) if i not in gross])
    problem = found.problem.without(frozenset(Aside(int(i)) for i in held))
    own = temper(weigh(problem, found.formulas, seed=seed, critical=found.critical))
    p = np.where(own.probabilities > COUNTS, own.probabilities, 0.0)
    each = [_errors(own.problem, h.fit, h.extras, held) for h, share in zip(own.hypotheses, p, strict=True) if share]
    after = np.einsum("h,hdk->dk", p[p > 0] / p.sum(), each)
    return _Fold(held, _errors(own.problem, own.null, (), held), after, own.hypotheses[0].causes)


def _errors(problem: Problem, fit: Fit, extras: Sequence[Extra], held: np.ndarray) -> np.ndarray:
    """Errors (2, k) on held entries: without, with what only interpolates from test to test."""
    look = fit.look
    kept = np.setdiff1d(np.arange(problem.m), [a.number for a in problem.aside if not a.sensor])
    prior = 1 / prior_precision(problem, look.acting)
    S = fit.noise.covariance + look.jacobian * prior @ look.jacobian.T
    r = problem.measured - look.shown + look.jacobian @ look.x
    known = White.of(S[np.ix_(kept, kept)]).back(r[kept])
    tie = S[np.ix_(held, kept)]
    in_time = [e.size * e.columns for e in extras if e.cause is not None]
    C = np.concatenate([np.zeros((problem.m, 0)), *in_time], axis=1)
    return np.array([r[held] - (tie - C[held] @ C[kept].T) @ known, r[held] - tie @ known])


def _gain(
    found: Found, scheme: str, folds: Sequence[np.ndarray], errors: Sequence[_Fold], sensor: int, seed: int
) -> Gain | None:
    """One sensor's errors over all folds of a scheme."""
    o = found.problem.data
    held = np.concatenate([e.held for e in errors])
    before, after = (np.concatenate([getattr(e, side) for e in errors], axis=1) for side in ("before", "after"))
    mine = o.kind[held] == sensor
    if not mine.any():
        return None
    gross = [a.number for a in found.problem.aside if not a.sensor]
    entries, rivals, s = np.setdiff1d(np.flatnonzero(o.kind == sensor), gross), {}, o.read[sensor]
    rows = o.row[entries]
    for name, rival in RIVALS.items():
        left = [rival(o, sensor, rows, ~np.isin(rows, fold)) for fold in folds if np.isin(rows, fold).any()]
        known = [e for e in left if e is not None]
        if len(known) == len(left) and np.isfinite(error := rms(np.concatenate(known))):
            rivals[name] = channels.difference(s, error)
    test = o.campaign.test[o.row[held[mine]]]
    left_out = [[channels.difference(s, rms(line[mine])) for line in side] for side in (before, after)]
    sides = [Gain.Both.model_validate({"without": one, "with": other}) for one, other in left_out]
    return Gain(
        scheme=scheme,
        channel=s.name,
        unit=channels.unit_of_difference(s),
        n=int(mine.sum()),
        rmse_before=sides[0].without,
        rmse_after=sides[1].without,
        before=sides[0],
        after=sides[1],
        ratio_ci90=_bootstrap(before[0, mine], after[0, mine], test, seed),
        noise_floor=channels.difference(s, noise_floor(found, sensor)),
        rivals=rivals,
        chosen=dict(Counter(c for e in errors for c in e.chosen).most_common()),
        folds=len(folds),
    )


def noise_floor(found: Found, sensor: int) -> float:
    """Standard deviation of one reading: its own scatter, that of the inputs and of the day, as found."""
    o, noise = found.problem.data, found.hypotheses[0].fit.noise
    loose = sum(np.exp(2 * s) * np.diag(t.matrix) for t, s in zip(noise.loose, noise.scales, strict=True))
    return float(np.sqrt(np.mean(np.asarray(loose)[found.problem.own][o.kind == sensor])))


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _bootstrap(before: np.ndarray, after: np.ndarray, test: np.ndarray, seed: int) -> tuple[float, float]:
    """90 % interval of the ratio of errors, tests drawn with replacement."""
    group = np.unique(test, return_inverse=True)[1]
    n = int(group.max()) + 1
    a, b = (np.bincount(group, weights=e**2, minlength=n) for e in (before, after))
    draws = np.random.default_rng(seed).integers(0, n, size=(DRAWS, n))
    ratios = np.sqrt(b[draws].sum(axis=1) / np.maximum(a[draws].sum(axis=1), 1e-300))
    low, high = np.quantile(ratios, [0.05, 0.95])
    return float(low), float(high)
