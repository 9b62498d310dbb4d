"""Lubricants and oils of a campaign: what a card says beside the rig and the catalogue."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.errors import suggestion
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
    sources = {p.name: spec.types[p.type] for p in spec.parts if issubclass(spec.types[p.type], LubricantProperties)}
    found: dict[str, str] = {}
    for net in spec.connections:
        parts = [port.removesuffix(f".{PORT}") for port in net if port.endswith(f".{PORT}")]
        source = next((sources[part] for part in parts if part in sources), None)
        if source is not None:
            kind = "oil" if issubclass(source, OilBath) else "grease"
            found |= {part: kind for part in parts if part not in sources and _is(spec, part, RollingBearing)}
    return found


def _is(spec: Spec, part: str, cls: type) -> bool:
    return issubclass(spec.types[spec.part(part).type], cls)


def bath_of(scenario: Scenario) -> str:
    """The part that the oil of a test fills, "" where the rig has none.

    Args:
        scenario: the rig; where its campaign does not say, it is its first oil bath
    """
    baths = [part.name for part in scenario.spec.parts if _is(scenario.spec, part.name, OilBath)]
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
        return scenario.entry_values(bath, name)
    if card.oil.nu40 is None and card.oil.name:
        return scenario.entry_values(bath, card.oil.name)
    keys = [path.rpartition(".")[2] for path in scenario.entry_values(bath, next(iter(known)))]
    own = {f"{bath}.{key}": float(scenario.spec.part(bath).values[key]) for key in keys}
    return own | {f"{bath}.{key}": value for key, value in card_oil(card.oil).items()}


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
            f'{places[oil]}: unknown oil "{oil}".{suggestion(oil, known) or " Known: " + ", ".join(known) + "."}'
            for oil in unknown
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
