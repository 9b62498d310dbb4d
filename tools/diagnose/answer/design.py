"""What a campaign tells apart, and what it would with experiments behind it: exact first-order effects, no data."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..infer.found import Found
from ..infer.problem import Acting, Look, Noise, Problem
from ..model.noise import terms
from ..model.observe import Observed, Seen
from ..setting import Setting
from . import findings
from .experiments import Check, Experiment, added, with_readings
from .sets import Effects

Pair = tuple[str, str]
#: A distance beyond this tells two causes apart as well as any.
ENOUGH = 6.0


@dataclass(frozen=True)
class Design:
    """Effects and scatter of all readings of a campaign and of experiments behind it.

    Args:
        experiments: those that the machine can run
        candidates: forms with their shapes
        effects: of one half width of each (M, k)
        covariance: without a cause (M, M)
        parts: mask (M,) of the campaign, as "", and of each experiment
    """

    experiments: tuple[Experiment, ...]
    candidates: tuple[Acting, ...]
    effects: np.ndarray
    covariance: np.ndarray
    parts: Mapping[str, np.ndarray]

    def seen(self, *done: str) -> Effects:
        """The causes in standard deviations, with some experiments done."""
        rows = np.logical_or.reduce([self.parts[""], *(self.parts[name] for name in done)])
        return Effects.of(self.candidates, self.effects[rows], self.covariance[np.ix_(rows, rows)])

    def distances(self, *done: str) -> dict[Pair, float]:
        """Distance of each pair of causes, with some experiments done."""
        seen = self.seen(*done)
        one = {cause: seen.distances(cause) for cause in seen.places}
        return {(a, b): min(one[a][b], one[b][a]) for a, b in combinations(seen.places, 2)}


def design(
    setting: Setting,
    problem: Problem,
    look: Look,
    noise: Noise,
    candidates: Sequence[Acting],
    effects: np.ndarray,
    experiments: Sequence[Experiment],
) -> Design:
    """A campaign with experiments behind it.

    Args:
        setting: the rig
        problem: the campaign
        look: at the rig as calibrated, without a cause
        noise: scatter there
        candidates: forms of the causes
        effects: theirs in the campaign (m, k)
        experiments: to try
    """
    blocks = [b for e in experiments if (b := _Block.of(setting, problem, look, candidates, e)) is not None]
    runs = [b for b in blocks if b.observed is not None]
    campaigns = [*problem.campaigns, *(b.observed for b in runs if b.observed is not None)]
    seen = [*look.seen, *(b.seen for b in runs if b.seen is not None)]
    scales = {t.name: s for t, s in zip(noise.loose, noise.scales, strict=True)}
    joint = terms(campaigns, seen, problem.day_sd, problem.nz)
    J = np.concatenate([look.jacobian, *(b.jacobian for b in runs)])
    V = J @ J.T + sum(np.exp(2 * scales.get(t.name, 0.0)) * t.matrix for t in joint)
    rows = [effects, *(b.effects for b in runs)]
    owner = np.concatenate([[""] * problem.m, *([b.experiment.id] * len(b.effects) for b in runs)])
    checks = [c for b in blocks for c in b.checks]
    known = {t.name: t.columns[:, 0] for t in joint if t.columns is not None and t.name.startswith("tolerance of ")}
    sensors = {s.name: s.offset_sd for s in problem.data.campaign.sensors}
    V = _with_checks(V, known, checks, sensors)
    owner = np.concatenate([owner, *([c.experiment] * len(c.effects) for c in checks)])
    parts = {name: owner == name for name in ["", *(b.experiment.id for b in blocks)]}
    whole = np.concatenate([*rows, *(c.effects for c in checks)])
    return Design(tuple(b.experiment for b in blocks), tuple(candidates), whole, V, parts)


def _with_checks(
    V: np.ndarray, known: Mapping[str, np.ndarray], checks: Sequence[_Checked], offset_sd: Mapping[str, float]
) -> np.ndarray:
    """A covariance (m, m) with the readings of checks behind it, which share the tolerances of their sensors.

    Args:
        V: of the readings
        known: term of a tolerance -> its effect on them (m,)
        checks: to add
        offset_sd: sensor -> its fixed tolerance
    """
    sizes = [len(c.effects) for c in checks]
    m, total = len(V), len(V) + sum(sizes)
    found = np.zeros((total, total))
    found[:m, :m] = V
    ends = m + np.cumsum(sizes)
    for c, n, end in zip(checks, sizes, ends, strict=True):
        own = slice(end - n, end)
        found[own, own] += c.one.sd**2 * np.eye(n) + c.one.standard**2
    for sensor in {c.one.sensor for c in checks}:
        effect = np.zeros(total)
        effect[:m] = known.get(f"tolerance of {sensor}", np.zeros(m))
        for c, n, end in zip(checks, sizes, ends, strict=True):
            effect[end - n : end] = offset_sd[sensor] if c.one.sensor == sensor else 0.0
        both = np.outer(effect, effect)
        both[:m, :m] = 0.0  # known already
        found += both
    return found


@dataclass(frozen=True)
class _Checked:
    """A check and what the causes make of reading less truth (n, k)."""

    one: Check
    effects: np.ndarray
    experiment: str


@dataclass(frozen=True)
class _Block:
    """What an experiment adds: tests with effects (m, k) and Jacobian (m, nz), and checks."""

    experiment: Experiment
    observed: Observed | None
    seen: Seen | None
    effects: np.ndarray
    jacobian: np.ndarray
    checks: tuple[_Checked, ...]

    @staticmethod
    def of(
        setting: Setting, problem: Problem, look: Look, candidates: Sequence[Acting], experiment: Experiment
    ) -> _Block | None:
        """An experiment simulated; None where the machine cannot run it."""
        checks = tuple(_Checked(c, _of_check(problem.data, c, candidates), experiment.id) for c in experiment.checks)
        nothing = np.zeros((0, len(candidates))), np.zeros((0, problem.nz))
        if not experiment.tests:
            return _Block(experiment, None, None, *nothing, checks)
        data, z = problem.data, np.append(look.z, 0.0)
        campaign = added(data.campaign, experiment)
        point = setting.scenario.operating_point
        o = Observed(setting.plant, campaign, data.nuisances, setting.oils, point)
        shown = o.at(z, []).shown
        if not np.isfinite(shown).all():
            return None
        readings = list(zip(o.kind.tolist(), o.row.tolist(), shown.tolist(), strict=True))
        o = Observed(setting.plant, with_readings(campaign, readings), data.nuisances, setting.oils, point)
        o.features[0] = 1.0  # behind the campaign
        seen = o.at(z, [])
        effects = o.tangents(z, [], [(c.formula, c.t) for c in candidates])
        if experiment.logged:  # a log knows its times
            effects[:, [c.formula.paced for c in candidates]] = 0.0
        if not np.isfinite(seen.shown).all() or not np.isfinite(effects).all():
            return None
        return _Block(experiment, o, seen, effects, seen.by[:, : problem.nz], checks)


def _of_check(o: Observed, check: Check, candidates: Sequence[Acting]) -> np.ndarray:
    """Reading less truth (n, k) per half width of each candidate, where a sensor is checked after the campaign."""
    n = len(check.true)
    sensors = {s.name: np.full(n, float(np.mean(o.sensors[s.name]))) for s in o.campaign.sensors}
    sensors[check.sensor] = np.array(check.true)
    reads = {s.name: sensors[s.name] for s in o.read}
    features = np.tile(np.array([1.0, 1.0, 0.0, 0.5, 0.0, 3600.0])[:, None], n)
    found = np.zeros((n, len(candidates)))
    for k, c in enumerate(candidates):
        t = np.r_[0.0, c.t[1:]]
        if check.sensor in c.formula.read:
            _, by_t, _ = c.formula.instruments(t, sensors, reads, features)
            found[:, k] = by_t[c.formula.read.index(check.sensor), :, 0]
        if check.sensor in c.formula.given:
            base = {path: np.full(n, float(o.p[0, o.plant.place[path]])) for path in c.formula.bases}
            _, by_t, _ = c.formula.physics(t, base, sensors, features)
            found[:, k] = -by_t[len(c.formula.paths) + c.formula.given.index(check.sensor), :, 0]
    return found


def of_search(setting: Setting, found: Found, causes: Collection[str], experiments: Sequence[Experiment]) -> Design:
    """The design of a search's data for some causes, with experiments behind it."""
    places = [k for k, c in enumerate(found.first.candidates) if c.id in causes]
    candidates = [found.first.candidates[k] for k in places]
    null = found.null
    return design(
        setting, found.problem, null.look, null.noise, candidates, found.first.effects[:, places], experiments
    )


def ranked(made: Design, weights: Mapping[str, float]) -> list[findings.Experiment]:
    """Experiments by what they add to the distances between causes, weighted by how probable both are.

    Args:
        made: the design
        weights: cause -> probability; pairs of them are judged
    """
    before, found = made.distances(), []
    for experiment in made.experiments:
        after = made.distances(experiment.id)
        value = {p: weights[p[0]] * weights[p[1]] * gain(before[p], after[p]) for p in before}
        best = max(value, key=lambda p: value[p], default=None)
        if best is not None and value[best] > 0:
            one = findings.Experiment(
                id=experiment.id,
                what=experiment.what,
                separates=best,
                separation_before=before[best],
                separation_after=after[best],
            )
            found.append((sum(value.values()), one))
    return [one for _, one in sorted(found, key=lambda item: (-item[0], item[1].id))]


def gain(before: float, after: float) -> float:
    """How much a distance grows, as far as that counts."""
    return max(min(after, ENOUGH) - min(before, ENOUGH), 0.0)
