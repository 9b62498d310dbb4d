"""What the causes gain on readings that were left out, with everything repeated without them.

In each fold the rig is calibrated without the fold's readings, all causes are looked at again there, the leading ones
are fitted and weighed again. What is predicted before and after has the same scatter, and both are predicted without
and with the same discrepancy: a smooth remainder over the conditions whose size the kept readings tell.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from ....model.errors import SolveError
from ..infer import screen
from ..infer.evidence import White
from ..infer.extra import REMAINDERS
from ..infer.fit import Fit, Start, fitted, joined, prior_precision
from ..infer.found import Found
from ..infer.problem import Aside, Problem
from ..model.formula import Formula
from . import channels
from .findings import Gain
from .folds import schemes
from .rivals import RIVALS

#: Causes that are looked at again in a fold.
LEADING = 6
#: Forms of each.
FORMS = 2
#: Causes that are fitted.
FITTED = 2
#: Draws of the bootstrap.
DRAWS = 2000
#: Steps of a fit in each of its rounds: it begins near its end.
STEPS = 4


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
        found: the search in all data; only its settings, its starting point and gross readings are used
        seed: of the bootstrap
        progress: told the share done
    """
    plans = schemes(found.problem.data.campaign)
    total, done, told = sum(len(folds) for folds in plans.values()), 0, []
    for scheme, folds in plans.items():
        errors = []
        for rows in folds:
            with suppress(SolveError):
                errors.append(_fold(found, rows))
            done += 1
            progress(done / total)
        if errors:
            told += [
                g for i in range(len(found.problem.data.read)) if (g := _gain(found, scheme, folds, errors, i, seed))
            ]
    oil = [s.name for s in found.problem.data.read if s.kind == "oil_temp"]
    return sorted(told, key=lambda g: g.channel not in oil)


def _fold(found: Found, rows: np.ndarray) -> _Fold:
    """Calibration, look, choice and prediction without the readings of some rows."""
    o = found.problem.data
    known = {a.number for a in found.problem.aside if not a.sensor}
    held = np.array([i for i in np.flatnonzero(np.isin(o.row, rows)) if i not in known])
    problem = found.problem.without(found.problem.aside | {Aside(int(i)) for i in held})
    null = fitted(problem, (), found.null.look.z, found.null.noise.scales)
    fits, logs = _chosen(found, problem, null)
    p = np.exp(logs - logsumexp(logs))
    errors = np.array([_errors(problem, fit, held) for fit in fits])
    best = fits[int(np.argmax(p))]
    return _Fold(held, errors[0], np.einsum("h,hdk->dk", p, errors), best.causes)


def _chosen(found: Found, problem: Problem, null: Fit) -> tuple[list[Fit], np.ndarray]:
    """Nothing, the leading causes and the best pair by the kept readings: fits and log joint probabilities.

    All causes are judged by their effects at the rig as calibrated in all data, the leading ones again by their effects
    at the rig as calibrated here.
    """
    formulas = found.formulas
    share = np.array([np.log(f.form.weight) + found.prior.share[f.cause.id] for f in formulas])
    whole = screen.judged(found.first.candidates, found.first.owner, found.first.effects, null.views(problem))
    short = _leading(formulas, whole.by_form(len(formulas)) + share)
    first = screen.look(problem, null, [formulas[k] for k in short])
    value = first.by_form(len(short)) + share[short]
    fits, logs = [null], [null.evidence + found.critical]
    for i in _best(formulas, short, value)[:FITTED]:
        with suppress(SolveError):
            fit = _begun(found, problem, null, first.start(i))
            own = [j for j, k in enumerate(short) if formulas[k].cause.id == formulas[short[i]].cause.id and j != i]
            others = [min(null.evidence + value[j], fit.evidence + share[short[j]]) for j in own]
            fits.append(fit)
            logs.append(float(logsumexp([fit.evidence + share[short[i]], *others])))
    if len(fits) > 1 and max(logs[1:]) > logs[0]:
        with suppress(SolveError):
            one, log = fits[int(np.argmax(logs[1:])) + 1], max(logs[1:])
            fit, log = _paired(found, problem, one, log, short)
            fits.append(fit)
            logs.append(log)
    return fits, np.array(logs)


