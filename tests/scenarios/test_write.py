"""A scenario written as a rig file loads as the same machine."""

from dataclasses import replace
from pathlib import Path

import pytest
from gearheat.model.machines.spec import PartSpec, assemble
from gearheat.scenarios.load import list_rigs, load
from gearheat.scenarios.write import rig_text


@pytest.mark.parametrize("name", list_rigs())
def test_what_is_written_loads_as_the_same_machine(name: str, tmp_path: Path) -> None:
    scenario = load(name)
    (path := tmp_path / f"{name}.toml").write_text(rig_text(scenario), encoding="utf-8")
    again = load(path)
    ports = [port for net in scenario.spec.connections for port in net]
    if len({*ports}) == len(ports):  # else nets that share a port are written as one
        assert again.spec == scenario.spec
    assert replace(again.spec, connections=()) == replace(scenario.spec, connections=())
    nets, before = ([[port.name for port in net] for net in assemble(s.spec).nets] for s in (again, scenario))
    assert nets == before
    for same in (
        "doc",
        "given",
        "operating_point",
        "sensors",
        "losses",
        "value_sources",
        "uncertainties",
        "errata",
        "protocol",
    ):
        assert getattr(again, same) == getattr(scenario, same), same
    assert rig_text(again).splitlines()[1:] == rig_text(scenario).splitlines()[1:]


def test_an_extension_is_written_with_what_it_added(tmp_path: Path) -> None:
    scenario = load("planetary")
    cooler = PartSpec("cooler", "ThermalConductor", {"G": 3.0})
    spec = scenario.spec.with_parts([cooler], [("oil.heat", "cooler.a"), ("cooler.b", "room.floor")])
    (path := tmp_path / "extended.toml").write_text(rig_text(replace(scenario, spec=spec)))
    again = load(path)
    assert again.spec.part("cooler") == cooler
    assert again.value_sources["cooler.G"] == "assumed: set by an extension of the rig"


def test_what_is_added_at_a_port_joins_its_net(tmp_path: Path) -> None:
    scenario = load("wind_turbine")
    fan = PartSpec("fan", "ThermalConductor", {"G": 3.0})
    spec = scenario.spec.with_parts([fan], [("sump.heat", "fan.a"), ("fan.b", "nacelle.floor")])
    (path := tmp_path / "extended.toml").write_text(rig_text(replace(scenario, spec=spec)))
    ports = [port for net in load(path).spec.connections for port in net]
    assert {"fan.a", "fan.b", "thermostat.sensed"} < {*ports} and len({*ports}) == len(ports)
