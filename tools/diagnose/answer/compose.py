"""From what a search found to the result as data: hypotheses, causes, impact, remainder, what to measure next."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ..infer.found import Found
from ..library.cause import Cause
from ..setting import Setting
from . import channels, estimate, findings
from .decide import Chance, Decision
from .design import Effects, find_alike, rank, simulate_design
from .experiments import list_experiments

#: Hypotheses that are listed.
MOST = 12
#: The least probability of one.
LISTED = 0.005
#: Causes between which experiments are judged.
JUDGED = 4
#: The least weight of one.
LEAST = 0.02
#: Of errors of several instruments of a kind.
PROPORTION = ", of the one that reads most, others in proportion"
#: Experiments that are listed.
TRIED = 6


def common(made: Setting, found: Found, decision: Decision) -> dict[str, Any]:
    """What the findings on readings and on logs have alike: the verdict, and what it follows from."""
    told = sets(made.causes, found, decision) if decision.verdict != "consistent" else ()
    # the most probable ones, nothing always among them
    listed = [j for k, j in enumerate(decision.joints) if not j.causes or (k < MOST and j.chance.probability > LISTED)]
    return {
        "verdict": decision.verdict,
        "hypotheses": tuple(findings.Hypothesis(causes=j.causes, **asdict(j.chance)) for j in listed),
        "answers": tuple(findings.Answer(causes=j.classes, **asdict(j.chance)) for j in decision.answers),
        "causes": causes(made, found, decision),
        "remainder": remainder(found, decision),
        "sets": told,
        "confusable": tuple(s.causes for s in told),
    }


def causes(made: Setting, found: Found, decision: Decision) -> tuple[findings.Cause, ...]:
    """All causes, most probable first."""
    smallest, chances = estimate.find_detectable(found), defaultdict(lambda: Chance(0.0, 0.0), decision.marginal)
    told = [findings.Cause(id=findings.UNEXPLAINED, **asdict(chances[findings.UNEXPLAINED]))]
    for cause in made.causes:
        known: dict[str, Any] = {"doc": cause.doc, "exposes": cause.exposes, "like": cause.like}
        known["meaning"] = cause.size.doc + (PROPORTION if any(f.scale != 1 for f in cause.forms) else "")
        known["unit"], (known["usual"],) = estimate.convert(cause.size, [cause.size.sd])
        if cause.id in smallest:
            _, (known["detectable"],) = estimate.convert(cause.size, [smallest[cause.id]])
        known |= _sized(made, cause.id, found, decision) if chances[cause.id].probability > LISTED else {}
        told.append(findings.Cause(id=cause.id, **asdict(chances[cause.id]), **known))
    return tuple(sorted(told, key=lambda c: (-c.probability, c.id)))


def _sized(made: Setting, cause: str, found: Found, decision: Decision) -> dict[str, Any]:
    """Size, shapes and forms of a cause, and what it alone changes."""
    members = decision.members[cause]
    shares = estimate.form_shares(cause, members)
    own: dict[str, Any] = {
        "parameters": estimate.estimate_cause(found, cause, members),
        "forms": [findings.FormShare(name=name, share=share) for name, share in shares.items() if share > LISTED],
    }
    acting = next(((h, a) for h, _ in members for a in h.fit.look.acting if a.id == cause), None)
    if acting is not None:
        h, one = acting
        form, theta = one.formula.form, one.formula.theta(one.t)
        own["regime"] = estimate.regime(form, theta)
        if form.regime.get("quantity") == "order above":
            own["since"] = estimate.first_test(found.problem.data.campaign, theta[form.regime["shape"]])
        own["impact"] = estimate.impacts(found.problem, h, made.nominal.ratios, cause)
    return own


def remainder(found: Found, decision: Decision) -> findings.Remainder | None:
    """What the library lacks, by channel: beside the most probable hypothesis that holds it."""
    chance = decision.marginal.get(findings.UNEXPLAINED)
    if chance is None or chance.probability < LISTED:
        return None
    beside = (e for h, _ in decision.members[findings.UNEXPLAINED] for e in h.extras if e.cause is None)
    own, told = next(beside), []
    columns = own.size * own.of.columns[found.problem.own]
    for _, s, mine in channels.compared(found.problem.data):
        if s.name in own.of.channels:
            rms = float(np.sqrt(np.mean((columns[mine] ** 2).sum(axis=1))))
            value = channels.difference(s, rms)
            one = findings.RemainderChannel(channel=s.name, rms=value, unit=channels.unit_of_difference(s))
            told.append((rms / s.repeat_sd, one))
    told.sort(key=lambda item: -item[0])
    return findings.Remainder(channels=tuple(c for _, c in told), **asdict(chance))


def leading(decision: Decision) -> list[str]:
    """Causes by their probability, those of the answers first."""
    named = [c for a in decision.answers for group in a.classes for c in group]
    others = sorted(decision.marginal, key=lambda c: -decision.marginal[c].probability)
    return [c for c in dict.fromkeys([*named, *others]) if c != findings.UNEXPLAINED]


def sets(library: Sequence[Cause], found: Found, decision: Decision) -> tuple[findings.CauseSet, ...]:
    """For each leading cause those the design cannot tell from it, at its usual size or as found, with its sign."""
    effects, like = Effects(found.first.candidates, found.first.white), {c.id: c.like for c in library}
    told = []
    for cause in leading(decision)[:JUDGED]:
        best, _ = decision.members[cause][0]
        size = next((float(a.t[0]) for a in best.fit.look.acting if a.id == cause), 1.0)
        told.append(find_alike(effects, cause, float(np.copysign(max(abs(size), 1.0), size)), like))
    return tuple(s for s in told if s is not None)


def next_experiments(setting: Setting, found: Found, decision: Decision) -> tuple[findings.Experiment, ...]:
    """Experiments by what they add to the distances between the leading causes."""
    known = {c.id for c in found.first.candidates}
    asked = list(dict.fromkeys(group[0] for a in decision.answers for group in a.classes if group[0] in known))
    causes = (asked if len(asked) > 1 else [c for c in leading(decision) if c in known])[:JUDGED]
    if len(causes) < 2:
        return ()
    weights = {c: max(decision.marginal[c].probability, LEAST) for c in causes}
    tried = list_experiments(found.problem.data.campaign, setting.nominal.value)
    made = simulate_design(found.problem, found.null.look, found.null.noise, found.first, causes, tried)
    return tuple(rank(made, weights)[:TRIED])
