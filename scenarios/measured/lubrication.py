"""Which lubricant reaches which parts, and the oils of the tests: what a card says beside rig file and catalogue."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from ...model.errors import DataError, Problems, suggestion
from ...model.machines.roles import Roles
from ...model.machines.spec import Spec
from ...model.parts.bearings import RollingBearing
from ...model.parts.lubrication import LubricantProperties, OilBath
from ..entries import catalogue
from ..scenario import Scenario
from .card import Card, Oil

#: Port by which a part is lubricated, and by which a lubricant reaches it.
PORT = "lubricant"
#: Relative difference of a viscosity from the catalogue's that is worth a warning.
OTHER_OIL = 0.02


def lubricants(spec: Spec) -> dict[str, str]:
    """Part that may run in oil or in grease -> "oil" or "grease", as the rig has it."""
    types = {p.name: spec.types[p.type] for p in spec.parts}
    sources = {name: cls for name, cls in types.items() if issubclass(cls, LubricantProperties)}
    found: dict[str, str] = {}
    for net in spec.connections:
        parts = [port.removesuffix(f".{PORT}") for port in net if port.endswith(f".{PORT}")]
        source = next((sources[part] for part in parts if part in sources), None)
        if source is not None:
            kind = "oil" if issubclass(source, OilBath) else "grease"
            found |= {part: kind for part in parts if part not in sources and issubclass(types[part], RollingBearing)}
    return found


def bath_of(scenario: Scenario) -> str:
    """The part that the oil of a test fills, "" where the rig has none.

    Args:
        scenario: the rig; where its campaign does not say, it is its first oil bath
    """
    baths = [name for name, cls in scenario.types.items() if issubclass(cls, OilBath)]
    return scenario.protocol.oil if scenario.protocol else next(iter(baths), "")


def oil_values(scenario: Scenario, name: str, card: Card) -> dict[str, float]:
    """Values by path of the oil of a name: the catalogue's, or else the card's, completed by those of the rig's oil.

    There are none for the rig's own oil, which it is filled with.

    Args:
        scenario: the rig
        name: as in the column `oil`, "" for the card's oil or else that of the rig
        card: which may describe or name the oil that the tables' own name stands for
    """
    bath, known = bath_of(scenario), catalogue("oil")
    if not bath or not (name or card.oil.name or card.oil.nu40):
        return {}
    if name in known:
        return scenario.following(scenario.entry_values(bath, name))
    if card.oil.nu40 is None and card.oil.name:
        return scenario.following(scenario.entry_values(bath, card.oil.name))
    keys = [path.rpartition(".")[2] for path in scenario.entry_values(bath, next(iter(known)))]
    own = {f"{bath}.{key}": float(scenario.spec.part(bath).values[key]) for key in keys}
    return scenario.following(own | {f"{bath}.{key}": value for key, value in card_oil(card.oil).items()})


def oil_problems(name: str, places: Mapping[str, str], card: Card) -> list[str]:
    """Oils that neither the catalogue nor the card has, or that one card cannot describe.

    Args:
        name: of the table
        places: name of an oil -> where it stands first
        card: which describes or names one oil at most
    """
    known = catalogue("oil")
    if card.oil.nu40 is None and card.oil.name and card.oil.name not in known:
        return [f'{card.name} oil: unknown oil "{card.oil.name}".{suggestion(card.oil.name, known)}']
    unknown = [oil for oil in places if oil and oil not in known]
    if card.oil.nu40 is None and not card.oil.name:
        return [
            f'{places[oil]}: unknown oil "{oil}".{suggestion(oil, known) or " See `gearheat list`."}' for oil in unknown
        ]
    if len(unknown) < 2:
        return []
    return [
        f"the card describes one oil, {name} names {len(unknown)} that the catalogue lacks:"
        f" {', '.join(sorted(unknown))}. Use one name for it."
    ]


def card_oil(oil: Oil) -> dict[str, float]:
    """What a card says of an oil, in SI by key. Density falls with temperature, whatever the sign of its change."""
    values = {key: 1e-6 * nu for key, nu in (("nu_40", oil.nu40), ("nu_100", oil.nu100)) if nu is not None}
    values |= {} if oil.rho15 is None else {"rho_15": oil.rho15}
    return values | ({} if oil.alpha_T is None else {"alpha_T": -abs(oil.alpha_T)})


def oil_warnings(scenario: Scenario, names: tuple[str, ...], card: Card) -> list[str]:
    """A card's oil that differs from the catalogue's of the same name.

    Args:
        scenario: the rig
        names: oil of each test
        card: which may describe an oil
    """
    stated = card_oil(card.oil)
    if not stated or len(set(names)) != 1 or names[0] not in catalogue("oil"):
        return []
    own = {path.rpartition(".")[2]: value for path, value in oil_values(scenario, names[0], card).items()}
    return [
        f"oil {names[0]}: the card states {key} = {stated[key] * 1e6:g} mm2/s, the catalogue {own[key] * 1e6:g};"
        " the catalogue's is used. Give the oil another name to use the card's."
        for key in ("nu_40", "nu_100")
        if abs(stated[key] / own[key] - 1) > OTHER_OIL
    ]


#: What a card calls groups of parts.
GROUPS = ("gears", "bearings", "needles", "seals")
LUBRICANTS = {"oil": "bath", "grease": "grease"}


def lubricate(spec: Spec, lubrication: Mapping[str, str]) -> Spec:
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
