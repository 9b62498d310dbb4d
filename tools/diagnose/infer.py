"""From inputs to findings: calibrate, search, weigh, certify on held-out points, propose the next experiment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ...scenarios.measured import Campaign
from ..effects.cause import Cause, Theta
from ..effects.taxonomy import CAUSES
from .campaign_model import CampaignModel, Rig
from .experiments import ranked
from .family import form_of
from .findings import Findings, Joint
from .gain import gain
from .inputs import Inputs
from .nuisance import Parameters
from .problem import Campaigned, Linear, Problem
from .search import DRAWS, Hypothesis, Search
from .weigh import SHOWN, confusable, joints, named, p_adequacy

#: Probability from which a hypothesis counts as the explanation; p below which what it leaves is not noise.
SURE, ADEQUATE = 0.9, 0.01
#: Hypotheses and causes that are reported; causes between which experiments are judged.
MOST, JUDGED = 12, 4


@dataclass(frozen=True)
class Predictor:
    """Oil temperatures that the instruments will show at new points, without and with the top hypothesis."""

    problem: Problem
    null: Linear
    top: Hypothesis
    applied: bool
    oils: Mapping[str, Mapping[str, float]]

    def __call__(self, points: Campaign) -> tuple[np.ndarray, np.ndarray]:
        """Nominal and extended oil temperatures [degC] at the readings of a table of points, in running order."""
        orders = [float(reading.order) for reading in self.problem.data.model.readings]
        model = CampaignModel(self.problem.rig, points, self.oils, span=(min(orders), max(orders)))
        nominal = self._at(model, self.null, {}, ())
        if not self.applied:
            return nominal, nominal
        causes = [CAUSES[c] for c in self.top.causes]
        return nominal, self._at(model, self.top.linear or self.null, self.top.theta, causes)

    def _at(
        self, model: CampaignModel, linear: Linear, theta: Mapping[str, Theta], causes: list[Cause] | tuple[()]
    ) -> np.ndarray:
        values = dict(linear.values)
        for cause in causes:
            values |= cause.values({**self.problem.rig.base, **values}, theta[cause.id], model.rows)
        shown = model.simulate([values])[0]
        for cause in causes:
            shown = cause.readings(theta[cause.id], model.rows, shown)
        return np.asarray(shown["T_oil"] - 273.15 + self._offset(linear, theta, causes))

    def _offset(self, linear: Linear, theta: Mapping[str, Theta], causes: list[Cause] | tuple[()]) -> float:
        """The oil probe's fixed error, as the data tell it: the mean of what the fit leaves, shrunk by its prior."""
        c, part = self.problem.data, self.problem.place(self.problem.data)
        left = linear.residual - linear.jacobian @ linear.z
        oil = left[part][c.channels.part("T_oil")]
        channel = self.problem.card.channel("T_oil_C")
        shrink = channel.offset_sd**2 / max(channel.offset_sd**2 + channel.repeat_sd**2 / len(oil), 1e-12)
        return float(shrink * oil.mean())


def infer(
    inputs: Inputs, alpha: float, seed: int, progress: Callable[[str, float], None] = lambda stage, share: None
) -> tuple[Findings, Predictor]:
    """The whole diagnosis."""
    problem = problem_of(inputs)
    search = Search(problem, seed, progress)
    search.run()
    found, members = joints(search)
    top, hypothesis = found[0], members[0]
    adequacy = p_adequacy(search, hypothesis)
    alarm = search.p_any <= alpha
    verdict = verdict_of(alarm, top, adequacy)
    progress("held-out points", 0.85)
    leading = [h for h in members if h.causes][:6]
    warnings = list(inputs.warnings)
    if len(problem.campaigns) == 1:
        warnings.append("No reference campaign: a rig that differs from the nominal may look like a fault.")
    certified = gain(search, leading, seed)
    progress("next experiment", 0.92)
    causes = named(search, found, leading)
    weights = {n.id: max(n.probability, 0.02) for n in causes[:JUDGED]}
    applied = alarm and bool(hypothesis.causes)
    findings = Findings(
        verdict=verdict,
        alpha=alpha,
        p_any=search.p_any,
        p_omnibus=search.p_omnibus,
        p_adequacy=adequacy,
        draws=DRAWS,
        hypotheses=tuple(j for j in found[:MOST] if j.probability > SHOWN or j is top),
        causes=tuple(causes),
        confusable=tuple(confusable(search, [n for n in causes[:3] if n.probability > 0.1])),
        impact=impact(search, hypothesis),
        gain=certified,
        next_experiment=tuple(ranked(problem, search.null.z, weights)),
        warnings=tuple(warnings),
        nominal=dict(search.null.values),
        extended=dict((hypothesis.linear or search.null).values),
        rows=shown(search, hypothesis),
    )
    progress("done", 1.0)
    return findings, Predictor(problem, search.null, hypothesis, applied, inputs.oils)


def problem_of(inputs: Inputs) -> Problem:
    """Data and reference as one problem on one rig."""
    rig = Rig(inputs.spec)
    campaigns = [Campaigned.of(CampaignModel(rig, inputs.data, inputs.oils, inputs.memory, series=inputs.series), acting=True)]
    if inputs.reference is not None:
        healthy = CampaignModel(rig, inputs.reference, inputs.oils, inputs.memory, series=inputs.reference_series)
        campaigns.append(Campaigned.of(healthy, acting=False))
    wide = inputs.reference is not None
    return Problem(rig, campaigns, inputs.card, Parameters.of(rig.base, inputs.card, wide=wide))


def verdict_of(alarm: bool, top: Joint, adequacy: float) -> str:
    """One word."""
    if not alarm:
        return "consistent"
    if adequacy < ADEQUATE:
        return "unexplained"
    return "explained" if top.probability > SURE and top.causes else "ambiguous"


def impact(search: Search, h: Hypothesis) -> dict[str, tuple[float, float, float]]:
    """Mean change of the readings that a hypothesis makes, with 95 % interval: channel -> (value, low, high)."""
    c, part = search.problem.data, search.problem.place(search.problem.data)
    totals = {"T_oil_K": ("T_oil", 0.0, 0.0), "T_wall_K": ("T_wall", 0.0, 0.0), "loss_Nm": ("loss", 0.0, 0.0)}
    for f in h.families:
        theta = h.theta[f.cause.id]
        k = form_of(f, theta)
        size, sd = theta[f.cause.size.name], float(f.sizes()[1][k])
        for name, (channel, value, variance) in totals.items():
            mean = float(f.signatures[part, k][c.channels.part(channel)].mean())
            totals[name] = (channel, value + mean * size, variance + (mean * sd) ** 2)
    return {n: (v, v - 1.96 * s**0.5, v + 1.96 * s**0.5) for n, (_, v, s) in totals.items()}


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
