"""The reference result: what FMPy reads and plays from it is what was written."""

import shutil
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv
from gearheat.fmu.related import write_reference


def test_fmpy_reproduces_the_reference_from_the_written_inputs(rc_fmu: Path, tmp_path: Path) -> None:
    fmu = Path(shutil.copy(rc_fmu, tmp_path / "circuit.fmu"))
    inputs = {"source.v": (np.array([0.0, 4, 4, 10]), np.array([5.0, 5, 0, 0]))}
    files = write_reference(fmu, inputs, 10, 0.5)
    assert [f.name for f in files] == ["circuit_in.csv", "circuit_ref.csv", "circuit_ref.opt"]
    assert "StopTime, 10.0\n" in files[2].read_text()
    given, expected = read_csv(str(files[0])), read_csv(str(files[1]))
    assert given["time"].tolist() == [0, 4, 4, 10]
    assert given["source.v"].tolist() == [5, 5, 0, 0]
    found = fmpy.simulate_fmu(str(fmu), stop_time=10, output_interval=0.5, input=given, relative_tolerance=1e-8)
    moments = expected["time"][np.append(True, np.diff(expected["time"]) > 0)]
    at = np.interp(moments, found["time"], found["capacitor.v"])
    assert at == pytest.approx(np.interp(moments, expected["time"], expected["capacitor.v"]), abs=1e-5)
