"""The command `losses`: every loss at every measured reading, without running the rig through its tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..model.core.flat import FlatModel
from ..model.errors import DataError, ScenarioError
from ..model.parts.contacts import ContactTable
from ..model.run.point import point
from ..model.run.rows import evaluate
from ..model.run.steady import steady, steady_table
from ..scenarios.entries import catalogue
from ..scenarios.measured import Campaign, Protocol, Reading, read_measured
from ..scenarios.scenario import Scenario
from ..scenarios.write import DIAGNOSED
from .console import answer, table
from .contacts import contacts_at, part_with_contacts, print_contacts
from .points import conditions, outside_of, tell_outside
from .rigs import load
from .settings import SET, adjusted, choice_paths, flat_of
from .unchecked import print_unchecked, unchecked


def command(
    rig: str,
    data: Path | None,
    temperature: str,
    power_flow: str | None,
    assignments: Sequence[str],
    json: str | None,
    *,
    contacts: bool = False,
) -> None:
    """Losses at all readings of a rig, or at the operating point of a rig without measured data.

    With `contacts` the contacts at the operating point as well.
    """
    scenario = load(rig)
    flows = [f"{path}={power_flow}" for path in choice_paths(scenario.spec) if path.endswith(".power_flow")]
    if power_flow is not None and not flows:
        raise ScenarioError(f"{scenario.name}: no part has a choice of power flow. Leave out --power-flow.")
    scenario = adjusted(scenario, [*assignments, *(flows if power_flow is not None else [])])
    if not scenario.losses:
        raise ScenarioError(f"{scenario.path.name}: there is no table [losses]. Say which outputs each column sums.")
    campaign = scenario.campaign
    if data is not None:
        campaign = read_measured(data, campaign.protocol if campaign else None)
    at_point: dict[str, Any] = {}
    if campaign:
        rows = at_readings(scenario, campaign, temperature)
    else:
        row, outside = at_operating_point(scenario)
        rows, at_point = [row], {"outside": outside}
    found: dict[str, Any] = {
        "schema": "gearheat.losses/1",
        "rig": scenario.name,
        "temperature": temperature if campaign else "model",
        "choices": {
            p: scenario.spec.part(p.rpartition(".")[0]).values.get(p.rpartition(".")[2]) for p in _flow_paths(scenario)
        },
        "rows": rows,
        **at_point,
        "unchecked": unchecked(scenario, flat_of(scenario), oils_of(campaign)),
    }
    columns = list(rows[0])
    told = contacts_at_operating_point(scenario) if contacts else None
    if told is not None:
        found |= {"contacts": told.rows, "columns": told.columns, **told.totals}
        found["cycle"] = [asdict(moment) for moment in told.cycle]

    def human() -> None:
        table(f"{scenario.name}: losses", columns, [[r[c] for c in columns] for r in rows])
        if told is not None:
            print_contacts(scenario.name, told)
        tell_outside(found.get("outside", ()))
        print_unchecked(found["unchecked"])

    answer(found, json, human)


def oils_of(campaign: Campaign | None) -> list[tuple[str, str]]:
    """The part that holds the oil and each oil of the catalogue that a campaign fills it with."""
    if campaign is None or campaign.protocol is None:
        return []
    used = dict.fromkeys(reading.oil for reading in campaign.readings)
    return [(campaign.protocol.oil, oil) for oil in used if oil in catalogue("oil")]


def at_readings(scenario: Scenario, campaign: Campaign, temperature: str) -> list[dict[str, Any]]:
    """One row of losses per reading.

    Args:
        scenario: the rig
        campaign: readings with the protocol that says what drives the model
        temperature: "measured": all temperatures are the measured oil temperature; "model": the model's steady ones

    Raises:
        DataError: how the campaign was run is not known
    """
    if (protocol := campaign.protocol) is None:
        raise DataError(f"{campaign.name}: how it was run is not known. Give the rig file a table [campaign].")
    flat = flat_of(scenario.driven_by(protocol.inputs))
    values = [given(scenario, protocol, reading) for reading in campaign.readings]
    if temperature == "model":
        result = steady_table(flat, values)
        columns: dict[str, np.ndarray] = dict(result.columns)
    else:
        columns = held(flat, values, [reading.si("T_oil_C") for reading in campaign.readings])
    rows = []
    for i, reading in enumerate(campaign.readings):
        name = {"point": reading.point, "test": reading.test, "direction": reading.direction, "oil": reading.oil}
        found = {c: float(sum(columns[p][i] for p in paths)) for c, paths in scenario.losses.items()}
        T_oil = reading.si("T_oil_C") if temperature == "measured" else float(columns[scenario.sensors["T_oil_C"]][i])
        total = float(columns["efficiency.P_loss"][i]) if "efficiency.P_loss" in columns else found["P_total_W"]
        rows.append({**name, **found, "alphaA_W_K": total / (T_oil - reading.si("T_amb_C"))})
    return rows


def given(scenario: Scenario, protocol: Protocol, reading: Reading) -> dict[str, float]:
    """Inputs and oil of one reading, in SI by path; what the user set stays."""
    driven = {path: d.sign[reading.direction - 1] * reading.si(d.column) for path, d in protocol.inputs.items()}
    return driven | {protocol.room: reading.si("T_amb_C")} | oil_values(scenario, protocol, reading.oil)


def oil_values(scenario: Scenario, protocol: Protocol, oil: str) -> dict[str, float]:
    """What the catalogue says of the oil of a test, but for values that the user set or a diagnosis changed.

    An oil that the catalogue lacks is that of the rig: a table is read with it only where the rig was filled with it.
    """
    if oil not in catalogue("oil"):
        return {}
    values = scenario.entry_values(protocol.oil, oil)
    kept = (SET, DIAGNOSED)
    return {path: value for path, value in values.items() if not scenario.value_sources.get(path, "").startswith(kept)}


def held(
    flat: FlatModel, values: Sequence[Mapping[str, float]], temperatures: Sequence[float]
) -> dict[str, np.ndarray]:
    """All outputs, inputs and parameters with every temperature of the model at a given value.

    Args:
        flat: the model
        values: inputs and parameters by path (SI), per point
        temperatures: of every body, per point [K]
    """
    hot = [q.name for q in flat.states if q.unit == "K"]
    points = [
        point(flat, row, dict.fromkeys(hot, T), who="losses") for row, T in zip(values, temperatures, strict=True)
    ]
    x, u, p = (np.array([getattr(here, kind) for here in points]).T for kind in "xup")
    y = evaluate(flat, x.reshape(len(flat.states), -1), u, p)["y"]
    groups = ((flat.outputs, y), (flat.inputs, u), (flat.parameters, p))
    return {q.name: line for quantities, lines in groups for q, line in zip(quantities, lines, strict=True)}


def at_operating_point(scenario: Scenario) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The losses at the rig's operating point and the steady temperatures there, and the laws outside their range."""
    flat = flat_of(scenario)
    result = steady(flat, conditions(scenario, flat))
    row = {c: float(sum(result[path][0] for path in paths)) for c, paths in scenario.losses.items()}
    return row, outside_of(result)


def contacts_at_operating_point(scenario: Scenario) -> ContactTable:
    """The contacts of a rig at its operating point and the steady temperatures there."""
    part_with_contacts(scenario)
    flat = flat_of(scenario)
    return contacts_at(scenario, flat, steady(flat, conditions(scenario, flat)))


def _flow_paths(scenario: Scenario) -> list[str]:
    return [path for path in choice_paths(scenario.spec) if path.endswith(".power_flow")]
