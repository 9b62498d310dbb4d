"""Everything that may be wrong, to first order: one list of terms, the linear problem they stand in, sets of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..model.formula import Formula
from ..model.noise import per_group, walk
from .prior import GROSS, OUTSIDE, Prior
from .problem import PACES, Acting, Aside, Look, Noise, Problem

#: Standard deviations of sizes that differ from test to test, in half widths of the cause's prior.
SPREADS = np.array([0.5, 1.0, 2.0, 4.0, 8.0, 16.0])
#: Standard deviations of a remainder, in those of one reading of its channel.
REMAINDERS = np.array([2.0, 4.0, 8.0, 16.0])
#: Standard deviations of a gross reading's error, in those of one reading.
ERRORS = np.array([6.0, 15.0, 40.0])
#: What a remainder is that differs from test to test.
BY_TEST = "from test to test"
#: Logarithms of scales that differ by less are the same.
SCALE = 0.1
#: Shares of the largest variance of a remainder below which its directions are left out.
FAINT = 0.01


@dataclass(frozen=True, eq=False)
class Term:
    """Something that may act.

    Attributes:
        name: id of the cause, or what stands for it: "T_oil 17", "remainder T_oil"
        family: terms of one family count as one answer, and one of them acts at a time
        log_prior: of the cause, its form and its sample of shapes together; of what scatters, of one of its widths
        columns: effect of one unit of it (M, k); k = 1 for a size
        widths: standard deviations of its prior, all as likely
        low, high: bounds of a size
        acting: what is fitted exactly; None: covariance only
        formula: form of a cause; None: a gross reading or a remainder
        aside: the reading, of a gross one
        channels: sensors in which a remainder acts
        passing: what of the columns is another in each test or mounting (M, k), and not the mean of all
    """

    name: str
    family: str
    log_prior: float
    columns: np.ndarray
    widths: np.ndarray
    low: float = -np.inf
    high: float = np.inf
    acting: Acting | None = None
    formula: Formula | None = None
    aside: Aside | None = None
    channels: tuple[str, ...] = ()
    passing: np.ndarray | None = None

    @property
    def scatters(self) -> bool:
        """Whether it is a covariance of several columns."""
        return self.acting is None and self.aside is None

    @property
    def label(self) -> str:
        """Name with the form, or with the channels of a remainder."""
        return f"{self.name}: {self.formula.form.name if self.formula else ', '.join(self.channels)}"


def as_term(acting: Acting, log_prior: float, column: np.ndarray) -> Term:
    """A form of a cause that acts, or may."""
    formula = acting.formula
    cause = formula.cause
    return Term(cause.id, cause.family, float(log_prior), column, acting.widths, *formula.limits, acting, formula)


def spreads(problem: Problem, look: Look, formulas: Sequence[Formula], prior: Prior) -> Iterator[Term]:
    """Causes drawn anew in each test or mounting, or wandering from test to test."""
    if not formulas:
        return
    own = [Acting(f, np.r_[f.paced * PACES[-1], np.zeros(f.size - 1)]) for f in formulas]
    effects = problem.tangents(look, own)
    for formula, effect in zip(formulas, effects.T, strict=True):
        columns, passing = _columns(problem, formula, effect)
        if np.count_nonzero(columns, axis=0).max() < 2 or not np.isfinite(columns).all():
            continue  # one reading each: that is its own scatter
        cause = formula.cause
        widths = SPREADS[SPREADS >= 1] if formula.paced else SPREADS  # less shows less than in proportion
        log = prior.share[cause.id] + float(np.log(formula.form.weight / len(widths)))
        beside = ", anew" if formula.form.spread == "mounting" else ""  # it may have a size besides
        yield Term(cause.id, cause.family + beside, log, columns, widths, formula=formula, passing=passing)


def _columns(problem: Problem, formula: Formula, effect: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is anew in each test or mounting, or adds up from test to test (M, k), and how far it is from its mean."""
    c, spread = problem.data.campaign, formula.form.spread
    groups = np.unique(c.mounting, return_inverse=True)[1] if spread == "mounting" else np.arange(c.n_tests)
    of_test = (walk if spread == "walk" else per_group)(np.ones(c.n_tests), groups)
    if formula.paced:  # dwells are only shortened: the sizes are those of half a normal distribution
        of_test = np.column_stack([np.sqrt(1 - 2 / np.pi) * of_test, np.full(c.n_tests, np.sqrt(2 / np.pi))])
    test = c.test[problem.data.row]
    found = np.zeros((2, problem.m, of_test.shape[1]))
    found[:, problem.own] = effect[problem.own, None] * np.array([of_test, of_test - of_test.mean(axis=0)])[:, test]
    return found[0], found[1]


