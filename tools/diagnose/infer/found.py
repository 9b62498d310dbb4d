"""What a search finds: hypotheses with their fits, weighed, and how unusual the data are without a cause."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..model.entries import Term
from ..model.formula import Formula
from . import terms
from .fit import Fit
from .prior import Prior
from .problem import Aside, Problem
from .screen import Screen

#: What tells sets apart: forms of the causes, terms that scatter, readings that are gross.
Key = tuple[frozenset[Formula], frozenset[str], frozenset[Aside]]
#: Log weight of each form of each cause, by id and name.
Forms = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True, eq=False)
class Extra:
    """What scatters beside the causes of a hypothesis: a term of the list, sizes that differ or a remainder.

    Args:
        of: the term
        size: standard deviation, in half widths of the prior or standard deviations of a reading
    """

    of: terms.Term
    size: float

    @property
    def cause(self) -> str | None:
        """Id; None: a remainder."""
        return self.of.name if self.of.formula else None

    @property
    def form(self) -> str:
        """Name of the cause's form, or of the remainder."""
        return self.of.formula.form.name if self.of.formula else self.of.name

    @property
    def term(self) -> Term:
        """Its covariance."""
        passing = None if self.of.passing is None else self.size * self.of.passing
        return Term(self.form, self.size * self.of.columns, passing=passing)


@dataclass(frozen=True)
class Hypothesis:
    """Causes that act together, the best fit, and the log of their joint probability with the data.

    Args:
        causes: ids; none: nothing is wrong
        fit: at the most likely forms
        log_joint: log evidence, all forms counted, plus log prior
        extras: spreads of sizes and remainders beside them; the scatter of the fit holds them
        forms: log weight of each form of each cause, by id and name
    """

    causes: tuple[str, ...]
    fit: Fit
    log_joint: float
    extras: tuple[Extra, ...] = ()
    forms: Forms = field(default_factory=dict)

    def form(self, cause: str) -> str:
        """Name of the form of a cause."""
        return next(a.formula.form.name for a in self.fit.look.acting if a.id == cause)


#: A hypothesis and its probability.
Member = tuple[Hypothesis, float]


def with_forms(hypotheses: Mapping[Key, Hypothesis]) -> list[Hypothesis]:
    """Hypotheses of any forms; forms that were not fitted count with the best of those that differ in forms alone."""
    alike: dict[tuple[object, ...], list[Hypothesis]] = {}
    for key, h in hypotheses.items():
        alike.setdefault((frozenset(h.fit.causes), *key[1:]), []).append(h)
    found = []
    for own in alike.values():
        own.sort(key=lambda h: -h.log_joint)
        best, log = own[0], own[0].log_joint
        for a in best.fit.look.acting:
            logs, known = best.forms.get(a.id, {}), {h.form(a.id) for h in own}
            more = [value - logs[best.form(a.id)] for name, value in logs.items() if name not in known]
            log += float(np.log1p(np.exp(np.minimum(more, 0.0)).sum()))
        found += [replace(best, log_joint=log), *own[1:]]
    return found


@dataclass(frozen=True)
class Found:
    """Result of a search.

    Args:
        formulas: all forms, those of spreads last
        null: the fit without a cause
        first: all causes beside none
        hypotheses: all that were fitted, most probable first
        probabilities: of them
        p_any: p of the log Bayes factor of any cause
        critical: its critical value
        prior: of hypotheses
        drawn: that log Bayes factor in campaigns without a cause, as drawn
        p_omnibus: chi-square p of the null
    """

    problem: Problem
    formulas: tuple[Formula, ...]
    null: Fit
    first: Screen
    hypotheses: tuple[Hypothesis, ...]
    probabilities: np.ndarray
    p_any: float
    critical: float
    drawn: np.ndarray
    p_omnibus: float
    prior: Prior

    def beside(self, log_bayes_factor: Callable[[Iterable[str]], float]) -> Found:
        """The search with what other data say of its causes, where the two share nothing else that is uncertain."""
        by = np.array([log_bayes_factor(h.causes) for h in self.hypotheses])
        hypotheses = tuple(replace(h, log_joint=h.log_joint + b) for h, b in zip(self.hypotheses, by, strict=True))
        with np.errstate(divide="ignore"):
            logs = np.log(self.probabilities) + by
        return replace(self, hypotheses=hypotheses).weighed(logs - np.logaddexp.reduce(logs))

    def weighed(self, logs: np.ndarray) -> Found:
        """The search with other log probabilities of its hypotheses, the most probable first."""
        order = np.argsort(-logs, kind="stable")
        return replace(self, hypotheses=tuple(self.hypotheses[k] for k in order), probabilities=np.exp(logs[order]))

    def log_bayes_factor(self, causes: Iterable[str]) -> float:
        """Of causes against none, free of their prior; nothing of causes that the search did not ask about.

        Of several that were not fitted together, the one that explains most counts.
        """
        values: dict[frozenset[str], float] = {}
        for h in self.hypotheses:
            key, log = frozenset(h.causes), h.log_joint - (self.prior(h.causes) if h.causes else self.critical)
            values[key] = float(np.logaddexp(values.get(key, -np.inf), log))
        own = frozenset(c for c in causes if c in self.prior.share)
        tried = [own] if own in values else [key for c in own if (key := frozenset([c])) in values]
        return max((values[key] for key in tried), default=values[frozenset()]) - values[frozenset()]
