"""Steady states: against equations by hand, standing and torque-driven shafts, several balances, none."""

from collections.abc import Iterator

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.component import Equation, equation
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.run.newton import stable
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady, steady_table
from hypothesis import given, settings, strategies as st
from scipy.optimize import brentq
from scipy.sparse import csc_matrix
from small_parts import (
    SIGMA,
    Ambient,
    Body,
    Conductor,
    Flywheel,
    Friction,
    Torque,
    brake,
    gear,
    model,
    motor,
    rc,
)


def brake_by_hand(w: float, T_room: float = 300.0) -> tuple[float, float]:
    """Oil and wall temperature of `brake()` from its two balances."""

    def loss(T_oil: float) -> float:
        return (2.0 * w / np.sqrt(w**2 + 1e-4) + 0.1 * w * np.exp(-0.02 * (T_oil - 313.15))) * w

    def leaves(T_wall: float) -> float:
        return 5.0 * (T_wall - T_room) + 0.3 * SIGMA * (T_wall**4 - T_room**4)

    def oil(T_wall: float) -> float:
        return T_wall + leaves(T_wall) / 20.0

    T_wall = brentq(lambda T: leaves(T) - loss(oil(T)), T_room - 1e-6, 1000.0, xtol=1e-12)
    return oil(T_wall), T_wall


@pytest.mark.parametrize("w", [0.0, 1e-3, 1.0, 30.0, 150.0, 400.0, -150.0])
def test_against_the_balances_by_hand(w: float) -> None:
    point = steady(brake(), {"drive.w": w})
    assert (point.kind, point.index.tolist()) == ("steady", [0.0])
    assert [point["oil.T"][0], point["wall.T"][0]] == pytest.approx(brake_by_hand(w), abs=1e-7)
    assert point.audit.residual < 1e-9


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.floats(-300.0, 300.0), st.floats(250.0, 350.0), st.floats(1.0, 3000.0), st.floats(1.0, 3000.0))
def test_from_any_start(w: float, T_room: float, T_oil: float, T_wall: float) -> None:
    guess = {"oil.T": min(T_oil, 1900.0), "wall.T": min(T_wall, 1900.0)}
    point = steady(brake(), {"drive.w": w, "room.T": T_room}, guess=guess)
    assert [point["oil.T"][0], point["wall.T"][0]] == pytest.approx(brake_by_hand(w, T_room), abs=1e-6)


def test_standstill_is_the_room() -> None:
    point = steady(gear(), {"drive.w": 0.0, "load.tau": -30.0, "room.T": 280.0})
    assert point["body.T"][0] == 280.0
    assert point["gear.P_loss"][0] == 0.0
    assert point.audit.residual < 1e-9


@pytest.mark.parametrize("tau", [2.5, 4.0, 5.0, -5.0])
@pytest.mark.parametrize("w", [-300.0, -1.0, 0.0, 500.0])
def test_a_shaft_driven_by_torque(tau: float, w: float) -> None:
    """Speed where friction takes the torque; whatever the start, for friction that does not thin there is one only."""
    point = steady(motor(thinning=0.0), {"drive.tau": tau}, guess={"rotor.w": w})
    speed = brentq(lambda v: 2.0 * v / np.sqrt(v**2 + 1e-4) + 0.1 * v - abs(tau), 0.0, 100.0, xtol=1e-13)
    assert point["rotor.w"][0] == pytest.approx(np.copysign(speed, tau), rel=1e-8)
    assert point["bearing.P_loss"][0] == pytest.approx(tau * point["rotor.w"][0], rel=1e-9)


@pytest.mark.parametrize("w", [-100.0, -1.0, 0.0, 1.0, 100.0])
def test_a_torque_below_dry_friction_leaves_the_shaft_at_rest(w: float) -> None:
    point = steady(motor(), {"drive.tau": 5.0, "load.tau": -4.0}, guess={"rotor.w": w})
    assert 0 < point["rotor.w"][0] < 0.01


