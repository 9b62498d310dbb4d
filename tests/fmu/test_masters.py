"""Masters of others: what they do before they have values to pass on must not stop the FMU."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp

SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" name="bench" version="1.0">
  <ssd:System name="bench">
    <ssd:Connectors>
      <ssd:Connector name="weather" kind="input"><ssc:Real/></ssd:Connector>
      <ssd:Connector name="T" kind="output"><ssc:Real/></ssd:Connector>
    </ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="box" type="application/x-fmu-sharedlibrary" source="resources/box.fmu">
        <ssd:Connectors>
          <ssd:Connector name="room.T" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="oil.T" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startConnector="weather" endElement="box" endConnector="room.T"/>
      <ssd:Connection startElement="box" startConnector="oil.T" endConnector="T"/>
    </ssd:Connections>
  </ssd:System>
</ssd:SystemStructureDescription>
"""


def test_fmpy_runs_a_system_whose_room_is_connected(heat_fmu: Path, tmp_path: Path) -> None:
    """It fills all inputs with zeros before the first step, and connects them after it."""
    path = tmp_path / "bench.ssp"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("SystemStructure.ssd", SYSTEM)
        file.write(heat_fmu, "resources/box.fmu")
    found = simulate_ssp(str(path), stop_time=3600.0, step_size=60.0, input={"weather": lambda t: 280.0})
    (oil,) = [name for name in found.dtype.names if name.endswith("oil.T")]
    assert np.isfinite(found[oil]).all()
    assert found[oil][-1] > found[oil][0] == pytest.approx(294.0, abs=2.0)
