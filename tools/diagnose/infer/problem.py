"""Campaigns and rig as one vector of readings: what is shown, its exact Jacobian, its scatter."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from ....model.errors import SolveError
from ..model.entries import Seen, Term, summed
from ..model.formula import Formula
from ..model.noise import alike, by_law, by_name, input_scatter, terms
from ..model.observe import Observed
from .evidence import INSTRUMENT, WIDTHS
from .scales import most_likely

#: Name of what makes a reading count for nothing.
SET_ASIDE = "set aside"
#: Shapes stay inside so many deviations.
INSIDE = 2.4
#: Sizes up to which causes that shorten dwells are judged: readings that end a dwell hardly follow its last minutes.
PACES = (1.0, 2.5)


@dataclass(frozen=True, order=True)
class Aside:
    """A reading that is set aside: number of a compared one in the vector, or of a row of a given sensor.

    `sensor` is the given sensor's name, "" for a compared reading; rows of campaigns are numbered one after the other.
    """

    number: int
    sensor: str = ""


@dataclass(frozen=True)
class Acting:
    """A form of a cause with its parameters: the size over its prior's half width, normal numbers of the shapes."""

    formula: Formula
    t: np.ndarray

    @property
    def id(self) -> str:
        """Of the cause."""
        return self.formula.cause.id

    @property
    def bounds(self) -> np.ndarray:
        """Lowest and highest parameters (2, d)."""
        low, high = self.formula.limits
        far = np.full(self.formula.size - 1, INSIDE)
        return np.array([np.r_[low, -far], np.r_[high, far]])

    @property
    def widths(self) -> np.ndarray:
        """Standard deviations of the size's prior, all as likely (w,)."""
        return WIDTHS if self.formula.paths or self.formula.paced else INSTRUMENT

    def started(self, size: float) -> Acting:
        """The same where its fit begins: not too near to zero, inside its bounds."""
        low, high = self.formula.limits
        size, least = float(np.clip(size, low, high)), 0.1 if high > 0.1 else -0.1
        return replace(self, t=np.r_[size if abs(size) > 0.1 else least, self.t[1:]])


