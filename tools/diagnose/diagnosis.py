"""The whole diagnosis: search, decide, and everything that the report shows; the whole plan: what a design tells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...model.errors import DataError
from .answer import compose, pictures
from .answer.channels import channel
from .answer.decide import Decision, decide, temper
from .answer.design import Effects, judge_design, simulate_design
from .answer.estimate import impacts, replay
from .answer.experiments import list_experiments, planned_campaign
from .answer.findings import About, Alarm, Findings, Gain, Invisible
from .answer.gain import measure_gains
from .answer.plan import Plan, rank_experiments
from .answer.predict import predict
from .answer.quality import average_residuals, check_data
from .infer.evidence import White
from .infer.found import Found
from .infer.screen import screened
from .infer.weigh import Options, Progress, weigh
from .library.cause import Cause
from .logs import LogDiagnosis, logged
from .report.extension import calibrated, rig_file
from .report.words import with_words
from .request import Inputs, PlanInputs, unknown_causes
from .setting import Setting, setting

#: Probability from which a cause that only logs can show is told.
ALONE = 0.1
#: What is said of a rig whose values are so.
ROUGHLY = "values of this rig follow from rules and count as uncertain as its file says; a healthy reference tells more"
#: Standard deviations at the usual size below which no reading moves with a cause.
BLIND = 0.01
#: The same from which the readings show it, whatever sensors they lack.
PLAIN = 1.0


def diagnose(inputs: Inputs, progress: Progress) -> Findings:
    """What the data of a request say; progress is called with (stage, fraction done).

    Raises:
        GearheatError: rig, card and data do not go together
    """
    request, data = inputs.request, inputs.data
    share = 0.5 if request.logs and data is not None else float(data is None)
    logs = logged(inputs, lambda stage, done: progress(stage, share * done)) if request.logs else None
    if logs and data is None:
        progress("done", 1.0)
        return logs.findings.model_copy(update={"warnings": (*logs.findings.warnings, *inputs.warnings)})
    assert data is not None, "a request has readings or logs"

    def then(stage: str, done: float) -> None:
        progress(stage, share + (1 - share) * done)

    then("compiling the rig", 0.01)
    others = [inputs.points] if inputs.points is not None else []
    made = setting(inputs.scenario, inputs.card, data, inputs.reference, request.libraries, others)
    options = Options(request.alpha, request.seed, request.causes, logs.causes if logs else ())
    found = temper(weigh(made.problem, made.formulas, options, lambda stage, done: then(stage, 0.05 + 0.75 * done)))
    if logs:
        asked = {cause.id: logs.asked(cause) for cause in made.causes}
        found = found.beside(lambda causes: logs.found.log_bayes_factor(asked[c] for c in causes))
    decision = decide(found)
    held: Sequence[Gain] = ()
    if decision.verdict != "consistent" and not request.quick:
        held = measure_gains(found, options, lambda done: then("readings left out", 0.82 + 0.13 * done))
    then("what was found", 0.95)
    findings = _composed(inputs, made, found, decision, held)
    progress("done", 1.0)
    return with_words(_with_logs(findings, logs, made.causes) if logs else findings)


def _with_logs(findings: Findings, logs: LogDiagnosis, causes: Sequence[Cause]) -> Findings:
    """The findings on readings and their causes with which logs were asked, too, and what these say alone."""
    of, known = logs.findings.about, {cause.id for cause in causes}
    said = [f"the logs alone: {logs.findings.says.verdict}", *logs.findings.warnings]
    lacking = [c for c in logs.causes if c not in known and logs.of(c) > ALONE]
    said += [f"the logs speak for {c} ({logs.of(c):.0%}), which no reading of the table shows" for c in lacking]
    about = findings.about.model_copy(update={"logs": of.logs, "log_rows": of.log_rows, "segments": of.segments})
    return findings.model_copy(update={"about": about, "warnings": (*findings.warnings, *said)})


def _composed(inputs: Inputs, made: Setting, found: Found, decision: Decision, held: Sequence[Gain]) -> Findings:
    """The findings without their words."""
    request, data, leader = inputs.request, found.problem.data.campaign, decision.leader
    reference, wrong = inputs.reference, decision.verdict != "consistent"
    rows, isolability = pictures.rows(found, leader), judge_design(Effects(found.first.candidates, found.first.white))
    seen = "thermometers" if all(s.kind.endswith("_temp") for s in data.read) else "readings"
    extended, cut = rig_file(made, found, leader)
    roughly = [ROUGHLY] if any(n.near < 1 for n in found.problem.data.nuisances) else []
    hidden = {one.cause: f"not visible in these {seen}" for one in isolability if one.visible < BLIND}
    plain = {one.cause for one in isolability if one.visible >= PLAIN}
    hidden |= {cause: why for cause, why in inputs.invisible.items() if cause not in plain}
    return Findings(
        **compose.common(made, found, decision),
        about=About(
            data=data.name,
            rig=made.scenario.name,
            readings=int((data.lines > 0).sum()),  # else a row that a test lacks
            tests=data.n_tests,
            reference=reference.name if reference else "",
            reference_readings=int((reference.lines > 0).sum()) if reference else 0,
            seed=request.seed,
        ),
        test=Alarm(
            alpha=request.alpha,
            p_any=decision.p_any,
            p_omnibus=found.p_omnibus,
            p_adequacy=decision.p_adequacy,
            draws=len(found.drawn),
        ),
        data_quality=check_data(found, leader),
        impact=impacts(found.problem, leader, made.nominal.ratios),
        gain=held[0] if held else None,
        gain_grouped=tuple(held[1:]),
        channels=tuple(channel(s) for s in data.sensors),
        played=replay(found.problem, found.null, leader),
        next_experiment=compose.next_experiments(made, found, decision) if wrong and not request.quick else (),
        isolability=isolability,
        residuals=average_residuals(found),
        rows=rows,
        views=pictures.views(found),
        pictures=pictures.pictures(found, leader, rows.quantities),
        calibrated=calibrated(made, found, leader),
        extended_rig=extended,
        predictions=predict(found, inputs.points) if inputs.points else (),
        invisible=tuple(Invisible(cause=cause, reason=why) for cause, why in hidden.items()),
        warnings=(*roughly, *inputs.warnings, *(f"in the extended rig {line}" for line in cut)),
    )


def plan(inputs: PlanInputs, progress: Progress) -> Plan:
    """What a campaign will tell, by exact first-order effects at the rig as in its file; progress as of `diagnose`.

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
    white = White.of(noise.covariance + look.jacobian @ look.jacobian.T)
    sized = [f for f in made.formulas if not f.form.spread]
    first = screened(problem, look, (white, np.zeros(problem.m)), sized)  # as if the readings were as simulated
    whole = Effects(first.candidates, first.white)
    common: dict[str, Any] = {
        "rig": made.scenario.name,
        "campaign": campaign.name,
        "readings": campaign.n,
        "reference": request.reference,
        "isolability": judge_design(whole),
        "warnings": (*inputs.card.warnings, *campaign.warnings),
    }
    if not request.causes:
        return Plan(**common)
    progress("experiments", 0.6)
    if scatter := [c for c in request.causes if c not in whole.places]:  # they have no size to first order
        raise DataError(f"--separate: {', '.join(scatter)} is a scatter, which a plan does not judge. Leave it out.")
    experiments = list_experiments(campaign, made.nominal.value)
    found = simulate_design(problem, look, noise, first, request.causes, experiments)
    return rank_experiments(found, request.causes, {c.id: c for c in made.causes}, common, whole)
