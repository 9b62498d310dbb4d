"""A search as findings: everything but what is decided, compared and designed, which comes from the answer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...scenarios.scenario import Scenario
from ..infer.search import Found
from . import fill_causes, fill_quality, fill_rows
from .findings import About, Alarm, Findings
from .quality import DataQuality, GrossReading
from .words import with_words


def filled(
    found: Found,
    scenario: Scenario,
    alpha: float,
    detectable: Mapping[str, float],
    gross: tuple[GrossReading, ...] = (),
    **decided: Any,
) -> Findings:
    """The findings, with their words.

    Args:
        found: the search
        scenario: the rig
        alpha: accepted rate of false alarms
        detectable: cause -> smallest size that would be found [SI]
        gross: readings that are set aside
        decided: `verdict`, `answers` and further fields of `Findings`
    """
    problem, best = found.problem, found.hypotheses[0]
    p_adequacy, by_channel = fill_quality.adequacy(problem, best)
    acting = {a.id: a for a in best.fit.look.acting}
    causes = tuple(
        c.model_copy(update={"impact": fill_rows.impact(problem, best.fit, [acting[c.id]])}) if c.id in acting else c
        for c in fill_causes.causes(found, detectable)
    )
    campaign = problem.data.campaign
    reference = problem.campaigns[1].campaign if len(problem.campaigns) > 1 else None
    made: dict[str, Any] = {
        "about": About(
            data=campaign.name,
            rig=scenario.name,
            readings=campaign.n,
            tests=campaign.n_tests,
            reference=reference.name if reference else "",
            reference_readings=reference.n if reference else 0,
        ),
        "test": Alarm(alpha=alpha, p_any=found.p_any, p_omnibus=found.p_omnibus, p_adequacy=p_adequacy),
        "hypotheses": fill_causes.hypotheses(found),
        "causes": causes,
        "remainder": fill_causes.remainder(found),
        "data_quality": DataQuality(
            gross=gross,
            nuisances=fill_quality.nuisances_off(problem, best.fit),
            variance=fill_quality.variance(problem, best.fit),
            repeated=fill_quality.repeated(problem, found.null),
            adequacy=by_channel,
        ),
        "impact": fill_rows.impact(problem, best.fit),
        "channels": fill_rows.channels(campaign),
        "rows": fill_rows.rows(problem, found.null, best.fit),
        "pictures": fill_rows.pictures(problem, best.fit),
        "calibrated": fill_quality.calibrated(problem, found.null, best.fit, scenario),
        "warnings": campaign.warnings,
    }
    return with_words(Findings(**(made | decided)))
