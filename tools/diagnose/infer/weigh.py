"""What the data say of everything that may be wrong: sets of terms to first order, the leading ones fitted exactly.

The problem is linearised where nothing acts, and the likeliest sets of terms are fitted exactly. It is linearised anew
at the best of them until the best one stays. All fits are weighed alike, nothing among them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from ....model.errors import SolveError
from ..model.formula import Formula
from . import sets
from .evidence import White
from .fit import Begin, Fit, Vector, fitted
from .found import Extra, Forms, Found, Hypothesis, Key, with_forms
from .prior import GROSS, Prior
from .problem import Acting, Aside, Problem
from .screen import Screen, Start, null_draws, screened
from .terms import ERRORS, Linear, Scatter, TermSet, as_term, gross, remainders, spreads

#: Linearisations at most: as calibrated, as the file or the healthy campaign says, and at the best hypotheses.
LOOKS = 4
#: Sets fitted of each linearisation.
FITTED = 10
#: Nats behind the likeliest set within which they are fitted.
WITHIN = 8.0
#: Causes fitted alone where the rig is calibrated, and where the file has it: a large effect bends, and its cause may
#: explain more than it promises to first order.
ALONE = (4, 10)
#: Causes that are fitted in place of one of the leading set.
EXCHANGED = 4
#: p of any cause above which nothing more is fitted, where none leads and no rule fails; of scatters it says nothing.
QUIET = 0.3
#: Scatters looked at for gross readings.
QUICK = 3
#: Log odds of nothing against one cause while gross readings are looked for.
FIRST = 2.0

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Options:
    """How hypotheses are weighed.

    Args:
        alpha: accepted rate of false alarms: the prior of none is such that its posterior is 1/2 there
        seed: of the draws
        most: causes that may act together
        wanted: causes that are fitted however they look
        critical: log prior odds of nothing against one cause, where they and gross readings are known; else draws of
            the null tell them
    """

    alpha: float = 0.01
    seed: int = 0
    most: int = 8
    wanted: Collection[str] = ()
    critical: float | None = None


def weigh(
    problem: Problem, formulas: Sequence[Formula], options: Options = Options(), progress: Progress | None = None
) -> Found:
    """All hypotheses that count, weighed; progress is told of each stage and the share done."""
    return Weighing(problem, formulas, options, progress).run()


class Weighing:
    """One run; arguments as for `weigh`."""

    def __init__(
        self, problem: Problem, formulas: Sequence[Formula], options: Options, progress: Progress | None = None
    ) -> None:
        self.whole, self.options, self.progress = problem, options, progress or (lambda stage, share: None)
        self.formulas = tuple(f for f in formulas if not f.form.spread)
        self.spreads = tuple(f for f in formulas if f.form.spread)
        self.prior = Prior(f.cause for f in formulas)
        self.hypotheses: dict[Key, Hypothesis] = {}
        self.exchanged = set[Key]()
        self.problem, self.critical = problem, FIRST
        self.progress("calibrating without a cause", 0.02)
        self.null = fitted(problem, (), Begin(np.zeros(problem.nz)))
        self.progress("effects of all causes", 0.1)
        self.first = self.screened(self.null, problem)
        if options.critical is None:  # else gross readings are known as well
            leader = self.search(self.null, self.first, "gross readings", 0.2, QUICK)[0]
            self.problem = problem.without(problem.aside | self.linear.aside(leader))
        if self.problem.aside != problem.aside:
            self.null = fitted(self.problem, (), Begin(self.null.look.z))
            self.first = self.screened(self.null, self.problem)
        self._ask_alarm()
        self._keep((frozenset(), frozenset(), self.problem.aside), self.null, (), {})

    def _ask_alarm(self) -> None:
        """p of any cause by draws of the null, and the prior of none that agrees with it."""
        weights = self.first.weights(self.prior)
        seen = float(np.logaddexp.reduce(self.first.log_bf + weights))
        if (known := self.options.critical) is not None:
            self.drawn, self.critical, self.p_any = np.zeros(0), known, 0.0 if seen > known else 1.0
            return
        self.drawn = null_draws(self.first, weights, self.options.seed)
        self.critical = float(np.quantile(self.drawn, 1 - self.options.alpha))
        self.p_any = float((1 + (self.drawn >= seen).sum()) / (1 + len(self.drawn)))

    def glance(self) -> Found:
        """The first linearisation alone: the likeliest sets where nothing acts, fitted."""
        self.fit_sets(self.search(self.null, self.first, "sets of causes", 0.3), self.null, 0.4)
        return self._weighed()

    def run(self) -> Found:
        """Everything."""
        for k in range(LOOKS):
            if k > (self.null.look.sd > self.problem.near).any() and self.p_any > QUIET and not self.leader().causes:
                break
            best = self.leader().fit
            with suppress(SolveError):
                near = self.null if k == 0 else self._home() if k == 1 else best
                look = self.first if near is self.null else self.screened(near, self.problem)
                if k < len(ALONE):
                    for start, logs in self._promising(look, set(), ALONE[k], self.options.wanted):
                        self._fit_joined(near, self.problem, start, (), {start.acting.id: logs})
                found = self.search(near, look, "sets of causes", 0.3 + 0.15 * k)
                self.fit_sets(found, near, 0.4 + 0.15 * k)
            if k:
                self._exchange()
            if k > 1 and self.leader().fit is best:
                break
        return self._weighed()

    def screened(self, near: Fit, problem: Problem) -> Screen:
        """What every cause would explain beside a fitted hypothesis."""
        return screened(problem, near.look, near.linear(problem), self.formulas)

    def leader(self) -> Hypothesis:
        """The likeliest hypothesis so far."""
        return max(self.hypotheses.values(), key=lambda h: h.log_joint)

    def _home(self) -> Fit:
        """Where the rig is as its healthy campaign says, or else its file.

        Nuisances far from what is expected of them may take up most of a cause where no cause is fitted. From there it
        shows.
        """
        z, campaigns = np.zeros(self.problem.nz), self.problem.campaigns
        if len(campaigns) > 1:
            z = fitted(Problem(campaigns[1:], self.problem.day_sd), (), Begin(z)).look.z
        look = self.problem.look(z, (), self.problem.near)
        return replace(self.null, look=look, noise=self.problem.noise(look))

    def search(self, near: Fit, look: Screen, stage: str, begun: float, scatters: int = sets.SCATTERS) -> list[TermSet]:
        """The likeliest sets of terms at a linearisation."""
        problem, J = self.whole, near.look.jacobian
        candidates = zip(look.candidates, look.weights(self.prior), look.effects.T, strict=True)
        terms = [as_term(c, log, effect[:, None]) for c, log, effect in candidates]
        effects = np.zeros(problem.m)
        for a, place in zip(near.look.acting, Vector(problem, near.look).sizes, strict=True):
            log = self.prior.share[a.id] + np.log(a.formula.form.weight)  # its shapes are fitted, none a sample of many
            terms.append(as_term(a, log, J[:, [place]]))
            effects += a.t[0] * J[:, place]
        terms += gross(problem, near.look)
        terms += spreads(problem, near.look, self.spreads, self.prior)
        terms += remainders(problem)
        wide = near.look.by_sd[:, : problem.nz]
        noise = problem.noise(near.look)
        residual = problem.measured - near.look.shown + J[:, : problem.nz] @ near.look.z + effects
        self.linear = Linear(terms, residual, wide @ wide.T, noise, self.prior, self.critical, self.options.most)
        starts = [Scatter((0.0,) * len(noise.loose)), Scatter(tuple(near.noise.scales.tolist()))]
        if self.hypotheses and (extras := (leader := self.leader()).extras):
            sizes = {e.of.label: e.size for e in extras}
            beside = tuple((k, sizes[t.label]) for k, t in enumerate(terms) if t.scatters and t.label in sizes)
            starts = [Scatter(tuple(leader.fit.noise.scales.tolist()), beside)]
        return sets.search(self.linear, starts, lambda share: self.progress(stage, begun + 0.1 * share), scatters)

    def _fit_joined(self, near: Fit, problem: Problem, start: Start, extras: tuple[Extra, ...], forms: Forms) -> None:
        """Fits a cause joined to what acts in a fit, beside what scatters."""
        z, kept = near.moved(problem, start.effect)
        with suppress(SolveError):
            begun = Begin(z, near.noise.scales, near.look.laws)
            self._fit_exactly(problem, [*kept, start.acting], begun, extras, forms)

    def _promising(
        self, look: Screen, taken: Set[str], n: int, wanted: Collection[str] = ()
    ) -> Iterator[tuple[Start, dict[str, float]]]:
        """Where fits of the n causes begin that promise most, and of those wanted, with log weights of their forms.

        Causes that are taken, by name or family, are left out.
        """
        log_bf = look.by_form(len(self.formulas))
        value = log_bf + [np.log(f.form.weight) + self.prior.share[f.cause.id] for f in self.formulas]
        best: dict[str, int] = {}
        for k in np.argsort(-value, kind="stable"):
            cause = self.formulas[k].cause
            if np.isfinite(value[k]) and taken.isdisjoint((cause.id, cause.family)):
                best.setdefault(cause.id, int(k))
        for name in dict.fromkeys([*list(best)[:n], *(c for c in wanted if c in best)]):
            forms = zip(self.formulas, value.tolist(), strict=True)
            yield look.start(best[name]), {f.form.name: log for f, log in forms if f.cause.id == name}

    def _exchange(self) -> None:
        """Fits the leading set without each of what acts in it, and with what promises most in its place.

        To first order a large effect tells its cause by the samples of its shapes, and the right one may fit none; so
        what promises most beside the best sets of fewer causes is fitted, too.
        """
        ranked = sorted(self.hypotheses.items(), key=lambda item: -item[1].log_joint)
        (leader, best), acting = ranked[0], ranked[0][1].fit.look.acting
        joins: list[tuple[Key, Hypothesis, Acting | Extra | None]] = []
        if leader not in self.exchanged and len(acting) + len(best.extras) > 1:
            joins = [*((leader, best, a) for a in acting), *((leader, best, e) for e in best.extras)]
        self.exchanged.add(leader)
        for n in range(1, len(acting)):
            key, fewer = next((item for item in ranked if len(item[1].fit.look.acting) == n), ranked[0])
            if key not in self.exchanged:
                self.exchanged.add(key)
                joins.append((key, fewer, None))
        if joins:
            look = self.screened(best.fit, self.problem)  # what else acts hardly changes effects
            for join in joins:
                self._join_all(look, *join)

    def _join_all(self, look: Screen, key: Key, known: Hypothesis, gone: Acting | Extra | None) -> None:
        """Fits what promises most beside a hypothesis; or what is left of it, and what promises most beside that."""
        fit, extras = known.fit, tuple(e for e in known.extras if e is not gone)
        rest, problem = [a for a in fit.look.acting if a is not gone], self._beside(key[2], extras)
        with suppress(SolveError):
            forms = {b.id: known.forms.get(b.id, {}) for b in rest}
            begun = Begin(fit.look.z, fit.noise.scales, fit.look.laws)
            near = self._fit_exactly(problem, rest, begun, extras, forms) if gone else fit
            taken = {*known.causes, *(b.formula.cause.family for b in rest)}
            for start, logs in self._promising(look.beside(near.linear(problem)), taken, EXCHANGED):
                self._fit_joined(near, problem, start, extras, forms | {start.acting.id: logs})

    def _beside(self, aside: frozenset[Aside], extras: Sequence[Extra]) -> Problem:
        """The problem with some gross readings and scatters."""
        return self.whole.without(aside).beside(tuple(e.term for e in extras))

    def fit_sets(self, found: Sequence[TermSet], near: Fit, share: float) -> None:
        """Fits the likeliest sets with the forms, scatters and starts that they promise."""
        alike: dict[Key, list[TermSet]] = {}
        for s in found:
            alike.setdefault(self._key(s), []).append(s)
        together = {key: float(np.logaddexp.reduce([s.log for s in own])) for key, own in alike.items()}
        logs = dict(sorted(together.items(), key=lambda item: -item[1]))
        for done, (key, log) in enumerate(list(logs.items())[:FITTED]):
            self.progress("causes fitted together", share + 0.1 * done / FITTED)
            if log < max(logs.values()) - WITHIN:
                break
            if key not in self.hypotheses:
                self._fit(key, alike[key][0], near, _forms(key, logs))

    def _key(self, s: TermSet) -> Key:
        terms = self.linear.terms
        forms = [t.formula for k in s.members if (t := terms[k]).formula is not None]
        aside = self.whole.aside | self.linear.aside(s)
        return frozenset(forms), frozenset(terms[k].label for k, _ in s.scatter.beside), aside

    def _fit(self, key: Key, s: TermSet, near: Fit, forms: Forms) -> None:
        """Fits sets alike exactly from where the likeliest of them is expected."""
        terms = self.linear.terms
        a = White.of(self.linear.covariance(s.scatter.scales, s.wide)).back(self.linear.residual)
        z = near.look.sd**2 * (near.look.jacobian[:, : self.whole.nz].T @ a)
        t = np.array(s.widths) * (self.linear.sized(s.sized).T @ a)
        begun = zip(s.members, t, strict=True)
        acting = [one.started(size) for k, size in begun if (one := terms[k].acting) is not None]
        extras = tuple(Extra(terms[k], width) for k, width in s.scatter.beside)
        start = Begin(z, np.array(s.scatter.scales), near.look.laws)
        with suppress(SolveError):
            self._fit_exactly(self._beside(key[2], extras), acting, start, extras, forms)

    def _fit_exactly(
        self,
        problem: Problem,
        acting: Sequence[Acting],
        begun: Begin,
        extras: tuple[Extra, ...],
        forms: Forms,
    ) -> Fit:
        """Fits causes beside scatters from where they begin, as a hypothesis.

        Raises:
            SolveError: the model cannot be run there
        """
        key = frozenset(a.formula for a in acting), frozenset(e.of.label for e in extras), problem.aside
        fit = fitted(problem, acting, begun)
        self._keep(key, fit, extras, forms)
        return fit

    def _keep(self, key: Key, fit: Fit, extras: tuple[Extra, ...], forms: Forms) -> None:
        """A fitted hypothesis with its log joint probability."""
        acting = [a.formula for a in fit.look.acting]
        causes = tuple(dict.fromkeys([*(f.cause.id for f in acting), *(e.cause for e in extras if e.cause)]))
        log = fit.evidence + sum(float(np.log(f.form.weight)) for f in acting)
        log += sum(e.of.log_prior - self.prior.share.get(e.of.name, 0.0) for e in extras)  # the prior has the share
        log += self.prior(causes) if causes else self.critical
        log += len(key[2] - self.whole.aside) * float(np.log(GROSS * Problem.FAR / ERRORS[1]))
        if key not in self.hypotheses or log > self.hypotheses[key].log_joint:
            self.hypotheses[key] = Hypothesis(causes, fit, float(log), extras, forms)

    def _weighed(self) -> Found:
        """All hypotheses with their probabilities."""
        found = sorted(with_forms(self.hypotheses), key=lambda h: -h.log_joint)
        self.problem = self.whole.without(next(key[2] for key, h in self.hypotheses.items() if h.fit is found[0].fit))
        logs = np.array([h.log_joint for h in found])
        _, e = self.null.linear(self.problem)
        return Found(
            self.problem,
            (*self.formulas, *self.spreads),
            self.null,
            self.first,
            tuple(found),
            np.exp(logs - np.logaddexp.reduce(logs)),
            self.p_any,
            self.critical,
            self.drawn,
            float(chdtrc(self.problem.m - len(self.problem.aside), e @ e)),
            self.prior,
        )


def _forms(own: Key, logs: Mapping[Key, float]) -> dict[str, dict[str, float]]:
    """Cause -> form -> log weight, over the sets alike that differ in their forms alone."""
    causes = {f.cause.id for f in own[0]}
    found: dict[str, dict[str, float]] = {c: {} for c in causes}
    for key, log in logs.items():
        if key[1:] == own[1:] and {f.cause.id for f in key[0]} == causes:
            for f in key[0]:
                known = found[f.cause.id].get(f.form.name, -np.inf)
                found[f.cause.id][f.form.name] = float(np.logaddexp(known, log))
    return found
