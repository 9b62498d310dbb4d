"""The contacts of a rig at its operating point: every part that tells its contacts in numbers answers."""

from __future__ import annotations

from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError
from ...model.machines.spec import assemble
from ...model.parts.contacts import ContactTable, TellsContacts, TellsFilmContact
from ...model.run.result import Result
from ...scenarios.scenario import Scenario


def part_with_contacts(scenario: Scenario) -> TellsContacts:
    """The part of a rig that tells its contacts.

    Args:
        scenario: the rig, with its values

    Raises:
        ScenarioError: no part does, or several do
    """
    parts = [part for part in assemble(scenario.spec).parts if isinstance(part, TellsContacts)]
    if not parts:
        kinds = ", ".join(sorted(kind for kind, cls in scenario.spec.types.items() if hasattr(cls, "contact_table")))
        raise ScenarioError(
            f"{scenario.name}: no part has a table of contacts. Leave out --contacts, or take a rig with: {kinds}."
        )
    if len(parts) > 1:
        names = ", ".join(part.name for part in parts)
        raise ScenarioError(f"{scenario.name}: several parts have contacts: {names}. Take a rig with one of them.")
    return parts[0]


def values_of(part: TellsContacts | TellsFilmContact, flat: FlatModel, result: Result) -> dict[str, float]:
    """Parameters and outputs of a part at a steady state, by key, in SI.

    Args:
        part: the part
        flat: the model that was run
        result: one steady point of it
    """
    start = f"{part.name}."
    found = {q.name: q.start for q in flat.parameters} | {name: float(c[0]) for name, c in result.columns.items()}
    return {name.removeprefix(start): value for name, value in found.items() if name.startswith(start)}


def contacts_at(scenario: Scenario, flat: FlatModel, result: Result) -> ContactTable:
    """The contacts of a rig at a steady state.

    Args:
        scenario: the rig, with its values
        flat: its model
        result: one steady point of it

    Raises:
        ScenarioError: no part tells its contacts, or several do
    """
    part = part_with_contacts(scenario)
    return part.contact_table(values_of(part, flat, result))
