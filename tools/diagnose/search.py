"""The search for causes: scores of all, evidence of singles and pairs, leaders looked at again where they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ...model.errors import SolveError
from ..effects.cause import Cause, Theta
from ..effects.taxonomy import CAUSES
from .evidence import White, score
from .family import FORMS, Family, Sample, families, form_of, nearer, pair_evidence, pair_promise, pair_theta
from .fit import Fit, fitted
from .problem import Linear, Problem
from .scatter import SCATTER, Days
from .unnamed import Unnamed

#: Pairs of which the evidence is computed; leading singles and pairs looked at again.
PAIRS, AGAIN_ONE, AGAIN_TWO = 30, 9, 6
#: Leading singles that are also weighed together with days that differ.
WITH_DAYS = 5
#: Prior probabilities: nothing wrong, one cause, two causes, something outside the library.
NONE, ONE, TWO, OUTSIDE = 0.5, 0.37, 0.08, 0.05
DRAWS = 4000
#: What another look is expected to lift a hypothesis by at least; one that stays behind even so is not looked at again.
LIFT = 7.0
#: A fit begins at the next best kind, too, if it is no worse than this; places at which thresholds are tried.
NEXT, SCAN = 7.0, np.linspace(0.05, 0.95, 10)
#: How far below the best a single or a pair may lie to be looked at again: other forms may lift it by this.
WORTH = (25.0, 10.0)


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
        self.base = log_gauss(self.white)
        self.progress("effects of all causes", 0.15)
        samples = (Sample.of_prior(c, FORMS) for c in self.causes if not c.scatter)
        self.found = families(self.problem, self.null, self.white, samples)
        self.days = Days.of(self.null, self.white)
        self.p_any, self.critical = self._alarm()
        self.p_omnibus = float(chi2.sf(self.white.e @ self.white.e, len(self.white.e)))
        self.progress("pairs of causes", 0.35)
        self.hypotheses = sorted(self._again(self._first_look()), key=lambda h: -h.log_posterior)
        self.outside = Unnamed(self.problem).evidence(self.hypotheses, self.null) + np.log(OUTSIDE)
        self.progress("hypotheses weighed", 0.8)

    def probabilities(self) -> np.ndarray:
        """Of each hypothesis, in order; what is missing to 1 lies outside the library."""
        logs = np.array([h.log_posterior for h in self.hypotheses])
        return np.asarray(np.exp(logs - np.logaddexp(logsumexp(logs), self.outside)))

    def prior(self, count: int) -> float:
        """Log prior probability of one hypothesis of so many causes."""
        n = len(self.causes)
        return float(np.log({0: NONE, 1: ONE / n, 2: TWO / (n * (n - 1) / 2)}[count]))

    def _alarm(self) -> tuple[float, float]:
        """Family-wise p of the largest directed score, by drawing residuals without any cause; and its 95 % point."""
        draws = np.random.default_rng(self.seed).standard_normal((DRAWS, len(self.white.e)))
        observed, largest = self.days.score(self.white.e[None])[0], self.days.score(draws)
        for f in self.found.values():
            observed = max(observed, float(score(f.s, f.q, *f.bounds).max()))
            largest = np.maximum(largest, score(draws @ f.white, f.q, *f.bounds).max(axis=1))
        return float((1 + (largest >= observed).sum()) / (DRAWS + 1)), float(np.quantile(largest, 0.95))

    def _first_look(self) -> list[Hypothesis]:
        singles = []
        for f in self.found.values():
            k = f.best()
            theta = {f.cause.id: f.theta(k, float(f.sizes()[0][k]))}
            singles.append(Hypothesis((f.cause.id,), self.base + f.evidence() + self.prior(1), theta, (f,), self.null))
        singles.sort(key=lambda h: -h.log_posterior)
        healthy = Hypothesis((), self.base + self.prior(0), linear=self.null)
        return [healthy, *singles, *self._pairs(), *self._with_days(singles[:WITH_DAYS])]

    def _pairs(self) -> list[Hypothesis]:
        """The most promising pairs of all."""
        every = [
            (a, b)
            for a, b in combinations(self.found.values(), 2)
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
            k, m = np.unravel_index(int(np.argmax(weights)), weights.shape)
            theta = pair_theta(a, b, int(k), int(m))
            log_posterior = self.base + value + self.prior(2)
            found.append(Hypothesis((a.cause.id, b.cause.id), log_posterior, theta, (a, b), self.null))
        return found

    def _with_days(self, singles: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Days that differ more than stated, alone and beside one cause."""
        found = []
        if not any(c.scatter for c in self.causes):
            return found
        logs: dict[str, list[float]] = {"": []} | {h.causes[0]: [] for h in singles}
        for covariance in self.days.covariances():
            white = White.of(self.null.residual, covariance)
            logs[""].append(log_gauss(white))
            for h in singles:
                logs[h.causes[0]].append(logs[""][-1] + h.families[0].seen(white).evidence())
        for name, values in logs.items():
            causes = (name, SCATTER) if name else (SCATTER,)
            value = float(logsumexp(values) - np.log(len(values))) + self.prior(len(causes))
            alone = {h.causes[0]: h for h in singles}.get(name)
            theta = {SCATTER: self.days.theta(values)} | (dict(alone.theta) if alone else {})
            found.append(Hypothesis(causes, value, theta, alone.families if alone else (), self.null))
        return found

    def _again(self, first: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Leaders again, fitted, and with more forms around the most likely one."""
        best = max(h.log_posterior for h in first)
        leaders = []
        for n, most in ((1, AGAIN_ONE), (2, AGAIN_TWO)):
            named = [h for h in first if len(h.causes) == n and SCATTER not in h.causes]
            ranked = sorted(named, key=lambda h: -h.log_posterior)
            least = max(best - WORTH[n - 1], first[0].log_posterior - 1.0)
            leaders += [h for h in ranked[:most] if h.log_posterior > least]
        kept, lift = [h for h in first if h not in leaders], LIFT
        found = [first[0]]
        for k, h in enumerate(leaders):
            if h.log_posterior + lift < max(other.log_posterior for other in found):
                kept.append(h)
                continue
            self.progress(f"looking again at {' and '.join(h.causes)}", 0.4 + 0.4 * k / len(leaders))
            with suppress(SolveError):  # what no machine can run explains nothing
                found.append(self._refined(h))
                lift = max(lift, 1.3 * (found[-1].log_posterior - h.log_posterior))
        return [*found, *kept[1:]]

    def _refined(self, h: Hypothesis) -> Hypothesis:
        """A hypothesis with its model linearised where it acts, and more forms around its best ones."""
        causes = [CAUSES[c] for c in h.causes]
        fit = min((self._fitted(h, start) for start in self._starts(h)), key=lambda fit: fit.cost)
        fit = self._scanned(h, fit)
        linear = self.problem.linearised(fit.z, fit.theta, causes)
        back = self.problem.put_back(linear)
        white = White.of(back.residual, back.covariance)
        samples = []
        for k, c in enumerate(causes):
            samples.append(nearer(c, fit.modes[c.id], sound(fit.theta[c.id][c.size.name], c), self.seed + k))
        found = families(self.problem, linear, white, samples)
        theta = {c.id: found[c.id].theta(0, fit.theta[c.id][c.size.name]) for c in causes}
        value = found[causes[0].id].evidence() if len(causes) == 1 else pair_evidence(*(found[c.id] for c in causes))[0]
        value += log_gauss(white) + self.prior(len(causes))
        return replace(h, log_posterior=float(value), theta=theta, families=tuple(found.values()), linear=back)

    def _starts(self, h: Hypothesis) -> list[dict[str, tuple[np.ndarray, float]]]:
        """Where fits begin: at the best forms, and for one cause at the best of its next best kind."""
        first = {}
        for f in h.families:
            theta = h.theta[f.cause.id]
            first[f.cause.id] = (f.shares[form_of(f, theta)], theta[f.cause.size.name])
        starts, f = [first], h.families[0]
        if len(h.causes) == 1 and f.cause.choice is not None:
            kinds = np.searchsorted(f.cause.shapes[f.cause.choice].ends, f.shares[:, f.cause.choice])
            logs = np.where(kinds == kinds[form_of(f, h.theta[f.cause.id])], -np.inf, f.log_bf() + f.log_w)
            k = int(np.argmax(logs))
            if logs[k] > (f.log_bf() + f.log_w).max() - NEXT:
                starts.append({f.cause.id: (f.shares[k], float(f.sizes()[0][k]))})
        return starts

    def _fitted(self, h: Hypothesis, start: Mapping[str, tuple[np.ndarray, float]], z: np.ndarray | None = None) -> Fit:
        causes = [CAUSES[c] for c in h.causes]
        theta = {}
        for c in causes:
            form = c.forms(start[c.id][0][None])[0] if c.shapes else {}
            theta[c.id] = {**form, c.size.name: start[c.id][1]}
        begin = self._shifted(h) if z is None else z
        return fitted(self.problem, self.problem.moved(self.null, begin, theta, causes), start)

    def _scanned(self, h: Hypothesis, fit: Fit) -> Fit:
        """A fit, begun again where another threshold promises more: a threshold has many local best places."""
        for c in (CAUSES[name] for name in h.causes):
            mode, place = fit.modes[c.id], next((k for k, s in enumerate(c.shapes) if s.name == "threshold"), None)
            if place is None or c.acts(fit.theta[c.id]) is None:
                continue
            size = fit.theta[c.id][c.size.name]
            shares = np.tile(mode.shares, (1 + len(SCAN), 1))
            shares[1:, place] = SCAN
            linear = self.problem.moved(self.null, fit.z, fit.theta, [CAUSES[name] for name in h.causes])
            back = self.problem.put_back(linear)
            white = White.of(back.residual, back.covariance)
            sample = Sample(c, shares, np.zeros(len(shares)), sound(size, c))
            logs = families(self.problem, linear, white, [sample])[c.id].log_bf()
            k = int(np.argmax(logs))
            if logs[k] > logs[0] + 0.5:
                start = {name: (m.shares, fit.theta[name][CAUSES[name].size.name]) for name, m in fit.modes.items()}
                again = self._fitted(h, {**start, c.id: (shares[k], size)}, fit.z)
                fit = min(fit, again, key=lambda fit: fit.cost)
        return fit

    def _shifted(self, h: Hypothesis) -> np.ndarray:
        """Nuisances under a hypothesis, by its linearisation."""
        linear = h.linear or self.null
        residual = linear.residual.copy()
        for f in h.families:
            theta = h.theta[f.cause.id]
            residual -= f.signatures[:, form_of(f, theta)] * theta[f.cause.size.name]
        z = self.problem.nuisances(linear, residual)
        return linear.z + np.clip(z - linear.z, -1.5, 1.5)


def visible(cause: Cause, problem: Problem) -> bool:
    """Whether the data hold what the cause needs."""
    return cause.id != "cooling.humidity" or problem.data.model.rows.humidity is not None


def sound(size: float, cause: Cause) -> float:
    """A size for a secant: not near zero, inside the bounds."""
    least = 0.2 * cause.size.sd
    if abs(size) >= least:
        return size
    return -least if size < 0 and cause.size.low <= -least else min(least, cause.size.high)
