"""What may differ from the rig file without being a fault: groups of parameters with priors, found by roles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.machines.roles import Roles
from ..model.machines.spec import PartSpec
from .scenario import Scenario

#: Relative standard deviations where neither card nor rig file says more, by the key of a card.
DEFAULT_SD: Mapping[str, float] = {
    "mu": 0.10,
    "brg": 0.12,
    "seal": 0.15,
    "hconv": 0.08,
    "rad": 0.08,
    "gow": 0.20,
    "gwh": 0.20,
    "cap": 0.10,
}

#: Least share of what a rule leaves open by which a value deviates where the rule holds.
NEAREST = 0.05


@dataclass(frozen=True)
class Nuisance:
    """What may differ from the rig file without being a fault: parameters whose logarithm changes by sd times z.

    Args:
        name: in words
        paths: parameter -> exponent; its value is base * exp(exponent * sd * z)
        sd: prior standard deviation of the logarithm
        wide: the same where a healthy reference campaign of the same rig tells the parameters
        refilled: whether another filling or mounting changes it, by half of its sd
        by_oil: whether it is another one with each oil
        near: share of the standard deviation by which it deviates where a rule holds that gives it; 1 without a rule.
            A rule that does not hold leaves the law open, too
        parts, connections: what is added to the machine for it, neutral
    """

    name: str
    paths: Mapping[str, float]
    sd: float
    wide: float
    refilled: bool = False
    by_oil: bool = False
    near: float = 1.0
    parts: tuple[PartSpec, ...] = ()
    connections: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class Group:
    """Parameters that differ together.

    Args:
        name: in words
        key: of the card
        wide: standard deviation where a healthy campaign tells them
        paths: roles of a machine -> parameters
        share: of the key's standard deviation
        refilled: whether another filling or mounting changes them
        by_oil: whether they are others with each oil
    """

    name: str
    key: str
    wide: float
    paths: Callable[[Roles], Sequence[str]]
    share: float = 1.0
    refilled: bool = False
    by_oil: bool = False


def _to(roles: Roles, bodies: Sequence[str]) -> list[str]:
    """Conductors on the oil's side that meet one of the bodies."""
    return [c for c in roles.oil_side if any(roles.at(p, "body") in bodies for p in roles.bodies_of(c))]


def _oil_inside(roles: Roles) -> Sequence[str]:
    hot = {roles.at(place.inner, "body") for place in roles.places["teeth"]}
    return roles.scaled(*_to(roles, [b for b in hot if b]))


def _oil_outside(roles: Roles) -> Sequence[str]:
    return [p for p in roles.scaled(*roles.oil_side) if p not in _oil_inside(roles)]


def _flow_of_fans(roles: Roles) -> Sequence[str]:
    return [path for paths in roles.failing("cooling.fan").values() for path, e in paths.items() if e == 1]


def _of_surfaces(roles: Roles, key: str) -> Sequence[str]:
    return [f"{name}.{key}" for name in roles.surfaces]


def _outer_area(roles: Roles) -> Sequence[str]:
    return [p for p in roles.scaled(*roles.surfaces) if p not in _of_surfaces(roles, "k_conv")]


#: All groups. Of the foundation a card says nothing, so it has half of what convection has; areas are known unless card
#: or rig file say that they are not.
GROUPS: tuple[Group, ...] = (
    Group("mesh friction", "mu", 0.4, lambda r: r.scaled(*r.parts("teeth")), by_oil=True),
    Group("bearing loss", "brg", 0.4, lambda r: r.scaled(*r.parts("bearing")), by_oil=True),
    Group("seal loss", "seal", 0.5, lambda r: r.scaled(*r.parts("seal")), by_oil=True),
    Group("churning", "seal", 0.5, lambda r: r.scaled(*r.having("churning")), refilled=True, by_oil=True),
    Group("radiation", "rad", 0.6, lambda r: _of_surfaces(r, "emissivity")),
    Group("oil to what turns", "gow", 0.6, _oil_inside, refilled=True),
    Group("oil to other bodies", "gow", 0.6, _oil_outside, refilled=True),
    Group("between bodies", "gwh", 0.6, lambda r: r.scaled(*r.contacts, *r.walls)),
    Group("capacities", "cap", 0.5, lambda r: r.scaled(*r.inside, *r.outside, *r.having("bath"))),
    Group("capacities inside", "cap", 0.5, lambda r: r.scaled(*r.inside)),
    Group("coolers", "hconv", 0.7, lambda r: r.scaled(*r.coolers)),
    Group("foundation", "hconv", 0.7, lambda r: r.scaled(*r.foundation), share=0.5),
    Group("outer area", "hconv", 0.0, _outer_area, share=0.0),
    Group("convection", "hconv", 0.6, lambda r: _of_surfaces(r, "k_conv")),
    Group("flow of fans", "hconv", 0.6, _flow_of_fans, share=0.0),
)


def nuisances(
    roles: Roles, prior_sd: Mapping[str, float], uncertainties: Mapping[str, float], rules: Mapping[str, float] = {}
) -> tuple[Nuisance, ...]:
    """All groups that the machine has, each with its prior.

    Args:
        roles: of the machine
        prior_sd: of the card: relative standard deviations by "mu", "PartType.parameter" or "part.parameter"
        uncertainties: path -> standard uncertainty that the rig file states, in SI; what the card says counts more
        rules: the same of what rules give, which may hold, too
    """
    kinds = {p.name: p.type for p in roles.spec.parts}

    def sd_of(group: Group, path: str, stated: float | None) -> float:
        """Standard deviation of one parameter: the card's own, the rig file's, or that of the group."""
        part, _, key = path.partition(".")
        for known in (path, f"{kinds[part]}.{key}"):
            if known in prior_sd:
                return prior_sd[known]
        if stated and group.key not in prior_sd:
            return float(abs(stated / roles.value(path)))
        return group.share * prior_sd.get(group.key, DEFAULT_SD[group.key])

    found: list[Nuisance] = []
    for group in GROUPS:
        paths = [path for path in group.paths(roles) if roles.value(path)]  # zero stays zero
        if paths:
            sds = [sd_of(group, path, rules.get(path, uncertainties.get(path))) for path in paths]
            most, near = max(sds), max(sd_of(group, path, uncertainties.get(path)) for path in paths)
            exponents = {path: sd / most if most else 1.0 for path, sd in zip(paths, sds, strict=True)}
            share = float(np.clip(near / most, NEAREST, 1.0)) if most else 1.0
            found.append(Nuisance(group.name, exponents, most, group.wide, group.refilled, group.by_oil, share))
    return tuple(found)


def usual_priors(scenario: Scenario) -> dict[str, float]:
    """Relative standard deviation by part type and parameter, and of single parts that differ; stated ones count.

    What the rig file says of values together stays with it.
    """
    kinds = {part.name: part.type for part in scenario.spec.parts}
    own: dict[str, float] = {}
    for nuisance in nuisances(Roles.of(scenario.spec), {}, scenario.uncertainties):
        for path, exponent in nuisance.paths.items() if nuisance.sd else ():
            own.setdefault(path, float(f"{nuisance.sd * exponent:.4g}"))
    found: dict[str, float] = {}
    rough = scenario.rough
    names = {path: f"{kinds[part]}.{key}" for path in (*own, *rough) for part, _, key in [path.partition(".")]}
    together = {names[path] for path in rough}
    for path, sd in own.items():
        if path not in rough and (names[path] in together or found.setdefault(names[path], sd) != sd):
            found[path] = sd
    return found
