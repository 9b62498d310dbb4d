"""How far readings that are set aside lie from what the others say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .fit import Fit
from .problem import Aside, Problem


@dataclass(frozen=True)
class Suspect:
    """A reading, and how far it lies from what the others say, in standard deviations of that difference."""

    aside: Aside
    size_sd: float


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
