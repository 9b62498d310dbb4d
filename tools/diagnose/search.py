"""The search for causes: scores of all, evidence of singles and pairs, leaders looked at again where they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ..effects.cause import Cause, Theta
from ..effects.library import CAUSES
from .evidence import White, log_bayes_factors, log_bayes_factors_pair, score
from .problem import Linear, Problem

#: Forms of each family in the first look and for leaders.
FORMS, FORMS_LEADER, FORMS_PAIR = 10, 32, 14
#: Leading singles searched for pairs, and hypotheses looked at again.
PAIR_LEADERS, AGAIN = 8, 5
#: Prior odds of one pair of causes against one single cause; and of something outside the library.
PAIR_ODDS, UNKNOWN_ODDS = 0.02, 1.0
DRAWS = 4000


@dataclass(frozen=True)
class Family:
    """All forms of one cause as signatures at one linearisation."""

    cause: Cause
    forms: Sequence[Theta]
    signatures: np.ndarray
    s: np.ndarray
    q: np.ndarray
    white: np.ndarray

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the size, one per form."""
        size = self.cause.size
        return np.full(len(self.forms), size.low), np.full(len(self.forms), size.high)

    @property
    def sd(self) -> np.ndarray:
        """Prior half width of the size, one per form."""
        return np.full(len(self.forms), self.cause.size.sd)

    def log_bf(self) -> np.ndarray:
        """Log Bayes factor of each form."""
        return log_bayes_factors(self.s, self.q, self.sd, *self.bounds)

    def evidence(self) -> float:
        """Log Bayes factor of the family."""
        return float(logsumexp(self.log_bf()) - np.log(len(self.forms)))

    def best(self) -> tuple[Theta, float]:
        """Form of most evidence and its size."""
        k = int(np.argmax(self.log_bf()))
        return self.forms[k], float(np.clip(self.s[k] / max(self.q[k], 1e-300), *(b[k] for b in self.bounds)))


@dataclass(frozen=True)
class Hypothesis:
    """A set of causes with its log evidence and, per cause, its fitted parameters."""

    causes: tuple[str, ...]
    log_evidence: float
    theta: Mapping[str, Theta] = field(default_factory=dict)
    sd: Mapping[str, float] = field(default_factory=dict)
    linear: Linear | None = None


def log_gauss(white: White) -> float:
    """Log density of a residual without any cause."""
    return float(-0.5 * white.e @ white.e - np.log(np.diag(white.L)).sum())


def families(
    problem: Problem, linear: Linear, white: White, causes: Sequence[Cause], n: int, sizes: Mapping[str, float]
) -> dict[str, Family]:
    """Signatures of n forms of each cause, as secants to the given sizes (the prior's half width where none is)."""
    wanted: list[tuple[Cause, Theta, float]] = []
    for cause in causes:
        size = sizes.get(cause.id, cause.size.sd)
        wanted += [(cause, form, size) for form in cause.forms(n if cause.shapes else 1)]
    G = problem.signatures(linear, wanted)
    whitened = white.columns(G)
    found, begin = {}, 0
    for cause in causes:
        forms = [form for c, form, _ in wanted if c is cause]
        part = slice(begin, begin + len(forms))
        g = whitened[:, part]
        found[cause.id] = Family(cause, forms, G[:, part], g.T @ white.e, (g**2).sum(axis=0), g)
        begin += len(forms)
    return found


def p_any(found: Mapping[str, Family], white: White, seed: int) -> float:
    """Family-wise p of the largest directed score, by drawing residuals without any cause."""
    observed = max(float(score(f.s, f.q, *f.bounds).max()) for f in found.values())
    draws = np.random.default_rng(seed).standard_normal((DRAWS, len(white.e)))
    largest = np.zeros(DRAWS)
    for f in found.values():
        low, high = f.bounds
        largest = np.maximum(largest, score(draws @ f.white, f.q, low, high).max(axis=1))
    return float((1 + (largest >= observed).sum()) / (DRAWS + 1))


def pair_evidence(a: Family, b: Family) -> tuple[float, tuple[int, int]]:
    """Log Bayes factor of two families together, and the forms of most evidence."""
    log_bf = log_bayes_factors_pair((a.s, b.s), (a.q, b.q), a.white.T @ b.white, (a.sd, b.sd), (a.bounds, b.bounds))
    k, l = np.unravel_index(int(np.argmax(log_bf)), log_bf.shape)  # noqa: E741
    return float(logsumexp(log_bf) - np.log(log_bf.size)), (int(k), int(l))


def pair_sizes(a: Family, b: Family, k: int, l: int) -> tuple[float, float]:  # noqa: E741
    """Most likely sizes of two forms together, with their priors."""
    A = np.array([[a.q[k], a.white[:, k] @ b.white[:, l]], [0.0, b.q[l]]])
    A[1, 0] = A[0, 1]
    A += np.diag([1 / (2 * a.cause.size.sd) ** 2, 1 / (2 * b.cause.size.sd) ** 2])
    x, y = np.linalg.solve(A, [a.s[k], b.s[l]])
    return float(np.clip(x, a.cause.size.low, a.cause.size.high)), float(
        np.clip(y, b.cause.size.low, b.cause.size.high)
    )


