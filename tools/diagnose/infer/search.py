"""The search: all causes at a first look, the leading ones fitted alone, in pairs and more; weighed all alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ....model.errors import SolveError
from ..model.formula import Formula
from . import pairs, screen
from .draws import correction
from .extra import extras
from .fit import Fit, Start, again, fitted, joined
from .found import Found, Hypothesis
from .gross import cleaned, set_aside
from .prior import OUTSIDE, Prior
from .problem import Acting, Problem

#: Causes fitted: within so many nats of the best or a share of it.
WITHIN = 12.0
#: As a first look is off by a share of what it finds; at most.
SHARE = 0.7
#: At least.
CAUSES = 20
#: So many.
LEAST = 4
#: Further forms of those that fit well: at most so many.
FURTHER = 8
#: Forms of one cause.
EACH = 4
#: How much more than it looks one may be.
MORE = 4.0
#: Forms of one side of a quantity that are fitted where the leader acts there.
SAME = 6
#: Pairs that look best.
COUPLES = 40
#: Those fitted of them.
PAIRS = 5
#: Of such as are grown from some singles.
GROWN = 3
#: Those fitted because they are like the best one.
LIKE = 4
#: How far behind the best hypothesis a pair may promise to be.
BEHIND = 5.0
#: p of any cause above which little is fitted.
QUIET = 0.3
#: Hypotheses within so many nats of the best are weighed by draws of the exact model.
NEAR = 3.0
#: Searches at most, where the leading hypothesis changes which readings are gross.
LOOKS = 2


def searched(
    problem: Problem,
    formulas: Sequence[Formula],
    alpha: float = 0.05,
    seed: int = 0,
    most: int = 2,
    progress: Callable[[str, float], None] = lambda stage, share: None,
    wanted: Collection[str] = (),
) -> Found:
    """A search in which gross readings are set aside; arguments as for `Search`."""
    progress("calibrating without a cause", 0.02)
    problem, null = cleaned(problem, fitted(problem, (), np.zeros(problem.nz)))
    progress("gross readings", 0.05)
    search = Search(problem, formulas, null, alpha, seed, most, progress, wanted)
    leaders = [search.leader()]
    for _ in range(LOOKS):
        aside = set_aside(problem, leaders)
        if aside != problem.aside:
            problem = problem.without(aside)
            again = fitted(problem, (), null.look.z)
            search = Search(problem, formulas, again, alpha, seed, most, progress, wanted)
        found = search.run()
        leaders = _leaders(found)
        if set_aside(problem, leaders) == problem.aside:
            break
    return found


def _leaders(found: Found) -> list[Fit]:
    """The leading hypothesis, and each of its causes alone: a gross reading may be all that another explains."""
    top = found.hypotheses[0]
    alone = {h.causes[0]: h.fit for h in found.hypotheses if len(h.causes) == 1 and h.extra is None}
    return [top.fit, *(alone[c] for c in top.causes if c in alone and len(top.causes) > 1)]


class Search:
    """One search.

    Args:
        problem: data and model
        formulas: all forms of all causes
        null: the fit without a cause
        alpha: accepted rate of false alarms: the prior of none is such that its posterior is 1/2 there
        seed: of the draws
        most: causes that may act together
        progress: told of each stage and the share done
        wanted: causes that are fitted however they look
    """

    def __init__(
        self,
        problem: Problem,
        formulas: Sequence[Formula],
        null: Fit,
        alpha: float = 0.05,
        seed: int = 0,
        most: int = 2,
        progress: Callable[[str, float], None] = lambda stage, share: None,
        wanted: Collection[str] = (),
    ) -> None:
        self.problem, self.alpha, self.seed, self.most, self.progress = problem, alpha, seed, most, progress
        self.formulas = tuple(f for f in formulas if not f.form.spread)
        self.spreads = tuple(f for f in formulas if f.form.spread)
        self.prior = Prior(f.cause for f in formulas)
        self.null, self.wanted = null, wanted
        progress("effects of all causes", 0.1)
        self.first = screen.look(problem, null, self.formulas)
        self._alarm()
        self.looks = screen.looks(problem, null, self.first, self.formulas)
        self.couples = [] if self.p_any > QUIET else pairs.couples(self.looks, self.prior)[:COUPLES]
        self._fits: dict[int, Fit | None] = {}
        self._tried: set[frozenset[Formula]] = set()

    def run(self) -> Found:
        """Everything."""
        problem = self.problem
        self.progress("causes one by one", 0.25)
        singles = self._singles()
        self.progress("causes two by two", 0.5)
        grown = [] if self.p_any > QUIET else self._grown(singles)
        base = self._corrected([Hypothesis((), self.null, self.null.evidence + self.critical), *singles, *grown])
        self.progress("scatter and remainder", 0.8)
        hypotheses = sorted([*base, *self._beside(base)], key=lambda h: -h.log_joint)
        logs = np.array([h.log_joint for h in hypotheses])
        _, e = self.null.linear(problem)
        free = problem.m - len(problem.aside)
        return Found(
            problem,
            (*self.formulas, *self.spreads),
            self.null,
            self.first,
            tuple(hypotheses),
            np.exp(logs - logsumexp(logs)),
            self.p_any,
            self.critical,
            self.drawn,
            float(chi2.sf(e @ e, free)),
            self.prior,
        )

    def leader(self) -> Fit:
        """The likeliest of no cause and a few alone, quickly."""
        log_bf = self.looks.by_form(len(self.formulas))
        fits = [self._alone(k) for k in self._leading(self._value(log_bf), LEAST - 1)]
        return max([self.null, *(f for f in fits if f is not None)], key=lambda fit: fit.evidence)

    def _alone(self, k: int) -> Fit | None:
        """A form fitted alone, None where it cannot be run."""
        if k not in self._fits:
            fits = []
            for near, start in self.looks.starts(k):
                with suppress(SolveError):
                    fits.append(joined(self.problem, near, [start]))
            self._fits[k] = max(fits, key=lambda fit: fit.evidence, default=None)
        return self._fits[k]

    def _alarm(self) -> None:
        """p of any cause by draws of the null, and the prior of none that agrees with it."""
        first = self.first
        weights = first.weights + [self.prior.share[c.id] for c in first.candidates]
        self.drawn = drawn = screen.null_draws(first, weights, self.seed)
        seen = float(logsumexp(first.log_bf + weights))
        self.critical = float(np.quantile(drawn, 1 - self.alpha))
        self.p_any = float((1 + (drawn >= seen).sum()) / (1 + len(drawn)))

    def _value(self, log_bf: np.ndarray) -> np.ndarray:
        """What forms promise at a first look: their log Bayes factors and priors."""
        return np.asarray(log_bf + [np.log(f.form.weight) + self.prior.share[f.cause.id] for f in self.formulas])

    def _leading(self, value: np.ndarray, most: int) -> list[int]:
        """The best-looking forms of the causes worth a fit, so many at most, best first."""
        chosen: dict[str, int] = {}
        worst = value.max() - max(WITHIN, SHARE * value.max())
        for k in np.argsort(-value):
            if len(chosen) >= most or (value[k] < worst and len(chosen) >= LEAST):
                break
            chosen.setdefault(self.formulas[k].cause.id, int(k))
        return list(chosen.values())

    def _further(self, log_bf: np.ndarray) -> None:
        """Fits further forms of the causes that fit well, which promise as much more than they look as those fitted."""
        prior, none = self._value(log_bf) - log_bf, self.null.evidence
        fits = {k: fit for k, fit in self._fits.items() if fit}
        more: dict[str, float] = {}
        for k, fit in fits.items():
            cause = self.formulas[k].cause.id
            more[cause] = max(more.get(cause, 1.0), min((fit.evidence - none) / max(log_bf[k], 1.0), MORE))
        promise = none + prior + log_bf * [more.get(f.cause.id, 0.0) for f in self.formulas]
        tried = Counter(self.formulas[k].cause.id for k in self._fits)
        lead, end = max(fit.evidence + prior[k] for k, fit in fits.items()), len(self._fits) + FURTHER
        for k in np.argsort(-promise):
            if promise[k] < lead - max(WITHIN, SHARE * (lead - none)) or len(self._fits) == end:
                break
            cause = self.formulas[k].cause.id
            if cause in more and k not in self._fits and tried[cause] < EACH:
                tried[cause] += 1
                if (more_fit := self._alone(int(k))) is not None:
                    lead = max(lead, more_fit.evidence + prior[k])

    def _same_side(self, log_bf: np.ndarray) -> None:
        """Where the leader acts on one side of a quantity, fits the best-looking forms of others from its threshold."""
        value = self._value(log_bf)
        worth = {k: fit.evidence + value[k] - log_bf[k] for k, fit in self._fits.items() if fit}
        lead = max(worth, key=lambda k: worth[k])
        sides = [f.form.regime.get("quantity") for f in self.formulas]
        alike = [int(k) for k in np.argsort(-value) if sides[lead] and sides[k] == sides[lead] and k != lead][:SAME]
        places = [[shape.name for shape in f.form.shapes] for f in self.formulas]
        if not alike or "threshold" not in places[lead]:
            return
        at = self._fits[lead].look.acting[0].t[1 + places[lead].index("threshold")]  # type: ignore[union-attr]
        moved = []
        for k in alike:
            t = np.r_[0.0, self.looks.starts(k)[0][1].acting.t[1:]]
            t[1 + places[k].index("threshold")] = at
            moved.append(Acting(self.formulas[k], t))
        look, null = self.null.look, self.null
        effects = self.problem.tangents(look.z, look.acting, moved)
        found = screen.judged(tuple(moved), np.array(alike), effects, null.views(self.problem))
        for k in alike:
            fits = [self._alone(k)]
            with suppress(SolveError):
                fits.append(joined(self.problem, null, [found.start(k)]))
            self._fits[k] = max((f for f in fits if f), key=lambda fit: fit.evidence, default=None)

    def _singles(self) -> list[Hypothesis]:
        """Every cause alone: its leading forms fitted, the others as they look at first."""
        log_bf = self.looks.by_form(len(self.formulas))
        value = self._value(log_bf)
        early = [k for k in np.argsort(-value) if self.formulas[k].paced]  # no first look shows early readings well
        paired = {start.acting.formula for couple in self.couples[:PAIRS] for start in couple}  # each alone, too
        both = [k for k, f in enumerate(self.formulas) if f in paired]
        looks_best = {self.formulas[k].cause.id: int(k) for k in np.argsort(value)}
        both += [looks_best[cause] for cause in self.wanted if cause in looks_best]
        for k in [*self._leading(value, CAUSES if self.p_any < QUIET else LEAST), *early[:EACH], *both]:
            self._alone(int(k))
        if self.p_any < QUIET:
            self._further(log_bf)
            self._same_side(log_bf)
        fits = {k: fit for k, fit in self._fits.items() if fit is not None}
        found = []
        for cause in dict.fromkeys(self.formulas[k].cause.id for k in fits):
            own = {k: fit for k, fit in fits.items() if self.formulas[k].cause.id == cause}
            best = max(own, key=lambda k: own[k].evidence)
            logs = {}
            for k, f in enumerate(self.formulas):
                if f.cause.id == cause:
                    at_first = min(self.null.evidence + log_bf[k], own[best].evidence)
                    logs[f.form.name] = np.log(f.form.weight) + (own[k].evidence if k in own else at_first)
            total = float(logsumexp(list(logs.values())))
            weights = {name: value - total for name, value in logs.items()}
            found.append(Hypothesis((cause,), own[best], total + self.prior([cause]), None, {cause: weights}))
        return sorted(found, key=lambda h: -h.log_joint)

    def _grown(self, singles: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Hypotheses of two causes and more: pairs that look best to first order, and leading ones with one more."""
        found: dict[frozenset[str], Hypothesis] = {}
        known = {h.causes[0]: h for h in singles}
        for starts in self.couples[:PAIRS]:
            self._paired(found, known, starts)
        top = max(found.values(), key=lambda h: h.log_joint, default=singles[0])
        if top.log_joint > singles[0].log_joint:  # others that look like one of the two
            like = [own for own in self.couples[PAIRS:] if any(s.acting.id in top.causes for s in own)]
            for starts in like[:LIKE]:
                self._paired(found, known, starts)
        beam = [h for h in singles if h.log_joint > singles[0].log_joint - 2 * BEHIND][:GROWN]
        for size in range(2, self.most + 1):
            best = max(h.log_joint for h in [*singles, *found.values()])
            promised = sorted((p for h in beam for p in self._beside_causes(h)), key=lambda p: -p[0])
            before = len(self._tried)
            for log, h, start in promised:
                if log < best - BEHIND or len(self._tried) >= before + PAIRS:
                    break
                self._together(found, known, h.fit, [start])
            beam = sorted((h for h in found.values() if len(h.causes) == size), key=lambda h: -h.log_joint)[:2]
            if not beam or beam[0].log_joint < best or size == self.most:
                break
        return list(found.values())

    def _paired(
        self, found: dict[frozenset[str], Hypothesis], singles: Mapping[str, Hypothesis], starts: Sequence[Start]
    ) -> None:
        """Fits two causes together from the likelier one as it was fitted alone, the other as it looks and as it was.

        Args:
            found: hypotheses so far
            singles: fitted causes alone
            starts: of both
        """
        alone = [singles[s.acting.id] for s in starts if s.acting.id in singles]
        best = max(alone, key=lambda h: h.log_joint, default=None)
        if best is None:
            self._together(found, singles, self.null, starts)
        else:
            others = [s for s in starts if s.acting.id not in best.causes]
            self._together(found, singles, best.fit, others)
            if all(s.acting.id in singles for s in others):
                self._together(found, singles, best.fit, [again(singles[s.acting.id].fit) for s in others])

    def _together(
        self,
        found: dict[frozenset[str], Hypothesis],
        singles: Mapping[str, Hypothesis],
        near: Fit,
        starts: Sequence[Start],
    ) -> None:
        """Fits causes together unless these forms were; the better forms stay, the others of each count as alone.

        Args:
            found: hypotheses so far
            singles: fitted causes alone
            near: what is there
            starts: what joins
        """
        formulas = (*(a.formula for a in near.look.acting), *(s.acting.formula for s in starts))
        causes = tuple(f.cause.id for f in formulas)
        if frozenset(formulas) in self._tried:
            return
        self._tried.add(frozenset(formulas))
        with suppress(SolveError):
            fit = joined(self.problem, near, starts)
            forms = {c: singles[c].forms[c] for c in causes if c in singles}
            spread = sum(logsumexp(list(w.values())) - max(w.values()) for w in forms.values())
            weight = sum(np.log(a.formula.form.weight) for a in fit.look.acting)
            log = float(fit.evidence + weight + spread + self.prior(causes))
            if frozenset(causes) not in found or log > found[frozenset(causes)].log_joint:
                found[frozenset(causes)] = Hypothesis(causes, fit, log, None, forms)

    def _beside_causes(self, h: Hypothesis) -> list[tuple[float, Hypothesis, Start]]:
        """What each cause promises beside a fitted hypothesis: log joint, the hypothesis, and its start."""
        try:
            beside = screen.look(self.problem, h.fit, self.formulas)
        except SolveError:
            return []
        log_bf = beside.by_form(len(self.formulas))
        own = {self.prior.causes[c].family for c in h.causes}
        best: dict[str, int] = {}
        for k, f in enumerate(self.formulas):
            if f.cause.family not in own and log_bf[k] + np.log(f.form.weight) > _value(best, f, log_bf, self.formulas):
                best[f.cause.id] = k
        found = []
        for cause, k in best.items():
            gain = log_bf[k] + np.log(self.formulas[k].form.weight)
            log = h.log_joint - self.prior(h.causes) + gain + self.prior([*h.causes, cause])
            found.append((float(log), h, beside.start(k)))
        return found

    def _corrected(self, base: Sequence[Hypothesis]) -> list[Hypothesis]:
        """The hypotheses, the leading ones with what importance sampling makes of their evidence.

        Those that lead once others are corrected are corrected, too.
        """
        found, done = list(base), set[int]()
        while True:
            best = max(h.log_joint for h in found)
            near = [k for k, h in enumerate(found) if k not in done and h.log_joint >= best - NEAR]
            if not near:
                return found
            for k in near:
                by = correction(self.problem, found[k].fit, self.seed)
                found[k] = replace(found[k], log_joint=found[k].log_joint + by.log, error=by.error)
            done.update(near)

    def _beside(self, base: Sequence[Hypothesis]) -> list[Hypothesis]:
        """The leading hypotheses with a spread of sizes or a remainder beside them, and such of fewer causes.

        A scatter that is not yet there may have brought a cause that is not.
        """
        best = max(h.log_joint for h in base)
        near = [h for h in base if not h.causes or h.log_joint >= best - 1.5 * BEHIND]
        found = [more for h in near for more in self._with_extras(h)]
        top, tried = max([*base, *found], key=lambda h: h.log_joint), {h.causes for h in near}
        fewer = [h for h in base if h.causes not in tried and set(h.causes) < set(top.causes)]
        return [*found, *(more for h in fewer for more in self._with_extras(h))]

    def _with_extras(self, h: Hypothesis) -> Iterator[Hypothesis]:
        """A hypothesis with each spread and remainder beside it."""
        for extra, gain, noise in extras(self.problem, h.fit, self.spreads):
            beside = replace(h, fit=h.fit if noise is h.fit.noise else replace(h.fit, noise=noise), extra=extra)
            if extra.cause is None:
                yield replace(beside, log_joint=float(h.log_joint + gain + np.log(OUTSIDE)))
            else:
                new = extra.cause not in h.causes
                causes = (*h.causes, extra.cause) if new else h.causes
                log = h.log_joint + gain + (self._added(h.causes, extra.cause) if new else 0.0)
                yield replace(beside, causes=causes, log_joint=float(log))

    def _added(self, causes: Sequence[str], more: str) -> float:
        """Log prior of a hypothesis with one cause more over that without."""
        if not causes:
            return self.prior([more]) - self.critical
        return self.prior([*causes, more]) - self.prior(causes)


def _value(best: Mapping[str, int], f: Formula, log_bf: np.ndarray, formulas: Sequence[Formula]) -> float:
    k = best.get(f.cause.id)
    return -np.inf if k is None else float(log_bf[k] + np.log(formulas[k].form.weight))
