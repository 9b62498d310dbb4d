"""`export --ssp`: the file is sound by SSP 1.0, and FMPy, which couples it, comes to what the whole rig does."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd
from gearheat.model.errors import ScenarioError
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.tools.export.systems import groups_of, split_rig, write_system
from gearheat.tools.solve.settings import flat_of
from importers import RIG, driven
from lxml import etree

GROUPS = groups_of(["cooler", "room = room, walls, outdoors"])


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ssp") / "block.ssp"
    write_system(RIG, split_rig(RIG, GROUPS, {}), path)
    return path


def test_the_file_is_sound(system: Path) -> None:
    with zipfile.ZipFile(system) as file:
        names = [f"resources/{name}" for name in ("gearbox", "cooler", "room")]
        held = {f"{name}{ending}" for name in names for ending in (".fmu", ".ssv")}
        assert {*file.namelist()} == {"SystemStructure.ssd", "Elements.ssd", *held}
        content = file.read("SystemStructure.ssd")
        alone = etree.fromstring(file.read("Elements.ssd"))  # libcosim and ecos know connections of elements alone
        assert all(c.get("startElement") for c in alone.iter("{*}Connection"))
        assert len(list(alone.iter("{*}Connection"))) == 4 + 2 and alone.find("{*}System/{*}Connectors") is None
        sets = {name: file.read(f"resources/{name}.ssv") for name in ("gearbox", "cooler", "room")}
    schema = Path(fmpy.__file__).parent / "ssp" / "schema" / "SystemStructureDescription.xsd"
    etree.XMLSchema(etree.parse(str(schema))).assertValid(etree.fromstring(content))
    read = read_ssd(str(system))
    (experiment,) = etree.fromstring(content).findall("{*}DefaultExperiment")
    assert dict(experiment.attrib) == {"startTime": "0.0", "stopTime": "14400.0"}
    assert {u.name for u in read.units} >= {"K", "W", "W/K"}
    kinds = {
        kind: {c.name for e in read.system.elements for c in e.connectors if c.kind == kind}
        for kind in ("output", "parameter")
    }
    assert kinds["output"] >= {"oil.T", "oil.Q_flow", "room.T", "room.Q_flow"}
    assert kinds["parameter"] >= {"oil.C", "cooler.G", "room.C"}
    assert {c.name for c in read.system.connectors} == {q.name for q in flat_of(RIG).inputs}
    for element in read.system.elements:
        values = {p.get("name") for p in etree.fromstring(sets[element.name]).iter("{*}Parameter")}
        assert values == {c.name for c in element.connectors if c.kind == "parameter"}
    annotation = etree.fromstring(content).find("{*}System/{*}Annotations/{*}Annotation")
    assert annotation.get("type") == "org.openmodelica"  # without it OMSimulator has no master
    assert [e.tag.partition("}")[2] for e in annotation.iter()][2:] == ["SimulationInformation", "FixedStepMaster"]


def test_a_duty_reaches_the_fmus(system: Path) -> None:
    """Heat into the oil, and a cold day outdoors: both were inputs of the FMUs alone."""
    duty = {"oil.Q_flow_external": 300.0, "outdoors.T": 270.0, "room.air_speed": 0.0}
    coupled = driven(system, 1200.0, 5.0, duty)
    alone = simulate(flat_of(RIG), join_phases([(1200.0, duty)]), times=[1200.0])
    for element, name in (("gearbox", "oil.T"), ("room", "room.T")):
        assert coupled[f"{element}.{name}"][-1] == pytest.approx(alone[name][-1], abs=0.1)


def test_all_fmus_start_where_the_rig_does() -> None:
    taken = split_rig(RIG, GROUPS, {"oil.T": 350.0})
    assert taken.starts["gearbox"]["oil.T"] == taken.starts["cooler"]["oil.T"] == 350.0
    assert taken.starts["gearbox"]["cooler.Q_flow"] == pytest.approx(-8.0 * (350.0 - 290.0))
    assert taken.starts["room"]["cooler.Q_flow"] == pytest.approx(8.0 * (350.0 - 290.0))
    assert taken.starts["room"]["gearbox.Q_flow"] > 0


def test_the_error_of_coupling_falls_with_the_step(system: Path) -> None:
    whole, errors = flat_of(RIG), []
    for step in (10.0, 5.0, 2.5):
        coupled = driven(system, 600.0, step)
        duty = join_phases([(600.0, {q.name: q.start for q in whole.inputs})])
        alone = simulate(whole, duty, times=np.append(0.0, coupled["time"] + step))
        errors.append(np.abs(coupled["gearbox.oil.T"] - alone["oil.T"][1:]).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 0.3


def test_inputs_of_several_fmus_are_those_of_the_system(tmp_path: Path) -> None:
    path = tmp_path / "apart.ssp"
    found = write_system(RIG, split_rig(RIG, groups_of(["world=outdoors", "room=room,walls"]), {}), path)
    assert {*found["inputs"]} == {q.name for q in flat_of(RIG).inputs}
    coupled = driven(path, 60.0, 10.0, {"outdoors.T": 270.0})
    assert coupled["room.outdoors.T"][-1] == coupled["world.outdoors.T"][-1] == 270.0


def test_what_does_not_work_is_told(gearheat, tmp_path: Path) -> None:
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.ssp", "--ssp", "foot", "--fmi", "3")
    assert answer.code == 2
    assert "--fmi 3 does not go with --ssp" in answer.err
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.ssp", "--ssp", "oil")
    assert answer.code == 2
    assert "Only nets of heat ports are cut" in answer.err
    with pytest.raises(ScenarioError, match="named twice"):
        groups_of(["room=room", "room=walls"])
    with pytest.raises(ScenarioError, match="no part"):
        split_rig(replace(RIG, name="other"), {"a": ["b"]}, {})


def test_an_fmu_that_would_exchange_nothing_is_refused(gearheat, tmp_path: Path) -> None:
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.ssp", "--ssp", "room")
    assert answer.code == 2
    assert "--ssp room: would exchange nothing" in answer.err and "ClosedRoom" in answer.err
    assert not list(tmp_path.iterdir())


def test_endings_say_what_is_written(gearheat, tmp_path: Path) -> None:
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.ssp")
    assert answer.code == 2
    assert "Say with --ssp which parts are one, or write a .fmu." in answer.err
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.fmu", "--ssp", "cooling")
    assert answer.code == 2
    assert "Name it *.ssp." in answer.err
    answer = gearheat("export", "planetary", "-o", tmp_path / "p.fmu", "--extras", tmp_path / "p.fmu")
    assert answer.code == 2
    assert "is the FMU itself. Give the folder another name." in answer.err
    assert not list(tmp_path.iterdir())
