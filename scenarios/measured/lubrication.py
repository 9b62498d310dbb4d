"""Which lubricant reaches which parts, and the oils of the tests: what a card says beside rig file and catalogue."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from ...model.errors import DataError, Problems, suggestion
from ...model.machines.roles import Roles
from ...model.machines.spec import Spec
from ..scenario import Scenario
from .card import Card
from .oils import oil_values

#: What a card calls groups of parts.
GROUPS = ("gears", "bearings", "needles", "seals")
LUBRICANTS = {"oil": "bath", "grease": "grease"}


def lubricated(spec: Spec, lubrication: Mapping[str, str]) -> Spec:
    """The machine with parts connected to the lubricants that a card names.

    Args:
        spec: the machine
        lubrication: part, part type or group of parts -> "oil" or "grease"; what is left out stays as it is

    Raises:
        DataError: unknown parts or lubricants, or a lubricant that the machine does not have
    """
    if not lubrication:
        return spec
    roles, moved, problems = Roles.of(spec), dict[str, str](), Problems()
    for name, lubricant in lubrication.items():
        parts = _parts(roles, name)
        sources = roles.having(LUBRICANTS.get(lubricant, ""))
        if parts is None:
            known = (*GROUPS, *(p.name for p in spec.parts))
            problems.append(f'card lubrication: unknown part "{name}".{suggestion(name, known)}')
        elif lubricant not in LUBRICANTS:
            problems.append(f'card lubrication: {name} = "{lubricant}" is not known. Write "oil" or "grease".')
        elif lubricant == "grease" and set(parts) & set(roles.having("teeth")):
            problems.append(f'card lubrication: {name} = "grease" is not modelled. The teeth run in the oil.')
        elif not sources and any(roles.nets.ports_of_lubricant(p) for p in parts):
            problems.append(f"card lubrication: {spec.name} has no {lubricant}. Leave out {name}.")
        else:
            ports = [port for p in parts for port in roles.nets.ports_of_lubricant(p)]
            moved |= {port: roles.nets.ports_of_lubricant(sources[0])[0] for port in ports if sources}
    problems.check(DataError)
    nets = []
    for net in spec.connections:
        users = [port for port in net if port not in moved]
        nets.append((*users, *(port for port, source in moved.items() if source in users)))
    return replace(spec, connections=tuple(net for net in nets if len(net) > 1))  # a lubricant without users goes


def _parts(roles: Roles, name: str) -> tuple[str, ...] | None:
    """The parts that a card means; None for an unknown name."""
    kinds = {p.name: p.type for p in roles.spec.parts}
    needles = tuple(p for p in roles.having("bearing") if kinds[p] == "NeedleBearing")
    groups = {
        "gears": roles.having("teeth"),
        "bearings": tuple(p for p in roles.having("bearing") if p not in needles),
        "needles": needles,
        "seals": roles.having("seal"),
    }
    if name in groups:
        return groups[name]
    found = tuple(p for p, kind in kinds.items() if name in (p, kind))
    return found or None


def oils_of(scenario: Scenario, card: Card, names: Iterable[str]) -> dict[str, dict[str, float]]:
    """Oil of a test -> values by path, without those that the rig is filled with.

    Args:
        scenario: the rig
        card: it may describe an oil that the catalogue does not have
        names: of all oils in the tables; "" is that of the rig
    """
    found = {name: oil_values(scenario, name, card) for name in dict.fromkeys(names)}
    return {name: values for name, values in found.items() if values}
