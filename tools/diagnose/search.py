"""The search for causes: scores of all, evidence of singles and pairs, leaders looked at again where they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from math import comb

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ...model.errors import SolveError
from ..effects.cause import Cause, Theta
from ..effects.taxonomy import CAUSES
from .evidence import White, score
from .family import FORMS, Family, Sample, best_pair, families, form_of, nearer, pair_evidence, pair_promise, pair_theta
from .fit import STEPS, Fit, fitted
from .problem import Linear, Problem
from .scatter import SCATTER, SIZES, Days
from .together import evidence_of
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
#: What another look may lift a hypothesis by: with thresholds that the first look hardly met, and without. One that
#: stays behind even so is not looked at again.
LIFT = {True: 120.0, False: 40.0}
#: Shares of the first look's sizes at which a fit begins, until one can be run.
SHARES = (1.0, 0.5, 0.2)
#: Half the squared misfit per reading from which a fit is repeated with slopes taken where it ended.
POOR = 0.7
#: A p of any cause below which the first look is repeated from the healthy machine, and above which little is fitted.
ELSEWHERE, QUIET = 0.05, 0.25
#: Standard deviations of what a form of the library leaves of a true effect, as shares of it, and their probabilities.
FORM = {0.03: 0.35, 0.06: 0.35, 0.12: 0.22, 0.24: 0.08}
#: Forms at which fits begin: how many, how much worse than the best at the first look, how far apart in the share of
#: the threshold, and steps after which only the best goes on.
MANY, NEXT, APART, BEGUN = 4, 40.0, 0.2, 3
#: Places at which thresholds are tried when a fit has ended, how many of the best it begins again from, and shares of
#: shapes that are the same.
SCAN, RETRIED, NEARBY = np.linspace(0.05, 0.95, 13), 3, 0.1
#: How far below the best a single or a pair may lie to be looked at again: other forms may lift it by this.
WORTH = (25.0, 10.0)


#: Where a fit begins: cause -> shares of its shapes, and size.
Start = Mapping[str, tuple[np.ndarray, float]]


@dataclass(frozen=True)
class Hypothesis:
    """A set of causes: log evidence with its prior, fitted parameters, and the families at their linearisation.

    `also` is where another first look would begin to fit it.
    """

    causes: tuple[str, ...]
    log_posterior: float
    theta: Mapping[str, Theta] = field(default_factory=dict)
    families: tuple[Family, ...] = ()
    linear: Linear | None = None
    also: tuple[Start, ...] = ()

    def scattered(self, null: Linear | None = None, sign: float = 1.0) -> Linear:
        """Its linearisation, `null` where it has none, with the scatter of its days in the covariance, or taken out."""
        linear = self.linear or null
        assert linear is not None
        size = self.theta[SCATTER]["sd"] if SCATTER in self.theta else 0.0
        days = sign * size**2 * linear.days @ linear.days.T
        return replace(linear, covariance=linear.covariance + days, noise=linear.noise + days)

    @property
    def begin(self) -> Start:
        """Where its fit begins: cause -> shares of the shapes, and size."""
        found = {}
        for f in self.families:
            theta = self.theta[f.cause.id]
            found[f.cause.id] = (f.shares[form_of(f, theta)], theta[f.cause.size.name])
        return found

    @property
    def effect(self) -> np.ndarray | float:
        """What its causes, as fitted, change in all readings (m); 0 without any."""
        found: np.ndarray | float = 0.0
        for f in self.families:
            theta = self.theta[f.cause.id]
            found = found + f.signatures[:, form_of(f, theta)] * theta[f.cause.size.name]
        return found


def log_gauss(white: White) -> float:
    """Log density of a residual without any cause."""
    return float(-0.5 * white.e @ white.e - np.log(np.diag(white.L)).sum())


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
        self.progress("effects of all causes", 0.15)
        self.found = self._families(self.null, self.white)
        self.days = Days.of(self.null.days, self.white)
        self.p_any, self.critical = self._alarm()
        self.p_omnibus = float(chi2.sf(self.white.e @ self.white.e, len(self.white.e)))
        self.progress("pairs of causes", 0.35)
        first = self._first_look(self.null, self.found)
        if self.p_any < ELSEWHERE:  # what is wrong may have bent the calibration: look from the healthy machine as well
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
                white = White.of(linear.residual, linear.covariance + size**2 * linear.days @ linear.days.T)
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
        there.white = White.of(there.null.residual, there.null.covariance)
        none, *first = there._first_look(there.null, there._families(there.null, there.white))
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
        changes = [0.0]
        some = sorted(some, key=lambda h: -h.log_posterior)
        for k, h in enumerate(some[:most]):
            best = max(other.log_posterior for other in (*known, *found))
            kinds = any(CAUSES[c].choice is not None for c in h.causes)
            if h.log_posterior + LIFT[kinds] / len(h.causes) < best:
                found.append(h)
                continue
            self.progress(f"looking again at {' and '.join(h.causes)}", 0.4 + 0.2 * len(h.causes) * k / most)
            with suppress(SolveError):  # what no machine can run explains nothing
                found.append(self._refined(h))
                changes.append(found[-1].log_posterior - h.log_posterior)
        less = min(float(np.median(changes[1:] or changes)), 0.0)
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
            pairs.append(Hypothesis(causes, alone + value + self.prior(2), theta, (own, f), a.linear))
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
                hypotheses.append(self._refined(first))

    def _refined(self, h: Hypothesis) -> Hypothesis:
        """A hypothesis with its model linearised where it acts, and more forms around its best ones."""
        causes = [CAUSES[c] for c in h.causes]
        fit = self._begun(h)
        with suppress(SolveError):
            fit = self._scanned(h, fit)
        linear = self.problem.linearised(fit.z, fit.theta, causes)
        if fit.cost > POOR * len(linear.residual):  # far from where the slopes of the nuisances were taken
            fit = fitted(self.problem, linear, fit.start)
            linear = self.problem.linearised(fit.z, fit.theta, causes)
        samples = []
        for k, c in enumerate(causes):
            samples.append(nearer(c, fit.modes[c.id], sound(fit.theta[c.id][c.size.name], c), self.seed + k))
        near = families(self.problem, linear, White.of(linear.residual, linear.covariance), samples)
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
        place = next((k for k, shape in enumerate(f.cause.shapes) if shape.name == "threshold"), choice)
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
                return fitted(
                    self.problem, self.problem.moved(h.linear or self.null, begin, theta, causes), smaller, steps
                )
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
            linear = self.problem.moved(h.linear or self.null, fit.z, fit.theta, causes)
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

    def _shifted(self, h: Hypothesis) -> np.ndarray:
        """Nuisances under a hypothesis, by its linearisation."""
        linear = h.linear or self.null
        z = self.problem.nuisances(linear, linear.residual - h.effect)
        return np.asarray(linear.z + np.clip(z - linear.z, -1.5, 1.5))


def kinds_and_thresholds(cause: Cause, shares: np.ndarray) -> np.ndarray:
    """Shares of the shapes with every kind of a choice at every threshold (n, shapes), the given ones first."""
    choice = cause.choice
    assert choice is not None
    ends = (0.0, *cause.shapes[choice].ends)
    place = next((k for k, shape in enumerate(cause.shapes) if shape.name == "threshold"), None)
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


def better(some: Sequence[Hypothesis], others: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The better of each hypothesis, single ones to be begun from both; no cause at all as the first list has it."""
    found, begins = distinct([*some, *others]), dict[frozenset[str], list[Start]]()
    for h in (*some, *others):
        begins.setdefault(frozenset(h.causes), []).append(h.begin)
    both = [replace(h, also=tuple(begins[frozenset(h.causes)])) if len(h.causes) == 1 else h for h in found]
    return [some[0], *(h for h in both if h.causes)]


def distinct(hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The best of all hypotheses of the same causes."""
    found: dict[frozenset[str], Hypothesis] = {}
    for h in hypotheses:
        causes = frozenset(h.causes)
        if causes not in found or h.log_posterior > found[causes].log_posterior:
            found[causes] = h
    return list(found.values())


def visible(cause: Cause, problem: Problem) -> bool:
    """Whether the data hold what the cause needs."""
    return cause.id != "cooling.humidity" or problem.data.model.rows.humidity is not None


def sound(size: float, cause: Cause) -> float:
    """A size for a secant: not near zero, inside the bounds."""
    least = 0.2 * cause.size.sd
    if abs(size) >= least:
        return size
    return -least if size < 0 and cause.size.low <= -least else min(least, cause.size.high)
