"""What to measure next: candidate experiments appended to the design, ranked by how far they move look-alikes apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ..effects.taxonomy import CAUSES
from .campaign_model import CampaignModel
from .evidence import White
from .family import Family, Sample, families
from .findings import Experiment
from .problem import Campaigned, Linear, Problem
from .weigh import distance

#: Forms of each cause by which an experiment is judged.
FORMS = 6


@dataclass(frozen=True)
class Candidate:
    """An experiment: speeds [rpm], torques [N.m] and room [degC] of tests to add, or accuracies it improves."""

    id: str
    what: str
    points: tuple[tuple[float, float, float], ...] = ()
    tolerance: Mapping[str, float] | None = None


CANDIDATES = (
    Candidate(
        "cold_room", "four points in a room of 5 degC", ((100, 1600, 5), (100, 2700, 5), (250, 1600, 5), (250, 2700, 5))
    ),
    Candidate("low_load", "four points at 300 N.m", ((100, 300, 25), (150, 300, 25), (200, 300, 25), (250, 300, 25))),
    Candidate(
        "high_speed", "four points at 400 rpm", ((400, 700, 25), (400, 1200, 25), (400, 1600, 25), (400, 2000, 25))
    ),
    Candidate("low_speed", "four points at 40 rpm", ((40, 1600, 25), (40, 2000, 25), (40, 2400, 25), (40, 2700, 25))),
    Candidate(
        "repeat", "four points of the grid again", ((100, 1600, 25), (100, 2700, 25), (250, 1600, 25), (250, 2700, 25))
    ),
    Candidate("tare", "a tare of both torque transducers", tolerance={"T_carrier_Nm": 0.2, "T_sun_Nm": 0.05}),
    Candidate("bath", "all probes in one bath", tolerance={"T_oil_C": 0.03, "T_wall_C": 0.03, "T_amb_C": 0.03}),
)


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
    enlarged, added = _enlarged(problem)
    there = np.asarray(~added.any(axis=0))
    linear = enlarged.linearised(z)
    causes = [CAUSES[c] for c in sorted(weights)]
    samples = [Sample.of_prior(c, FORMS) for c in causes]
    G = families(enlarged, linear, White.of(linear.residual, linear.covariance), samples)
    before = _distances(linear, linear.covariance, G, there, pairs)
    found = []
    for candidate, own in zip(CANDIDATES, added, strict=True):
        noise = _with(enlarged, candidate).instrument - enlarged.instrument
        after = _distances(linear, linear.covariance + noise, G, own | there, pairs)
        gains = {p: weights[p[0]] * weights[p[1]] * max(min(after[p], 6.0) - min(before[p], 6.0), 0.0) for p in pairs}
        best = max(pairs, key=lambda p: gains[p])
        found.append((sum(gains.values()), Experiment(candidate.id, candidate.what, best, before[best], after[best])))
    found.sort(key=lambda item: (-item[0], item[1].id))
    return [experiment for value, experiment in found if value > 0]


def _distances(
    linear: Linear,
    covariance: np.ndarray,
    found: Mapping[str, Family],
    rows: np.ndarray,
    pairs: Sequence[tuple[str, str]],
) -> dict[tuple[str, str], float]:
    """Distance of each pair of causes at their prior sizes, as some of the readings show them."""
    white = White.of(linear.residual[rows], covariance[np.ix_(rows, rows)])
    seen = {}
    for name, f in found.items():
        g = white.columns(f.signatures[rows])
        seen[name] = replace(f, white=g, s=g.T @ white.e, q=(g**2).sum(axis=0))
    return {
        (a, b): min(distance(seen[x], 0, CAUSES[x].size.sd, seen[y]) for x, y in ((a, b), (b, a))) for a, b in pairs
    }


def _with(problem: Problem, candidate: Candidate) -> Problem:
    """The problem with the accuracies of an experiment."""
    if not candidate.tolerance:
        return problem
    card = problem.card
    channels = {k: card.channel(k).model_copy(update={"offset_sd": v}) for k, v in candidate.tolerance.items()}
    card = card.model_copy(update={"channels": {**card.channels, **channels}})
    return Problem(problem.rig, problem.campaigns, card, problem.parameters)


def _enlarged(problem: Problem) -> tuple[Problem, np.ndarray]:
    """The problem with the points of all experiments, and which readings each experiment adds (candidates, m)."""
    c = problem.data
    last, pattern = max(r.test for r in c.model.readings), c.model.tests[0]
    added, owners = [], {}
    for candidate in CANDIDATES:
        for rpm, torque, room in candidate.points:
            last += 1
            owners[last] = candidate.id
            for reading in pattern.halves:
                values = {**reading.values, "n_carrier_rpm": rpm, "T_carrier_Nm": torque, "T_amb_C": room}
                values |= {"T_sun_Nm": torque / 4, "T_start_C": np.nan, "T_amb_start_C": np.nan}
                added.append(replace(reading, test=last, order=c.model.readings[-1].order, values=values))
    campaign = replace(c.model.campaign, readings=(*c.model.campaign.readings, *added))
    oils = {test.oil: oil for test, oil in zip(c.model.tests, c.model.oils, strict=True)}
    longer = Campaigned.of(CampaignModel(problem.rig, campaign, oils), acting=True)
    campaigns = [longer if other is c else other for other in problem.campaigns]
    enlarged = Problem(problem.rig, campaigns, problem.card, problem.parameters)
    owner = np.array([owners.get(r.test, "") for r in longer.model.readings])
    mask = np.zeros((len(CANDIDATES), len(enlarged.measured)), dtype=bool)
    part = enlarged.place(longer)
    for k, candidate in enumerate(CANDIDATES):
        mask[k, part] = (owner == candidate.id)[longer.channels.rows]
    return enlarged, mask
