"""From inputs to findings: calibrate, search, weigh, certify on held-out points, propose the next experiment."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ...model.errors import SolveError
from ...scenarios.measured import Campaign
from ..effects.taxonomy import CAUSES
from .campaign_model import CampaignModel, Rig
from .experiments import ranked
from .extension import of_machine
from .family import form_of
from .findings import UNEXPLAINED, Findings, Joint, Named
from .gain import gain, gains, rms
from .hypothesis import Hypothesis
from .inputs import Inputs
from .nuisance import Channels, Parameters, instrument_covariance
from .problem import Campaigned, Linear, Problem, remainder
from .search import DRAWS, Search
from .split import certified
from .superset import buildable
from .together import covariance
from .weigh import SHOWN, confusable, joints, named, outside, p_adequacy, with_outside
from .words import ADEQUATE

#: Probability from which a hypothesis counts as the explanation.
SURE = 0.9
#: Hypotheses and causes that are reported; causes between which experiments are judged.
MOST, JUDGED = 12, 4
#: Probability from which a hypothesis counts in predictions.
COUNTS = 0.03
#: Weight of the likeliest one where it has none, because something outside the library is all but certain.
LEAST = 1e-300


@dataclass(frozen=True)
class Predictor:
    """Oil temperatures that the instruments will show at new points, without a cause and by the weighed hypotheses."""

    problem: Problem
    null: Linear
    weighed: tuple[tuple[float, Hypothesis], ...]
    oils: Mapping[str, Mapping[str, float]]

    def __call__(self, points: Campaign) -> tuple[np.ndarray, np.ndarray]:
        """Nominal and extended oil temperatures [degC] at the readings of a table of points, in running order.

        A nominal rig that, bent by a loud cause, cannot be run there gives way to that of the likeliest hypothesis.
        """
        orders = [float(reading.order) for reading in self.problem.data.model.readings]
        model = CampaignModel(self.problem.rig, points, self.oils, span=(min(orders), max(orders)))
        try:
            nominal = self._at(model, Hypothesis((), 0.0, linear=self.null))
        except SolveError:
            nominal = self._at(model, replace(self.weighed[0][1], causes=()))
        weights, shown = [], []
        for weight, h in self.weighed:
            with suppress(SolveError):  # what cannot be run there predicts nothing
                shown.append(self._at(model, h))
                weights.append(weight)
        return nominal, np.average(shown, axis=0, weights=weights) if shown else nominal

    def _at(self, model: CampaignModel, h: Hypothesis) -> np.ndarray:
        linear, causes = h.linear or self.null, [CAUSES[c] for c in h.causes]
        points = Campaigned(model, Channels({"T_oil": np.arange(model.n)}), np.empty(0), acting=True)
        shown = self.problem.shown_at(points, [(linear.values, h.theta)], causes)[:, 0]
        return np.asarray(shown - 273.15 + self._tied(points, linear, linear.residual - h.effect))

    def _tied(self, points: Campaigned, linear: Linear, left: np.ndarray) -> np.ndarray:
        """What the oil probe's tolerance, the room probe's and the smooth remainder add, as the data tell them."""
        problem = self.problem
        weights = problem.tied.T @ cho_solve(cho_factor(linear.covariance), left)
        columns = instrument_covariance(points.channels, points.model.rows, problem.card)[1]
        if len(problem.campaigns) > 1:
            columns |= remainder(points.channels, points.model.rows)
        known = dict(zip(problem.tied_names, weights, strict=True))
        return np.asarray(sum(known[name] * column for name, column in columns.items()))


def infer(
    inputs: Inputs, alpha: float, seed: int, progress: Callable[[str, float], None] = lambda stage, share: None
) -> tuple[Findings, Predictor]:
    """The whole diagnosis."""
    problem = problem_of(inputs)
    search = Search(problem, seed, progress, inputs.most)
    search.run()
    found, members = joints(search)
    listed, hypothesis = with_outside(found), members[0]
    adequacy = p_adequacy(search, hypothesis)
    alarm = search.p_any <= alpha
    verdict = verdict_of(alarm, listed[0], adequacy)
    progress("held-out points", 0.85)
    leading = [h for h in members if h.causes][:6]
    warnings = list(inputs.warnings)
    if len(problem.campaigns) == 1:
        warnings.append("No reference campaign: a rig that differs from the nominal may look like a fault.")
    gained, grouped = gain(search, leading, seed), gains(search, leading, seed)
    progress("next experiment", 0.92)
    causes = certificates(search, named(search, found, leading))
    unexplained = Named(UNEXPLAINED, outside(found), math.inf)
    weights = {n.id: max(n.probability, 0.02) for n in causes[:JUDGED]}
    weighed = [
        (max(j.probability, LEAST), h)
        for j, h in zip(found, members, strict=True)
        if j is found[0] or j.probability > COUNTS
    ]
    if not alarm:
        weighed = [(1.0, h) for h in members if not h.causes]
    left = played(search, hypothesis)
    if not left:
        warnings.append("The extended rig cannot be run over these readings: no rig file holds what was fitted.")
    findings = Findings(
        verdict=verdict,
        alpha=alpha,
        p_any=search.p_any,
        p_omnibus=search.p_omnibus,
        p_adequacy=adequacy,
        draws=DRAWS,
        hypotheses=tuple(j for j in listed[:MOST] if j.probability > SHOWN or j is found[0]),
        causes=tuple(sorted([*causes, unexplained], key=lambda n: (-n.probability, n.id))),
        confusable=tuple(confusable(search, [n for n in causes[:3] if n.probability > 0.1])),
        impact=impact(search, hypothesis),
        gain=gained,
        grouped=grouped,
        next_experiment=tuple(ranked(problem, search.null.z, weights)),
        warnings=tuple(warnings),
        nominal=dict(search.null.values),
        extended=dict((hypothesis.linear or search.null).values),
        played=left,
        rows=shown(search, hypothesis),
    )
    progress("done", 1.0)
    return findings, Predictor(problem, search.null, tuple(weighed), inputs.oils)


def problem_of(inputs: Inputs) -> Problem:
    """Data and reference as one problem on one rig."""
    rig = Rig(inputs.spec)
    campaigns = [
        Campaigned.of(CampaignModel(rig, inputs.data, inputs.oils, inputs.memory, series=inputs.series), acting=True)
    ]
    if inputs.reference is not None:
        healthy = CampaignModel(rig, inputs.reference, inputs.oils, inputs.memory, series=inputs.reference_series)
        campaigns.append(Campaigned.of(healthy, acting=False))
    wide = inputs.reference is not None
    return Problem(rig, campaigns, inputs.card, Parameters.of(rig.base, inputs.card, wide=wide))


def verdict_of(alarm: bool, top: Joint, adequacy: float) -> str:
    """One word."""
    if not alarm:
        return "consistent"
    if adequacy < ADEQUATE or top.outside:
        return "unexplained"
    return "explained" if top.probability > SURE and top.causes else "ambiguous"


def impact(search: Search, h: Hypothesis) -> dict[str, tuple[float, float, float]]:
    """Mean change of the readings that a hypothesis makes, with 95 % interval: channel -> (value, low, high)."""
    c, part = search.problem.data, search.problem.place(search.problem.data)
    forms = [form_of(f, h.theta[f.cause.id]) for f in h.families]
    sizes = np.array([h.theta[f.cause.id][f.cause.size.name] for f in h.families])
    known = covariance(h.parts(search.null), forms) if forms else np.empty((0, 0))
    found = {}
    for name, channel in {"T_oil_K": "T_oil", "T_wall_K": "T_wall", "loss_Nm": "loss"}.items():
        rows = c.channels.part(channel)
        mean = [f.signatures[part, k][rows].mean() for f, k in zip(h.families, forms, strict=True)]
        value, spread = float(np.dot(mean, sizes)), 1.96 * float(np.dot(mean, known @ mean)) ** 0.5
        found[name] = (value, value - spread, value + spread)
    return found


def shown(search: Search, h: Hypothesis) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Channel -> measured, nominal and extended readings of the data."""
    c, part = search.problem.data, search.problem.place(search.problem.data)
    extended = search.problem.shown_by((h.linear or search.null).values, h.theta, [CAUSES[c] for c in h.causes])
    return {
        channel: (
            c.measured[c.channels.part(channel)],
            search.null.nominal[part][c.channels.part(channel)],
            extended[c.channels.part(channel)],
        )
        for channel in c.channels.names
    }


