"""Which lubricant reaches which part, and the oils of the tables: what a card says beside the catalogue."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ...model.errors import DataError, GearheatError, suggestion
from ...model.machines.spec import Spec
from ...scenarios.csv_table import read_cells
from ...scenarios.entries import catalogue
from ...scenarios.scenario import Scenario
from .card import Card, Oil

#: What a card calls a group of parts -> the parts.
GROUPS: Mapping[str, tuple[str, ...]] = {
    "gears": ("gear_set",),
    "bearings": ("carrier_bearing", "sun_bearing"),
    "needles": ("planet_bearing",),
}
LUBRICANTS = ("oil", "grease")
#: Relative difference of a viscosity from the catalogue's that is worth a warning.
OTHER_OIL = 0.02


def lubricated(spec: Spec, lubrication: Mapping[str, str]) -> Spec:
    """The machine with parts connected to the lubricants that a card names.

    Args:
        spec: the machine
        lubrication: group of parts -> "oil" or "grease"; groups left out stay as they are

    Raises:
        DataError: unknown groups or lubricants, or parts that the machine does not have
    """
    wanted, problems = _wanted(spec, lubrication)
    if problems:
        raise DataError(problems)
    moved = {f"{part}.lubricant": f"{lubricant}.lubricant" for part, lubricant in wanted.items()}
    nets = []
    for net in spec.connections:
        users = [port for port in net if port not in moved]
        nets.append((*users, *(port for port, source in moved.items() if source in users)))
    return replace(spec, connections=tuple(net for net in nets if len(net) > 1))  # a lubricant without users goes


def _wanted(spec: Spec, lubrication: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    """Part -> lubricant, and what is wrong."""
    known = {part.name for part in spec.parts}
    wanted: dict[str, str] = {}
    problems: list[str] = []
    for group, lubricant in lubrication.items():
        if group not in GROUPS:
            close = suggestion(group, GROUPS)
            problems.append(f'card lubrication: unknown part "{group}".{close} Known: {", ".join(GROUPS)}.')
        elif lubricant not in LUBRICANTS:
            problems.append(f'card lubrication: {group} = "{lubricant}" is not known. Write "oil" or "grease".')
        elif group == "gears" and lubricant != "oil":
            problems.append('card lubrication: gears = "grease" is not modelled. The teeth run in the oil.')
        elif missing := [p for p in (*GROUPS[group], lubricant) if p not in known]:
            problems.append(f"card lubrication: {spec.name} has no {', '.join(missing)}. Leave out {group}.")
        else:
            wanted |= dict.fromkeys(GROUPS[group], lubricant)
    return wanted, problems


def known_oils(tables: Iterable[Path], card: Card | None) -> tuple[list[str], list[str]]:
    """Names that may stand in the tables, and what is wrong: the catalogue's, and one that the card's oil stands for.

    Args:
        tables: files that may have a column `oil`
        card: the card; None where it could not be read, so that any name may be its oil's
    """
    known = list(catalogue("oil"))
    unknown = sorted(_names(tables) - set(known))
    if card is not None and (card.oil is None or (isinstance(card.oil, str) and card.oil not in known)):
        return known, []
    if card is None or len(unknown) < 2:
        return known + unknown, []
    return known + unknown, [
        f"the card describes one oil, the tables name {len(unknown)} that the catalogue lacks: {', '.join(unknown)}."
        " Use one name for it."
    ]


def _names(tables: Iterable[Path]) -> set[str]:
    """Names in the columns `oil` of all tables that can be read."""
    names: set[str] = set()
    for path in tables:
        try:
            head, rows = read_cells(path)
        except GearheatError:
            continue  # told when the table is read
        if "oil" in head:
            names |= {cells[head.index("oil")] for _, cells in rows} - {""}
    return names


def oil_values(scenario: Scenario, name: str, card: Card) -> dict[str, float]:
    """Values by path of the oil of a name: the catalogue's, or else the card's, completed by the rig's own oil."""
    bath = scenario.protocol.oil if scenario.protocol else "oil"
    if name in catalogue("oil"):
        return scenario.entry_values(bath, name)
    if not isinstance(card.oil, Oil):
        return scenario.entry_values(bath, str(card.oil))
    own = scenario.entry_values(bath, next(iter(catalogue("oil"))))
    own = {path: float(scenario.spec.part(bath).values[path.rpartition(".")[2]]) for path in own}
    return own | {f"{bath}.{key}": value for key, value in card_oil(card.oil).items()}


def card_oil(oil: Oil) -> dict[str, float]:
    """What a card says of an oil, in SI by key. Density falls with temperature, whatever the sign of its change."""
    values = {"nu_40": oil.nu40 * 1e-6, "nu_100": oil.nu100 * 1e-6}
    values |= {} if oil.rho15 is None else {"rho_15": oil.rho15}
    return values | ({} if oil.alpha_T is None else {"alpha_T": -abs(oil.alpha_T)})


def oil_warnings(oils: Mapping[str, Mapping[str, float]], card: Card) -> list[str]:
    """A card's oil that differs from the catalogue's of the same name."""
    if not isinstance(card.oil, Oil) or len(oils) != 1 or (name := next(iter(oils))) not in catalogue("oil"):
        return []
    own = {path.rpartition(".")[2]: value for path, value in oils[name].items()}
    stated = card_oil(card.oil)
    return [
        f"oil {name}: the card states {key} = {stated[key] * 1e6:g} mm2/s, the catalogue {own[key] * 1e6:g};"
        " the catalogue's is used. Give the oil another name to use the card's."
        for key in ("nu_40", "nu_100")
        if abs(stated[key] / own[key] - 1) > OTHER_OIL
    ]
