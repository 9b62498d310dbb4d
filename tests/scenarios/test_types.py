"""A floor above may bring types of parts of its own: a rig file names them where the reader is told of them."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Parameter
from gearheat.model.errors import ScenarioError
from gearheat.model.parts import PARTS
from gearheat.model.parts.ports import HeatPort
from gearheat.scenarios.load import load
from gearheat.scenarios.write import rig_text

RIG = """
kind = "network"
doc = "a heated block in a room"
[drive]
[operating_point]
[part.block]
type = "HeatCapacity"
C = "1000 J/K"
source = "assumed: an example"
[part.heater]
type = "Heater"
P = "20 W"
source = "assumed: an example"
[connect]
heat = ["block.heat", "heater.heat"]
"""


class Heater(Component):
    """A part that no floor of the project knows."""

    heat = HeatPort()
    P = Parameter("W", "power")

    def equations(self) -> Iterator[Equation]:
        yield equation("heat", self.heat.Q_flow, -self.P)


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    (path := tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    return path


def test_a_type_that_is_handed_over_is_read_built_and_written(rig: Path) -> None:
    types = PARTS | {"Heater": Heater}
    scenario = load(rig, types)
    flat = scenario.spec.flat()
    assert [q.name for q in flat.states] == ["block.T"] and "heater.P" in scenario.settable()
    rig.write_text(rig_text(scenario), encoding="utf-8")
    assert load(rig, types).spec.part("heater") == scenario.spec.part("heater")


def test_a_type_that_is_not_handed_over_is_refused(rig: Path) -> None:
    with pytest.raises(ScenarioError, match=r'\[part\.heater\]: there is no part type "Heater"'):
        load(rig)


def test_a_spec_takes_parts_of_types_it_did_not_know() -> None:
    spec = load("planetary").spec
    added = spec.with_parts([], [], {"Heater": Heater})
    assert added.types["Heater"] is Heater and "Heater" not in spec.types