def certificates(search: Search, causes: Sequence[Named]) -> list[Named]:
    """Causes with their certificates by the split of the tests, where they have one."""
    known = certified(search)
    return [replace(c, p_split=known[c.id][0], q=known[c.id][1]) if c.id in known else c for c in causes]


def played(search: Search, h: Hypothesis) -> dict[str, tuple[float, float]]:
    """Root mean square that the rig leaves on the readings: channel -> calibrated, extended by a hypothesis.

    Nothing where the extended rig cannot be run as a rig file can hold it.
    The extended rig is what `--extended` writes: faults of instruments and procedure, and what differs from test to
    test, are no part of it; nor is what was found of an oil, where the data have several and each brings its own.
    """
    problem, c = search.problem, search.problem.data
    base, several = problem.rig.base, len({test.oil for test in c.model.tests}) > 1
    parts = {path.rpartition(".")[0] for path in base} - {"read"}
    own: set[str] = set().union(*c.model.oils) if several else set()
    values = buildable((h.linear or search.null).values)
    for cause in (CAUSES[name] for name in h.causes):
        changed = of_machine(cause, {**base, **values}, h.theta[cause.id], parts)
        values |= {path: value for path, value in changed.items() if path not in own}
    try:
        extended = c.channels.stack(c.model.simulate([values])[0])
    except SolveError:
        return {}
    nominal, channels = search.null.nominal[problem.place(c)], c.channels
    left = [(n, channels.part(n)) for n in ("T_oil", "T_wall", "loss") if n in channels.names]
    return {n: (rms(nominal[k] - c.measured[k]), rms(extended[k] - c.measured[k])) for n, k in left}
