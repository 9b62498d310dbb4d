"""What is uncertain of a rig: values whose uncertainty its file states, and groups of parameters by what parts are."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ...fmu.leading import Uncertain, Uncertainty
from ...fmu.variables import Variable
from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError
from ...model.machines.roles import Roles
from ...scenarios.nuisances import nuisances
from ...scenarios.scenario import Scenario
from .sampling import Axis
from .steady import leading_outputs

#: Stands on the command line for all uncertain parameters of a rig.
UNCERTAINTY = "uncertainty"


def reasons(scenario: Scenario, flat: FlatModel, given: Collection[str] = ()) -> tuple[Uncertainty, ...]:
    """Why results of a rig are uncertain, each reason independent of the others.

    A value with an uncertainty in the rig file stands for itself, values that it states as uncertain together stand
    together. All others differ by groups, as in a diagnosis before it has seen data.

    Args:
        scenario: the rig
        flat: its model
        given: paths of values that are certain, as they are given otherwise

    Raises:
        ScenarioError: nothing is uncertain
    """
    alone = {path: {path: sd} for path, sd in scenario.uncertainties.items() if sd > 0}
    stated = {path for path, sd in scenario.standard_uncertainties.items() if sd > 0}
    values = {q.name: q.start for q in (*flat.parameters, *flat.states) if q.name not in given}
    found = []
    for name, changes in (*alone.items(), *scenario.joint_uncertainties.items()):
        if known := {path: change for path, change in changes.items() if path in values}:
            found.append(Uncertainty(name, known))
    for group in nuisances(Roles.of(scenario.spec), {}, {}):
        paths = {path: share for path, share in group.paths.items() if path in values and path not in stated}
        changes = {path: share * group.sd * values[path] for path, share in paths.items()}
        if any(changes.values()):
            found.append(Uncertainty(group.name, changes))
    if not found:
        raise ScenarioError(
            f"{scenario.name}: no parameter of this rig is uncertain. State an uncertainty in a part,\n"
            'for example uncertainties = { G = "0.19 W/K" }.'
        )
    return tuple(found)


def shares(found: Sequence[Uncertainty]) -> tuple[Axis, ...]:
    """One standard normal number for each reason.

    Args:
        found: the reasons
    """
    return tuple(Axis(reason.name, "normal", 0.0, 1.0) for reason in found)


def draw_values(
    found: Sequence[Uncertainty], flat: FlatModel, sizes: np.ndarray
) -> tuple[tuple[Axis, ...], np.ndarray]:
    """Values of all uncertain parameters, none beyond the range of its parameter.

    Their logarithms are normal, as in a diagnosis before it has seen data; a parameter that is zero is normal itself.

    Args:
        found: the reasons
        flat: the model
        sizes: of each reason in standard deviations (rows, reasons)

    Returns:
        an axis of each parameter, with its standard deviation, and the values (rows, parameters)
    """
    paths = list(dict.fromkeys(path for reason in found for path in reason.changes))
    changes = np.array([[reason.changes.get(path, 0.0) for path in paths] for reason in found])
    quantities = [flat.quantity(path) for path in paths]
    starts = np.array([q.start for q in quantities])
    scale = np.where(starts, starts, 1.0)
    moved = sizes @ (changes / scale)
    values = scale * np.where(starts, np.exp(moved), moved)
    ends = [Variable(0, "parameter", q).bounds for q in quantities]
    deviations = np.hypot.reduce(changes, axis=0)
    axes = tuple(
        Axis(q.name, "lognormal" if q.start else "normal", q.start, float(sd))
        for q, sd in zip(quantities, deviations, strict=True)
    )
    return axes, np.clip(values, *np.array(ends).T)


def collect_uncertain(scenario: Scenario, flat: FlatModel) -> Uncertain:
    """What an FMU of a rig needs for its standard deviations: of temperatures, and of the loss and the efficiency.

    Args:
        scenario: the rig
        flat: its model

    Raises:
        ScenarioError: nothing is uncertain
    """
    shown = [q.name for q in flat.states] + leading_outputs(scenario)
    return Uncertain(reasons(scenario, flat), tuple(dict.fromkeys(name for name in shown if name in flat.index)))
