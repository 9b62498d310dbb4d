"""The whole diagnosis: search, decide, and everything that the report shows."""

from __future__ import annotations

from collections.abc import Callable

from .answer.decide import decided
from .answer.gain import gains
from .infer.search import searched
from .logs import diagnosed_logs
from .report import compose, compose_data, compose_pictures, compose_points, compose_rig
from .report.channels import channel
from .report.findings import Findings
from .report.words import with_words
from .request import Inputs
from .setting import setting

Progress = Callable[[str, float], None]


def diagnosed(inputs: Inputs, progress: Progress) -> Findings:
    """What the data of a request say.

    Args:
        inputs: what its files hold
        progress: told of each stage and the share done

    Raises:
        GearheatError: rig, card and data do not go together
    """
    request, data = inputs.request, inputs.data
    if data is None:
        return diagnosed_logs(inputs, progress)
    progress("compiling the rig", 0.01)
    others = [inputs.points] if inputs.points is not None else []
    made = setting(inputs.scenario, inputs.card, data, inputs.reference, request.libraries, others)
    found = searched(
        made.problem,
        made.formulas,
        request.alpha,
        request.seed,
        request.causes,
        lambda stage, share: progress(stage, 0.05 + 0.75 * share),
    )
    decision = decided(found)
    told = (
        []
        if decision.verdict == "consistent"
        else gains(found, request.seed, lambda s: progress("held-out readings", 0.82 + 0.13 * s))
    )
    gain, grouped = compose.gains(found, told)
    progress("what was found", 0.95)
    leader = decision.leader
    rows = compose_data.rows(found, leader)
    findings = Findings(
        verdict=decision.verdict,
        about=compose.about(data, made.scenario.name, inputs.reference, request.seed),
        test=compose.alarm(found, decision, request.alpha),
        hypotheses=compose.hypotheses(decision),
        answers=compose.answers(decision.answers),
        causes=compose.causes(made.causes, found, decision),
        remainder=compose.remainder(found, decision),
        data_quality=compose_data.data_quality(made, found, leader).model_copy(
            update={"repeated": compose_points.repeated(found)}
        ),
        impact=compose.impacts(found, leader),
        channels=tuple(channel(s) for s in data.sensors),
        gain=gain,
        gain_grouped=grouped,
        rows=rows,
        pictures=compose_pictures.pictures(found, leader, rows.quantities),
        calibrated=compose_rig.calibrated(made, found, leader),
        extended_rig=compose_rig.rig_file(made, found, leader),
        predictions=compose_points.predictions(made, found, leader, inputs.points) if inputs.points else (),
        warnings=inputs.warnings,
    )
    progress("done", 1.0)
    return with_words(findings)