def priors(candidates: Sequence[Acting]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of sizes in prior half widths: lowest and highest (k,), and standard deviations, all as likely (w, k)."""
    low, high = np.array([c.formula.limits for c in candidates]).reshape(-1, 2).T
    return low, high, np.array([c.widths for c in candidates]).reshape(-1, len(WIDTHS)).T


@dataclass(frozen=True)
class Look:
    """The readings at one point of the vector (z, t...), their Jacobian (M, d), and what each campaign shows.

    Args:
        shown: without what laws leave open, to first order
        sd: standard deviations of the nuisances (nz,): 1, or less where a rule holds
        laws: how far the nuisances of each row of the data are from their laws (nz, n)
        bent: what it does to the readings (M,), to first order
    """

    z: np.ndarray
    acting: tuple[Acting, ...]
    shown: np.ndarray
    jacobian: np.ndarray
    seen: tuple[Seen, ...]
    sd: np.ndarray
    laws: np.ndarray
    bent: np.ndarray

    @property
    def x(self) -> np.ndarray:
        """The vector: nuisances, then the parameters of each cause."""
        return np.concatenate([self.z, *(a.t for a in self.acting)])

    @property
    def by_sd(self) -> np.ndarray:
        """The Jacobian by one standard deviation of each nuisance (M, d)."""
        return np.asarray(self.jacobian * np.r_[self.sd, np.ones(self.jacobian.shape[1] - len(self.sd))])


@dataclass(frozen=True)
class Noise:
    """Covariance terms at a linearisation, and logarithms of the scales of those that are loose."""

    terms: tuple[Term, ...]
    scales: np.ndarray

    @property
    def loose(self) -> list[Term]:
        """The terms whose scale the data may change."""
        return [t for t in self.terms if t.loose > 0]

    @cached_property
    def covariance(self) -> np.ndarray:
        """The whole (M, M)."""
        return self.scaled(self.terms)

    def scaled(self, terms: Sequence[Term]) -> np.ndarray:
        """Covariance (m, m) of some terms, or of those of more campaigns, with the scales of their names."""
        return summed(terms, self._scales_of(terms), terms[0].m)

    @property
    def passing(self) -> np.ndarray:
        """What of the rows is another in each test or mounting, with the columns as they are (M, M)."""
        own = zip(self.terms, np.exp(2 * self._scales_of(self.terms)), strict=True)
        parts = (v * t.passing @ t.effects.T for t, v in own if t.passing is not None)
        return sum(parts, np.zeros((self.terms[0].m,) * 2))

    def _scales_of(self, terms: Sequence[Term]) -> np.ndarray:
        known = {t.name: scale for t, scale in zip(self.loose, self.scales, strict=True)}
        return np.array([known.get(t.name, 0.0) for t in terms])

    @property
    def log_prior(self) -> float:
        """Of the scales."""
        sd = np.array([t.loose for t in self.loose])
        return float(-0.5 * ((self.scales / sd) ** 2).sum())

    def fitted(self, residual: np.ndarray, known: np.ndarray) -> Noise:
        """With the most likely scales.

        Args:
            residual: r ~ N(0, known + this) (M,)
            known: covariance of what else is uncertain (M, M)
        """
        kept = [t for t in self.terms if t.loose == 0]
        fixed = summed(kept, np.zeros(len(kept)), len(residual))
        return replace(self, scales=most_likely(known + fixed, self.loose, residual, self.scales))


class Problem:
    """Campaigns of one rig; causes act in the first.

    Args:
        campaigns: the data, then a healthy reference where there is one
        day_sd: standard deviation of the cooling from day to day; its direction is the last nuisance of a campaign
    """

    #: A reading that is set aside scatters by so many of its standard deviations.
    FAR = 1e3

    def __init__(self, campaigns: Sequence[Observed], day_sd: float) -> None:
        self.campaigns, self.day_sd = tuple(campaigns), day_sd
        #: Readings that count for nothing, and what scatters beside all that is known.
        self.aside, self.more = frozenset[Aside](), tuple[Term, ...]()
        self.data = campaigns[0]
        self.nz = len(self.data.nuisances) - 1
        #: Standard deviations of the nuisances where all rules hold (nz,).
        self.near = np.array([n.near for n in self.data.nuisances[:-1]])
        self.measured = np.concatenate([o.measured for o in campaigns])
        #: Number of readings.
        self.m = len(self.measured)
        self.repeat = np.concatenate([o.entries.repeat for o in campaigns])
        self.own = slice(0, self.data.m)
        #: Which entries are readings at the ends of dwells (M,); the others lie along logged courses.
        self.ends = np.concatenate([o.kind < len(o.read) for o in campaigns])

    @cached_property
    def alike(self) -> np.ndarray:
        """Correlation (m, m) of what is smooth in the conditions of the data."""
        return alike(self.data)

    @cached_property
    def same(self) -> np.ndarray:
        """Which readings of the data are of one channel (m, m)."""
        sensor = self.data.entries.sensor
        return np.asarray(sensor[:, None] == sensor)

    @cached_property
    def by_law(self) -> np.ndarray:
        """Covariance of nuisances by rules by row of the data (n, n), in shares squared."""
        return by_law(self.data)

    @property
    def entries_aside(self) -> list[int]:
        """Numbers of the compared readings that are set aside."""
        return [a.number for a in self.aside if not a.sensor]

    def without(self, aside: frozenset[Aside]) -> Self:
        """The same with some readings set aside."""
        found = copy(self)
        found.aside = aside
        return found

    def beside(self, more: tuple[Term, ...]) -> Self:
        """The same with further scatter."""
        found = copy(self)
        found.more = more
        return found

    def only(self, kept: np.ndarray) -> Problem:
        """The same with some of its compared readings (k,), renumbered; all that are set aside are among them."""
        ends = pairwise(np.cumsum([0, *(o.m for o in self.campaigns)]))
        own = [o.only(kept[(kept >= a) & (kept < b)] - a) for o, (a, b) in zip(self.campaigns, ends, strict=True)]
        aside = (a if a.sensor else Aside(int(np.searchsorted(kept, a.number))) for a in self.aside)
        return Problem(own, self.day_sd).without(frozenset(aside))

    def look(
        self,
        z: np.ndarray,
        acting: Sequence[Acting] = (),
        sd: np.ndarray | None = None,
        laws: np.ndarray | None = None,
    ) -> Look:
        """Readings and Jacobian, beside standard deviations of the nuisances and what laws leave open.

        If None, no rule holds, and all is as the laws say.

        Raises:
            SolveError: the model cannot be run there
        """
        sd = np.ones(self.nz) if sd is None else sd
        laws = np.zeros((self.nz, self.data.campaign.n)) if laws is None else laws
        whole, seen, bent = self._whole(z, laws), [], np.zeros(self.m)
        blocks = np.zeros((self.m, self.nz + sum(a.formula.size for a in acting)))
        begin = 0
        for o in self.campaigns:
            own = acting if o is self.data else ()
            found = o.at(whole, [(a.formula, a.t) for a in own])
            if (bad := o.row[~np.isfinite(found.shown)]).size:
                line = f"{o.campaign.name} line {o.campaign.lines[bad[0]]}"
                raise SolveError(f"{line}: the rig cannot be run there. Check the line and the rig file.")
            part = slice(begin, begin + o.m)
            if laws.any():
                bent[part] = (found.by[:, : self.nz] * laws.T[o.row]).sum(axis=1)
                found = replace(found, shown=found.shown - bent[part])
            by = np.delete(found.by, self.nz, axis=1)  # without the cooling of a day
            blocks[part, : by.shape[1]] = by
            seen.append(found)
            begin += o.m
        shown = np.concatenate([s.shown for s in seen])
        return Look(np.array(z), tuple(acting), shown, blocks, tuple(seen), sd, laws, bent)

    @staticmethod
    def _whole(z: np.ndarray, laws: np.ndarray) -> np.ndarray:
        """Nuisances with the cooling of a day: of all rows (nz + 1,), or of each where they are not as laws say."""
        return np.append(z[:, None] + laws, np.zeros((1, laws.shape[1])), axis=0) if laws.any() else np.append(z, 0.0)

    def shown(self, look: Look, acting: Sequence[Acting]) -> np.ndarray:
        """Readings (M,) with other causes than those of a look, NaN where the model cannot be run."""
        whole, parts = self._whole(look.z, look.laws), [(a.formula, a.t) for a in acting]
        shown = [o.shown_by(whole, parts if o is self.data else []) for o in self.campaigns]
        return np.asarray(np.concatenate(shown) - look.bent)

    def noise(self, look: Look, scales: np.ndarray | None = None) -> Noise:
        """The scatter at a look."""
        found = self.scatters(look)
        found += [*(self.far(aside, look) for aside in sorted(self.aside)), *self.more]
        n = sum(t.loose > 0 for t in found)
        return Noise(tuple(found), np.zeros(n) if scales is None else scales)

    def scatters(self, look: Look) -> list[Term]:
        """What scatters at a look, all readings in it."""
        return terms(self.campaigns, look.seen, self.day_sd, look.sd)

    def far(self, aside: Aside, look: Look) -> Term:
        """The term that makes a reading count for nothing."""
        if not aside.sensor:
            variance = np.zeros(self.m)
            variance[aside.number] = (self.FAR * self.repeat[aside.number]) ** 2
            return Term(SET_ASIDE, variance=variance)
        columns = dict(self.inputs(look))[aside.sensor]
        return Term(SET_ASIDE, self.FAR * columns[:, [aside.number]])

    def inputs(self, look: Look) -> list[tuple[str, np.ndarray]]:
        """Given sensor -> effects (M, rows of all campaigns) of one standard deviation of each of its readings."""
        pairs = enumerate(zip(self.campaigns, look.seen, strict=True))
        parts = [(name, k, columns) for k, (o, seen) in pairs for name, columns in input_scatter(o, seen)]
        return list(by_name(parts, [o.m for o in self.campaigns]).items())

    def source(self, aside: Aside) -> tuple[Observed, int, str]:
        """The campaign that a reading is of, its number there, and its sensor."""
        sizes = [o.campaign.n if aside.sensor else o.m for o in self.campaigns]
        k = int(np.searchsorted(np.cumsum(sizes), aside.number, side="right"))
        o, number = self.campaigns[k], aside.number - sum(sizes[:k])
        return o, number, aside.sensor or o.read[o.kind[number]].name

    def tangents(self, look: Look, candidates: Sequence[Acting]) -> np.ndarray:
        """Effects (M, k) of one prior half width of each candidate beside what acts.

        To first order at size zero; of a candidate with a size, the secant up to there.
        """
        whole, parts = self._whole(look.z, look.laws), [(a.formula, a.t) for a in look.acting]
        tried = [(c.formula, c.t) for c in candidates]
        effects = self.data.tangents(whole, parts, tried)
        if far := [k for k, (_, t) in enumerate(tried) if t[0]]:
            without = self.data.shown_by(whole, parts)
            for k in far:
                effects[:, k] = (self.data.shown_by(whole, [*parts, tried[k]]) - without) / tried[k][1][0]
        found = np.zeros((self.m, len(candidates)))
        found[self.own] = effects
        return found
