"""The search for causes: scores of all, evidence of singles and pairs, leaders looked at again where they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2, norm

from ..effects.cause import Cause, Theta, spread
from ..effects.taxonomy import CAUSES
from .evidence import WIDTHS, White, log_bayes_factors, log_bayes_factors_pair, score
from .problem import Linear, Problem

#: Forms of each family in the first look, and of each regime; more of the prior and around the best ones for leaders.
FORMS, EACH, MORE, NEAR = 9, 3, 14, 36
#: Forms around which more are drawn, and how far, in shares of the prior.
CENTRES, REACH = 6, 0.13
#: Leading singles searched for pairs; leading singles and pairs looked at again.
PAIR_LEADERS, AGAIN_ONE, AGAIN_TWO = 8, 5, 3
#: Prior probabilities: nothing wrong, one cause, two causes, something outside the library.
NONE, ONE, TWO, OUTSIDE = 0.5, 0.4, 0.06, 0.04
DRAWS = 4000
#: How far below the best a single or a pair may lie to be looked at again: other forms may lift it by this.
WORTH = (20.0, 8.0)
#: Sizes of an unnamed smooth discrepancy, in multiples of its unit: 1 K, 2 N.m.
UNNAMED = (0.7, 1.5, 3.0)


@dataclass(frozen=True)
class Family:
    """All forms of one cause as signatures at one linearisation; `white` are they in units of the scatter."""

    cause: Cause
    forms: Sequence[Theta]
    signatures: np.ndarray
    white: np.ndarray
    s: np.ndarray
    q: np.ndarray
    shares: np.ndarray
    log_w: np.ndarray

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the size, one per form."""
        n = len(self.forms)
        return np.full(n, self.cause.size.low), np.full(n, self.cause.size.high)

    @property
    def sd(self) -> np.ndarray:
        """Prior half width of the size, one per form."""
        return np.full(len(self.forms), self.cause.size.sd)

    def log_bf(self) -> np.ndarray:
        """Log Bayes factor of each form against no cause."""
        return log_bayes_factors(self.s, self.q, self.sd, *self.bounds)

    def evidence(self) -> float:
        """Log Bayes factor of the family."""
        return float(logsumexp(self.log_bf() + self.log_w) - np.log(len(self.forms)))

    def weights(self) -> np.ndarray:
        """Posterior weight of each form."""
        logs = self.log_bf() + self.log_w
        return np.asarray(np.exp(logs - logsumexp(logs)))

    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Posterior mean and standard deviation of the size, per form, under a wide prior."""
        variance = 1 / (self.q + 1 / (WIDTHS[-1] * self.sd) ** 2)
        return np.clip(variance * self.s, *self.bounds), np.sqrt(variance)

    def best(self) -> int:
        """The form of most evidence."""
        return int(np.argmax(self.log_bf()))

    def theta(self, k: int, size: float) -> Theta:
        """Parameters of a form with a size."""
        return {**self.forms[k], self.cause.size.name: size}


@dataclass(frozen=True)
class Hypothesis:
    """A set of causes: log evidence with its prior, fitted parameters, and the families at their linearisation."""

    causes: tuple[str, ...]
    log_posterior: float
    theta: Mapping[str, Theta] = field(default_factory=dict)
    families: tuple[Family, ...] = ()
    linear: Linear | None = None


def log_gauss(white: White) -> float:
    """Log density of a residual without any cause."""
    return float(-0.5 * white.e @ white.e - np.log(np.diag(white.L)).sum())


@dataclass(frozen=True)
class Sample:
    """Forms of one cause: shares (n, shapes) of the prior, log weights against it, and the size of the secants."""

    cause: Cause
    shares: np.ndarray
    log_w: np.ndarray
    size: float

    @staticmethod
    def of_prior(cause: Cause, n: int, size: float | None = None) -> Sample:
        """n forms spread over the prior, the middle first."""
        return Sample(cause, *cause.sample(n, EACH), cause.size.sd if size is None else size)


def families(problem: Problem, linear: Linear, white: White, samples: Iterable[Sample]) -> dict[str, Family]:
    """Signatures of all forms of all samples."""
    samples = list(samples)
    forms = {s.cause.id: (s, s.cause.forms(s.shares) if s.cause.shapes else [{}]) for s in samples}
    wanted = [(s.cause, form, s.size) for s, own in forms.values() for form in own]
    G = problem.signatures(linear, wanted)
    whitened = white.columns(G)
    found, begin = {}, 0
    for s, own in forms.values():
        part = slice(begin, begin + len(own))
        g = whitened[:, part]
        found[s.cause.id] = Family(s.cause, own, G[:, part], g, g.T @ white.e, (g**2).sum(axis=0), s.shares, s.log_w)
        begin += len(own)
    return found


def nearer(f: Family, size: float, seed: int) -> Sample:
    """More forms of a family around its best ones and over its prior, weighted so that the prior stays what it was."""
    d = f.shares.shape[1]
    if d == 0:
        return Sample(f.cause, f.shares, f.log_w, size)
    best = f.shares[np.argsort(-f.weights())[:CENTRES]]
    rng = np.random.default_rng(seed)
    drawn = best[np.arange(NEAR) % len(best)] + REACH * rng.standard_normal((NEAR, d))
    drawn = np.abs(drawn)  # reflected at both ends of the prior
    drawn = np.clip(1 - np.abs(1 - drawn), 1e-3, 1 - 1e-3)
    shares = np.concatenate([best[:1], spread(MORE, d), drawn])
    log_w = -np.log((MORE + NEAR * _density(shares, best)) / (MORE + NEAR))
    log_w[0] = -50.0  # the best form of before is looked at, but counts through those drawn around it
    return Sample(f.cause, shares, log_w, size)


def _density(shares: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Density of the draws around centres, with what is reflected at the ends of the prior."""
    total = np.zeros(len(shares))
    for centre in centres:
        own = np.ones(len(shares))
        for k in range(shares.shape[1]):
            x = shares[:, k]
            own *= sum(norm.pdf(x, c, REACH) for c in (centre[k], -centre[k], 2 - centre[k]))
        total += own / len(centres)
    return total


