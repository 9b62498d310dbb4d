"""From what a search found to the result as data: what these data can tell, and what to measure next."""

from __future__ import annotations

from collections.abc import Sequence

from ..answer import estimate
from ..answer.decide import UNEXPLAINED, Decision
from ..answer.design import Ranked, of_search, ranked
from ..answer.experiments import experiments
from ..answer.sets import Effects, alike
from ..infer.found import Found
from ..library.cause import Cause
from ..setting import Setting
from . import channels, findings

#: Causes between which experiments are judged.
JUDGED = 4
#: The least weight of one.
LEAST = 0.02
#: Experiments that are listed.
LISTED = 6


def leading(decision: Decision) -> list[str]:
    """Causes by their probability, those of the answers first."""
    named = [c for a in decision.answers for group in a.classes for c in group if c != UNEXPLAINED]
    others = sorted(decision.marginal, key=lambda c: -decision.marginal[c].probability)
    return list(dict.fromkeys([*named, *(c for c in others if c != UNEXPLAINED)]))


def seen(found: Found) -> Effects:
    """The causes as the data see them at the calibrated rig."""
    return Effects(found.first.candidates, found.first.white)


def sets(library: Sequence[Cause], found: Found, decision: Decision) -> tuple[findings.CauseSet, ...]:
    """For each leading cause those that the design cannot tell from it, at its usual size or as found if larger."""
    effects, like = seen(found), {c.id: c.like for c in library}
    told = []
    for cause in leading(decision)[:JUDGED]:
        members = decision.members.get(cause, ())
        sizes = [abs(a.t[0]) for h, _ in members[:1] for a in h.fit.look.acting if a.id == cause]
        if (one := alike(effects, cause, max([1.0, *sizes]), like)) is not None:
            told.append(findings.CauseSet(causes=one.causes, distance=one.distance, reason=one.reason))
    return tuple(told)


def isolability(effects: Effects) -> tuple[findings.Isolability, ...]:
    """What the design says of every cause of usual size."""
    told = []
    for cause in effects.places:
        near = effects.nearest(cause)
        name, distance = near if near else ("", None)
        told.append(findings.Isolability(cause=cause, visible=effects.visible(cause), nearest=name, distance=distance))
    return tuple(sorted(told, key=lambda i: -i.visible))


def next_experiments(setting: Setting, found: Found, decision: Decision) -> tuple[findings.Experiment, ...]:
    """Experiments by what they add to the distances between the leading causes."""
    places = seen(found).places
    causes = [c for c in leading(decision) if c in places][:JUDGED]
    if len(causes) < 2:
        return ()
    weights = {c: max(decision.marginal[c].probability if c in decision.marginal else 0.0, LEAST) for c in causes}
    made = of_search(setting, found, causes, experiments(found.problem.data.campaign))
    return tuple(experiment(r) for r in ranked(made, weights)[:LISTED])


def experiment(one: Ranked) -> findings.Experiment:
    """A proposed measurement."""
    e = one.experiment
    return findings.Experiment(
        id=e.id, what=e.what, separates=one.pair, separation_before=one.before, separation_after=one.after
    )


def played(found: Found, decision: Decision) -> dict[str, findings.Played]:
    """What the calibrated and the extended rig leave on the data."""
    told = {}
    known = {s.name: s for s in found.problem.data.read}
    for name, rms in estimate.played(found.problem, found.null, decision.leader).items():
        calibrated, extended = (channels.difference(known[name], v) for v in rms)
        unit = channels.unit_of_difference(known[name])
        told[name] = findings.Played(rms_calibrated=calibrated, rms_extended=extended, unit=unit)
    return told
