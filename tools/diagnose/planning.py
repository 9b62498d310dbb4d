"""The plan of a campaign: what its design tells of every cause, and which experiments tell some of them apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...model.errors import DataError
from .answer.design import design
from .answer.experiments import experiments
from .answer.grid import planned_campaign
from .answer.plan import Outlook, Planner, verdict
from .answer.sets import Effects
from .infer.screen import changes, samples
from .report.compose_design import isolability
from .report.plan import Outlook as Shown
from .report.plan import Plan, Planned, PlannedCause, PlannedPair
from .request import PlanInputs, unknown_causes
from .setting import Setting, setting


def planned(inputs: PlanInputs, progress: Callable[[str, float], None]) -> Plan:
    """What a campaign will tell, by exact first-order effects at the rig as in its file.

    Args:
        inputs: what the files of a request hold
        progress: called with (stage, fraction done)

    Raises:
        GearheatError: rig, card and points do not go together
    """
    request = inputs.request
    progress("compiling the rig", 0.05)
    campaign = planned_campaign(inputs.scenario, inputs.card, inputs.points)
    reference = campaign if request.reference else None
    made = setting(inputs.scenario, inputs.card, campaign, reference, request.libraries)
    if problems := unknown_causes(request.causes, [c.id for c in made.causes]):
        raise DataError(problems)
    progress("effects of all causes", 0.3)
    problem = made.problem
    look = problem.look(np.zeros(problem.nz))
    noise = problem.noise(look)
    candidates, _ = samples([f for f in made.formulas if not f.form.spread], changes(problem))
    effects = problem.tangents(look.z, (), candidates)
    effects[:, ~np.isfinite(effects).all(axis=0)] = 0.0
    V = noise.covariance + look.jacobian @ look.jacobian.T
    whole = Effects.of(candidates, effects, V)
    plan = Plan(
        rig=made.scenario.name,
        campaign=campaign.name,
        readings=campaign.n,
        reference=request.reference,
        isolability=isolability(whole),
        warnings=(*inputs.card.warnings, *campaign.warnings),
    )
    if not request.causes:
        return plan
    progress("experiments", 0.6)
    places = [k for k, c in enumerate(candidates) if c.id in request.causes]
    some = [candidates[k] for k in places]
    found = design(made, problem, look, noise, some, effects[:, places], experiments(campaign))
    return _told(plan, made, whole, Planner(found, _seen(request.causes, whole), {c.id: c.like for c in made.causes}))


def _seen(causes: tuple[str, ...], whole: Effects) -> list[str]:
    """Causes that have a size to first order; those that scatter have none."""
    scatter = [c for c in causes if c not in whole.places]
    if scatter:
        raise DataError(f"--separate: {', '.join(scatter)} is a scatter, which a plan does not judge. Leave it out.")
    return list(causes)


def _told(plan: Plan, made: Setting, whole: Effects, planner: Planner) -> Plan:
    """The plan with experiments."""
    now, single = planner.now, planner.single()
    together = planner.together(single)
    known = {c.id: c for c in made.causes}
    causes = tuple(
        PlannedCause(
            id=name,
            size=known[name].size.name,
            usual=known[name].size.sd,
            unit=known[name].size.unit,
            visible=whole.visible(name),
            exposes=known[name].exposes,
        )
        for name in planner.design.seen().places
    )
    pairs = tuple(
        PlannedPair(
            causes=p,
            distance=0.0 if p in planner.same else planner.before[p],
            one_answer=planner.same[p].partition(":")[2].strip() or planner.same[p] if p in planner.same else None,
        )
        for p in planner.pairs
    )
    catalogue = tuple(
        Planned(id=e.id, what=e.what, checks=tuple(dict.fromkeys(c.sensor for c in e.checks)))
        for e in planner.design.experiments
    )
    return plan.model_copy(
        update={
            "verdict": verdict(now, single, together),
            "causes": causes,
            "pairs": pairs,
            "now": _shown(planner, now) if now else None,
            "catalogue": catalogue,
            "outlooks": tuple(_shown(planner, o) for o in single),
            "together": tuple(_shown(planner, o) for o in together),
        }
    )


def _shown(planner: Planner, o: Outlook) -> Shown:
    """Some experiments, as the result has them."""
    return Shown(
        experiments=tuple(e.id for e in o.experiments),
        smallest=o.smallest,
        nearest=o.nearest,
        gain=o.gain,
        separates=o.separates,
        pairs=tuple(Shown.Pair(causes=p, before=planner.before[p], after=o.after[p]) for p in planner.open),
    )