def remainders(problem: Problem) -> Iterator[Term]:
    """What no cause of the library is: smooth in the conditions, in thermometers, one, others, or all; or by test.

    What errs by test in one sensor alone is its own error, and has a name.
    """
    o = problem.data
    warm = tuple(i for i, s in enumerate(o.read) if s.kind.endswith("_temp"))
    other = tuple(i for i in range(len(o.read)) if i not in warm)
    groups = [g for g in dict.fromkeys([warm, *((i,) for i in warm), other, warm + other]) if g]
    tests = o.campaign.test[o.row]
    kernels = [("smooth in the conditions", problem.alike, groups)]
    if np.bincount(o.campaign.test).max() > 1 or len(np.unique(tests)) < o.campaign.n:
        kernels.append((BY_TEST, tests[:, None] == tests, [g for g in groups if len(g) > 1]))
    log = float(np.log(OUTSIDE) - np.log(len(REMAINDERS) * sum(len(places) for _, _, places in kernels)))
    for name, kernel, places in kernels:
        variance, vectors = np.linalg.eigh(kernel * problem.same)
        kept = variance > FAINT * variance[-1]
        root = vectors[:, kept] * np.sqrt(variance[kept])
        for group in places:
            mine = np.isin(o.entries.sensor, group)
            columns = np.zeros((problem.m, root.shape[1]))
            columns[problem.own] = (mine * o.entries.repeat)[:, None] * root
            channels = tuple(o.read[i].name for i in group)
            columns = columns[:, (columns**2).sum(axis=0) > 0]
            passing = columns if name == BY_TEST else None
            yield Term(f"remainder {name}", "remainder", log, columns, REMAINDERS, channels=channels, passing=passing)


def gross(problem: Problem, look: Look) -> Iterator[Term]:
    """Single readings that cannot be: compared ones at the ends of dwells, and given ones through the model."""
    for i in np.flatnonzero(problem.ends):
        column = np.zeros((problem.m, 1))
        column[i] = problem.repeat[i]
        yield Term(f"reading {i}", f"reading {i}", float(np.log(GROSS)), column, ERRORS, aside=Aside(int(i)))
    for sensor, columns in problem.inputs(look):
        for k in np.flatnonzero((columns**2).sum(axis=0) > 0):
            aside, name = Aside(int(k), sensor), f"{sensor} {k}"
            yield Term(name, name, float(np.log(GROSS)), columns[:, [k]], ERRORS, aside=aside)


@dataclass(frozen=True)
class Scatter:
    """What whitens: logarithms of the scales of the loose terms, and widths of the scatters beside them by number."""

    scales: tuple[float, ...]
    beside: tuple[tuple[int, float], ...] = ()

    @property
    def alike(self) -> Scatter:
        """The same for all scatters with nearly these scales."""
        return replace(self, scales=tuple(np.round(self.scales, 1).tolist()))


@dataclass(frozen=True)
class TermSet:
    """Sizes that act together in a scatter.

    Attributes:
        members: numbers of the terms, in order
        widths: standard deviation of each
        scatter: beside them
        log: log joint density with the residual
    """

    members: tuple[int, ...]
    widths: tuple[float, ...]
    scatter: Scatter
    log: float

    @property
    def sized(self) -> tuple[tuple[int, float], ...]:
        """Members and their widths."""
        return tuple(zip(self.members, self.widths, strict=True))

    @property
    def wide(self) -> tuple[tuple[int, float], ...]:
        """The same of all terms, scatters too."""
        return *self.sized, *self.scatter.beside

    @property
    def terms(self) -> tuple[int, ...]:
        """Numbers of all terms, scatters too."""
        return tuple(sorted(k for k, _ in self.wide))


@dataclass(frozen=True, eq=False)
class Linear:
    """A problem to first order.

    Attributes:
        terms: all that may act, sizes and gross readings before scatters
        residual: (M,)
        known: covariance of what nuisances do (M, M)
        noise: its scatter
        prior: of causes
        critical: log prior odds of nothing against one cause
        most: causes that may act together
    """

    terms: Sequence[Term]
    residual: np.ndarray
    known: np.ndarray
    noise: Noise
    prior: Prior
    critical: float
    most: int

    def at(self, scales: Sequence[float]) -> Noise:
        """The scatter with some scales."""
        return replace(self.noise, scales=np.array(scales))

    def rescaled(self, scatter: Scatter, sized: Sequence[tuple[int, float]]) -> Scatter:
        """A scatter with its likeliest scales beside sizes of some widths, where they are others."""
        columns = self.sized((*sized, *scatter.beside))
        found = self.at(scatter.scales).fitted(self.residual, self.known + columns @ columns.T).scales
        scales = np.where(np.abs(found - scatter.scales) > SCALE, found, scatter.scales)
        return replace(scatter, scales=tuple(scales.tolist()))

    def covariance(self, scales: Sequence[float], beside: Iterable[tuple[int, float]]) -> np.ndarray:
        """Of the residual with some scales, beside terms of some widths (M, M)."""
        columns = self.sized(beside)
        return np.asarray(self.at(scales).covariance + self.known + columns @ columns.T)

    def sized(self, widths: Iterable[tuple[int, float]]) -> np.ndarray:
        """Columns of terms times their widths (M, k)."""
        own = (width * self.terms[k].columns for k, width in widths)
        return np.concatenate([np.zeros((len(self.residual), 0)), *own], axis=1)

    def aside(self, own: TermSet) -> frozenset[Aside]:
        """The gross readings of a set."""
        return frozenset(aside for k in own.members if (aside := self.terms[k].aside) is not None)