class Stribeck(Friction):
    """Friction that falls with the speed before it rises: three balances for one torque, the middle one unstable."""

    def equations(self) -> Iterator[Equation]:
        w = self.shaft.w
        size = 1.0 + 3.0 * ca.exp(-ca.fabs(w) / 5.0) + self.d_40 * ca.fabs(w)
        yield equation("opposes rotation", self.shaft.tau, size * w / ca.sqrt(w**2 + 1e-4))
        yield equation("power", self.P_loss, self.shaft.tau * w)
        yield equation("becomes heat", self.heat.Q_flow, -self.P_loss)


def stribeck() -> FlatModel:
    parts = (
        Torque("drive"),
        Flywheel("rotor", J=0.5),
        Stribeck("bearing", tau_dry=0.0, d_40=0.02, thinning=0.0),
        Body("body", C=500.0),
        Conductor("foot", G=5.0),
        Ambient("room"),
    )
    nets = [
        ("drive.shaft", "rotor.shaft", "bearing.shaft"),
        ("body.heat", "bearing.heat", "foot.a"),
        ("foot.b", "room.heat"),
    ]
    return model(*parts, nets=nets)


@pytest.mark.parametrize(
    ("w", "runs"), [(0.0, False), (2.0, False), (5.5, False), (6.5, True), (8.0, True), (30.0, True)]
)
def test_of_several_balances_the_one_where_the_machine_goes(w: float, runs: bool) -> None:
    """Balances at rest, near 6 rad/s (unstable) and near 50 rad/s: the start decides as it does for the run."""
    flat = stribeck()
    point = steady(flat, {"drive.tau": 2.0}, guess={"rotor.w": w})
    end = simulate(flat, join_phases([(1e5, {"drive.tau": 2.0})]), start={"rotor.w": w}, times=[1e5])
    assert (point["rotor.w"][0] > 40.0) == runs
    assert point["rotor.w"][0] == pytest.approx(end["rotor.w"][0], abs=1e-4)


def test_a_start_at_the_unstable_balance_is_left() -> None:
    flat = stribeck()
    middle = brentq(lambda w: 1.0 + 3.0 * np.exp(-w / 5.0) + 0.02 * w - 2.0, 3.0, 15.0, xtol=1e-14)
    heat = 300.0 + 2.0 * middle / 5.0
    point = steady(flat, {"drive.tau": 2.0}, guess={"rotor.w": middle, "body.T": heat})
    assert abs(point["rotor.w"][0] - middle) > 1.0


def test_a_table_is_its_points() -> None:
    flat = motor(thinning=0.0)
    rows = [{"drive.tau": tau, "room.T": T} for tau in (3.0, -4.0, 1.0, 20.0) for T in (280.0, 310.0)]
    table = steady_table(flat, rows)
    assert table.index.tolist() == list(range(8))
    for k, row in enumerate(rows):
        single = steady(flat, row)
        for q in flat.states:
            assert table[q.name][k] == pytest.approx(single[q.name][0], rel=1e-8, abs=1e-10)
    back = steady_table(flat, rows[::-1])
    assert table["body.T"] == pytest.approx(back["body.T"][::-1], rel=1e-9)
    assert table.audit.residual < 1e-9


def test_no_solution_names_conditions_state_and_remedy() -> None:
    with pytest.raises(SolveError) as caught:
        steady(brake(thinning=-0.02), {"drive.w": 100.0, "room.T": 293.15})
    text = str(caught.value)
    assert "steady: no solution at drive.w = 954.9 rpm, room.T = 20 degC (last oil.T " in text
    assert "degC after" in text
    assert "The loss grows faster than the cooling" in text
    assert "There are solutions up to" in text
    assert len(text.splitlines()) <= 3


def test_no_solution_because_nothing_brakes() -> None:
    with pytest.raises(SolveError) as caught:
        steady(motor(d_40=0.0), {"drive.tau": 20.0})
    assert "rotor.w" in str(caught.value)
    assert "The torques balance at no speed" in str(caught.value)


