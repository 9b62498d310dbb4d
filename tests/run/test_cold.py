"""Cold rigs and rigs at rest: thick oil brakes, friction holds, and a run says which law it has left."""

import math

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

RPM = math.pi / 30
BEARINGS = [f"{shaft}_bearing_{end}" for shaft in ("input", "middle", "output") for end in "ab"]


def reducer(values: dict | None = None, **given: tuple[str, ...]) -> FlatModel:
    spec = load("helical_two_stage").spec.with_values(values or {})
    return spec.driven(given or {"input": ("w",), "output": ("tau",)}).flat()


@pytest.fixture(scope="module")
def driven() -> FlatModel:
    return reducer()


@pytest.fixture(scope="module")
def free() -> FlatModel:
    """Torques given at both ends: the speed is a state."""
    return reducer(input=("tau",), output=("tau",))


def test_a_colder_room_costs_more(driven: FlatModel) -> None:
    """Efficiency falls and bearings lose more all the way down; the starved formula gave 97.25 % at -40 degC."""
    points = [steady(driven, {"room.T": 273.15 + T}) for T in (20.0, 0.0, -20.0, -40.0)]
    etas = [float(point["efficiency.eta"][0]) for point in points]
    bearings = [sum(float(point[f"{name}.P_loss"][0]) for name in BEARINGS) for point in points]
    assert etas == sorted(etas, reverse=True) and etas[-1] < 0.957
    assert bearings == sorted(bearings) and bearings[-1] > 2 * bearings[0]


@pytest.mark.parametrize("T", [-40.0, -20.0, 0.0])
def test_a_cold_bearing_brakes_before_it_has_warmed_up(driven: FlatModel, T: float) -> None:
    """Every loss at the first moment is that of a warmer start or more, but the teeth: they are lubricated better."""
    losses = []
    for start in (273.15 + T, 273.15 + T + 15.0):
        run = simulate(driven, join_phases([(1e-3, {})]), start=dict.fromkeys((q.name for q in driven.states), start))
        losses.append({name: run[name][0] for name in run.columns if "bearing" in name or "churning" in name})
    assert all(losses[0][name] > losses[1][name] for name in losses[0] if name.endswith("P_loss"))


@pytest.mark.parametrize(
    ("tau_in", "tau_out"), [(0.02, 0.0), (-0.05, 0.0), (0.064, 0.0), (46.97, -590.0), (47.5, -590.0), (46.4, -590.0)]
)
def test_a_rig_at_rest_stays_at_rest(free: FlatModel, tau_in: float, tau_out: float) -> None:
    """Below its breakaway torque, without load and with one that hangs on it, no shaft creeps by 0.001 rpm."""
    run = simulate(free, join_phases([(600.0, {"input.tau": tau_in, "output.tau": tau_out})]), start={"rotor.w": 0.0})
    assert np.abs(run["input.w"]).max() < 1e-3 * RPM
    assert run.audit.residual < 1e-6


def test_a_rig_breaks_away_above_it(free: FlatModel) -> None:
    run = simulate(free, join_phases([(60.0, {"input.tau": 0.1, "output.tau": 0.0})]), start={"rotor.w": 0.0})
    assert run["input.w"][-1] > 10 * RPM


def test_oil_below_its_pour_point_is_named(driven: FlatModel) -> None:
    """ISO VG 220 mineral pours above -18 degC; the warm point names nothing of the oil."""
    start = dict.fromkeys((q.name for q in driven.states), 253.15)
    run = simulate(driven, join_phases([(60.0, {"room.T": 253.15})]), start=start)
    (found,) = [o for o in run.outside if o.component == "oil"]
    assert (found.law, found.argument) == ("kinematic_viscosity", "T - T_pour")
    assert found.lowest == pytest.approx(-2.0, abs=0.01)
    assert not [o for o in steady(driven, {}).outside if o.component == "oil"]


def test_an_oil_without_a_pour_point_is_not_judged() -> None:
    spec = load("helical_two_stage").spec
    parts = tuple(p for p in spec.parts if p.name == "oil")
    assert "T_pour" in parts[0].values
    unknown = reducer({"oil.T_pour": 0.0})
    start = dict.fromkeys((q.name for q in unknown.states), 253.15)
    run = simulate(unknown, join_phases([(1.0, {"room.T": 253.15})]), start=start)
    assert not [o for o in run.outside if o.component == "oil"]
