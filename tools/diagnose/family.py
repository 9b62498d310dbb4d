"""A cause's family of forms at one linearisation: signatures, evidence, sizes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, norm

from ..effects.cause import Cause, Theta, spread
from .evidence import WIDTHS, White, log_bayes_factors, log_bayes_factors_pair
from .fit import Mode
from .problem import Linear, Problem

#: Forms of a first look, and of each of its regimes; forms of a closer look: over the prior, and around the best ones.
FORMS, EACH, MORE, NEAR = 12, 10, 8, 24
#: Those are drawn wider than the fit says, and most keep its choice of kind.
WIDER, FAITHFUL = 1.4, 0.85


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

    def seen(self, white: White) -> Family:
        """The same signatures against another scatter."""
        g = white.columns(self.signatures)
        return replace(self, white=g, s=g.T @ white.e, q=(g**2).sum(axis=0))


@dataclass(frozen=True)
class Sample:
    """Forms of one cause: shares (n, shapes) of the prior, log weights against it, sizes of the secants (n or 1)."""

    cause: Cause
    shares: np.ndarray
    log_w: np.ndarray
    size: float | np.ndarray

    @staticmethod
    def of_prior(cause: Cause, n: int) -> Sample:
        """n forms spread over the prior, the middle first."""
        shares, log_w = cause.sample(n, EACH)
        size = np.full(len(shares), prior_size(cause))
        if cause.size.far is not None:
            size[1::2] = cause.size.far
        return Sample(cause, shares, log_w, size)

    def wanted(self) -> list[tuple[Cause, Theta, float]]:
        """Forms and sizes of which the signatures are sought."""
        sizes = np.broadcast_to(self.size, len(self.shares))
        return [
            (self.cause, form, float(size)) for form, size in zip(self.cause.forms(self.shares), sizes, strict=True)
        ]


def prior_size(cause: Cause) -> float:
    """One half width of the prior, to the side on which the cause can be so large."""
    size = cause.size
    return size.sd if size.sd <= size.high else -size.sd


def families(problem: Problem, linear: Linear, white: White, samples: Iterable[Sample]) -> dict[str, Family]:
    """Signatures of all forms of all samples."""
    looked_at = [(s, s.wanted()) for s in samples]
    G = problem.signatures(linear, [one for _, wanted in looked_at for one in wanted])
    whitened = white.columns(G)
    found, begin = {}, 0
    for s, wanted in looked_at:
        part, forms = slice(begin, begin + len(wanted)), [form for _, form, _ in wanted]
        g = whitened[:, part]
        found[s.cause.id] = Family(s.cause, forms, G[:, part], g, g.T @ white.e, (g**2).sum(axis=0), s.shares, s.log_w)
        begin += len(wanted)
    return found


def nearer(cause: Cause, mode: Mode, size: float, seed: int) -> Sample:
    """Forms around the most likely one and over the prior, weighted so that the prior stays what it was.

    Args:
        cause: the cause
        mode: where its shapes are, and how well they are known
        size: of the secants
        seed: of the draws
    """
    d, choice = len(cause.shapes), cause.choice
    if d == 0:
        return Sample(cause, np.zeros((1, 0)), np.zeros(1), size)
    free = [k for k in range(d) if k != choice]
    rng = np.random.default_rng(seed)
    shares = np.concatenate([mode.shares[None], spread(MORE, d), np.tile(mode.shares, (NEAR, 1))])
    density = np.ones(len(shares))
    if free:
        centre = norm.ppf(mode.shares[free])
        covariance = WIDER**2 * mode.covariance + 1e-4 * np.eye(len(free))
        drawn = centre + rng.standard_normal((NEAR, len(free))) @ np.linalg.cholesky(covariance).T
        shares[-NEAR:, free] = np.clip(norm.cdf(drawn), 1e-4, 1 - 1e-4)
        u = norm.ppf(shares[:, free])
        density *= multivariate_normal(centre, covariance).pdf(u) / norm.pdf(u).prod(axis=1)
    if choice is not None:
        ends = np.array([0.0, *cause.shapes[choice].ends])
        own = int(np.searchsorted(ends[1:], mode.shares[choice]))
        inside = rng.random(NEAR) < FAITHFUL
        low, high = np.where(inside, ends[own], 0.0), np.where(inside, ends[own + 1], 1.0)
        shares[-NEAR:, choice] = low + (high - low) * rng.random(NEAR)
        same = np.searchsorted(ends[1:], shares[:, choice]) == own
        density *= FAITHFUL * same / (ends[own + 1] - ends[own]) + 1 - FAITHFUL
    log_w = -np.log((MORE + NEAR * density) / (MORE + NEAR))
    log_w[0] = -50.0  # the most likely form is looked at, but counts through those drawn around it
    return Sample(cause, shares, log_w, size)


def form_of(f: Family, theta: Theta) -> int:
    """Which form of a family given parameters are."""
    return next(k for k, form in enumerate(f.forms) if all(theta[name] == value for name, value in form.items()))


def pair_evidence(a: Family, b: Family) -> tuple[float, np.ndarray]:
    """Log Bayes factor of two families together, and the log posterior weights of the forms (k, l), not normed."""
    log_bf = log_bayes_factors_pair((a.s, b.s), (a.q, b.q), a.white.T @ b.white, (a.sd, b.sd), (a.bounds, b.bounds))
    weighted = log_bf + a.log_w[:, None] + b.log_w[None, :]
    return float(logsumexp(weighted) - np.log(log_bf.size)), weighted


def pair_promise(a: Family, b: Family) -> float:
    """A quick look at the evidence of two families together: sizes of any sign, one width of their priors."""
    cross = a.white.T @ b.white
    pa, pb = a.q[:, None] + 1 / a.cause.size.sd**2, b.q[None, :] + 1 / b.cause.size.sd**2
    det = pa * pb - cross**2
    sa, sb = a.s[:, None], b.s[None, :]
    fit = 0.5 * (pb * sa**2 + pa * sb**2 - 2 * cross * sa * sb) / det
    logs = fit - 0.5 * np.log(det * (a.cause.size.sd * b.cause.size.sd) ** 2)
    return float(logsumexp(logs + a.log_w[:, None] + b.log_w[None, :]) - np.log(logs.size))


def best_pair(weights: np.ndarray) -> tuple[int, int]:
    """The two forms of most weight."""
    k, m = np.unravel_index(int(np.argmax(weights)), weights.shape)
    return int(k), int(m)


def pair_theta(a: Family, b: Family, k: int, m: int) -> dict[str, Theta]:
    """Two forms with their most likely sizes together."""
    cross = a.white[:, k] @ b.white[:, m]
    prior = [1 / (WIDTHS[-1] * f.cause.size.sd) ** 2 for f in (a, b)]
    x, y = np.linalg.solve([[a.q[k] + prior[0], cross], [cross, b.q[m] + prior[1]]], [a.s[k], b.s[m]])
    found = {}
    for f, form, size in ((a, k, x), (b, m, y)):
        found[f.cause.id] = f.theta(form, float(np.clip(size, f.cause.size.low, f.cause.size.high)))
    return found
