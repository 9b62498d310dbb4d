"""The search for causes: scores of all, evidence of singles and pairs, leaders looked at again where they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import combinations
from math import comb

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ...model.errors import SolveError
from ..effects.cause import Cause
from ..effects.taxonomy import CAUSES
from .evidence import White, log_gauss, score
from .family import FORMS, Family, Sample, best_pair, families, pair_evidence, pair_promise, pair_theta
from .hypothesis import Hypothesis, better, distinct
from .problem import Linear, Problem
from .refine import Refiner
from .scatter import SCATTER, SIZES, Days
from .unnamed import Unnamed

#: Pairs of which the evidence is computed; leading singles and pairs looked at again.
PAIRS, AGAIN_ONE, AGAIN_TWO = 20, 8, 4
#: Leading singles that are also weighed together with days that differ, and those fitted where days differ so.
WITH_DAYS, ON_SUCH_DAYS = 5, 3
#: Prior probabilities: nothing wrong, one cause, two causes, something outside the library.
NONE, ONE, TWO, OUTSIDE = 0.5, 0.37, 0.08, 0.05
#: Of each further cause, where more than two are looked for.
MORE = 0.25
DRAWS = 4000
#: What another look may lift a hypothesis by: with thresholds that the first look hardly met, and without, and so many
#: times what it has lifted others. One that stays behind even so is not looked at again.
LIFT, OTHERS = {True: 120.0, False: 40.0}, 2.0
#: A p of any cause below which the first look is repeated from the healthy machine, and above which little is fitted.
ELSEWHERE, QUIET = 0.05, 0.25


class Search:
    """The search on one problem; `run` fills null, families, p values and hypotheses of at most so many causes."""

    def __init__(
        self, problem: Problem, seed: int = 0, progress: Callable[[str, float], None] | None = None, most: int = 2
    ) -> None:
        self.problem, self.seed, self.most = problem, seed, most
        self.causes = [c for c in CAUSES.values() if visible(c, problem)]
        self.progress = progress or (lambda stage, share: None)

    def run(self) -> None:
        """Everything."""
        self.progress("calibrating without a cause", 0.0)
        self.null = self.problem.settled()
        self.white = White.of(self.null.residual, self.null.covariance)
        self.refiner = Refiner(self.problem, self.null, self.seed, self.prior)
        self.progress("effects of all causes", 0.15)
        self.found = self._families(self.null, self.white)
        self.days = Days.of(self.null.days, self.white)
        self.p_any, self.critical = self._alarm()
        self.p_omnibus = float(chi2.sf(self.white.e @ self.white.e, len(self.white.e)))
        self.progress("pairs of causes", 0.35)
        first = self._first_look(self.null, self.found)
        if self.p_any < ELSEWHERE:  # what is wrong may have bent the calibration: look from the healthy machine as well
            with suppress(SolveError):
                healthy = self.problem.linearised(self.problem.healthy())
                there = self._families(healthy, White.of(healthy.residual, healthy.covariance))
                first = better(first, self._first_look(healthy, there))
        quiet = self.p_any > QUIET
        found = self._again(first[:1], [h for h in first if len(h.causes) == 1], AGAIN_ONE if not quiet else 2)
        self.progress("pairs of causes", 0.6)
        beside = [] if quiet else self._beside(found)
        seen = {frozenset(h.causes) for h in beside}
        pairs = beside + [h for h in first if len(h.causes) == 2 and frozenset(h.causes) not in seen]
        found += first[:1]
        pairs = self._again(found, pairs, AGAIN_TWO if not quiet else 0)
        weighed = self._settled([*found, *pairs, *self._with_days(found)])
        if SCATTER in weighed[0].causes and not quiet:
            weighed = sorted([*weighed, *self._on_such_days(weighed[0])], key=lambda h: -h.log_posterior)
        self.hypotheses = distinct(weighed)
        if self.most > 2 and not quiet:
            from .several import grown  # which builds on this module

            more = [*self.hypotheses, *grown(self, self.most)]
            self.hypotheses = distinct(sorted(more, key=lambda h: -h.log_posterior))
        self.outside = Unnamed(self.problem).evidence(self.hypotheses, self.null) + np.log(OUTSIDE)
        self.progress("hypotheses weighed", 0.8)

    def probabilities(self) -> np.ndarray:
        """Of each hypothesis, in order; what is missing to 1 lies outside the library."""
        logs = np.array([h.log_posterior for h in self.hypotheses])
        return np.asarray(np.exp(logs - np.logaddexp(logsumexp(logs), self.outside)))

    def prior(self, count: int) -> float:
        """Log prior probability of one hypothesis of so many causes."""
        every = {0: NONE, 1: ONE}.get(count, TWO * MORE ** (count - 2))
        return float(np.log(every / comb(len(self.causes), count)))

    def _alarm(self) -> tuple[float, float]:
        """Family-wise p of the largest directed score, by drawing residuals without any cause; and its 95 % point."""
        draws = np.random.default_rng(self.seed).standard_normal((DRAWS, len(self.white.e)))
        observed, largest = self.days.score(self.white.e[None])[0], self.days.score(draws)
        for f in self.found.values():
            observed = max(observed, float(score(f.s, f.q, *f.bounds).max()))
            largest = np.maximum(largest, score(draws @ f.white, f.q, *f.bounds).max(axis=1))
        return float((1 + (largest >= observed).sum()) / (DRAWS + 1)), float(np.quantile(largest, 0.95))

    def _families(self, linear: Linear, white: White) -> dict[str, Family]:
        """All causes with all forms of a first look."""
        samples = (Sample.of_prior(c, FORMS) for c in self.causes if not c.scatter)
        return families(self.problem, linear, white, samples)

    def _first_look(self, linear: Linear, found: Mapping[str, Family]) -> list[Hypothesis]:
        """No cause, single causes in order, and promising pairs, as one linearisation shows them."""
        singles, base = [], log_gauss(White.of(linear.residual, linear.covariance))
        for f in found.values():
            k = f.best()
            theta = {f.cause.id: f.theta(k, float(f.sizes()[0][k]))}
            singles.append(Hypothesis((f.cause.id,), base + f.evidence() + self.prior(1), theta, (f,), linear))
        singles.sort(key=lambda h: -h.log_posterior)
        none = Hypothesis((), base + self.prior(0), linear=linear)
        return [none, *singles, *self._pairs(linear, found, base)]

    def _pairs(self, linear: Linear, families_there: Mapping[str, Family], base: float) -> list[Hypothesis]:
        """The most promising pairs of all."""
        every = [
            (a, b)
            for a, b in combinations(families_there.values(), 2)
            if not (a.cause.like and a.cause.like == b.cause.like)
        ]
        every.sort(key=lambda pair: -pair_promise(*pair))
        found, classes = [], set()
        for a, b in every[:PAIRS]:
            names = frozenset((a.cause.like or a.cause.id, b.cause.like or b.cause.id))
            if names in classes:  # two of the same classes are one answer
                continue
            classes.add(names)
            value, weights = pair_evidence(a, b)
            theta = pair_theta(a, b, *best_pair(weights))
            found.append(Hypothesis((a.cause.id, b.cause.id), base + value + self.prior(2), theta, (a, b), linear))
        return found

    def _with_days(self, found: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Days that differ more than stated, alone and beside one cause as fitted."""
        weighed: list[Hypothesis] = []
        singles = sorted((h for h in found if len(h.causes) == 1), key=lambda h: -h.log_posterior)[:WITH_DAYS]
        for h in [h for h in found if not h.causes] + singles:
            linear, logs = h.linear or self.null, []
            for size in SIZES:
                white = White.of(linear.residual, linear.with_days(size).covariance)
                logs.append(log_gauss(white) + sum(f.seen(white).evidence() for f in h.families))
            causes = (*h.causes, SCATTER)
            value = float(logsumexp(logs) - np.log(len(logs))) + self.prior(len(causes))
            theta = {**h.theta, SCATTER: self.days.theta(logs)}
            weighed.append(replace(h, causes=causes, log_posterior=value, theta=theta))
        return weighed

    def _on_such_days(self, leader: Hypothesis) -> list[Hypothesis]:
        """Single causes fitted where days differ as found: a fit that takes the days for alike bends its cause."""
        size = leader.theta[SCATTER]["sd"]
        there = Search(replace(self.problem, scattered=size), self.seed, self.progress)
        there.null = there.problem.settled(self.null.z)
        there.refiner = Refiner(there.problem, there.null, self.seed, there.prior)
        white = White.of(there.null.residual, there.null.covariance)
        none, *first = there._first_look(there.null, there._families(there.null, white))
        singles = there._again([none], [h for h in first if len(h.causes) == 1], ON_SUCH_DAYS)[:ON_SUCH_DAYS]
        less, found = there.prior(2) - there.prior(1) - np.log(len(SIZES)), []
        for h in singles:
            if h.linear and h.linear.causes:
                theta = {**h.theta, SCATTER: {"sd": size}}
                bare = replace(h, theta=theta).scattered(sign=-1.0)
                value = h.log_posterior + less
                found.append(replace(h, causes=(*h.causes, SCATTER), log_posterior=value, theta=theta, linear=bare))
        return found

    def _again(self, known: Sequence[Hypothesis], some: Sequence[Hypothesis], most: int) -> list[Hypothesis]:
        """Leaders of some hypotheses fitted, with more forms around the most likely one.

        What the fits lose against the first look, in the middle, the first look of the others is taken to promise too
        much as well.
        """
        found: list[Hypothesis] = []
        changes: list[float] = []
        some = sorted(some, key=lambda h: -h.log_posterior)
        for k, h in enumerate(some[:most]):
            best = max(other.log_posterior for other in (*known, *found))
            kinds = any(CAUSES[c].choice is not None for c in h.causes)
            lift = max(LIFT[kinds] / len(h.causes), OTHERS * max(changes, default=0.0))
            if h.log_posterior + lift < best:
                found.append(h)
                continue
            self.progress(f"looking again at {' and '.join(h.causes)}", 0.4 + 0.2 * len(h.causes) * k / most)
            with suppress(SolveError):  # what no machine can run explains nothing
                found.append(self.refiner.refined(h))
                changes.append(found[-1].log_posterior - h.log_posterior)
        less = min(float(np.median(changes or [0.0])), 0.0)
        return [*found, *(replace(h, log_posterior=h.log_posterior + less) for h in some[most:])]

    def _beside(self, found: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Pairs of the leading cause as fitted with every other, looked at where it acts."""
        a = max(found, key=lambda h: h.log_posterior)
        if len(a.causes) != 1 or a.linear is None or not a.linear.causes:
            return []
        own, name = a.families[0], a.causes[0]
        like = own.cause.like or name
        others = [c for c in self.causes if not c.scatter and (c.like or c.id) != like]
        acting = self.problem.moved(a.linear, a.linear.z, a.theta, [own.cause])
        white, pairs = White.of(a.linear.residual, a.linear.covariance), []
        alone = a.log_posterior - self.prior(1) - own.evidence()
        for f in families(self.problem, acting, white, (Sample.of_prior(c, FORMS // 2) for c in others)).values():
            value, weights = pair_evidence(own, f)
            causes = (name, f.cause.id)
            theta = pair_theta(own, f, *best_pair(weights))
            pair = Hypothesis(causes, alone + value + self.prior(2), theta, (own, f), a.linear)
            pairs.append(pair if f.cause.size.far is None else self.refiner.from_afar(pair, a))
        return pairs

    def _settled(self, hypotheses: list[Hypothesis]) -> list[Hypothesis]:
        """Hypotheses in order, until the first of them is one that was fitted."""
        while True:
            hypotheses = sorted(hypotheses, key=lambda h: -h.log_posterior)
            first = hypotheses[0]
            if not first.families or (first.linear and first.linear.causes) or SCATTER in first.causes:
                return hypotheses
            hypotheses = hypotheses[1:]
            with suppress(SolveError):
                hypotheses.append(self.refiner.refined(first))


def visible(cause: Cause, problem: Problem) -> bool:
    """Whether the data hold what the cause needs."""
    return cause.id != "cooling.humidity" or problem.data.model.rows.humidity is not None