def _leading(formulas: Sequence[Formula], value: np.ndarray) -> list[int]:
    """The best forms of the leading causes."""
    taken: dict[str, list[int]] = {}
    for k in np.argsort(-value):
        cause = formulas[k].cause.id
        if cause in taken or len(taken) < LEADING:
            taken.setdefault(cause, []).append(int(k))
    return sorted(k for own in taken.values() for k in own[:FORMS])


def _best(formulas: Sequence[Formula], short: Sequence[int], value: np.ndarray) -> list[int]:
    """The best form of each class of causes, as a place in the short list, best first."""
    best: dict[str, int] = {}
    for i in np.argsort(-value):
        best.setdefault(formulas[short[i]].cause.family, int(i))
    return list(best.values())


def _paired(found: Found, problem: Problem, one: Fit, log: float, short: Sequence[int]) -> tuple[Fit, float]:
    """A fitted cause with the one that promises most beside it, and its log joint probability."""
    (acting,) = one.look.acting
    others = [k for k in short if found.formulas[k].cause.family != acting.formula.cause.family]
    formulas = [found.formulas[k] for k in others]
    beside = screen.look(problem, one, formulas)
    share = np.array([np.log(f.form.weight) + found.prior.share[f.cause.id] for f in formulas])
    k = int(np.argmax(beside.by_form(len(formulas)) + share))
    fit = _begun(found, problem, one, beside.start(k))
    prior = found.prior([acting.id, formulas[k].cause.id]) - found.prior([acting.id])
    return fit, log + fit.evidence - one.evidence + prior + float(np.log(formulas[k].form.weight))


def _begun(found: Found, problem: Problem, near: Fit, start: Start) -> Fit:
    """A cause that joins, fitted to the kept readings; where all data have a fit of these forms it begins there."""
    forms = {id(a.formula) for a in (*near.look.acting, start.acting)}
    for h in found.hypotheses:
        if {id(a.formula) for a in h.fit.look.acting} == forms:
            return fitted(problem, h.fit.look.acting, h.fit.look.z, h.fit.noise.scales, STEPS)
    return joined(problem, near, [start], STEPS)


def _errors(problem: Problem, fit: Fit, held: np.ndarray) -> np.ndarray:
    """Errors (2, k) on held entries: without, with the discrepancy."""
    look = fit.look
    kept = np.setdiff1d(np.arange(problem.m), [a.number for a in problem.aside if not a.sensor])
    prior = 1 / prior_precision(problem, look.acting)
    S = fit.noise.covariance + look.jacobian * prior @ look.jacobian.T
    r = problem.measured - look.shown + look.jacobian @ look.x
    D, without = discrepancy(problem), White.of(S[np.ix_(kept, kept)])
    own, logs = D[np.ix_(kept, kept)], [without.log_density(without(r[kept]))]
    for size in REMAINDERS:
        white = White.of(S[np.ix_(kept, kept)] + size**2 * own)
        logs.append(white.log_density(white(r[kept])))
    sizes = np.array([0.0, *REMAINDERS])
    shares = np.exp(np.array(logs) - logsumexp(logs))
    mean = float(np.sqrt(shares @ sizes**2))
    return np.array([_left(S + size**2 * D, r, kept, held) for size in (0.0, mean)])


def _left(S: np.ndarray, r: np.ndarray, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Held residuals less what the kept ones let one expect of them."""
    white = White.of(S[np.ix_(kept, kept)])
    return np.asarray(r[held] - S[np.ix_(held, kept)] @ white.back(r[kept]))


def discrepancy(problem: Problem) -> np.ndarray:
    """Covariance (M, M) of a remainder that is smooth in the conditions, of each sensor its own, at size one."""
    o = problem.data
    sd, sensor = o.entries.repeat, o.entries.sensor
    whole = np.zeros((problem.m, problem.m))
    whole[problem.own, problem.own] = problem.alike * (sensor[:, None] == sensor) * np.outer(sd, sd)
    return whole


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
        rivals[name] = channels.difference(s, rms(np.concatenate(left)))
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
