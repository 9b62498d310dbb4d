"""What is uncertain of a rig: values whose uncertainty its file states, and groups of parameters by what parts are."""

from __future__ import annotations

from ..diagnose.library.nuisances import nuisances
from ..diagnose.library.roles import Roles
from ..fmu.leading import Uncertain, Uncertainty
from ..model.core.flat import FlatModel
from ..model.errors import ScenarioError
from ..scenarios.scenario import Scenario
from .points import told


def reasons(scenario: Scenario, flat: FlatModel) -> tuple[Uncertainty, ...]:
    """Why results of a rig are uncertain, each reason independent of the others.

    A value with an uncertainty in the rig file stands for itself. All others differ by groups, as in a diagnosis before
    it has seen data.

    Args:
        scenario: the rig
        flat: its model
    """
    stated = {path: sd for path, sd in scenario.uncertainties.items() if sd > 0}
    values = {q.name: q.start for q in (*flat.parameters, *flat.states)}
    found = [Uncertainty(path, {path: sd}) for path, sd in stated.items() if path in values]
    for group in nuisances(Roles.of(scenario.spec), {}, {}):
        paths = {path: share for path, share in group.paths.items() if path in values and path not in stated}
        changes = {path: share * group.sd * values[path] for path, share in paths.items()}
        if any(changes.values()):
            found.append(Uncertainty(group.name, changes))
    return tuple(found)


def uncertain(scenario: Scenario, flat: FlatModel) -> Uncertain:
    """What an FMU of a rig needs for its standard deviations: of temperatures, and of the loss and the efficiency.

    Args:
        scenario: the rig
        flat: its model

    Raises:
        ScenarioError: nothing is uncertain
    """
    found = reasons(scenario, flat)
    if not found:
        raise ScenarioError(
            f"{scenario.name}: --uncertainty: no parameter of this rig is uncertain. State an uncertainty in a part,\n"
            'for example uncertainties = { G = "0.19 W/K" }.'
        )
    shown = [q.name for q in flat.states] + told(scenario)
    return Uncertain(found, tuple(dict.fromkeys(name for name in shown if name in flat.index)))
