"""Campaigns and rig as one vector of readings: what is shown, its exact Jacobian, its scatter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import minimize

from ...model.errors import SolveError
from ..model.formula import Formula
from ..model.noise import Term, alike, input_scatter, stacked, summed, terms
from ..model.observe import Observed, Seen
from .evidence import White

#: Bounds of the logarithms of scales.
BOUNDS = (-1.5, 2.5)
#: Loose terms with fewer columns than this share of the entries are weighed by their columns.
FEW = 0.8


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


@dataclass(frozen=True)
class Look:
    """The readings at one point of the vector (z, t...), their Jacobian (M, d) and what each campaign shows."""

    z: np.ndarray
    acting: tuple[Acting, ...]
    shown: np.ndarray
    jacobian: np.ndarray
    seen: tuple[Seen, ...]

    @property
    def x(self) -> np.ndarray:
        """The vector: nuisances, then the parameters of each cause."""
        return np.concatenate([self.z, *(a.t for a in self.acting)])


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
    def parts(self) -> tuple[np.ndarray, list[np.ndarray]]:
        """The sum of all fixed terms, and each loose one (M, M)."""
        return summed([t for t in self.terms if t.loose == 0]), [t.matrix for t in self.loose]

    @cached_property
    def covariance(self) -> np.ndarray:
        """The whole (M, M)."""
        fixed, loose = self.parts
        return np.asarray(fixed + sum(np.exp(2 * s) * C for s, C in zip(self.scales, loose, strict=True)))

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
        fixed, loose = self.parts
        base, sd = fixed + known, np.array([t.loose for t in self.loose])
        columns = [t.effects for t in self.loose]
        if sum(c.shape[1] for c in columns) < FEW * len(residual):
            return replace(self, scales=_most_likely(_Few(base, columns, residual), self.scales, sd))

        even = np.array([t.variance is not None for t in self.loose])  # diagonal: most of them
        variances = np.array([np.diag(C) for C in loose])

        def cost(scales: np.ndarray) -> tuple[float, np.ndarray]:
            weights = np.exp(2 * scales)
            V = base + np.diag(weights[even] @ variances[even])
            for k in np.flatnonzero(~even):
                V += weights[k] * loose[k]
            white = White.of(V)
            inverse = white.inverse
            a = inverse @ residual
            value = 0.5 * residual @ a + 0.5 * white.log_det
            slopes = variances @ (np.diag(inverse) - a**2)
            for k in np.flatnonzero(~even):
                slopes[k] = np.vdot(inverse, loose[k]) - a @ loose[k] @ a
            return float(value), weights * slopes

        return replace(self, scales=_most_likely(cost, self.scales, sd))


class _Few:
    """Minus the log density of a residual by scales, where the loose terms have few columns beside the entries.

    The covariance is base + U W U' with W > 0: all is said by G = U' base^-1 U and b = U' base^-1 r.

    Args:
        base: covariance of what is fixed (M, M), which may lack variances
        columns: of each loose term (M, k)
        residual: (M,)
    """

    #: Part of the smallest variance that counts with the base.
    PART = 0.5

    def __init__(self, base: np.ndarray, columns: Sequence[np.ndarray], residual: np.ndarray) -> None:
        self.counts, U = [c.shape[1] for c in columns], np.concatenate(columns, axis=1)
        self.least = self.PART * np.exp(2 * BOUNDS[0])
        white = White.of(base + self.least * U @ U.T)
        near, e = white(U), white(residual)
        self.G, self.b, self.rest = near.T @ near, near.T @ e, 0.5 * (e @ e + white.log_det)

    def __call__(self, scales: np.ndarray) -> tuple[float, np.ndarray]:
        """Value and slopes."""
        w = np.repeat(np.exp(2 * scales) - self.least, self.counts)
        white = White.of(self.G + np.diag(1 / w))
        S = white.inverse
        along = S @ self.b
        value = self.rest + 0.5 * (white.log_det + np.log(w).sum() - self.b @ along)
        own = (1 - np.diag(S) / w - along**2 / w) / w
        each = [part.sum() for part in np.split(own, np.cumsum(self.counts)[:-1])]
        return float(value), np.exp(2 * scales) * np.array(each)


def _most_likely(
    cost: Callable[[np.ndarray], tuple[float, np.ndarray]], scales: np.ndarray, sd: np.ndarray
) -> np.ndarray:
    """Scales of the least cost, their priors included.

    Args:
        cost: minus the log density, and its slopes
        scales: logarithms where it begins
        sd: standard deviations of their priors
    """

    def whole(x: np.ndarray) -> tuple[float, np.ndarray]:
        value, slopes = cost(x)
        return float(value + 0.5 * ((x / sd) ** 2).sum()), slopes + x / sd**2

    bounds = [BOUNDS] * len(sd)
    found = minimize(whole, scales, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 25, "gtol": 0.03})
    return np.asarray(found.x)


class Problem:
    """Campaigns of one rig; causes act in the first.

    Args:
        campaigns: the data, then a healthy reference where there is one
        day_sd: standard deviation of the cooling from day to day; its direction is the last nuisance of a campaign
    """

    #: A reading that is set aside scatters by so many of its standard deviations.
    FAR = 1e3

    def __init__(self, campaigns: Sequence[Observed], day_sd: float, aside: frozenset[Aside] = frozenset()) -> None:
        self.campaigns, self.day_sd, self.aside = tuple(campaigns), day_sd, aside
        self.data = campaigns[0]
        self.nz = len(self.data.nuisances) - 1
        self.measured = np.concatenate([o.measured for o in campaigns])
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

    @property
    def m(self) -> int:
        """Number of readings."""
        return len(self.measured)

    def without(self, aside: frozenset[Aside]) -> Problem:
        """The same with some readings set aside."""
        return Problem(self.campaigns, self.day_sd, aside)

    def look(self, z: np.ndarray, acting: Sequence[Acting] = ()) -> Look:
        """Readings and Jacobian.

        Raises:
            SolveError: the model cannot be run there
        """
        whole, seen = np.append(z, 0.0), []
        blocks = np.zeros((self.m, self.nz + sum(a.formula.size for a in acting)))
        begin = 0
        for o in self.campaigns:
            own = acting if o is self.data else ()
            found = o.at(whole, [(a.formula, a.t) for a in own])
            if not np.isfinite(found.shown).all():
                raise SolveError("the model cannot be run with what its causes make of it.")
            part = slice(begin, begin + o.m)
            blocks[part, : self.nz] = found.by[:, : self.nz]
            if own:
                blocks[part, self.nz :] = found.by[:, self.nz + 1 :]
            seen.append(found)
            begin += o.m
        return Look(np.array(z), tuple(acting), np.concatenate([s.shown for s in seen]), blocks, tuple(seen))

    def shown(self, z: np.ndarray, acting: Sequence[Acting] = ()) -> np.ndarray:
        """Readings (M,), NaN where the model cannot be run."""
        whole = np.append(z, 0.0)
        parts = [(a.formula, a.t) for a in acting]
        return np.concatenate([o.shown_by(whole, parts if o is self.data else []) for o in self.campaigns])

    def noise(self, look: Look, scales: np.ndarray | None = None) -> Noise:
        """The scatter at a look."""
        found = terms(self.campaigns, look.seen, self.day_sd, self.nz)
        found += [self.far(aside, look) for aside in sorted(self.aside)]
        n = sum(t.loose > 0 for t in found)
        return Noise(tuple(found), np.zeros(n) if scales is None else scales)

    def far(self, aside: Aside, look: Look) -> Term:
        """The term that makes a reading count for nothing."""
        if not aside.sensor:
            variance = np.zeros(self.m)
            variance[aside.number] = (self.FAR * self.repeat[aside.number]) ** 2
            return Term("set aside", variance=variance)
        columns = dict(self.inputs(look))[aside.sensor]
        return Term("set aside", self.FAR * columns[:, [aside.number]])

    def inputs(self, look: Look) -> list[tuple[str, np.ndarray]]:
        """Given sensor -> effects (M, rows of all campaigns) of one standard deviation of each of its readings."""
        found: dict[str, list[tuple[int, np.ndarray]]] = {}
        for k, (o, seen) in enumerate(zip(self.campaigns, look.seen, strict=True)):
            for name, columns in input_scatter(o, seen):
                found.setdefault(name, []).append((k, columns))
        sizes = [o.m for o in self.campaigns]
        return [(name, stacked(items, sizes)) for name, items in found.items()]

    def source(self, aside: Aside) -> tuple[int, str]:
        """Number of the campaign and the sensor that a reading is of."""
        sizes = [o.campaign.n if aside.sensor else o.m for o in self.campaigns]
        k = int(np.searchsorted(np.cumsum(sizes), aside.number, side="right"))
        o, number = self.campaigns[k], aside.number - sum(sizes[:k])
        return k, aside.sensor or o.read[o.kind[number]].name

    def touched(self, aside: Aside, look: Look) -> frozenset[int]:
        """The compared readings that a reading has to do with."""
        if not aside.sensor:
            return frozenset([aside.number])
        effect = np.abs(dict(self.inputs(look))[aside.sensor][:, aside.number])
        return frozenset(np.flatnonzero(effect > 0.05 * effect.max(initial=1e-300)).tolist())

    def tangents(self, z: np.ndarray, acting: Sequence[Acting], candidates: Sequence[Acting]) -> np.ndarray:
        """Effects (M, k) of one prior half width of each candidate beside what acts.

        To first order at size zero; of a candidate with a size, the secant up to there.
        """
        whole, parts, tried = (
            np.append(z, 0.0),
            [(a.formula, a.t) for a in acting],
            [(c.formula, c.t) for c in candidates],
        )
        effects = self.data.tangents(whole, parts, tried)
        if far := [k for k, (_, t) in enumerate(tried) if t[0]]:
            without = self.data.shown_by(whole, parts)
            for k in far:
                effects[:, k] = (self.data.shown_by(whole, [*parts, tried[k]]) - without) / tried[k][1][0]
        found = np.zeros((self.m, len(candidates)))
        found[self.own] = effects
        return found
