"""Sheet "plates": units of the sheet "machines" of which only the name plate is known.

The true machine differs from the rig file by as much as that file says, all parts of a kind together, and its losses
and heat paths follow speed, load and room otherwise than the laws: a bearing by Palmgren is not one by SKF.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gearheat.model.machines.roles import Roles
from gearheat.scenarios.scenario import Scenario

from .machines import Machine


class Plated(Machine):
    """A true machine on its bench, as uncertain as its rig file says."""

    curved = 0.5

    def tell(self, path: Path) -> None:
        """All that it says."""

    def deviate(self, scenario: Scenario, names: Sequence[str]) -> list[dict[str, float]]:
        """As the rig file says."""
        value, known = Roles.of(scenario.spec).value, scenario.standard_uncertainties
        return [
            {path: known[path] / value(path) for path in changes if path in names}
            for changes in scenario.joint_uncertainties.values()
        ]
