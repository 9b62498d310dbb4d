"""From files to a problem: the rig as the campaign drives it, its causes, everything compiled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from ...model.machines.roles import Roles
from ...model.machines.spec import Spec
from ...scenarios.measured.card import Card
from ...scenarios.measured.lubrication import lubricate, oils_of
from ...scenarios.measured.nominal import Nominal
from ...scenarios.measured.sensors import drive_by
from ...scenarios.measured.table import Campaign
from ...scenarios.nuisances import Nuisance, nuisances
from ...scenarios.scenario import Scenario
from .infer.problem import Problem
from .library.cause import Cause
from .library.forms import Context
from .library.registry import library
from .library.thin_films import thin_film_friction
from .model.formula import Formula
from .model.observe import Observed
from .model.plant import Plant
from .model.ranges import ranges_of


@dataclass(frozen=True)
class Setting:
    """A rig, its causes and its campaigns, ready to be searched.

    Args:
        scenario: the rig as its file has it
        spec: driven and lubricated as in the campaign
        formulas: all forms of all causes
        problem: data, and a reference where there is one
    """

    scenario: Scenario
    spec: Spec
    card: Card
    causes: tuple[Cause, ...]
    formulas: tuple[Formula, ...]
    plant: Plant
    problem: Problem
    oils: dict[str, dict[str, float]]

    @cached_property
    def nominal(self) -> Nominal:
        """Steady states of the rig as its file has it."""
        return Nominal(drive_by(self.scenario, self.problem.data.campaign.sensors))


def setting(
    scenario: Scenario,
    card: Card,
    data: Campaign,
    reference: Campaign | None = None,
    libraries: Sequence[Path] = (),
    others: Sequence[Campaign] = (),
) -> Setting:
    """Everything compiled.

    Args:
        scenario: the rig
        card: what is known of campaign and instruments
        data: the campaign in which causes act
        reference: a healthy campaign of the same rig with the same instruments
        libraries: files with further causes
        others: further campaigns whose oils must be known

    Raises:
        GearheatError: rig, card and data do not go together
    """
    driven = drive_by(scenario, data.sensors)
    spec = lubricate(driven.spec, card.lubrication)
    roles = Roles.of(spec)
    campaigns = [c for c in (data, reference, *others) if c is not None]
    oils = oils_of(driven, card, [name for c in campaigns for name in c.oil])
    point = driven.operating_point
    ranges = ranges_of(spec, roles, data, oils, point)
    sensors = data.sensors
    causes = library(roles, ranges, sensors, libraries)
    wide = reference is not None
    films = thin_film_friction(Context(roles, ranges, sensors))
    known = (*nuisances(roles, card.prior_sd, driven.uncertainties), *([films] if films else ()))
    known = tuple(replace(n, sd=n.wide) if wide else n for n in known if wide or n.sd > 0)
    day = Nuisance("day", dict.fromkeys(roles.daily, 1.0), 1.0, 1.0)
    names, reads = [s.name for s in sensors], [s.name for s in data.read]
    formulas = tuple(Formula(cause, form, names, reads) for cause in causes for form in cause.forms)
    knobs = dict.fromkeys([p for n in (*known, day) for p in n.paths] + [p for f in formulas for p in f.paths])
    forms = [f.form for f in formulas]
    shown = tuple(dict.fromkeys(s.reads for c in campaigns for s in c.read))
    tried = tuple(dict.fromkeys(path for f in formulas for path in f.sized))
    plant = Plant.of(spec, [*forms, *known], tuple(knobs), [s.reads for s in data.given], shown, tried)
    observed = [Observed(plant, c, (*known, day), oils, point) for c in (data, reference) if c is not None]
    problem = Problem(observed, card.day_cooling_sd)
    return Setting(scenario, spec, card, causes, formulas, plant, problem, oils)
