from __future__ import annotations

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.scenarios.load import load
from gearheat.tools.settings import adjusted, deduced, driven_at, driven_by, flat_of

GIVEN = {"carrier": ("w", "tau")}


@pytest.mark.parametrize(
    ("named", "drive"),
    [
        ((), {"carrier": ("w", "tau")}),
        (("carrier.w",), {"carrier": ("tau", "w")}),
        (("sun.w",), {"carrier": ("tau",), "sun": ("w",)}),
        (("sun.tau",), {"carrier": ("w",), "sun": ("tau",)}),
        (("sun.w", "sun.tau"), {"sun": ("w", "tau")}),
        (("carrier.tau", "sun.tau"), {"carrier": ("tau",), "sun": ("tau",)}),
    ],
)
def test_named_quantities_take_the_place_of_given_ones(named, drive):
    found = deduced(GIVEN, named)
    assert {end: set(quantities) for end, quantities in found.items()} == {e: set(q) for e, q in drive.items()}


def test_a_machine_driven_by_torques_alone_keeps_its_speed_as_a_state():
    flat = flat_of(adjusted(load("planetary"), ["carrier.tau=2500 N.m", "sun.tau=-600 N.m"]))
    assert "rotor.w" in {q.name for q in flat.states}
    assert {"carrier.tau", "sun.tau"} <= {q.name for q in flat.inputs}


def test_settings_reach_the_model_in_si():
    scenario = adjusted(load("planetary"), ["cooling.A=5000 cm2", "room.T=0 degC", "wall.T=40 degC", "oil=MINE"])
    flat = flat_of(scenario)
    assert flat.quantity("cooling.A").start == pytest.approx(0.5)
    assert flat.quantity("room.T").start == pytest.approx(273.15)
    assert flat.quantity("wall.T").start == pytest.approx(313.15)
    assert flat.quantity("oil.rho_15").start == pytest.approx(893.0)
    assert scenario.value_sources["cooling.A"] == "set on the command line"


def test_inputs_that_are_no_shaft_quantities_leave_the_drive_alone():
    scenario = load("planetary")
    assert driven_by(scenario, ["room.T", "room.air_speed"]).given == scenario.given


def test_drives_of_an_fmu():
    scenario = load("planetary")
    assert driven_at(scenario, None, "speed") == dict(scenario.given)
    assert driven_at(scenario, "sun", "speed") == {"sun": ("w", "tau")}
    assert driven_at(scenario, None, "torque") == {"carrier": ("tau",), "sun": ("tau",)}
    with pytest.raises(ScenarioError, match="shaft end"):
        driven_at(scenario, "room", "speed")
