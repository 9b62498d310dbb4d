"""Single readings that cannot be: found by what all other readings say of them, and set aside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .fit import Fit
from .problem import Aside, Problem

#: Standard deviations from what the others say beyond which a reading is gross, and how far it stands out of the rest.
GROSS, OUT = 6.0, 1.6
#: A given reading is suspected before a compared one only where it stands out by so much more.
GIVEN = 0.9
#: A reading that a hypothesis brings within this is none.
FINE = 4.0
#: Readings set aside at most, as a share of all.
MOST = 0.05


@dataclass(frozen=True)
class Suspect:
    """A reading, and how far it lies from what the others say, in standard deviations of that difference."""

    aside: Aside
    size_sd: float


def suspects(problem: Problem, fit: Fit) -> list[Suspect]:
    """All readings by how far they lie from what the others say, the farthest first: compared and given ones."""
    white, e = fit.linear(problem)
    inverse = white.back(np.eye(problem.m))
    a = inverse @ (white.L @ e)
    found = [
        Suspect(Aside(i), float(value)) for i, value in enumerate(a / np.sqrt(np.diag(inverse))) if np.isfinite(value) and problem.ends[i]
    ]
    for sensor, columns in problem.inputs(fit.look):
        length = np.einsum("mk,mk->k", columns, inverse @ columns)
        along = columns.T @ a
        for k in np.flatnonzero(length > 1e-12):
            # one unit of this reading's scatter is part of the covariance: what is left without it
            own = length[k] / max(1 - min(length[k], 0.999), 1e-3)
            value = along[k] / max(1 - min(length[k], 0.999), 1e-3) / np.sqrt(own)
            found.append(Suspect(Aside(int(k), sensor), GIVEN * float(value)))
    return sorted(found, key=lambda s: -abs(s.size_sd))


def gross(problem: Problem, fit: Fit) -> Suspect | None:
    """The reading that is gross beside a hypothesis, if there is one that is not set aside yet."""
    known = [s for s in suspects(problem, fit) if s.aside not in problem.aside]
    if not known or abs(known[0].size_sd) < GROSS:
        return None
    own = problem.touched(known[0].aside, fit.look)
    others = [abs(s.size_sd) for s in known[1:] if not problem.touched(s.aside, fit.look) & own]
    typical = np.quantile(others, 0.9) if others else 0.0
    return known[0] if abs(known[0].size_sd) > OUT * max(others[0] if others else 0.0, 1.5 * typical) else None


def after_all(problem: Problem, fit: Fit) -> frozenset[Aside]:
    """Readings that were set aside and that a hypothesis explains."""
    return frozenset(s.aside for s in distances(problem, fit) if abs(s.size_sd) < FINE)


def distances(problem: Problem, fit: Fit) -> list[Suspect]:
    """How far each reading that is set aside lies from what a hypothesis says of it."""
    white, e = fit.linear(problem)
    V, r = white.L @ white.L.T, white.L @ e
    inverse = white.back(np.eye(problem.m))
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


