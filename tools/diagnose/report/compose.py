"""From what a search found to the result as data: hypotheses, answers, causes, impact, remainder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ....scenarios.measured.table import Campaign
from ..answer import estimate
from ..answer.decide import UNEXPLAINED, Chance, Decision, Joint
from ..answer.gain import Gain
from ..infer.found import Found, Hypothesis
from ..setting import Setting
from . import channels, findings
from .estimate import Estimate

#: Hypotheses that are listed.
MOST = 12
#: The least probability of one.
LISTED = 0.005
#: Changes of the loss by name, with their units.
LOSS = {"loss_Nm": "N.m", "heat_W": "W"}


def about(own: Campaign, rig: str, reference: Campaign | None, seed: int) -> findings.About:
    """What was diagnosed."""
    return findings.About(
        data=own.name,
        rig=rig,
        readings=own.n,
        tests=own.n_tests,
        reference=reference.name if reference else "",
        reference_readings=reference.n if reference else 0,
        seed=seed,
    )


def alarm(found: Found, decision: Decision, alpha: float) -> findings.Alarm:
    """The alarm and what is left."""
    return findings.Alarm(
        alpha=alpha,
        p_any=decision.p_any,
        p_omnibus=found.p_omnibus,
        p_adequacy=decision.p_adequacy,
        draws=len(found.drawn),
    )


def hypotheses(decision: Decision) -> tuple[findings.Hypothesis, ...]:
    """The most probable ones, nothing always among them."""
    listed = [j for k, j in enumerate(decision.joints) if not j.causes or (k < MOST and j.chance.probability > LISTED)]
    return tuple(
        findings.Hypothesis(causes=j.causes, probability=j.chance.probability, mc_error=j.chance.mc_error)
        for j in listed
    )


def answers(joints: Sequence[Joint]) -> tuple[findings.Answer, ...]:
    """What the verdict names."""
    return tuple(
        findings.Answer(causes=j.classes, probability=j.chance.probability, mc_error=j.chance.mc_error) for j in joints
    )


def causes(made: Setting, found: Found, decision: Decision) -> tuple[findings.Cause, ...]:
    """All causes, most probable first."""
    smallest = estimate.detectable(found)
    none = Chance(0.0, 0.0)
    told = []
    for cause in made.causes:
        chance = decision.marginal.get(cause.id, none)
        size = _sized(made, cause.id, found, decision) if chance.probability > LISTED else {}
        told.append(
            findings.Cause(
                id=cause.id,
                probability=chance.probability,
                mc_error=chance.mc_error,
                detectable=smallest.get(cause.id),
                doc=cause.doc,
                exposes=cause.exposes,
                like=cause.like,
                usual=cause.size.sd,
                unit=cause.size.unit,
                meaning=cause.size.doc,
                **size,
            )
        )
    outside = decision.marginal.get(UNEXPLAINED, none)
    told.append(findings.Cause(id=UNEXPLAINED, probability=outside.probability, mc_error=outside.mc_error))
    return tuple(sorted(told, key=lambda c: (-c.probability, c.id)))


def _sized(made: Setting, cause: str, found: Found, decision: Decision) -> dict[str, Any]:
    """Size, shapes and forms of a cause, and what it alone changes."""
    members = decision.members[cause]
    shares = estimate.form_shares(cause, members)
    own: dict[str, Any] = {
        "parameters": [
            Estimate.model_validate(e, from_attributes=True) for e in estimate.estimates(found, cause, members)
        ],
        "forms": [findings.FormShare(name=name, share=share) for name, share in shares.items() if share > LISTED],
    }
    acting = next(((h, a) for h, _ in members for a in h.fit.look.acting if a.id == cause), None)
    if acting is not None:
        h, one = acting
        own["regime"] = estimate.regime(one.formula.form, one.formula.theta(one.t))
        own["impact"] = impacts(made, found, h, cause)
    return own


def impacts(made: Setting, found: Found, h: Hypothesis, only: str | None = None) -> dict[str, findings.Impact]:
    """Mean change of each compared sensor, and of the loss, by a hypothesis or by one of its causes."""
    o = found.problem.data
    means, sensors = estimate.sensor_means(o), {s.name: s for s in o.read}
    if loss := estimate.loss_means(o, made.ratios):
        means |= {key: weights for key, weights in zip(LOSS, loss, strict=True) if len(weights)}
    told = {}
    for name, change in estimate.impact(found.problem, h, means, only).items():
        if name in LOSS:
            told[name] = findings.Impact(value=change.value, ci95=change.ci95, unit=LOSS[name], what="loss")
            continue
        s = sensors[name]
        value, low, high = (channels.difference(s, v) for v in (change.value, *change.ci95))
        unit, what = channels.unit_of_difference(s), channels.words(s)
        told[channels.change_name(s)] = findings.Impact(value=value, ci95=(low, high), unit=unit, what=what)
    return told


def remainder(found: Found, decision: Decision) -> findings.Remainder | None:
    """What the library lacks, by channel: beside the most probable hypothesis that holds it."""
    chance = decision.marginal.get(UNEXPLAINED)
    own = [e for h, _ in decision.members.get(UNEXPLAINED, ()) for e in h.extras if e.cause is None]
    if chance is None or chance.probability < LISTED or not own:
        return None
    o, told = found.problem.data, []
    for i, s in enumerate(o.read):
        rows = np.flatnonzero(o.kind == i)
        if s.name in own[0].channels and len(rows):
            rms = float(np.sqrt(np.mean((own[0].size * own[0].columns[rows]) ** 2 @ np.ones(own[0].columns.shape[1]))))
            value = channels.difference(s, rms)
            one = findings.RemainderChannel(channel=s.name, rms=value, unit=channels.unit_of_difference(s))
            told.append((rms / s.repeat_sd, one))
    told.sort(key=lambda item: -item[0])
    return findings.Remainder(
        probability=chance.probability, mc_error=chance.mc_error, channels=tuple(c for _, c in told)
    )


def gain(found: Found, one: Gain) -> findings.Gain:
    """Errors of one channel by one scheme."""
    s = next(s for s in found.problem.data.read if s.name == one.sensor)
    before, after = ([channels.difference(s, v) for v in pair] for pair in (one.before, one.after))
    return findings.Gain(
        scheme=one.scheme,
        channel=one.sensor,
        unit=channels.unit_of_difference(s),
        n=one.n,
        rmse_before=before[0],
        rmse_after=after[0],
        before=findings.Gain.Both.model_validate({"without": before[0], "with": before[1]}),
        after=findings.Gain.Both.model_validate({"without": after[0], "with": after[1]}),
        ratio_ci90=one.ratio,
        noise_floor=channels.difference(s, one.noise),
        rivals={name: channels.difference(s, value) for name, value in one.rivals.items()},
        chosen=one.chosen,
        folds=one.folds,
    )


def gains(found: Found, told: Sequence[Gain]) -> tuple[findings.Gain | None, tuple[findings.Gain, ...]]:
    """The gain in the first thermometer of the oil, else in the first channel, by the first scheme; all others."""
    kinds = {s.name: s.kind for s in found.problem.data.read}
    ranked = sorted(told, key=lambda g: kinds[g.sensor] != "oil_temp")
    made = [gain(found, one) for one in ranked]
    return (made[0] if made else None), tuple(made[1:])
