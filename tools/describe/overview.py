"""Which parameters of a rig matter most: what a tenth more of each does to oil temperature and loss."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...model.core.declare import list_declared
from ...model.core.flat import FlatModel
from ...model.errors import SolveError
from ...model.parts.ports import Flange, HeatPort
from ...model.run.result import Result
from ...model.run.sensitivity import sensitivities
from ...model.units import from_si, show_unit
from ...scenarios.scenario import Scenario
from ..show.console import cell
from ..solve.steady import conditions, leading_outputs

#: Number of parameters in the table.
FIRST = 12
#: Share of its value by which each is changed [1].
SHARE = 0.1
#: Below this share of the largest effect of all a parameter does not matter.
LEAST = 1e-2


def effects_table(
    scenario: Scenario, flat: FlatModel, parameters: Sequence[Mapping[str, Any]], rest: Result
) -> tuple[str, Sequence[str], list[list[Any]]] | None:
    """Title, head and rows of the parameters that change the temperature of the oil and the loss the most.

    Args:
        scenario: the rig
        flat: its model
        parameters: as `--json` lists them
        rest: the steady state

    Returns:
        None where no parameter has an effect
    """
    of = [name for name in leading_outputs(scenario) if name in flat.index and not name.endswith(".eta")][:2]
    ranked = effects(scenario, flat, of, parameters, rest)
    if not ranked:
        return None
    units = [flat.quantity(name).unit for name in of]
    body = []
    for line, changes in ranked:
        own = {**line, **(line["written"] or {})}
        shows = [c if unit == "K" else from_si(c, unit) for c, unit in zip(changes, units, strict=True)]
        body.append([own["name"], own["value"], own["unit"], *map(_format_change, shows), own["doc"], own["source"]])
    keys = [name.rpartition(".")[2] for name in of]
    heads = [f"{key} [{unit if unit == 'K' else show_unit(unit)}]" for key, unit in zip(keys, units, strict=True)]
    title = f"Parameters that matter most: what {100 * SHARE:g} % more of each does to {' and '.join(of)}"
    return title, ("name", "value", "unit", *heads, "doc", "source"), body


def effects(
    scenario: Scenario, flat: FlatModel, of: Sequence[str], parameters: Sequence[Mapping[str, Any]], rest: Result
) -> list[tuple[Mapping[str, Any], list[float]]]:
    """The parameters with the largest effect, and what each changes in SI.

    Those that the rig gives and that are no temperatures. Left out is what the drawing fixes: numbers of things, and
    lengths and angles of all parts but those that only carry heat.

    Args:
        scenario: the rig
        flat: its model
        of: outputs or states that are changed
        parameters: as `--json` lists them
        rest: the steady state
    """
    thermal = {p.name for p in scenario.spec.parts if _thermal(scenario.spec.types[p.type])}
    own = {line["name"]: line for line in parameters if line["kind"] == "given"}
    free = [q for q in flat.parameters if q.name in own and q.unit != "K" and not q.whole]
    free = [q for q in free if q.unit not in ("m", "rad") or q.name.rpartition(".")[0] in thermal]
    if not free or not of:
        return []
    guess = {q.name: float(rest[q.name][0]) for q in flat.states}
    try:
        slopes = sensitivities(flat, of, [q.name for q in free], conditions(scenario, flat), guess=guess)
    except (SolveError, np.linalg.LinAlgError):
        return []
    change = SHARE * slopes * np.array([q.start for q in free])
    largest = np.abs(change).max(axis=1, keepdims=True)
    weight = (np.abs(change) / np.where(largest > 0, largest, 1.0)).max(axis=0)
    order = sorted((k for k in range(len(free)) if weight[k] > LEAST), key=lambda k: (-float(f"{weight[k]:.6g}"), k))
    return [(own[free[k].name], [float(c) for c in change[:, k]]) for k in order[:FIRST]]


def _thermal(cls: type) -> bool:
    return bool(list_declared(cls, HeatPort)) and not list_declared(cls, Flange)


def _format_change(value: float) -> str:
    return f"+{cell(value)}" if value > 0 else cell(value)
