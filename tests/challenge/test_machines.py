"""The sheet of machines that nobody chose: the same seed gives the same bytes, and what is hidden shows."""

from pathlib import Path

import numpy as np
import pytest
from challenge import machines
from challenge.hide import APART
from gearheat.scenarios.load import load

CASES = {"clean": 4, "single": 2, "several": 0}


@pytest.mark.parametrize("kind", CASES)
def test_a_case_is_what_its_seed_says(kind: str, tmp_path: Path) -> None:
    first, again = (machines.make(5, 3, CASES[kind], tmp_path / name, kind) for name in ("one", "two"))
    one, two = (tmp_path / name / "case" for name in ("one", "two"))
    for file in ("DATA.csv", "machine.toml"):
        assert (one / file).read_bytes() == (two / file).read_bytes()
    assert first["effects"] == again["effects"] and first["kind"] == kind
    assert load(str(one / "machine.toml")).spec.parts
    table = np.genfromtxt(one / "DATA.csv", delimiter=",", names=True)
    assert 20 <= len(table) <= 32 and np.isfinite(table["T_oil_C"]).all()
    assert (table["T_oil_C"] - table["T_amb_C"]).max() > machines.WARM - 10.0  # an instrument may be wrong
    number = {"clean": (0, 0), "single": (1, 1), "several": (2, 4)}[kind]
    assert number[0] <= len(first["causes"]) <= number[1]
    assert all(machines.LEAST <= e["snr"] <= machines.MOST for e in first["effects"])


def test_probes_that_err_together_are_nearer_to_their_rivals_than_one_alone(tmp_path: Path) -> None:
    truth = machines.make(5, 3, 1, tmp_path, "single")
    machine = machines.Machine(tmp_path / "case" / "machine.toml", np.random.default_rng(0))
    oil, wall = ({}, {"T_oil": -3.0}), ({}, {"T_wall": -3.0})
    near, _ = machine.distance([oil, wall], {"sensor.oil_temp.offset", "sensor.wall_temp.offset"})
    far, _ = machine.distance([oil], {"sensor.oil_temp.offset"})
    assert near < far and far > APART and truth["rival"]["distance"] >= 0.0
