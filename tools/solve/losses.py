"""Every loss at every measured reading, without running the rig through its tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...model.core.component import Component
from ...model.core.flat import FlatModel
from ...model.errors import DataError, ScenarioError
from ...model.parts.contacts import ContactTable, TellsContacts, TellsFilmContact
from ...model.parts.shaft import Efficiency
from ...model.run.point import point
from ...model.run.result import Result
from ...model.run.rows import evaluate
from ...model.run.steady import steady, steady_table
from ...scenarios.entries import catalogue
from ...scenarios.frames import Table
from ...scenarios.given import RigLike, Settings, assignments_of, scenario_of
from ...scenarios.measured.lubrication import bath_of
from ...scenarios.measured.readings import about
from ...scenarios.measured.study import Measured, read_study
from ...scenarios.scenario import Scenario
from ..show.display import Answer
from .settings import adjust, choice_paths, find_unchecked, flat_of
from .steady import conditions, outside_of


@dataclass(frozen=True, eq=False, repr=False)
class LossTable(Answer):
    """Losses at all readings of a rig, or at the operating point of a rig without measured data.

    Attributes:
        contacts: the contacts at the operating point, where they were asked for
    """

    contacts: ContactTable | None = None


def losses(
    rig: RigLike,
    *,
    data: Table | None = None,
    card: str | Path | None = None,
    temperature: str = "measured",
    power_flow: str | None = None,
    contacts: bool = False,
    set: Settings = (),
) -> LossTable:
    """Loss of every part at each measured reading, without running the rig through its tests.

    Args:
        rig: name, file or rig
        data: measured table, file or DataFrame; the rig's own if None
        card: how that table was taken
        temperature: "measured": at the measured oil temperature; "model": at the one the model reaches
        power_flow: "ideal": mesh forces from the input torque; "successive": each stage sees upstream losses
        contacts: also every contact over a mesh cycle
        set: values by name: texts with units, quantities of pint, or numbers in SI

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.losses("helical_two_stage", temperature="model").found["temperature"]
        'model'
    """
    scenario = scenario_of(rig)
    flows = _flow_paths(scenario)
    if temperature not in ("measured", "model"):
        raise ScenarioError(f'--temperature {temperature} is not known. Choose "measured" or "model".')
    if power_flow is not None and not flows:
        raise ScenarioError(f"{scenario.name}: no part has a choice of power flow. Leave out --power-flow.")
    chosen = [f"{path}={power_flow}" for path in flows if power_flow is not None]
    scenario = adjust(scenario, [*assignments_of(set, scenario.settable), *chosen])
    if not scenario.losses:
        raise ScenarioError(f"{scenario.path.name}: there is no table [losses]. Say which outputs each column sums.")
    study, flat = read_study(scenario, data, card), flat_of(scenario)
    at_point: dict[str, Any] = {}
    if study:
        rows = at_readings(study, temperature)
    else:
        result = steady(flat, conditions(scenario, flat))
        rows = [{c: float(sum(result[path][0] for path in paths)) for c, paths in scenario.losses.items()}]
        at_point = {"outside": outside_of(result)}
    found: dict[str, Any] = {
        "schema": "gearheat.losses/1",
        "rig": scenario.name,
        "temperature": temperature if study else "model",
        "choices": {
            p: scenario.spec.part(p.rpartition(".")[0]).values.get(p.rpartition(".")[2]) for p in _flow_paths(scenario)
        },
        "rows": rows,
        **at_point,
        "unchecked": find_unchecked(scenario, flat, oils_of(study)),
    }
    cycle = None
    if contacts:
        part, values = contacts_part(scenario)
        cycle = part.contact_table(values)
        found |= {"contacts": cycle.rows, "columns": cycle.columns, **cycle.totals}
        found["cycle"] = [asdict(moment) for moment in cycle.cycle]
    shown = list(rows[0]), [list(row.values()) for row in rows]
    return LossTable(found, cycle, heading=f"{scenario.name}: losses", shown=shown)


def oils_of(study: Measured | None) -> list[tuple[str, str]]:
    """The part that holds the oil and each oil of the catalogue that a campaign fills it with."""
    if study is None or not (bath := bath_of(study.scenario)):
        return []
    return [(bath, oil) for oil in dict.fromkeys(study.campaign.oil) if oil in catalogue("oil")]


def at_readings(study: Measured, temperature: str) -> list[dict[str, Any]]:
    """One row of losses per reading.

    Args:
        study: the rig and its readings
        temperature: "measured": all temperatures are the measured oil temperature, the first one of a rig without oil;
            "model": the model's steady ones

    Raises:
        DataError: no temperature was measured
    """
    scenario, campaign = study.scenario, study.campaign
    if (sensor := study.oil_sensor) is None:
        raise DataError(f"{campaign.name}: no temperature of the gearbox was read. Use --temperature model.")
    flat, kept = flat_of(scenario), np.array(study.read_rows)
    if temperature == "measured":
        kept = kept[np.isfinite(campaign.values[sensor.name][kept])]  # cells may be empty
    values = [study.oil(int(campaign.test[row])) | study.given(row) for row in kept]
    T_read = campaign.values[sensor.name][kept]
    if temperature == "model":
        columns: dict[str, np.ndarray] = dict(steady_table(flat, values).columns)
    else:
        columns = hold(flat, values, [float(T) for T in T_read])
    T_oil = T_read if temperature == "measured" else columns[sensor.reads]
    total = next((columns[f"{part}.P_loss"] for part in scenario.spec.of_type(Efficiency.__name__)), None)
    rows = []
    for i, row in enumerate(kept):
        found = {c: float(sum(columns[p][i] for p in paths)) for c, paths in scenario.losses.items()}
        power = float(total[i]) if total is not None else found.get("P_total_W", sum(found.values()))
        rise = float(T_oil[i] - campaign.values[study.rooms[0].name][row]) if study.rooms else np.nan
        rows.append({**about(study, row), **found, "alphaA_W_K": power / rise})
    return rows


def hold(
    flat: FlatModel, values: Sequence[Mapping[str, float]], temperatures: Sequence[float]
) -> dict[str, np.ndarray]:
    """All outputs, inputs and parameters with every temperature of the model at a given value.

    Args:
        flat: the model
        values: inputs and parameters by path (SI), per point
        temperatures: of every body, per point [K]
    """
    points = [
        point(flat, row, dict.fromkeys(flat.bodies, T), who="losses")
        for row, T in zip(values, temperatures, strict=True)
    ]
    x, u, p = (np.array([getattr(here, kind) for here in points]).T for kind in "xup")
    y = evaluate(flat, x.reshape(len(flat.states), -1), u, p)["y"]
    groups = ((flat.outputs, y), (flat.inputs, u), (flat.parameters, p))
    return {q.name: line for quantities, lines in groups for q, line in zip(quantities, lines, strict=True)}


def _flow_paths(scenario: Scenario) -> list[str]:
    return [path for path in choice_paths(scenario.spec) if path.endswith(".power_flow")]


def contacts_part(scenario: Scenario) -> tuple[TellsContacts, dict[str, float]]:
    """The part of a rig that tells its contacts, and its values at the operating point as `values_of` has them.

    Args:
        scenario: the rig, with its values

    Raises:
        ScenarioError: no part does, or several do
    """
    parts = [part for part in scenario.spec.assembly().parts if isinstance(part, TellsContacts)]
    if not parts:
        kinds = ", ".join(sorted(kind for kind, cls in scenario.spec.types.items() if hasattr(cls, "contact_table")))
        raise ScenarioError(
            f"{scenario.name}: no part has a table of contacts. Leave out --contacts, or take a rig with: {kinds}."
        )
    if len(parts) > 1:
        names = ", ".join(part.name for part in parts)
        raise ScenarioError(f"{scenario.name}: several parts have contacts: {names}. Take a rig with one of them.")
    flat = flat_of(scenario)
    return parts[0], values_of(parts[0], flat, steady(flat, conditions(scenario, flat)))


def values_of(part: TellsContacts | TellsFilmContact | Component, flat: FlatModel, result: Result) -> dict[str, float]:
    """Parameters and outputs of a part at a steady state, by key, in SI.

    Args:
        part: the part
        flat: the model that was run
        result: one steady point of it
    """
    start = f"{part.name}."
    found = {q.name: q.start for q in flat.parameters} | {name: float(c[0]) for name, c in result.columns.items()}
    return {name.removeprefix(start): value for name, value in found.items() if name.startswith(start)}
