"""Transients: closed forms over ramps and jumps, rows and times, order under tolerance, errors in words."""

import time

import numpy as np
import pytest
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.run.schedule import Schedule, join_phases
from gearheat.model.run.simulate import simulate
from small_parts import Ambient, Conductor, Heater, Thermometer, brake, gear, model, motor, rc

#: Charging, a ramp, a jump to zero.
DUTY = join_phases([(0.1, {"battery.V": 5.0}), (0.2, {"battery.V": (5.0, 9.0)}), (0.1, {"battery.V": 0.0})])
TIMES = np.linspace(0.0, 0.4, 81)


def closed_form(t: np.ndarray, k: float = 10.0) -> np.ndarray:
    """Voltage of a capacitor of time constant 1/k through `DUTY`."""

    def ramp(s: np.ndarray | float, u: float, v: float, slope: float) -> np.ndarray:
        return v + slope * s - slope / k + (u - v + slope / k) * np.exp(-k * s)

    u1 = ramp(0.1, 0.0, 5.0, 0.0)
    u2 = ramp(0.2, u1, 5.0, 20.0)
    pieces = [ramp(t, 0.0, 5.0, 0.0), ramp(t - 0.1, u1, 5.0, 20.0), ramp(t - 0.3, u2, 0.0, 0.0)]
    return np.select([t <= 0.1, t <= 0.3 + 1e-12], pieces[:2], pieces[2])


@pytest.mark.parametrize("method", ["idas", "lsoda"])
def test_ramps_and_jumps_as_in_closed_form(method: str) -> None:
    run = simulate(rc(), DUTY, times=TIMES, method=method)
    assert run["capacitor.u"] == pytest.approx(closed_form(TIMES), abs=2e-6)
    assert run.audit.residual < 1e-6


def test_error_follows_the_tolerance() -> None:
    """Over six decades of tolerance the error falls about as much: observed order between 0.7 and 1.3."""
    tolerances = np.array([1e-4, 1e-6, 1e-8, 1e-10])
    runs = [simulate(rc(), DUTY, times=TIMES, tolerance=tol) for tol in tolerances]
    errors = [np.abs(run["capacitor.u"] - closed_form(TIMES)).max() for run in runs]
    order = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.7 < order < 1.3
    audits = [run.audit.residual for run in runs]
    assert audits == sorted(audits, reverse=True)


def test_methods_agree_on_a_motor_that_warms_up() -> None:
    duty = join_phases([(600.0, {"drive.tau": 5.0}), (1200.0, {"drive.tau": (5.0, 3.0)}), (600.0, {"drive.tau": 0.0})])
    one, other = (simulate(motor(), duty, method=m) for m in ("idas", "lsoda"))
    assert one["body.T"] == pytest.approx(other["body.T"], abs=1e-5)
    assert one["rotor.w"] == pytest.approx(other["rotor.w"], abs=1e-4)
    assert max(one.audit.residual, other.audit.residual) < 1e-6


def test_rows_every_minute_and_both_sides_of_jumps() -> None:
    duty = join_phases([(90.0, {"drive.w": 10.0}), (60.0, {"drive.w": 20.0})])
    run = simulate(brake(), duty)
    assert run.index.tolist() == [0.0, 60.0, 90.0, 90.0, 120.0, 150.0]
    assert run["drive.w"].tolist() == [10.0, 10.0, 10.0, 20.0, 20.0, 20.0]
    assert run["oil.T"][2] == run["oil.T"][3]
    assert run["bearing.P_loss"][2] < run["bearing.P_loss"][3]
    assert run.kind == "transient"


def test_rows_at_times_asked_for() -> None:
    duty = join_phases([(90.0, {"drive.w": 10.0}), (60.0, {"drive.w": (20.0, 30.0)})])
    run = simulate(brake(), duty, times=[5.0, 90.0, 120.0, 150.0])
    assert run.index.tolist() == [5.0, 90.0, 120.0, 150.0]
    assert run["drive.w"].tolist() == [10.0, 20.0, 25.0, 30.0]
    both = simulate(brake(), duty, times=[90.0, 90.0])
    assert both["drive.w"].tolist() == [10.0, 20.0]


def test_times_do_not_change_the_solution() -> None:
    duty = join_phases([(600.0, {"drive.w": (0.0, 150.0)}), (600.0, {"drive.w": 50.0})])
    coarse = simulate(brake(), duty, times=[600.0, 1200.0])
    fine = simulate(brake(), duty, times=np.linspace(0.0, 1200.0, 2401))
    assert fine["oil.T"][[1200, 2400]] == pytest.approx(coarse["oil.T"], abs=1e-5)


def test_a_measured_duty_with_many_kinks() -> None:
    """A kink every second: the run, not restarted there, is off by no more than a local error at each of them."""
    t = np.arange(0.0, 301.0)
    duty = Schedule(t, {"drive.w": 50 + 30 * np.sin(t / 20), "room.T": 300 + 5 * np.cos(t / 50)})
    run = simulate(brake(), duty, tolerance=1e-8)
    exact = simulate(brake(), duty, tolerance=1e-12, method="lsoda")
    assert run["oil.T"] == pytest.approx(exact["oil.T"], abs=len(t) * 1e-8 * 10.0)
    assert run.audit.residual < 1e-6


def test_a_duty_that_does_not_start_at_zero() -> None:
    late = Schedule(DUTY.time + 1e4, DUTY.values)
    run = simulate(rc(), late, times=TIMES + 1e4)
    assert run["capacitor.u"] == pytest.approx(closed_form(TIMES), abs=2e-6)


