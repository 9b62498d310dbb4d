"""The gain on points held out: both halves of a test together, the choice of the cause repeated without them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import logsumexp

from .evidence import White
from .findings import Gain
from .family import Family
from .search import NONE, ONE, Hypothesis, Search

DRAWS = 2000


def gain(search: Search, leading: Sequence[Hypothesis], seed: int, scheme: str = "leave-one-operating-point") -> Gain:
    """Errors of the oil temperature on held-out groups, before and after the best hypothesis of the remaining data."""
    c, part = search.problem.data, search.problem.place(search.problem.data)
    test, ends = c.model.rows.test, c.model.rows.test[: c.model.n]
    labels = test[c.channels.rows]
    oil = part.start + np.arange(len(labels))[c.channels.part("T_oil")]
    V, r = search.null.covariance, search.null.residual
    before, after = np.zeros(c.model.n), np.zeros(c.model.n)
    pool = candidates(search, leading)
    for group in groups(search, scheme):
        out = part.start + np.flatnonzero(np.isin(labels, group))
        kept = np.setdiff1d(np.arange(len(r)), out)
        held = np.flatnonzero(np.isin(ends, group))
        factor = cho_factor(V[np.ix_(kept, kept)])
        carry = cho_solve(factor, V[np.ix_(kept, oil[held])]).T
        before[held] = r[oil[held]] - carry @ r[kept]
        effect = chosen_effect(pool, r, V, kept)
        left = r - effect
        after[held] = left[oil[held]] - carry @ left[kept]
    ratios = _bootstrap(before, after, ends, seed)
    return Gain(scheme, "T_oil_C", rms(before), rms(after), ratios, noise_floor(search), len(before))


def candidates(
    search: Search, leading: Sequence[Hypothesis]
) -> list[tuple[tuple[Family, ...], tuple[int, ...], float]]:
    """What a fold may choose from: every form of every single, and the leading pairs, each with its log prior."""
    prior = float(np.log(ONE / len(search.causes)))
    pool: list[tuple[tuple[Family, ...], tuple[int, ...], float]] = []
    seen = set()
    for h in leading:
        if len(h.causes) == 1:
            f = h.families[0]
            pool += [((f,), (k,), prior + float(f.log_w[k] - np.log(len(f.forms)))) for k in range(len(f.forms))]
            seen.add(h.causes[0])
        elif h.families:
            best = tuple(_index(f, h) for f in h.families)
            pool.append((h.families, best, prior - 3.0))
    for f in search.found.values():
        if f.cause.id not in seen:
            pool += [((f,), (k,), prior + float(f.log_w[k] - np.log(len(f.forms)))) for k in range(len(f.forms))]
    return pool


def _index(f: Family, h: Hypothesis) -> int:
    theta = h.theta[f.cause.id]
    return next(k for k, form in enumerate(f.forms) if all(theta[n] == v for n, v in form.items()))


def chosen_effect(
    pool: Sequence[tuple[tuple[Family, ...], tuple[int, ...], float]], r: np.ndarray, V: np.ndarray, kept: np.ndarray
) -> np.ndarray:
    """Effect on all readings of what the kept ones prefer, averaged over what they leave open; none counts too."""
    white = White.of(r[kept], V[np.ix_(kept, kept)])
    columns = np.stack([f.signatures[:, k] for fs, ks, _ in pool for f, k in zip(fs, ks, strict=True)], axis=1)
    G = white.columns(columns[kept])
    logs, effects, j = [float(np.log(NONE))], [np.zeros(len(r))], 0
    for fs, ks, prior in pool:
        n = len(ks)
        A = G[:, j : j + n]
        sd = np.array([2 * f.cause.size.sd for f in fs])
        precision = A.T @ A + np.diag(sd**-2)
        size = np.linalg.solve(precision, A.T @ white.e)
        size = np.clip(size, [f.cause.size.low for f in fs], [f.cause.size.high for f in fs])
        fit = float(size @ (A.T @ white.e) - 0.5 * size @ precision @ size)
        logs.append(prior + fit - 0.5 * float(np.log(np.linalg.det(precision) * np.prod(sd**2))))
        effects.append(columns[:, j : j + n] @ size)
        j += n
    weights = np.exp(np.array(logs) - logsumexp(logs))
    keep = np.flatnonzero(weights > 1e-4)
    return np.asarray(sum(weights[i] * effects[i] for i in keep))


def groups(search: Search, scheme: str) -> Iterable[Sequence[int]]:
    """Test indices held out together."""
    rows = search.problem.data.model.rows
    n = rows.n_tests
    if scheme == "leave-one-operating-point":
        return [[k] for k in range(n)]
    tests = search.problem.data.model.tests
    if scheme == "leave-one-oil":
        labels: list[object] = [t.oil for t in tests]
    else:
        values = (
            rows.per_test(rows.w * 30 / np.pi) / 25 if scheme == "leave-one-speed" else rows.per_test(rows.tau) / 200
        )
        labels = list(np.round(values).astype(int))
    return [[k for k in range(n) if labels[k] == label] for label in dict.fromkeys(labels)]


def noise_floor(search: Search) -> float:
    """Standard deviation of one oil reading against the room, as the card states it."""
    card, c = search.problem.card, search.problem.data
    rise = float(np.mean(c.measured[c.channels.part("T_oil")] - c.model.rows.T_room[: c.model.n]))
    parts = (card.channel("T_oil_C").repeat_sd, card.channel("T_amb_C").repeat_sd, card.day_cooling_sd * rise)
    return float(np.sqrt(sum(p**2 for p in parts)))


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _bootstrap(before: np.ndarray, after: np.ndarray, test: np.ndarray, seed: int) -> tuple[float, float]:
    """90 % interval of the ratio of errors, tests drawn with replacement."""
    n = int(test.max()) + 1
    a, b = (np.bincount(test, weights=e**2, minlength=n) for e in (before, after))
    draws = np.random.default_rng(seed).integers(0, n, size=(DRAWS, n))
    ratios = np.sqrt(b[draws].sum(axis=1) / np.maximum(a[draws].sum(axis=1), 1e-300))
    low, high = np.quantile(ratios, [0.05, 0.95])
    return float(low), float(high)