def test_the_last_solutions_of_a_thermal_runaway() -> None:
    """Solutions exist up to a certain speed; just below it they are found, above refused, and the run agrees."""
    flat = brake(thinning=-0.02)

    def solvable(w: float) -> bool:
        try:
            steady(flat, {"drive.w": w})
        except SolveError:
            return False
        return True

    low, high = 10.0, 100.0
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if solvable(middle) else (low, middle)
    assert 30.0 < low < 33.0  # from the fold of the two balances by hand
    near = steady(flat, {"drive.w": 0.99 * low})
    end = simulate(flat, join_phases([(1e7, {"drive.w": 0.99 * low})]), times=[1e7])
    assert near["oil.T"][0] == pytest.approx(end["oil.T"][0], abs=1e-4)
    with pytest.raises(SolveError):
        simulate(flat, join_phases([(1e7, {"drive.w": 1.01 * high})]), times=[1e7])


def test_all_points_without_solution_are_named() -> None:
    rows = [{"drive.w": w} for w in (10.0, 100.0, 20.0, 200.0)]
    with pytest.raises(SolveError) as caught:
        steady_table(brake(thinning=-0.02), rows)
    assert [problem[:8] for problem in caught.value.problems] == ["point 2:", "point 4:"]


def test_a_body_that_nothing_cools() -> None:
    flat = model(Body("a", C=1.0), Body("b", C=2.0), Conductor("c", G=1.0), nets=[("a.heat", "c.a"), ("b.heat", "c.b")])
    with pytest.raises(SolveError, match=r"nothing holds [ab]\.T"):
        steady(flat, {"a.Q": 1.0})


def test_wrong_names() -> None:
    with pytest.raises(ScenarioError) as caught:
        steady(rc(), {"battery.U": 1.0, "capacitor.u": 1.0}, guess={"resistor.R": 1.0})
    assert len(caught.value.problems) == 3
    with pytest.raises(SolveError, match="no point"):
        steady_table(rc(), [])


def test_a_large_network_is_solved_sparse(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rod that is heated at one end and cooled along its length: T - T_room falls as a cosh."""
    n = 160
    parts = [Ambient("room"), *(Body(f"m{k}", C=1e3) for k in range(n))]
    parts += [*(Conductor(f"g{k}", G=10.0) for k in range(n - 1)), *(Conductor(f"c{k}", G=1e-4) for k in range(n))]
    nets = [("room.heat", *(f"c{k}.b" for k in range(n)))]
    nets += [(f"m{k}.heat", f"c{k}.a", *([f"g{k}.a"] * (k < n - 1)), *([f"g{k - 1}.b"] * (k > 0))) for k in range(n)]
    flat = model(*parts, nets=nets)
    hot = steady(flat, {"m0.Q": 5.0})
    rise = np.array([hot[f"m{k}.T"][0] for k in range(n)]) - 300.0
    mu = np.arccosh(1 + 1e-4 / 10.0 / 2)
    assert rise / rise[-1] == pytest.approx(np.cosh(mu * (n - 0.5 - np.arange(n))) / np.cosh(mu / 2), rel=1e-7)
    assert 1e-4 * rise.sum() == pytest.approx(5.0, rel=1e-7)
    with pytest.raises(SolveError, match="nothing holds"):
        steady(flat, {"m0.Q": 5.0, **{f"c{k}.G": 0.0 for k in range(n)}})


def test_a_deviation_decays_where_the_diagonal_outweighs_the_rows_in_some_scales() -> None:
    decays = csc_matrix(np.array([[-1.0, 2.0], [0.25, -1.0]]))
    grows = csc_matrix(np.array([[-1.0, 2.0], [0.6, -1.0]]))
    swings = csc_matrix(np.array([[-1.0, 9.0], [-9.0, -1.0]]))  # decays, though no scales tell
    assert stable(decays) and not stable(grows) and stable(swings)
    assert not stable(csc_matrix(np.array([[np.nan, 0.0], [0.0, -1.0]])))