def test_inputs_that_the_duty_does_not_name() -> None:
    duty = join_phases([(60.0, {"drive.w": 10.0})])
    assert simulate(brake(), duty)["room.T"].tolist() == [300.0, 300.0]
    given = simulate(brake(), duty, values={"room.T": 280.0, "foot.G": 7.0})
    assert given["room.T"].tolist() == [280.0, 280.0]
    assert given["foot.Q_flow"][0] == pytest.approx(7.0 * 20.0)


def test_start_and_parameters() -> None:
    run = simulate(
        rc(), join_phases([(0.3, {"battery.V": 0.0})]), start={"capacitor.u": 4.0}, values={"resistor.R": 50.0}
    )
    assert run["capacitor.u"][-1] == pytest.approx(4 * np.exp(-0.3 / 0.05), abs=1e-6)


def test_result_knows_units_laws_and_where_they_end() -> None:
    run = simulate(brake(), join_phases([(36000.0, {"drive.w": 300.0})]))
    assert run.units["oil.T"] == "K"
    assert run.units["bearing.P_loss"] == "W"
    assert run.laws == ("radiated (Example, eq. 1)",)
    (outside,) = run.outside
    assert (outside.component, outside.law, outside.argument) == ("surface", "radiated", "T")
    assert (outside.low, outside.high) == (250.0, 400.0)
    assert outside.lowest == run["wall.T"].min()
    assert outside.highest == run["wall.T"].max() > 400.0


def test_implicit_residuals_are_reported() -> None:
    run = simulate(gear(), join_phases([(600.0, {"drive.w": 100.0, "load.tau": -30.0}), (60.0, {"load.tau": -300.0})]))
    assert run.implicit.keys() == {"gear: loss"}
    assert 0 <= run.implicit["gear: loss"] < 1e-8


def test_a_model_without_states() -> None:
    parts = (Ambient("room"), Conductor("g", G=2.0), Heater("q"), Thermometer("t"))
    flat = model(*parts, nets=[("room.heat", "g.a"), ("g.b", "q.heat", "t.heat")])
    run = simulate(flat, join_phases([(120.0, {"q.Q": (0.0, 10.0)})]))
    assert run["t.T"].tolist() == pytest.approx([300.0, 302.5, 305.0])
    assert run.audit.residual < 1e-9


def test_same_input_same_bytes() -> None:
    duty = join_phases([(600.0, {"drive.tau": 5.0}), (600.0, {"drive.tau": -5.0})])
    one, other = simulate(motor(), duty), simulate(motor(), duty)
    assert all(one[name].tobytes() == other[name].tobytes() for name in one.columns)
    assert one.audit == other.audit


def test_a_warm_up_takes_well_below_a_second() -> None:
    flat, duty = brake(), join_phases([(335 * 60.0, {"drive.w": 100.0})])
    begin = time.perf_counter()
    simulate(flat, duty)
    assert time.perf_counter() - begin < 0.5


def test_all_wrong_names_and_values_at_once() -> None:
    duty = join_phases([(60.0, {"drive.w": 10.0, "drve.w": 1.0, "room.T": -5.0})])
    with pytest.raises(ScenarioError) as caught:
        simulate(brake(), duty, times=[70.0], method="lsode")
    text = str(caught.value)
    assert 'unknown name "drve.w". Did you mean "drive.w"' in text
    assert "room.T = -5 K" in text
    assert 'unknown method "lsode". Did you mean "lsoda"' in text
    assert "output time 70 s lies outside the duty (0 ... 60 s)" in text


def test_wrong_values_and_starts() -> None:
    duty = join_phases([(60.0, {"drive.w": 10.0})])
    with pytest.raises(ScenarioError) as caught:
        simulate(
            brake(), duty, start={"oil.TT": 1.0, "foot.G": 1.0}, values={"drive.w": 1.0, "oil.C": -1.0, "oil.T": 3.0}
        )
    assert len(caught.value.problems) == 5
    text = str(caught.value)
    assert "drive.w is given twice" in text
    assert "oil.C = -1" in text
    assert "oil.T is a state of bench. Expected a parameter or an input" in text
    assert "foot.G is a parameter of bench. Expected a state" in text
    assert 'unknown name "oil.TT". Did you mean "oil.T"' in text


def test_a_duty_of_no_duration() -> None:
    with pytest.raises(ScenarioError, match="lasts no time"):
        simulate(rc(), Schedule(np.zeros(2), {"battery.V": np.array([1.0, 2.0])}))


def test_a_state_that_leaves_its_range() -> None:
    with pytest.raises(SolveError, match=r"body\.T leaves its range \(0 \.\.\. 2000 K\) at 720 s"):
        simulate(motor(thinning=0.2), join_phases([(3600.0, {"drive.tau": 100.0})]))


@pytest.mark.parametrize("method", ["idas", "lsoda"])
def test_a_blow_up_names_time_and_state(method: str) -> None:
    """Friction that grows with its own heat runs away within a minute."""
    with pytest.raises(SolveError) as caught:
        simulate(brake(thinning=-0.02), join_phases([(3600.0, {"drive.w": 100.0})]), method=method, times=[3600.0])
    text = str(caught.value)
    assert "simulate: the run stops at 41.3" in text
    assert "oil.T has reached" in text
    assert "It started at 26.85 degC" in text
    assert "CVode" not in text
    assert len(text.splitlines()) <= 3


def test_a_method_that_gives_up_alone_names_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearheat.model.run.integrate.MOST_STEPS", 3)
    with pytest.raises(SolveError, match=r"idas gives up between 0 and 0\.1 s.*Use the method \"lsoda\""):
        simulate(rc(), DUTY, times=[0.4])


def test_a_coupling_so_weak_that_its_square_underflows() -> None:
    run = simulate(motor(thinning=1e-147), join_phases([(1e4, {"drive.tau": 1.0})]), times=[1e4])
    assert run.audit.residual < 1e-6