def pair_evidence(a: Family, b: Family) -> tuple[float, tuple[int, int]]:
    """Log Bayes factor of two families together, and the forms of most evidence."""
    log_bf = log_bayes_factors_pair((a.s, b.s), (a.q, b.q), a.white.T @ b.white, (a.sd, b.sd), (a.bounds, b.bounds))
    k, m = np.unravel_index(int(np.argmax(log_bf)), log_bf.shape)
    weighted = log_bf + a.log_w[:, None] + b.log_w[None, :]
    return float(logsumexp(weighted) - np.log(log_bf.size)), (int(k), int(m))


def pair_theta(a: Family, b: Family, k: int, m: int) -> dict[str, Theta]:
    """Two forms with their most likely sizes together."""
    cross = a.white[:, k] @ b.white[:, m]
    prior = [1 / (WIDTHS[-1] * f.cause.size.sd) ** 2 for f in (a, b)]
    x, y = np.linalg.solve([[a.q[k] + prior[0], cross], [cross, b.q[m] + prior[1]]], [a.s[k], b.s[m]])
    found = {}
    for f, form, size in ((a, k, x), (b, m, y)):
        found[f.cause.id] = f.theta(form, float(np.clip(size, f.cause.size.low, f.cause.size.high)))
    return found


class Search:
    """The search on one problem; `run` fills null, families, p values and hypotheses."""

    def __init__(self, problem: Problem, seed: int = 0, progress: Callable[[str, float], None] | None = None) -> None:
        self.problem, self.seed = problem, seed
        self.causes = [c for c in CAUSES.values() if visible(c, problem)]
        self.progress = progress or (lambda stage, share: None)

    def run(self) -> None:
        """Everything."""
        self.progress("calibrating without a cause", 0.0)
        self.null = self.problem.settled()
        self.white = White.of(self.null.residual, self.null.covariance)
        self.progress("effects of all causes", 0.15)
        self.found = families(self.problem, self.null, self.white, (Sample.of_prior(c, FORMS) for c in self.causes))
        self.p_any, self.critical = self._alarm()
        self.p_omnibus = float(chi2.sf(self.white.e @ self.white.e, len(self.white.e)))
        first = self._first_look()
        self.hypotheses = sorted(self._again(first), key=lambda h: -h.log_posterior)
        self.progress("hypotheses weighed", 0.8)

    def probabilities(self) -> np.ndarray:
        """Of each hypothesis, in order; what is missing to 1 lies outside the library."""
        logs = np.array([h.log_posterior for h in self.hypotheses])
        return np.asarray(np.exp(logs - np.logaddexp(logsumexp(logs), self.outside)))

    def _alarm(self) -> tuple[float, float]:
        """Family-wise p of the largest directed score, by drawing residuals without any cause; and its 95 % point."""
        observed = max(float(score(f.s, f.q, *f.bounds).max()) for f in self.found.values())
        draws = np.random.default_rng(self.seed).standard_normal((DRAWS, len(self.white.e)))
        largest = np.zeros(DRAWS)
        for f in self.found.values():
            largest = np.maximum(largest, score(draws @ f.white, f.q, *f.bounds).max(axis=1))
        return float((1 + (largest >= observed).sum()) / (DRAWS + 1)), float(np.quantile(largest, 0.95))

    def _first_look(self) -> list[Hypothesis]:
        base = log_gauss(self.white)
        self.outside = self._unnamed() + np.log(OUTSIDE)
        prior = np.log(ONE / len(self.causes))
        singles = []
        for f in self.found.values():
            k = f.best()
            theta = {f.cause.id: f.theta(k, float(f.sizes()[0][k]))}
            singles.append(Hypothesis((f.cause.id,), base + f.evidence() + prior, theta, (f,), self.null))
        singles.sort(key=lambda h: -h.log_posterior)
        return [Hypothesis((), base + np.log(NONE), linear=self.null), *singles, *self._pairs(singles, base)]

    def _pairs(self, singles: Sequence[Hypothesis], base: float) -> list[Hypothesis]:
        n = len(self.causes)
        prior, found = np.log(TWO / (n * (n - 1) / 2)), []
        for x, y in combinations([h.causes[0] for h in singles[:PAIR_LEADERS]], 2):
            a, b = self.found[x], self.found[y]
            if a.cause.like and a.cause.like == b.cause.like:
                continue
            value, (k, m) = pair_evidence(a, b)
            found.append(Hypothesis((x, y), base + value + prior, pair_theta(a, b, k, m), (a, b), self.null))
        return found

    def _unnamed(self) -> float:
        """Log evidence of a smooth discrepancy in the acting campaign that no cause of the library makes."""
        c, part = self.problem.data, self.problem.place(self.problem.data)
        rows = c.model.rows
        features = np.stack(
            [(rows.w - 18.0) / 5.0, (rows.tau - 2100.0) / 450.0, rows.direction, 2 * rows.order], axis=1
        )
        kernel = np.exp(-0.5 * ((features[:, None, :] - features[None, :, :]) ** 2).sum(axis=2))
        logs = []
        for T in UNNAMED:
            for loss in UNNAMED:
                extra = np.zeros_like(self.null.covariance)
                for name in c.channels.names:
                    place = c.channels.part(name)
                    block = slice(part.start + place.start, part.start + place.stop)
                    extra[block, block] = kernel * ((2 * loss) ** 2 if name == "loss" else T**2)
                logs.append(log_gauss(White.of(self.null.residual, self.null.covariance + extra)))
        return float(logsumexp(logs) - np.log(len(logs)))

    def _again(self, first: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Leaders again, with nuisances where the cause acts and more forms of its family."""
        best = max(h.log_posterior for h in first)
        leaders = []
        for n, most in ((1, AGAIN_ONE), (2, AGAIN_TWO)):
            ranked = sorted((h for h in first if len(h.causes) == n), key=lambda h: -h.log_posterior)
            least = max(best - WORTH[n - 1], first[0].log_posterior - 1.0)
            leaders += [h for h in ranked[:most] if h.log_posterior > least]
        kept = [h for h in first if h not in leaders]
        for k, h in enumerate(leaders):
            self.progress(f"looking again at {' and '.join(h.causes)}", 0.4 + 0.4 * k / len(leaders))
            kept.append(self._refined(h))
        return kept

    def _refined(self, h: Hypothesis) -> Hypothesis:
        causes = [CAUSES[c] for c in h.causes]
        linear = self.problem.settled(self._shifted(h), h.theta, causes, steps=1)
        back = self.problem.without(linear)
        white = White.of(back.residual, back.covariance)
        samples = []
        for k, (c, f) in enumerate(zip(causes, h.families, strict=True)):
            samples.append(nearer(f, sound(h.theta[c.id][c.size.name], c), self.seed + k))
        found = families(self.problem, back, white, samples)
        base = log_gauss(white)
        if len(causes) == 1:
            f = found[causes[0].id]
            k = f.best()
            theta: dict[str, Theta] = {f.cause.id: f.theta(k, float(f.sizes()[0][k]))}
            value = base + f.evidence() + np.log(ONE / len(self.causes))
        else:
            a, b = (found[c.id] for c in causes)
            gain, (k, m) = pair_evidence(a, b)
            theta, n_all = pair_theta(a, b, k, m), len(self.causes)
            value = base + gain + np.log(TWO / (n_all * (n_all - 1) / 2))
        return replace(h, log_posterior=float(value), theta=theta, families=tuple(found.values()), linear=linear)

    def _shifted(self, h: Hypothesis) -> np.ndarray:
        """Nuisances under a hypothesis, by the null's linearisation."""
        residual = self.null.residual.copy()
        for f in h.families:
            theta = h.theta[f.cause.id]
            k = next(i for i, form in enumerate(f.forms) if all(theta[n] == v for n, v in form.items()))
            residual -= f.signatures[:, k] * theta[f.cause.size.name]
        return self.problem.nuisances(self.null, residual)


def visible(cause: Cause, problem: Problem) -> bool:
    """Whether the data hold what the cause needs."""
    return cause.id != "cooling.humidity" or problem.data.model.rows.humidity is not None


def sound(size: float, cause: Cause) -> float:
    """A size for a secant: not near zero, inside the bounds."""
    least = 0.2 * cause.size.sd
    if abs(size) >= least:
        return size
    return -least if size < 0 and cause.size.low <= -least else min(least, cause.size.high)
