"""The electric axle drive: what its page says of its losses, of published figures and of the ends of its laws."""

import math

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import Scenario
from gearheat.scenarios.shipped import RIGS

COLUMNS = ("P_total_W", "P_mesh_W", "P_bearings_W", "P_seals_W", "P_windage_W", "P_jets_W", "P_pump_W")
RPM = math.pi / 30


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("e_axle")


@pytest.fixture(scope="module")
def flat(scenario: Scenario) -> FlatModel:
    return scenario.spec.flat()


def test_the_table_of_its_page(scenario: Scenario, flat: FlatModel) -> None:
    text = (RIGS / "e_axle" / "README.md").read_text(encoding="utf-8")
    lines = [line.strip("| \n").split("|") for line in text.splitlines() if line[:2] == "| " and line[2:5].isdigit()]
    assert len(lines) >= 6
    for n, tau, eta, *losses, T in [[float(cell) for cell in line] for line in lines]:
        found = steady(flat, {"input.w": n * RPM, "output.tau": -tau})
        expected = [sum(found[path][0] for path in scenario.losses[column]) for column in COLUMNS]
        assert losses == pytest.approx(expected, abs=0.6), n
        assert found["tank.T"][0] - 273.15 == pytest.approx(T, abs=0.06)
        assert eta == pytest.approx(100 * found["efficiency.eta"][0], abs=6e-3)
    assert found["input.tau"][0] > 0


def test_it_loses_less_than_makers_of_such_gearboxes_allow(flat: FlatModel) -> None:
    """BorgWarner2010: more than 97 %; 97 to 99.5 % of gearboxes in general."""
    for n, tau, ratio in ((16000.0, -880.0, 0.56), (4620.0, -3040.0, 0.71)):
        eta = steady(flat, {"input.w": n * RPM, "output.tau": tau})["efficiency.eta"][0]
        assert (1 - eta) / 0.03 == pytest.approx(ratio, abs=0.006)


def test_drag_without_load_and_a_wet_mist(flat: FlatModel) -> None:
    idle = steady(flat, {"output.tau": 0.0})
    assert idle["input.tau"][0] == pytest.approx(0.31, abs=0.005)
    gears = [q.name for q in flat.parameters if q.name.endswith("share_oil")]
    wet = steady(flat, dict.fromkeys(gears, 0.01))["efficiency.P_loss"][0]
    assert wet - steady(flat, {})["efficiency.P_loss"][0] == pytest.approx(153, abs=4)


def test_faster_than_its_laws_go_is_said(flat: FlatModel) -> None:
    assert not steady(flat, {}).outside
    fast = steady(flat, {"input.w": 20000 * RPM, "output.tau": -700.0}).outside
    assert {o.component for o in fast} == {"stage_1", "input_bearing_a", "input_bearing_b", "input_seal"}


def test_jets_cool_the_gears(flat: FlatModel) -> None:
    found = [steady(flat, {"jet_1.A": 0.03 * k, "jet_2.A": 0.05 * k})["gears.T"][0] for k in (0.1, 1.0, 3.0)]
    assert list(np.diff(found) < -1.0) == [True, True]
