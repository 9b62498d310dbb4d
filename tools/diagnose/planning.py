"""The plan of a campaign: what its design tells of every cause, and which experiments tell some of them apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...model.errors import DataError
from .answer.design import Effects, design, isolability
from .answer.experiments import experiments
from .answer.grid import planned_campaign
from .answer.plan import Plan, rank_experiments
from .infer.screen import changes, samples
from .request import PlanInputs, unknown_causes
from .setting import setting


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
    common: dict[str, Any] = {
        "rig": made.scenario.name,
        "campaign": campaign.name,
        "readings": campaign.n,
        "reference": request.reference,
        "isolability": isolability(whole),
        "warnings": (*inputs.card.warnings, *campaign.warnings),
    }
    if not request.causes:
        return Plan(**common)
    progress("experiments", 0.6)
    if scatter := [c for c in request.causes if c not in whole.places]:  # they have no size to first order
        raise DataError(f"--separate: {', '.join(scatter)} is a scatter, which a plan does not judge. Leave it out.")
    places = [k for k, c in enumerate(candidates) if c.id in request.causes]
    some = [candidates[k] for k in places]
    found = design(made, problem, look, noise, some, effects[:, places], experiments(campaign, made.nominal.value))
    return rank_experiments(found, request.causes, {c.id: c for c in made.causes}, common, whole)
