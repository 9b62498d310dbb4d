"""Runs of the shipped planetary gearbox: every drive, both directions, rest, no load, overload."""

import math

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import SolveError
from gearheat.model.run.design import design
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady, steady_table
from gearheat.scenarios.load import load

RPM = math.pi / 30
NOMINAL = {"carrier.w": 250 * RPM, "carrier.tau": 2500.0}
TEMPERATURES = ("oil.T", "gears.T", "carrier_body.T", "wall.T", "surface.T")


def gearbox(**given: tuple[str, ...]) -> FlatModel:
    return load("planetary").spec.driven(given).flat()


@pytest.fixture(scope="module")
def flat() -> FlatModel:
    return gearbox(carrier=("w", "tau"))


def test_a_day_on_the_rig(flat: FlatModel) -> None:
    """240 min multiplier, 90 min reducer, 5 min stop: energy is kept and 240 min are long enough for steady."""
    turned = {"carrier.w": 150 * RPM, "carrier.tau": -2000.0}
    duty = join_phases([(14400.0, NOMINAL), (5400.0, turned), (300.0, {"carrier.w": 0.0, "carrier.tau": 0.0})])
    run = simulate(flat, duty)
    assert run.audit.residual < 1e-6
    assert max(run.implicit.values(), default=0.0) < 1e-9
    assert run["oil.T"][run.index == 14400.0][0] == pytest.approx(steady(flat, NOMINAL)["oil.T"][0], abs=0.05)
    assert run["oil.T"][-1] < run["oil.T"][run.index == 19800.0][0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_point_whatever_is_given(flat: FlatModel, sign: float) -> None:
    """Speed and torque at either shaft describe the same point."""
    known = steady(flat, {"carrier.w": 250 * RPM, "carrier.tau": sign * 2500.0})
    for given in ({"sun": ("w", "tau")}, {"carrier": ("w",), "sun": ("tau",)}, {"carrier": ("tau",), "sun": ("w",)}):
        values = {f"{end}.{q}": float(known[f"{end}.{q}"][0]) for end, names in given.items() for q in names}
        same = steady(gearbox(**given), values)
        for name in (*TEMPERATURES, "efficiency.eta", "carrier.tau", "sun.tau", "sun.w"):
            assert same[name][0] == pytest.approx(known[name][0], rel=1e-8)


@pytest.mark.parametrize("tau", [2500.0, -2500.0, 0.0])
def test_turned_around(flat: FlatModel, tau: float) -> None:
    """Backwards with the torque backwards is the same machine in a mirror."""
    one, other = (steady(flat, {"carrier.w": s * 250 * RPM, "carrier.tau": s * tau}) for s in (1.0, -1.0))
    for name in TEMPERATURES:
        assert one[name][0] == pytest.approx(other[name][0], abs=1e-7)
    assert one["sun.tau"][0] == pytest.approx(-other["sun.tau"][0], rel=1e-9)


@pytest.mark.parametrize("tau", [2500.0, 0.0, -2500.0])
def test_at_rest_nothing_is_warm(flat: FlatModel, tau: float) -> None:
    point = steady(flat, {"carrier.w": 0.0, "carrier.tau": tau, "room.T": 290.0})
    for name in TEMPERATURES:
        assert point[name][0] == pytest.approx(290.0, abs=1e-9)
    assert point["efficiency.P_loss"][0] == pytest.approx(0.0, abs=1e-9)


def test_without_load_all_power_is_loss(flat: FlatModel) -> None:
    point = steady(flat, {"carrier.w": 100 * RPM, "carrier.tau": 0.0})
    assert point["efficiency.eta"][0] == pytest.approx(0.0, abs=1e-4)
    assert point["sun.P"][0] == pytest.approx(point["efficiency.P_loss"][0], rel=1e-9)


def test_a_grid_of_points(flat: FlatModel) -> None:
    rows = [{"carrier.w": n * RPM, "carrier.tau": tau} for n in (1, 100, 250) for tau in (-2800.0, 0.0, 2800.0)]
    table = steady_table(flat, rows)
    assert table.audit.residual < 1e-9
    assert np.isfinite(table["oil.T"]).all()
    assert (np.diff(table["oil.T"][[2, 5, 8]]) > 0).all()


@pytest.mark.parametrize("w", [0.0, 50.0, 105.0])
def test_torque_at_both_ends(w: float) -> None:
    """The machine goes where the run goes, from rest and from speed."""
    both = gearbox(carrier=("tau",), sun=("tau",))
    values = {"carrier.tau": 2500.0, "sun.tau": -620.0}
    end = simulate(both, join_phases([(1e6, values)]), start={"rotor.w": w}, times=[1e6])
    point = steady(both, values, guess={"rotor.w": w})
    assert point["rotor.w"][0] == pytest.approx(end["rotor.w"][0], abs=1e-5)
    assert point["oil.T"][0] == pytest.approx(end["oil.T"][0], abs=1e-4)


def test_an_overload_does_not_pass_in_silence(flat: FlatModel) -> None:
    for factor in (10, 30, 100):
        values = {name: factor * value for name, value in NOMINAL.items()}
        try:
            point = steady(flat, values)
        except SolveError as error:
            assert "no solution at carrier.w" in str(error)
        else:
            assert any(o.law == "kinematic_viscosity" for o in point.outside)


def test_a_housing_for_an_oil_temperature(flat: FlatModel) -> None:
    found = design(flat, ["cooling.A"], {"oil.T": 345.0}, NOMINAL)
    end = simulate(flat, join_phases([(1e6, NOMINAL)]), values=found.values, times=[1e6])
    assert end["oil.T"][0] == pytest.approx(345.0, abs=1e-4)
    h = 0.01
    ends = [design(flat, ["cooling.A"], {"oil.T": 345.0 + s}, NOMINAL).values["cooling.A"] for s in (h, -h)]
    assert found.sensitivity[0, 0] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-5)


def test_a_load_and_a_housing_together(flat: FlatModel) -> None:
    targets = {"sun.tau": -600.0, "oil.T": 350.0}
    found = design(flat, ["carrier.tau", "cooling.A"], targets, NOMINAL)
    again = steady(flat, {**NOMINAL, **found.values})
    assert again["sun.tau"][0] == pytest.approx(-600.0, rel=1e-8)
    assert again["oil.T"][0] == pytest.approx(350.0, abs=1e-6)
