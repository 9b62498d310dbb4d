"""The gain on points held out: both halves of a test together, the choice of the cause repeated without them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp

from ..rivals import least_squares
from .evidence import White, log_gauss
from .family import Family
from .findings import Gain
from .hypothesis import Hypothesis
from .problem import Linear
from .repeated import repeated
from .search import Search
from .together import best_together, evidence_of

DRAWS = 2000
#: Groups of tests that are held out together, beside single operating points.
SCHEMES = ("leave-one-speed", "leave-one-load", "leave-one-oil", "first-oil-to-others")


@dataclass(frozen=True)
class View:
    """Hypotheses that share a linearisation: none at all, families alone, or pairs of families."""

    linear: Linear
    hypotheses: tuple[tuple[float, tuple[Family, ...]], ...]


def gain(search: Search, leading: Sequence[Hypothesis], seed: int, scheme: str = "leave-one-operating-point") -> Gain:
    """Errors of the oil temperature on held-out groups, before and after what the remaining data prefer."""
    c, part = search.problem.data, search.problem.place(search.problem.data)
    test, ends = c.model.rows.test, c.model.rows.test[: c.model.n]
    labels = test[c.channels.rows]
    oil = part.start + np.arange(len(labels))[c.channels.part("T_oil")]
    before, after = np.full(c.model.n, np.nan), np.full(c.model.n, np.nan)
    rivals = {name: before.copy() for name in RIVALS}
    views = views_of(search, leading)
    for group in groups(search, scheme):
        out = part.start + np.flatnonzero(np.isin(labels, group))
        kept = np.setdiff1d(np.arange(len(search.null.residual)), out)
        there = np.isin(ends, group)
        held = np.flatnonzero(there)
        logs, errors = zip(*(found for view in views for found in seen(view, kept, oil[held])), strict=True)
        weights = np.exp(np.array(logs) - logsumexp(logs))
        before[held], after[held] = errors[0], weights @ np.array(errors)
        for name, rival in RIVALS.items():
            rivals[name][held] = rival(search, ~there, there)
    tried = np.flatnonzero(np.isfinite(before))
    ratios = _bootstrap(before[tried], after[tried], np.unique(ends[tried], return_inverse=True)[1], seed)
    plain = {name: rms(errors[tried]) for name, errors in rivals.items()}
    errors = rms(before[tried]), rms(after[tried])
    return Gain(scheme, "T_oil_C", *errors, ratios, noise_floor(search), len(tried), plain)


def gains(search: Search, leading: Sequence[Hypothesis], seed: int) -> tuple[Gain, ...]:
    """Errors where whole groups are held out, by every scheme that leaves several groups."""
    n = search.problem.data.model.rows.n_tests
    schemes = {scheme: list(groups(search, scheme)) for scheme in SCHEMES}
    sound = [scheme for scheme, own in schemes.items() if own and all(0 < len(group) < n for group in own)]
    return tuple(gain(search, leading, seed, scheme) for scheme in sound)


def views_of(search: Search, leading: Sequence[Hypothesis]) -> list[View]:
    """What a fold may choose from: nothing, every cause at the first look, and the leading hypotheses as fitted."""
    fitted = [h for h in leading if h.families and h.linear and h.linear.causes]
    closer = {h.causes[0] for h in fitted if len(h.causes) == 1}
    first = [(search.prior(1), (f,)) for f in search.found.values() if f.cause.id not in closer]
    views = [View(search.null, ((search.prior(0), ()), *first))]
    return views + [View(h.scattered(), ((search.prior(len(h.causes)), h.families),)) for h in fitted]


def seen(view: View, kept: np.ndarray, held: np.ndarray) -> Iterable[tuple[float, np.ndarray]]:
    """Log posterior of each hypothesis by the kept readings, and the errors it leaves on the held ones."""
    V, r = view.linear.covariance, view.linear.residual
    white = White.of(r[kept], V[np.ix_(kept, kept)])
    carry = white.columns(V[np.ix_(kept, held)]).T
    base, error = log_gauss(white), r[held] - carry @ white.e
    for prior, own in view.hypotheses:
        if not own:
            yield base + prior, error
            continue
        cut = [replace(f, signatures=f.signatures[kept]).seen(white) for f in own]
        if len(own) == 1:
            shares, sizes = [cut[0].weights()], [cut[0].sizes()[0]]
        else:
            places, at = best_together(cut)
            shares = [np.eye(len(f.forms))[k] for f, k in zip(own, places, strict=True)]
            sizes = [np.full(len(f.forms), size) for f, size in zip(own, at, strict=True)]
        effect = np.zeros(len(held))
        for f, g, w, size in zip(own, cut, shares, sizes, strict=True):
            effect += (f.signatures[held] - carry @ g.white) @ (w * size)
        yield base + evidence_of(cut) + prior, error - effect


def constant_cooling(search: Search, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Errors of an oil that is warmer than the room by the loss over one constant."""
    c = search.problem.data
    loss = c.measured[c.channels.part("loss")] * c.model.rows.w[: c.model.n] * c.model.rows.direction[: c.model.n]
    return _regression(search, np.abs(loss)[:, None], kept, held)


def linear_in_conditions(search: Search, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Errors of an oil whose rise over the room is linear in speed and load."""
    rows, n = search.problem.data.model.rows, search.problem.data.model.n
    return _regression(search, np.stack([np.ones(n), rows.w[:n], rows.tau[:n]], axis=1), kept, held)


def _regression(search: Search, features: np.ndarray, kept: np.ndarray, held: np.ndarray) -> np.ndarray:
    c = search.problem.data
    rise = c.measured[c.channels.part("T_oil")] - c.model.rows.T_room[: c.model.n]
    return np.asarray(rise[held] - features[held] @ least_squares(features[kept], rise[kept]))


#: Plain statistics to beat: what it assumes -> its errors on held readings.
RIVALS: Mapping[str, Callable[[Search, np.ndarray, np.ndarray], np.ndarray]] = {
    "constant cooling": constant_cooling,
    "linear in speed and load": linear_in_conditions,
}


def groups(search: Search, scheme: str) -> Iterable[Sequence[int]]:
    """Test indices held out together."""
    rows = search.problem.data.model.rows
    n = rows.n_tests
    if scheme == "leave-one-operating-point":
        return [[k] for k in range(n)]
    tests = search.problem.data.model.tests
    if scheme == "first-oil-to-others":
        return [[k for k in range(n) if tests[k].oil != tests[0].oil]]
    if scheme == "leave-one-oil":
        labels: list[object] = [t.oil for t in tests]
    else:
        values = (
            rows.per_test(rows.w * 30 / np.pi) / 25 if scheme == "leave-one-speed" else rows.per_test(rows.tau) / 200
        )
        labels = list(np.round(values).astype(int))
    return [[k for k in range(n) if labels[k] == label] for label in dict.fromkeys(labels)]


def noise_floor(search: Search) -> float:
    """Standard deviation of one oil reading against the room: by repeated points, or else as the card states it."""
    card, c = search.problem.card, search.problem.data
    if (found := repeated(c.model.campaign)) is not None:
        return found.T_oil
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
