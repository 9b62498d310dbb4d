"""Single readings that cannot be: found by what all other readings say of them, and set aside."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from .fit import Fit, fitted
from .problem import Aside, Problem

#: Standard deviations from what the others say beyond which a reading is gross.
GROSS = 5.0
#: So many times those which nine of ten readings keep within.
OUT = 2.5
#: Half of a normal scatter lies within so many standard deviations.
HALF = 0.6745
#: No scatter is taken for less than that share.
LEAST = 0.2
#: A given reading is suspected before a compared one only where it stands out by so much more.
GIVEN = 0.9
#: A reading that a hypothesis brings within this is none.
FINE = 4.0
#: Readings set aside at most: as a share of all.
MOST = 0.05
#: Of one sensor of a campaign. More of one sensor have a cause.
ALIKE = 2
#: Of so many that are set aside, those that lie nearest to a hypothesis, all sets are weighed.
TOGETHER = 6


@dataclass(frozen=True)
class Suspect:
    """A reading, and how far it lies from what the others say, in standard deviations of that difference."""

    aside: Aside
    size_sd: float


def suspects(problem: Problem, fit: Fit) -> list[Suspect]:
    """All readings by how far they lie from what the others say, the farthest first: compared and given ones."""
    white, e = fit.linear(problem)
    inverse = white.inverse
    a = inverse @ (white.L @ e)
    kinds = np.concatenate([1000 * k + o.kind for k, o in enumerate(problem.campaigns)])
    stands = _robust(a / np.sqrt(np.diag(inverse)), kinds)
    found = [Suspect(Aside(i), float(value)) for i, value in enumerate(stands) if problem.ends[i]]
    for sensor, columns in problem.inputs(fit.look):
        length = np.einsum("mk,mk->k", columns, inverse @ columns)
        along = columns.T @ a
        seen = np.flatnonzero(length > 1e-12)
        stands = GIVEN * _robust(along[seen] / np.sqrt(length[seen]), np.zeros(len(seen)))
        found += [Suspect(Aside(int(k), sensor), float(value)) for k, value in zip(seen, stands, strict=True)]
    return sorted(found, key=lambda s: -abs(s.size_sd))


def _robust(stands: np.ndarray, kinds: np.ndarray) -> np.ndarray:
    """Distances in units of those which half of a kind keep within: gross readings raise the scatter they hide in."""
    found = stands.copy()
    for kind in np.unique(kinds):
        own = kinds == kind
        found[own] /= np.clip(np.median(np.abs(stands[own])) / HALF, LEAST, 1.0)
    return found


def outliers(problem: Problem, fit: Fit) -> list[Suspect]:
    """The readings not yet set aside that are gross beside a hypothesis, one for each compared reading they touch.

    They are found one after the other: what is left of a reading counts once those before it are gone.
    """
    every = suspects(problem, fit)
    usual = float(np.quantile([abs(s.size_sd) for s in every], 0.9))
    found: list[Suspect] = []
    taken: set[int] = set()
    for s in every:
        if abs(s.size_sd) < max(GROSS, OUT * usual):
            break
        touched = problem.touched(s.aside, fit.look)
        if s.aside not in problem.aside and not touched & taken:
            found.append(s)
            taken |= touched
    return found


def few(problem: Problem, found: Iterable[Aside]) -> frozenset[Aside]:
    """Those of readings, the grossest first, that are few enough to be gross."""
    kept: list[Aside] = []
    alike: Counter[tuple[int, str]] = Counter()
    for aside in dict.fromkeys(found):
        sensor = problem.source(aside)
        alike[sensor] += 1
        if alike[sensor] <= ALIKE and len(kept) < max(ALIKE, int(MOST * problem.m)):
            kept.append(aside)
    return frozenset(kept)


def remaining(problem: Problem, fit: Fit) -> frozenset[Aside]:
    """The readings set aside that a hypothesis does not explain: one of them may be all that speaks for another.

    Of all their sets the one counts with which the others are likeliest, where one more must be worth its distance.
    """
    open_ = [s.aside for s in sorted(distances(problem, fit), key=lambda s: abs(s.size_sd))[:TOGETHER]]
    gone = problem.aside - frozenset(open_)
    without, far = problem.without(gone).noise(fit.look, fit.noise.scales), {a: problem.far(a, fit.look) for a in open_}
    each = np.log(problem.FAR) - 0.5 * FINE**2

    def worth(some: tuple[Aside, ...]) -> float:
        noise = replace(without, terms=(*without.terms, *(far[a] for a in some)))
        white, e = replace(fit, noise=noise).linear(problem)
        return white.log_density(e) + len(some) * float(each)

    sets = [some for n in range(len(open_) + 1) for some in combinations(open_, n)]
    likeliest = max(sets, key=worth)
    return gone | frozenset(likeliest)


def distances(problem: Problem, fit: Fit) -> list[Suspect]:
    """How far each reading that is set aside lies from what a hypothesis says of it."""
    white, e = fit.linear(problem)
    V, r = white.L @ white.L.T, white.L @ e
    inverse = white.inverse
    a = inverse @ r
    found = []
    for aside in sorted(problem.aside):
        term = problem.far(aside, fit.look)
        if term.variance is not None:
            i = aside.number
            spread = 1 / inverse[i, i] - term.variance[i]
            own = a[i] / inverse[i, i] / np.sqrt(max(spread, 1e-12 * V[i, i]))
        else:
            assert term.columns is not None
            c = term.columns[:, 0] / problem.FAR
            length = c @ inverse @ c
            own = (c @ a) / np.sqrt(length) / np.sqrt(max(1 - (problem.FAR**2 - 1) * length, 1e-9))
        found.append(Suspect(aside, float(own)))
    return found


def set_aside(problem: Problem, fits: Sequence[Fit]) -> frozenset[Aside]:
    """The gross readings: those that the first hypothesis does not explain, and others that show beside one of them."""
    return few(
        problem, [*sorted(remaining(problem, fits[0])), *(s.aside for fit in fits for s in outliers(problem, fit))]
    )


def cleaned(problem: Problem, null: Fit) -> tuple[Problem, Fit]:
    """The problem without the gross readings that the null shows, and the null fitted without them."""
    taken: list[Aside] = []
    while found := [s.aside for s in outliers(problem, null) if s.aside in few(problem, [*taken, s.aside])]:
        taken.append(found[0])
        problem = problem.without(frozenset(taken))
        null = fitted(problem, (), null.look.z)
    return problem, null
