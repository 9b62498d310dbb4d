"""What a campaign tells apart, and what it would with experiments behind it: exact first-order effects, no data."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from scipy.linalg import block_diag

from ..infer.evidence import White
from ..infer.problem import Acting, Look, Noise, Problem, priors
from ..infer.screen import Screen
from ..model.entries import Seen
from ..model.noise import terms
from ..model.observe import Observed
from . import channels, findings
from .experiments import Check, Experiment, build_tests

Pair = tuple[str, str]
#: A distance beyond this tells two causes apart as well as any.
ENOUGH = 6.0
#: What an experiment has to add to a distance [standard deviations].
WORTH = 0.1


@dataclass(frozen=True)
class Effects:
    """Whitened effects of candidates, forms with their shapes, per half width of the prior (m, k)."""

    candidates: tuple[Acting, ...]
    white: np.ndarray

    @cached_property
    def places(self) -> Mapping[str, np.ndarray]:
        """Cause -> its candidates, the middle of its general form first."""
        ids = np.array([c.id for c in self.candidates])
        return {id: np.flatnonzero(ids == id) for id in dict.fromkeys(ids.tolist())}

    @cached_property
    def _gram(self) -> np.ndarray:
        """Products of all pairs of effects (k, k)."""
        return np.asarray(self.white.T @ self.white)

    def visible(self, cause: str) -> float:
        """Distance of a cause from none, at a half width of its prior."""
        k = self.places[cause][0]
        return float(np.sqrt(self._gram[k, k]))

    def distances(self, cause: str, *sizes: float) -> dict[str, float]:
        """Standard deviations between a cause and the best form of each other, rescaled as its bounds allow.

        Args:
            cause: in the middle of its general form
            sizes: in half widths of its prior, the nearest of which counts; else one to each side that it has
        """
        k, (low, high, _) = self.places[cause][0], priors(self.candidates)
        size = np.array(sizes or [s for s, end in ((-1, low[k]), (1, high[k])) if s * end > 0], dtype=float)[:, None]
        across, length = size * self._gram[k], np.diag(self._gram)
        best = np.clip(across / np.maximum(length, 1e-300), low, high)
        left = (size**2 * self._gram[k, k] - 2 * best * across + best**2 * length).min(axis=0)
        found = {o: float(left[own].min()) for o, own in self.places.items() if o != cause}
        return {o: float(np.sqrt(max(value, 0.0))) for o, value in found.items()}


def find_alike(effects: Effects, cause: str, size: float, like: Mapping[str, str]) -> findings.CauseSet | None:
    """The set that a design cannot tell from a cause, declared classes included; None where it stands alone.

    Args:
        effects: of all causes, `like` their classes and why
        size: in half widths of its prior
    """
    if cause not in effects.places:
        return None
    distances = effects.distances(cause, size)
    declared = {o for o in distances if like[cause] and like[o].partition(":")[0] == like[cause].partition(":")[0]}
    near = sorted((o for o in distances if distances[o] < findings.APART or o in declared), key=lambda o: distances[o])
    if not near:
        return None
    reason = like[cause].partition(":")[2].strip() if declared & set(near) else ""
    return findings.CauseSet(causes=(cause, *near), distance=distances[near[0]], reason=reason)


def judge_design(effects: Effects) -> tuple[findings.Isolability, ...]:
    """What the design says of every cause of usual size."""
    told = []
    for cause in effects.places:
        name, distance = min(effects.distances(cause).items(), key=lambda item: item[1], default=("", None))
        told.append(findings.Isolability(cause=cause, visible=effects.visible(cause), nearest=name, distance=distance))
    return tuple(sorted(told, key=lambda i: -i.visible))


@dataclass(frozen=True)
class Design:
    """Effects and scatter of all readings of a campaign and of experiments behind it.

    Args:
        experiments: those that the machine can run
        candidates: forms with their shapes
        effects: of one half width of each (M, k)
        covariance: without a cause (M, M)
        owner: experiment of each reading (M,), "" for those of the campaign
    """

    experiments: tuple[Experiment, ...]
    candidates: tuple[Acting, ...]
    effects: np.ndarray
    covariance: np.ndarray
    owner: np.ndarray

    def seen(self, *done: str) -> Effects:
        """The causes in standard deviations, with some experiments done."""
        rows = np.isin(self.owner, ["", *done])
        return Effects(self.candidates, White.of(self.covariance[np.ix_(rows, rows)])(self.effects[rows]))

    def distances(self, *done: str) -> dict[Pair, float]:
        """Distance of each pair of causes, with some experiments done."""
        seen = self.seen(*done)
        one = {cause: seen.distances(cause) for cause in seen.places}
        return {(a, b): min(one[a][b], one[b][a]) for a, b in combinations(seen.places, 2)}


def simulate_design(
    problem: Problem,
    look: Look,
    noise: Noise,
    first: Screen,
    causes: Collection[str],
    experiments: Sequence[Experiment],
) -> Design:
    """A campaign with experiments behind it, for some causes; look, noise and first screen are without a cause."""
    places = [k for k, c in enumerate(first.candidates) if c.id in causes]
    candidates = [first.candidates[k] for k in places]
    runs = {e.id: r for e in experiments if e.tests and (r := _run(problem.data, look, candidates, e)) is not None}
    checks = [(e.id, check) for e in experiments for check in e.checks]
    campaigns = [*problem.campaigns, *(o for o, _, _ in runs.values())]
    seen = [*look.seen, *(s for _, s, _ in runs.values())]
    joint = terms(campaigns, seen, problem.day_sd, look.sd, points=len(runs))
    J = look.sd * np.concatenate([look.jacobian, *(s.by[:, : problem.nz] for _, s, _ in runs.values())])
    V = J @ J.T + noise.scaled(joint)
    known = {t.name: t.columns[:, 0] for t in joint if t.columns is not None and t.name.startswith("tolerance of ")}
    sensors = {s.name: s.offset_sd for s in problem.data.campaign.sensors}
    V = _with_checks(V, known, [check for _, check in checks], sensors)
    checked = (_of_check(problem.data, c, candidates) for _, c in checks)
    rows = [first.effects[:, places], *(e for _, _, e in runs.values()), *checked]
    owner = np.repeat(["", *runs, *(id for id, _ in checks)], [len(r) for r in rows])
    possible = tuple(e for e in experiments if not e.tests or e.id in runs)
    return Design(possible, tuple(candidates), np.concatenate(rows), V, owner)


def _with_checks(
    V: np.ndarray, known: Mapping[str, np.ndarray], checks: Sequence[Check], offset_sd: Mapping[str, float]
) -> np.ndarray:
    """A covariance (m, m) with the readings of checks behind it, which share the tolerances (m,) of their sensors."""
    m = len(V)
    found = block_diag(V, *(c.sd**2 * np.eye(len(c.true)) + c.standard**2 for c in checks))
    for sensor in dict.fromkeys(c.sensor for c in checks):
        shared = [np.full(len(c.true), offset_sd[sensor] if c.sensor == sensor else 0.0) for c in checks]
        effect = np.concatenate([known[f"tolerance of {sensor}"], *shared])
        both = np.outer(effect, effect)
        both[:m, :m] = 0.0  # known already
        found += both
    return np.asarray(found)


def _run(
    data: Observed, look: Look, candidates: Sequence[Acting], experiment: Experiment
) -> tuple[Observed, Seen, np.ndarray] | None:
    """The tests of an experiment simulated, with the effects of the causes (m, k); None where the machine cannot."""
    z, campaign = np.append(look.z, 0.0), build_tests(data.campaign, experiment)
    o = data.another(campaign)
    shown = o.at(z, []).shown
    if not np.isfinite(shown).all():
        return None
    for i, s in enumerate(campaign.read):
        campaign.values[s.name][o.row[o.kind == i]] = shown[o.kind == i]
    o = data.another(campaign)
    o.features[0] = 1.0  # behind the campaign
    seen = o.at(z, [])
    effects = o.tangents(z, [], [(c.formula, c.t) for c in candidates])
    if experiment.logged:  # a log knows its times
        effects[:, [c.formula.paced for c in candidates]] = 0.0
    return (o, seen, effects) if np.isfinite(seen.shown).all() and np.isfinite(effects).all() else None


def _of_check(o: Observed, check: Check, candidates: Sequence[Acting]) -> np.ndarray:
    """Reading less truth (n, k) per half width of each candidate, where a sensor is checked after the campaign."""
    n = len(check.true)
    units = {s.name: channels.unit(s) for s in o.campaign.sensors}  # all thermometers are in one bath
    sensors = {s: np.full(n, check.true if units[s] == units[check.sensor] else v.mean()) for s, v in o.sensors.items()}
    features = np.tile(o.features.mean(axis=1)[:, None], n)
    features[0] = 1.0  # behind the campaign
    found = np.zeros((n, len(candidates)))
    for k, c in enumerate(candidates):
        t = np.r_[0.0, c.t[1:]]
        if check.sensor in c.formula.read:
            _, by_t, _ = c.formula.instruments(t, sensors, sensors, features)
            found[:, k] = by_t[c.formula.read.index(check.sensor), :, 0]
        if check.sensor in c.formula.given:
            base = {path: np.full(n, float(o.p[0, o.plant.place[path]])) for path in c.formula.bases}
            _, by_t, _ = c.formula.physics(t, base, sensors, features)
            found[:, k] = -by_t[len(c.formula.paths) + c.formula.given.index(check.sensor), :, 0]
    return found


def rank(made: Design, weights: Mapping[str, float]) -> list[findings.Experiment]:
    """Experiments by what they add to distances of causes not yet told apart, weighted by how probable both are."""
    before, found = {p: d for p, d in made.distances().items() if d < findings.APART}, []
    for e in made.experiments:
        after = made.distances(e.id)
        value = {p: weights[p[0]] * weights[p[1]] * gain(before[p], after[p]) for p in before}
        best = max(value, key=lambda p: value[p], default=None)
        if best is not None and value[best] > 0 and gain(before[best], after[best]) >= WORTH:
            distances = {"separation_before": before[best], "separation_after": after[best]}
            one = findings.Experiment(id=e.id, what=e.what, separates=best, **distances)
            found.append((sum(value.values()), one))
    return [one for _, one in sorted(found, key=lambda item: (-item[0], item[1].id))]


def gain(before: float, after: float) -> float:
    """How much a distance grows, as far as that counts."""
    return max(min(after, ENOUGH) - min(before, ENOUGH), 0.0)