@dataclass
class Search:
    """The whole search on one problem."""

    problem: Problem
    seed: int = 0
    causes: Sequence[Cause] = field(default_factory=lambda: list(CAUSES.values()))

    def run(self) -> None:
        """Fill the results."""
        self.null = self.problem.settled()
        self.white = White.of(self.null.residual, self.null.covariance)
        self.base = log_gauss(self.white)
        self.found = families(self.problem, self.null, self.white, self.causes, FORMS, {})
        self.p_any = p_any(self.found, self.white, self.seed)
        self.p_omnibus = float(chi2.sf(self.white.e @ self.white.e, len(self.white.e)))
        first = self._first_look()
        self.hypotheses = sorted(self._again(first), key=lambda h: -h.log_evidence)

    def _first_look(self) -> list[Hypothesis]:
        singles = []
        for f in self.found.values():
            form, size = f.best()
            singles.append(
                Hypothesis((f.cause.id,), self.base + f.evidence(), {f.cause.id: {**form, f.cause.size.name: size}})
            )
        singles.sort(key=lambda h: -h.log_evidence)
        pairs = []
        for x, y in combinations([h.causes[0] for h in singles[:PAIR_LEADERS]], 2):
            a, b = self.found[x], self.found[y]
            if a.cause.like and a.cause.like == b.cause.like:
                continue
            value, (k, l) = pair_evidence(a, b)  # noqa: E741
            sizes = pair_sizes(a, b, k, l)
            theta = {x: {**a.forms[k], a.cause.size.name: sizes[0]}, y: {**b.forms[l], b.cause.size.name: sizes[1]}}
            pairs.append(Hypothesis((x, y), self.base + value + np.log(PAIR_ODDS), theta))
        pairs.sort(key=lambda h: -h.log_evidence)
        return [Hypothesis((), self.base), *singles, *pairs]

    def _again(self, first: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Leaders with nuisances settled where the cause acts, and more forms of its family."""
        ranked = sorted((h for h in first if h.causes), key=lambda h: -h.log_evidence)
        leaders = ranked[:AGAIN]
        rest = [h for h in first if h not in leaders]
        return [*rest, *(self._refined(h) for h in leaders if h.causes)]

    def _refined(self, h: Hypothesis) -> Hypothesis:
        causes = [CAUSES[c] for c in h.causes]
        theta = dict(h.theta)
        for _ in range(2):
            linear = self.problem.settled(self.null.z, theta, causes)
            white, found, value, theta, sd = self._at(linear, causes, theta)
        return Hypothesis(h.causes, value, theta, sd, linear)

    def _at(self, linear: Linear, causes: Sequence[Cause], theta: Mapping[str, Theta]):
        """Evidence at a linearisation that holds the causes: their effect is put back, then explained by all forms."""
        n = FORMS_LEADER if len(causes) == 1 else FORMS_PAIR
        sizes = {c.id: _safe(theta[c.id][c.size.name], c) for c in causes}
        held = linear.nominal - self._healthy(linear)
        back = Linear(
            linear.z,
            linear.values,
            linear.nominal,
            linear.residual + held,
            linear.covariance,
            linear.jacobian,
            linear.noise,
        )
        white = White.of(back.residual, back.covariance)
        found = families(self.problem, back, white, causes, n, sizes)
        if len(causes) == 1:
            f = found[causes[0].id]
            form, size = f.best()
            value = log_gauss(white) + f.evidence()
            k = int(np.argmax(f.log_bf()))
            return (
                white,
                found,
                value,
                {causes[0].id: {**form, causes[0].size.name: size}},
                {causes[0].id: float(f.q[k] ** -0.5)},
            )
        a, b = (found[c.id] for c in causes)
        gain, (k, l) = pair_evidence(a, b)  # noqa: E741
        x, y = pair_sizes(a, b, k, l)
        new = {a.cause.id: {**a.forms[k], a.cause.size.name: x}, b.cause.id: {**b.forms[l], b.cause.size.name: y}}
        sd = {a.cause.id: float(a.q[k] ** -0.5), b.cause.id: float(b.q[l] ** -0.5)}
        return white, found, log_gauss(white) + gain + np.log(PAIR_ODDS), new, sd

    def _healthy(self, linear: Linear) -> np.ndarray:
        return self.problem.shown([linear.values])[:, 0]


def _safe(size: float, cause: Cause) -> float:
    """A size for a secant: not zero, inside the bounds."""
    least = 0.2 * cause.size.sd
    if abs(size) >= least:
        return size
    return least if cause.size.high >= least and size >= 0 else -least if cause.size.low <= -least else least
