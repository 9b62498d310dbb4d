"""What to measure next: experiments ranked by how far they move apart what the data cannot tell apart yet."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from ...model.errors import SolveError
from ..effects.cause import Cause, spread
from ..effects.taxonomy import CAUSES
from .candidates import candidates
from .design import Design
from .family import Sample, prior_size
from .findings import Experiment
from .problem import Problem

#: Forms of each cause by which an experiment is judged.
FORMS = 6
#: A distance beyond this tells two causes apart as well as any.
ENOUGH = 6.0


def ranked(problem: Problem, z: np.ndarray, weights: Mapping[str, float]) -> list[Experiment]:
    """Experiments by what they add to the distances between causes, weighted by how probable both are.

    Args:
        problem: data and model
        z: nuisances at which to look
        weights: cause -> probability; pairs of them are judged
    """
    pairs = list(combinations(sorted(weights), 2))
    if not pairs:
        return []
    try:
        design = Design.of(problem, z, candidates(problem.data.model), [_few(CAUSES[c]) for c in sorted(weights)])
    except SolveError:  # where the model does not run no experiment is judged
        return []
    before, found = design.distances(), []
    for candidate in design.experiments:
        after = design.distances(candidate.id)
        gains = {p: weights[p[0]] * weights[p[1]] * gain(before[p], after[p]) for p in pairs}
        best = max(pairs, key=lambda p: gains[p])
        found.append((sum(gains.values()), Experiment(candidate.id, candidate.what, best, before[best], after[best])))
    found.sort(key=lambda item: (-item[0], item[1].id))
    return [experiment for value, experiment in found if value > 0]


def gain(before: float, after: float) -> float:
    """How much a distance grows, as far as that counts."""
    return max(min(after, ENOUGH) - min(before, ENOUGH), 0.0)


def _few(cause: Cause) -> Sample:
    """Few forms of a cause: where each has to be simulated, those of its main kind."""
    if not cause.physical or cause.choice is None:
        return Sample.of_prior(cause, FORMS)
    shares = spread(FORMS, len(cause.shapes))
    shares[:, cause.choice] *= cause.shapes[cause.choice].ends[0]
    return Sample(cause, shares, np.zeros(FORMS), prior_size(cause))
