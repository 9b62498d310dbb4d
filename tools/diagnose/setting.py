"""From files to a problem: the rig as the campaign drives it, its causes, everything compiled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ...model.errors import SolveError
from ...model.machines.roles import Roles
from ...model.machines.spec import Spec
from ...scenarios.measured.card import Card
from ...scenarios.measured.lubrication import lubricate, oils_of
from ...scenarios.measured.nominal import Nominal, drive_by
from ...scenarios.measured.table import Campaign
from ...scenarios.nuisances import Nuisance, nuisances
from ...scenarios.scenario import Scenario
from .infer.problem import Problem
from .library.cause import Cause, Ranges
from .library.extras import thin_film_friction
from .library.forms import Context
from .library.registry import library
from .model.formula import Formula
from .model.observe import Observed
from .model.plant import Plant, with_additions

#: Outputs of a part that say what it does.
DOES = ("P_loss", "Q_flow", "Q_flow_convection", "Q_flow_radiation")


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
    causes: tuple[Cause, ...]
    formulas: tuple[Formula, ...]
    problem: Problem

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
    stated = nuisances(roles, card.prior_sd, driven.uncertainties, driven.rules)
    known = tuple(n for n in [*stated, thin_film_friction(Context(roles, ranges, sensors))] if n is not None)
    if reference is not None:
        known = tuple(replace(n, sd=max(n.sd, n.wide), near=1.0) for n in known)
    known = tuple(n for n in known if n.sd > 0)
    day = Nuisance("day", dict.fromkeys(roles.daily, 1.0), 1.0, 1.0)
    names, reads = [s.name for s in sensors], [s.name for s in data.read]
    formulas = tuple(Formula(cause, form, names, reads) for cause in causes for form in cause.forms)
    knobs = dict.fromkeys([p for n in (*known, day) for p in n.paths] + [p for f in formulas for p in f.paths])
    added = [(f.form.parts, f.form.connections) for f in formulas] + [(n.parts, n.connections) for n in known]
    shown = tuple(dict.fromkeys(s.reads for c in campaigns for s in c.read))
    tried = tuple(dict.fromkeys(path for f in formulas for path in f.sized))
    plant = Plant(with_additions(spec, added, knobs), tuple(knobs), [s.reads for s in data.given], shown, tried)
    observed = [Observed(plant, c, (*known, day), oils, point) for c in (data, reference) if c is not None]
    return Setting(scenario, spec, causes, formulas, Problem(observed, card.day_cooling_sd))


def ranges_of(
    spec: Spec, roles: Roles, campaign: Campaign, oils: Mapping[str, Mapping[str, float]], point: Mapping[str, float]
) -> Ranges:
    """Of a campaign on a rig as its file has it.

    Args:
        spec: the rig, driven as the campaign drives it
        roles: of its parts
        campaign: the data
        oils: oil of a test -> values by path
        point: values of inputs that no sensor gives

    Raises:
        SolveError: the rig cannot be run in any test
    """
    flat = spec.flat()
    ends = [f"{end}.{quantity}" for end in roles.ends for quantity in ("w", "tau")]
    shown = [roles.speed, roles.torque, roles.oil, *([roles.viscosity] if roles.viscosity else []), *ends]
    does = {p.name: [path for key in DOES if (path := f"{p.name}.{key}") in flat.index] for p in spec.parts}
    plant = Plant(flat, (), (), tuple(dict.fromkeys([*shown, *(path for paths in does.values() for path in paths)])))
    o = Observed(plant, campaign, (), oils, point)
    values = dict(zip(plant.shown, o.outputs().T, strict=True))
    if not (fine := np.isfinite(values[roles.oil])).any():
        raise SolveError(f"{spec.name}: the rig cannot be run at any point of {campaign.name}. Check its rig file.")
    power = [values[f"{end}.w"] * values[f"{end}.tau"] for end in roles.ends]
    w, tau, T = np.abs(values[roles.speed]), np.abs(values[roles.torque]), values[roles.oil]
    nu = values[roles.viscosity] if roles.viscosity else np.full(campaign.n, 1e-4)
    rooms = [s.name for s in campaign.sensors if s.kind == "ambient"]
    room = o.sensors[rooms[0]] if rooms else np.full(campaign.n, point.get(f"{roles.room}.T", 293.15))
    whole = {"w": w, "tau": tau, "T": T, "nu": nu, "film": w * nu}
    whole |= {s.name: np.abs(o.sensors[s.name]) for s in campaign.sensors}
    whole |= {"order": campaign.progress, "direction": campaign.direction}
    low, mid, high = ({name: float(np.quantile(v[fine], q)) for name, v in whole.items()} for q in (0.05, 0.5, 0.95))
    loss = float(np.median(np.abs(np.sum(power, axis=0)[fine])))
    facts = {"order": np.ptp(campaign.order) > 0, "mounting": len(set(campaign.mounting)) > 1}
    facts |= {"dwell": np.isfinite(campaign.dwell).any(), "humidity": np.isfinite(campaign.humidity).any()}
    facts |= {f"still: {s.name}": campaign.still(s) for s in campaign.read}
    known = frozenset(name for name, holds in facts.items() if holds)
    rise = max(float(np.median((T - room)[fine])), 1.0)
    powers = {part: sum(float(np.median(np.abs(values[p][fine]))) for p in paths) for part, paths in does.items()}
    return Ranges(low, mid, high, max(loss, 1e-3), rise, known, powers)
