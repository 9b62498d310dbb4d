"""The FMU of a model with rigid couplings: one state, and it says what follows it."""

import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu
from gearheat.fmu.export import export
from gearheat.fmu.play import play
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from small_parts import Ambient, Body, Conductor, Flywheel, LossyGear, Torque, model


def test_two_inertias_through_a_gear_are_one_state(tmp_path: Path) -> None:
    parts = (Torque("drive"), Flywheel("rotor", J=0.5), LossyGear("gear", ratio=3.0, mu=0.05), Flywheel("mill", J=4.0))
    parts += (Torque("load"), Body("body", C=800.0), Conductor("foot", G=4.0), Ambient("room"))
    nets = [("drive.shaft", "rotor.shaft", "gear.a"), ("gear.b", "mill.shaft", "load.shaft")]
    nets += [("gear.heat", "body.heat", "foot.a"), ("foot.b", "room.heat")]
    flat = model(*parts, nets=nets)
    path = export(flat, tmp_path / "joined.fmu")
    assert validate_fmu(str(path)) == []
    root = ET.fromstring(zipfile.ZipFile(path).read("modelDescription.xml"))
    assert "mill.w follows rotor.w" in root.get("description", "")
    variables = {v.get("name"): v for v in root.iter("ScalarVariable")}
    assert variables["mill.w"].get("description", "").endswith("mill.w follows rotor.w")
    assert variables["mill.w"].get("causality") == "output"
    derivatives = [name for name in variables if name.startswith("der(") and not name.startswith("der(energy.")]
    assert derivatives == ["der(rotor.w)", "der(body.T)"]

    start, duty = {"rotor.w": 30.0}, {"drive.tau": 10.0, "load.tau": -12.0}
    played = play(path, {}, 5.0, 1.0, start={**start, **duty}, tolerance=1e-9)
    own = simulate(flat, join_phases([(5.0, duty)]), start=start, times=played.time)
    assert played["mill.w"] == pytest.approx(own["mill.w"], rel=1e-6)
    assert played["mill.w"] == pytest.approx(played["rotor.w"] / 3, rel=1e-12)
