"""The sheet of machines that nobody chose: the same seed gives the same bytes, and what is hidden shows."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from challenge import machines
from challenge.hide import APART
from challenge.sheets import MAKERS
from gearheat.scenarios.load import load

#: Kind of a case -> its number, and how few and many causes it hides.
CASES = {"clean": (7, 0, 0), "single": (1, 1, 1), "several": (7, 2, 4)}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Path, dict[str, Any]]]:
    """Folder and truth of the case of a kind; made once."""

    @cache
    def make(kind: str) -> tuple[Path, dict[str, Any]]:
        folder = tmp_path_factory.mktemp(kind)
        return folder, machines.make(machines.Machine, 5, 3, CASES[kind][0], folder, kind)

    return make


@pytest.mark.parametrize("kind", CASES)
def test_a_case_shows_what_it_hides(kind: str, made) -> None:
    folder, truth = made(kind)
    assert truth["kind"] == kind
    assert load(str(folder / "case" / "machine.toml")).spec.parts
    table = np.genfromtxt(folder / "case" / "DATA.csv", delimiter=",", names=True)
    assert 20 <= len(table) <= 32 and np.isfinite(table["T_oil_C"]).all()
    assert (table["T_oil_C"] - table["T_amb_C"]).max() > machines.WARM - 10.0  # an instrument may be wrong
    assert CASES[kind][1] <= len(truth["causes"]) <= CASES[kind][2]
    assert all(machines.LEAST <= e["snr"] <= machines.MOST for e in truth["effects"])


def test_a_case_is_what_its_seed_says(made, tmp_path: Path) -> None:
    folder, first = made("several")
    again = machines.make(machines.Machine, 5, 3, CASES["several"][0], tmp_path, "several")
    for file in ("DATA.csv", "machine.toml"):
        assert (folder / "case" / file).read_bytes() == (tmp_path / "case" / file).read_bytes()
    assert first["effects"] == again["effects"]


def test_probes_that_err_together_are_nearer_to_their_rivals_than_one_alone(made) -> None:
    folder, truth = made("single")
    machine = machines.Machine(folder / "case" / "machine.toml", np.random.default_rng(1))
    oil, wall = ({}, {"T_oil": -3.0}), ({}, {"T_wall": -3.0})
    near, _ = machine.distance([oil, wall], {"sensor.oil_temp.offset", "sensor.wall_temp.offset"})
    far, _ = machine.distance([oil], {"sensor.oil_temp.offset"})
    assert near < far and far > APART and truth["rival"]["distance"] >= 0.0


@pytest.mark.parametrize(("sheet", "files"), [("logs", ["LOG.csv", "REFLOG.csv"]), ("lone_logs", ["LOG.csv"])])
def test_logs_of_machines(sheet: str, files: list[str], tmp_path: Path) -> None:
    """Their rows are evenly apart, the same seed gives the same ones, and what is hidden shows."""
    truth = MAKERS[sheet](2, 0, tmp_path / "first", kind="single")
    MAKERS[sheet](2, 0, tmp_path / "again", kind="single")
    assert sorted(path.name for path in (tmp_path / "first" / "case").glob("*.csv")) == files
    for name in files:
        assert (tmp_path / "first" / "case" / name).read_bytes() == (tmp_path / "again" / "case" / name).read_bytes()
        table = np.genfromtxt(tmp_path / "first" / "case" / name, delimiter=",", names=True)
        assert len(set(np.diff(table["time_s"]))) == 1 and np.isfinite(table["T_oil_C"]).all()
    assert len(truth["causes"]) == 1 and truth["effects"][0]["snr"] >= machines.LEAST and truth["rival"]["cause"]
