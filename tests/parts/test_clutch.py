"""Clutches, brake and spring in motion: they hold, slip and overrun. Every run audits its energy by itself."""

import numpy as np
import pytest
from gearheat.model.core.component import Component
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flatten import flatten
from gearheat.model.parts import PARTS
from gearheat.model.run.result import Result
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady


def run(coupling: Component, phases: list, start: dict[str, float] | None = None) -> Result:
    """Two inertias of 0.1 kg.m2, a torque given on either, a coupling between them and a body for its heat."""
    parts = (
        PARTS["ShaftEnd"]("motor", given=("tau",)),
        PARTS["Inertia"]("first", J=0.1),
        coupling,
        PARTS["Inertia"]("second", J=0.1),
        PARTS["ShaftEnd"]("load", given=("tau",)),
        PARTS["HeatCapacity"]("body", C=500.0),
    )
    nets = (
        ("motor.flange", "first.flange", "coupling.a"),
        ("coupling.b", "second.flange", "load.flange"),
        ("coupling.heat", "body.heat"),
    )
    flat = flatten(Assembly("drive", "", parts, nets))
    stop = sum(duration for duration, _ in phases)
    return simulate(flat, join_phases(phases), start=start, times=np.linspace(0.0, stop, 41), method="lsoda")


def test_a_clutch_is_open_slips_at_its_capacity_and_then_holds() -> None:
    """20 N.m bring 100 and 0 rad/s together at 50 in 0.25 s; half of the energy, 250 of 500 J, becomes heat."""
    given = {"motor.tau": 0.0, "load.tau": 0.0}
    duty = [(0.5, given | {"coupling.tau_max": 0.0}), (0.5, given | {"coupling.tau_max": 20.0})]
    found = run(PARTS["FrictionClutch"]("coupling"), duty, {"first.w": 100.0})
    opened, slipping = found.index < 0.5, (found.index > 0.5) & (found.index < 0.74)
    assert found["first.w"][opened] == pytest.approx(100.0, abs=1e-6)
    assert found["coupling.tau"][slipping] == pytest.approx(20.0, rel=1e-6)
    assert found["first.w"][slipping] == pytest.approx(200.0 - 200.0 * found.index[slipping], abs=1e-3)
    assert found["first.w"][-1] == pytest.approx(50.0, abs=1e-3)
    assert 500.0 * (found["body.T"][-1] - found["body.T"][0]) == pytest.approx(250.0, rel=1e-4)


def test_a_one_way_clutch_drives_and_overruns() -> None:
    """Driven at a the halves turn together; driven at b, b runs ahead and a is dragged."""
    clutch = PARTS["OneWayClutch"]("coupling", tau_max=500.0, tau_drag=0.1)
    duty = [(1.0, {"motor.tau": 10.0, "load.tau": 0.0}), (1.0, {"motor.tau": 0.0, "load.tau": 10.0})]
    found = run(clutch, duty, {"first.w": 20.0, "second.w": 20.0})
    assert found["second.w"][20] == pytest.approx(70.0, rel=1e-3)
    assert found["coupling.slip"][19] == pytest.approx(0.0, abs=0.01)
    assert found["second.w"][-1] == pytest.approx(169.0, rel=2e-3)
    assert found["first.w"][-1] == pytest.approx(71.0, rel=5e-3)


def test_a_spring_twists_by_its_torque_and_gives_its_energy_back() -> None:
    shaft = PARTS["CompliantShaft"]("coupling", c=200.0, d=8.0)
    found = run(shaft, [(4.0, {"motor.tau": 10.0, "load.tau": 0.0})], {"first.w": 20.0, "second.w": 20.0})
    assert found["coupling.phi"][-1] == pytest.approx(5.0 / 200.0, rel=1e-4)
    assert found["first.w"][-1] == pytest.approx(found["second.w"][-1], rel=1e-3)


def test_a_brake_stops_a_shaft_and_keeps_its_energy_as_heat() -> None:
    parts = (
        PARTS["ShaftEnd"]("motor", given=("tau",)),
        PARTS["Inertia"]("rotor", J=0.1),
        PARTS["Brake"]("brake", count=1.0, inner_share=0.5),
        PARTS["HeatCapacity"]("body", C=500.0),
    )
    nets = (("motor.flange", "rotor.flange", "brake.shaft"), ("brake.inner", "brake.outer", "body.heat"))
    duty = join_phases([(1.0, {"brake.tau_max": 20.0, "motor.tau": 5.0})])
    found = simulate(flatten(Assembly("b", "", parts, nets)), duty, start={"rotor.w": 100.0}, times=[0.5, 1.0])
    assert found["rotor.w"] == pytest.approx([25.0, 0.0], abs=1e-3)
    supplied = 5.0 * 100.0**2 * 0.1 / (2 * 15.0)  # by the motor while it slows down
    assert 500.0 * (found["body.T"][1] - 298.15) == pytest.approx(500.0 + supplied, rel=1e-3)


@pytest.mark.parametrize("kind", ["FrictionClutch", "OneWayClutch"])
def test_a_clutch_that_holds_has_a_steady_state(kind: str) -> None:
    values = dict(tau_max=50.0, tau_drag=0.1) if kind == "OneWayClutch" else {}
    parts = (
        PARTS["ShaftEnd"]("motor", given=("w",)),
        PARTS[kind]("coupling", **values),
        PARTS["ShaftEnd"]("load", given=("tau",)),
        PARTS["PrescribedTemperature"]("body"),
    )
    nets = (("motor.flange", "coupling.a"), ("coupling.b", "load.flange"), ("coupling.heat", "body.heat"))
    flat = flatten(Assembly("drive", "", parts, nets))
    given = {"motor.w": 100.0, "load.tau": -20.0} | ({} if values else {"coupling.tau_max": 50.0})
    found = steady(flat, given)
    assert found["load.w"][0] == pytest.approx(100.0, abs=0.01)
    assert found["motor.tau"][0] == pytest.approx(20.0, rel=1e-9)
