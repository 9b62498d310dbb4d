"""A hypothesis fitted: from several starts, over all kinds and thresholds, and its evidence around what was found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.special import logsumexp

from ...model.errors import SolveError
from ..effects.cause import Cause
from ..effects.taxonomy import CAUSES
from .evidence import White, log_gauss
from .family import Family, Sample, best_pair, families, form_of, nearer, pair_evidence, pair_theta
from .fit import STEPS, Fit, fitted
from .hypothesis import Hypothesis, Start
from .problem import Linear, Problem
from .together import evidence_of

#: Shares of the first look's sizes at which a fit begins, until one can be run.
SHARES = (1.0, 0.5, 0.2)
#: Standard deviations of what a form of the library leaves of a true effect, as shares of it, and their probabilities.
FORM = {0.01: 0.25, 0.03: 0.25, 0.06: 0.25, 0.12: 0.18, 0.24: 0.07}
#: Forms at which fits begin: how many, how much worse than the best at the first look, how far apart in the share of
#: the threshold, and steps after which only the best goes on.
MANY, NEXT, APART, BEGUN = 4, 40.0, 0.2, 3
#: Places at which thresholds are tried when a fit has ended, how many of the best it begins again from, and shares of
#: shapes that are the same.
SCAN, RETRIED, NEARBY = np.linspace(0.05, 0.95, 13), 3, 0.1
#: A fit goes on so often at most with slopes of the nuisances taken where it ended, and is begun again so often at a
#: form drawn around it that promises so much more in log likelihood; the least gain that counts.
STALE, STALLED, PROMISED, KEPT = 2, 2, 5.0, 0.5
#: What a second cause costs, about, where its evidence is not known yet.
OCCAM = 5.0


@dataclass(frozen=True)
class Refiner:
    """Fits hypotheses on one problem.

    Args:
        problem: data and model
        null: linearisation of hypotheses that have none
        seed: of the forms drawn around a fit
        prior: number of causes -> log prior probability of one hypothesis of so many
    """

    problem: Problem
    null: Linear
    seed: int
    prior: Callable[[int], float]

    def refined(self, h: Hypothesis) -> Hypothesis:
        """A hypothesis with its model linearised where it acts, and more forms around its best ones."""
        causes = [CAUSES[c] for c in h.causes]
        fit = self._begun(h)
        with suppress(SolveError):
            fit = self._scanned(h, fit)
        fit, linear, near = self._near(causes, fit)
        for _ in range(STALLED):
            if (better := self._better(h, fit, linear, near)) is None:
                break
            fit, linear, near = self._near(causes, better)
        theta = {c.id: near[c.id].theta(0, fit.theta[c.id][c.size.name]) for c in causes}
        logs, views = [], []
        for back, weight in zip(self.problem.put_back(linear, list(FORM)), FORM.values(), strict=True):
            white = White.of(back.residual, back.covariance)
            own = tuple(f.seen(white) for f in near.values())
            value = evidence_of(own)
            logs.append(value + log_gauss(white) + np.log(weight))
            views.append((own, back))
        found, back = views[int(np.argmax(logs))]
        value = float(logsumexp(logs)) + self.prior(len(causes))
        return replace(h, log_posterior=value, theta=theta, families=found, linear=back)

    def from_afar(self, h: Hypothesis, alone: Hypothesis) -> Hypothesis:
        """A pair with a cause far from linear, begun also where a short fit from a far size ends, if that promises.

        Args:
            h: the pair, as a first look beside a fitted cause shows it
            alone: the fitted cause
        """
        tried = []
        for f in h.families:
            if f.cause.size.far is None or f.cause.id in alone.causes:
                continue
            for far in (-f.cause.size.far, f.cause.size.far):
                if f.cause.size.low <= far <= f.cause.size.high:
                    with suppress(SolveError):
                        start = {**h.begin, f.cause.id: (h.begin[f.cause.id][0], far)}
                        tried.append(self._fitted(h, start, steps=BEGUN))
        if not tried or alone.linear is None:
            return h
        best, base = min(tried, key=lambda fit: fit.cost), self._fitted(alone, alone.begin, alone.linear.z, steps=1)
        value = alone.log_posterior + base.cost - best.cost - OCCAM + self.prior(2) - self.prior(1)
        return h if value < h.log_posterior else replace(h, log_posterior=value, also=(*h.also, best.start))

    def _near(self, causes: Sequence[Cause], fit: Fit) -> tuple[Fit, Linear, dict[str, Family]]:
        """A fit, the model linearised there, and forms around it."""
        linear = self.problem.linearised(fit.z, fit.theta, causes)
        for _ in range(STALE):
            better = fitted(self.problem, linear, fit.start)
            if better.cost > fit.cost - KEPT:
                break
            try:
                linear = self.problem.linearised(better.z, better.theta, causes)
            except SolveError:
                break
            fit = better
        samples = []
        for k, c in enumerate(causes):
            samples.append(nearer(c, fit.modes[c.id], sound(fit.theta[c.id][c.size.name], c), self.seed + k))
        return fit, linear, families(self.problem, linear, White.of(linear.residual, linear.covariance), samples)

    def _better(self, h: Hypothesis, fit: Fit, linear: Linear, near: Mapping[str, Family]) -> Fit | None:
        """A fit begun again at one of the forms drawn around it, where the way of the fit was too rough to get there.

        None for more than two causes, where no form promises more, or what was promised is not kept.
        """
        if len(near) > 2:
            return None
        (back,) = self.problem.put_back(linear)
        white = White.of(back.residual, back.covariance)
        own = [f.seen(white) for f in near.values()]
        if len(own) == 1:
            (f,) = own
            logs = f.log_bf()
            best: tuple[int, ...] = (f.best(),)
            theta = {f.cause.id: f.theta(best[0], float(f.sizes()[0][best[0]]))}
        else:
            f, g = own
            logs = pair_evidence(f, g)[1] - f.log_w[:, None] - g.log_w
            best = best_pair(logs)
            theta = pair_theta(f, g, *best)
        if logs[best] < logs[(0,) * len(own)] + PROMISED:
            return None
        start = {
            f.cause.id: (f.shares[k], sound(theta[f.cause.id][f.cause.size.name], f.cause))
            for f, k in zip(own, best, strict=True)
        }
        with suppress(SolveError):
            again = self._fitted(h, start, fit.z)
            if again.cost < fit.cost - KEPT:
                return again
        return None

    def _begun(self, h: Hypothesis) -> Fit:
        """The best of short fits from several forms, gone on with. Raises SolveError where none can be run."""
        starts, tried = self._starts(h), []
        if len(starts) == 1:
            return self._fitted(h, starts[0])
        for start in starts:
            with suppress(SolveError):
                tried.append(self._fitted(h, start, steps=BEGUN))
        if not tried:
            raise SolveError(f"{' and '.join(h.causes)}: no form of it can be run.")
        best = min(tried, key=lambda fit: fit.cost)
        return self._fitted(h, best.start, best.z)

    def _starts(self, h: Hypothesis) -> list[Start]:
        """Where fits begin: at the best forms, and for one cause at other kinds and thresholds nearly as good."""
        first = h.begin
        starts, f = [first, *h.also], h.families[0]
        if len(h.causes) > 1:
            return starts
        shares, size = first[f.cause.id]
        if f.cause.size.low < 0 < f.cause.size.high:  # far from linear: the other sign may do
            other = -np.sign(size) * f.cause.size.sd
            starts.append({f.cause.id: (shares, float(np.clip(other, f.cause.size.low, f.cause.size.high)))})
        if f.cause.size.far is not None:
            starts.append({f.cause.id: (shares, f.cause.size.far)})
        if f.cause.choice is None:
            return starts
        choice, logs, sizes = f.cause.choice, f.log_bf() + f.log_w, f.sizes()[0]
        place = choice if f.cause.threshold is None else f.cause.threshold
        kinds = np.searchsorted(f.cause.shapes[choice].ends, f.shares[:, choice])
        seen = [(kinds[form_of(f, h.theta[f.cause.id])], first[f.cause.id][0][place])]
        for k in np.argsort(-logs):
            new = all(kinds[k] != kind or (kind and abs(f.shares[k, place] - at) > APART) for kind, at in seen)
            if len(seen) < MANY and new and logs[k] > logs.max() - NEXT:
                seen.append((kinds[k], f.shares[k, place]))
                starts.append({f.cause.id: (f.shares[k], float(sizes[k]))})
        return starts

    def _fitted(
        self,
        h: Hypothesis,
        start: Start,
        z: np.ndarray | None = None,
        steps: int = STEPS,
    ) -> Fit:
        """A fit from a start, with smaller causes where it cannot be run."""
        causes = [CAUSES[c] for c in h.causes]
        begin = self._shifted(h) if z is None else z
        for share in SHARES:
            theta = {}
            for c in causes:
                form = c.forms(start[c.id][0][None])[0]
                theta[c.id] = {**form, c.size.name: share * start[c.id][1]}
            smaller = {name: (shares, share * size) for name, (shares, size) in start.items()}
            try:
                return fitted(self.problem, self.problem.moved(self._from(h), begin, theta, causes), smaller, steps)
            except SolveError:
                if share == SHARES[-1]:
                    raise
        raise AssertionError("unreachable")

    def _scanned(self, h: Hypothesis, fit: Fit) -> Fit:
        """A fit, begun again where other kinds or thresholds promise more: each has a best place of its own."""
        causes = [CAUSES[name] for name in h.causes]
        for c in causes:
            if c.choice is None:
                continue
            size = fit.theta[c.id][c.size.name]
            shares = kinds_and_thresholds(c, fit.modes[c.id].shares)
            linear = self.problem.moved(self._from(h), fit.z, fit.theta, causes)
            (back,) = self.problem.put_back(linear)
            white = White.of(back.residual, back.covariance)
            sample = Sample(c, shares, np.zeros(len(shares)), sound(size, c))
            f = families(self.problem, linear, white, [sample])[c.id]
            logs, sizes, short = f.log_bf(), f.sizes()[0], list[Fit]()
            tried = [shares[0]]
            for k in np.argsort(-logs):
                new = all(np.abs(shares[k] - other).max() > NEARBY for other in tried)
                if new and len(tried) <= RETRIED and logs[k] > logs[0] - NEXT:
                    tried.append(shares[k])
                    with suppress(SolveError):
                        start = {**fit.start, c.id: (shares[k], sound(float(sizes[k]), c))}
                        short.append(self._fitted(h, start, fit.z, steps=BEGUN))
            if short and min(other.cost for other in short) < fit.cost + 5.0:
                best = min(short, key=lambda other: other.cost)
                fit = min(fit, self._fitted(h, best.start, best.z), key=lambda fit: fit.cost)
        return fit

    def _from(self, h: Hypothesis) -> Linear:
        """The linearisation a fit begins from, without scatter of forms that miss what they should explain."""
        J, noise = (h.linear or self.null).jacobian, self.null.noise
        return replace(h.linear or self.null, noise=noise, covariance=noise + J @ J.T)

    def _shifted(self, h: Hypothesis) -> np.ndarray:
        """Nuisances under a hypothesis, by its linearisation."""
        linear = self._from(h)
        z = self.problem.nuisances(linear, linear.residual - h.effect)
        return np.asarray(linear.z + np.clip(z - linear.z, -1.5, 1.5))


def kinds_and_thresholds(cause: Cause, shares: np.ndarray) -> np.ndarray:
    """Shares of the shapes with every kind of a choice at every threshold (n, shapes), the given ones first."""
    choice, place = cause.choice, cause.threshold
    assert choice is not None
    ends = (0.0, *cause.shapes[choice].ends)
    found = [shares]
    for start, end in pairwise(ends):
        for threshold in SCAN if place is not None else (0.5,):
            other = shares.copy()
            other[choice] = (start + end) / 2
            if place is not None:
                other[place] = threshold
            found.append(other)
            acts = cause.acts(cause.forms(other[None])[0])
            if acts is None or acts[0][0] == "d":  # no threshold there
                break
    return np.array(found)


def sound(size: float, cause: Cause) -> float:
    """A size for a secant: not near zero, inside the bounds."""
    least = 0.2 * cause.size.sd
    if abs(size) >= least:
        return size
    return -least if size < 0 and cause.size.low <= -least else min(least, cause.size.high)
