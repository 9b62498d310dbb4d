"""Playing: against closed forms and an accurate reference, at jumps, for several communication steps."""

import os
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu import batch_library
from gearheat.fmu.play import Played, Player, play
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import FmuError
from scipy.integrate import solve_ivp

#: A duty of one hour: speed and load in ramps and jumps, a slowly changing room.
DUTY = {
    "governor.w": (np.array([0.0, 600, 1200, 1200, 2400, 3600]), np.array([150.0, 150, 210, 120, 120, 180])),
    "load.tau": (np.array([0.0, 900, 900, 3000, 3000, 3600]), np.array([20.0, 30, 60, 60, 10, 10])),
    "room.T": (np.array([0.0, 3600]), np.array([293.15, 303.15])),
}


def at(points: tuple[np.ndarray, np.ndarray], t: float, middle: float) -> float:
    """The piecewise linear function at t, taken on the piece that holds `middle`."""
    time, value = points
    i = int(np.searchsorted(time, middle, side="right")) - 1
    return float(value[i] + (t - time[i]) / (time[i + 1] - time[i]) * (value[i + 1] - value[i]))


def reference(flat: FlatModel, duty: dict, times: np.ndarray) -> np.ndarray:
    """States at the times, by an independent integrator at a tolerance of 1e-10, restarted at every kink."""
    p = flat.starts("parameter")
    jacobian = ca.Function("jacobian", flat.point, [ca.jacobian(flat.ode, flat.x)])
    kinks = np.unique(np.concatenate([t for t, _ in duty.values()]))
    x, rows = flat.starts("state"), [flat.starts("state")]
    for a, b in pairwise(kinks):
        middle = (a + b) / 2
        u = lambda t, m=middle: [at(duty[q.name], t, m) for q in flat.inputs]  # noqa: E731
        inside = times[(times > a) & (times <= b)]
        solution = solve_ivp(
            lambda t, z, u=u: np.array(flat.function(z, [], u(t), p)[0]).ravel(),
            (a, b),
            x,
            method="Radau",
            rtol=1e-10,
            atol=1e-10,
            t_eval=np.append(inside[inside < b], b),
            jac=lambda t, z, u=u: np.array(jacobian(z, [], u(t), p)),
        )
        x = solution.y[:, -1]
        rows += list(solution.y.T[: len(inside)])
    return np.array(rows)


@pytest.fixture(scope="module")
def accurate(models: SimpleNamespace) -> tuple[np.ndarray, np.ndarray]:
    times = np.arange(0, 3601, 300.0)
    return times, reference(models.heat, DUTY, times)


STATES = ["oil.T", "gears.T", "cover.T", "housing.T", "shaft.w"]


@pytest.mark.parametrize("step", [1.0, 10.0, 60.0, 300.0])
def test_play_agrees_with_an_accurate_reference(
    heat_fmu: Path, accurate: tuple[np.ndarray, np.ndarray], step: float
) -> None:
    times, states = accurate
    played = play(heat_fmu, DUTY, 3600, step, record=STATES, output_times=times)
    assert np.abs(played.values - states).max() < 1e-4


def test_error_follows_the_tolerance(heat_fmu: Path, accurate: tuple[np.ndarray, np.ndarray]) -> None:
    times, states = accurate
    with Player(heat_fmu) as player:
        errors = [
            np.abs(player.run(DUTY, 3600, 60, record=STATES, output_times=times, tolerance=t).values - states).max()
            for t in (1e-4, 1e-6, 1e-8)
        ]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[2] < 1e-5


def test_energy_audit(heat_fmu: Path) -> None:
    for step in (1.0, 60.0):
        played = play(heat_fmu, DUTY, 3600, step)
        gained = played["energy.stored"] - played["energy.stored"][0]
        throughput = played["energy.throughput"]
        assert np.abs(played["energy.supplied"] - gained).max() < 1e-7 * throughput[-1]
        assert np.abs(played["energy.residual"]).max() < 1e-8
        assert (np.diff(throughput) >= 0).all()


def test_closed_form_of_the_circuit(rc_fmu: Path) -> None:
    played = play(rc_fmu, {}, 30, 1, tolerance=1e-9)
    assert played["capacitor.v"] == pytest.approx(5 - 4 * np.exp(-played.time / 6), abs=1e-7)
    assert played["resistor.i"] == pytest.approx(2 * np.exp(-played.time / 6), abs=1e-7)


@pytest.mark.parametrize("step", [0.01, 0.3, 7.0, 1000.0])
def test_closed_form_of_a_ramp_for_any_step(rc_fmu: Path, step: float) -> None:
    stop = max(6.0, step)
    played = play(rc_fmu, {"source.v": (np.array([0, stop]), np.array([1.0, 1.0 + stop]))}, stop, step, tolerance=1e-9)
    exact = 1 + played.time - 6 + 6 * np.exp(-played.time / 6)
    assert played["capacitor.v"] == pytest.approx(exact, abs=2e-6)
    assert played["source.v"] == pytest.approx(1 + played.time, rel=1e-12)


def test_rows_at_a_jump(rc_fmu: Path) -> None:
    inputs = {"source.v": (np.array([0, 2.5, 2.5, 4]), np.array([5.0, 5, 0, 0]))}
    both = play(rc_fmu, inputs, 4, 1)
    assert both.time.tolist() == [0, 1, 2, 2.5, 2.5, 3, 4]
    assert both["source.v"].tolist() == [5, 5, 5, 5, 0, 0, 0]
    assert both["capacitor.v"][3] == both["capacitor.v"][4]
    asked = play(rc_fmu, inputs, 4, 1, output_times=[0, 2.5, 4], record=["source.v"])
    assert asked.values.ravel().tolist() == [5, 0, 0]
    twice = play(rc_fmu, inputs, 4, 1, output_times=[2.5, 2.5], record=["source.v"])
    assert twice.values.ravel().tolist() == [5, 0]


def test_a_jump_between_communication_points_is_exact(rc_fmu: Path) -> None:
    inputs = {"source.v": (np.array([0, 2.5, 2.5, 60]), np.array([5.0, 5, 0, 0]))}
    played = play(rc_fmu, inputs, 60, 60, tolerance=1e-9, output_times=[60.0])
    at_jump = 5 - 4 * np.exp(-2.5 / 6)
    assert played["capacitor.v"][0] == pytest.approx(at_jump * np.exp(-57.5 / 6), abs=1e-7)


def test_a_player_runs_again_as_from_fresh(rc_fmu: Path) -> None:
    def values(p: Played) -> bytes:
        return p.values.tobytes()

    fresh = values(play(rc_fmu, {}, 10, 1))
    with Player(rc_fmu) as player:
        player.run({}, 10, 1, start={"resistor.R": 5.0, "capacitor.v": -3.0, "source.v": 1.0}, tolerance=1e-9)
        assert values(player.run({}, 10, 1)) == fresh
        with pytest.raises(FmuError):
            player.run({"source.v": (np.array([0, 5, 6]), np.array([1, 1, np.nan]))}, 10, 1)
        assert values(player.run({}, 10, 1)) == fresh


@pytest.mark.parametrize(
    "name", ["oil.C", "gears.C", "cover.C", "housing.C", "shaft.J", "governor.K", "housing.A", "oil.b_0"]
)
def test_every_parameter_acts(heat_fmu: Path, models: SimpleNamespace, name: str) -> None:
    with Player(heat_fmu) as player:
        usual = player.run(DUTY, 1500, 60)
        changed = player.run(DUTY, 1500, 60, start={name: 1.1 * models.heat.quantity(name).start})
    assert np.abs(changed.values - usual.values).max() > 1e-6


def test_start_values_act(rc_fmu: Path) -> None:
    played = play(rc_fmu, {}, 6, 6, start={"capacitor.v": 0.0, "resistor.R": 4.0, "source.v": 2.0}, tolerance=1e-9)
    assert played["capacitor.v"][-1] == pytest.approx(2 * (1 - np.exp(-0.5)), abs=1e-7)


def refusal(call: Callable[[], object]) -> str:
    with pytest.raises(FmuError) as caught:
        call()
    return str(caught.value)


def test_names_and_values_that_are_refused(rc_fmu: Path) -> None:
    ramp = (np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    told = refusal(lambda: play(rc_fmu, {"source.w": ramp, "resistor.R": ramp}, 1, 1, start={"resistor.i": 1.0}))
    assert 'input "source.w" is unknown. Did you mean "source.v"' in told
    assert 'input "resistor.R" is no input' in told
    assert 'start value "resistor.i" is calculated' in told
    assert "Did you mean" in refusal(lambda: play(rc_fmu, {}, 1, 1, record=["resistor.j"]))
    told = refusal(lambda: play(rc_fmu, {}, 1, 1, start={"resistor.R": 0.0}))
    assert "resistor.R = 0 ohm is out of range. It must be above 0 ohm." in told
    told = refusal(lambda: play(rc_fmu, {"source.v": (np.array([0.0]), np.array([np.nan]))}, 1, 1))
    assert "source.v = nan is not finite" in told
    for arguments in (({}, 0, 1), ({}, 1, 0), ({}, 1, -1), ({"source.v": ([1, 0], [0, 0])}, 1, 1)):
        assert refusal(lambda a=arguments: play(rc_fmu, *a))
    assert refusal(lambda: play(rc_fmu, {}, 1, 1, output_times=[0.5, 2.0]))


def test_files_that_are_refused(rc_fmu: Path, tmp_path: Path) -> None:
    text = tmp_path / "text.fmu"
    text.write_text("no zip file")
    assert "is no FMU" in refusal(lambda: Player(text))
    assert "is a folder" in refusal(lambda: Player(tmp_path))
    assert "no such file" in refusal(lambda: Player(tmp_path / "nothing.fmu"))


@pytest.mark.skipif(not hasattr(os, "ST_NOEXEC"), reason="file systems of this machine run all code")
def test_a_folder_from_which_no_code_runs_is_told(
    rc_fmu: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the program stays where it is, as names of files that follow are from there."""
    broken = tmp_path / "broken.fmu"
    with zipfile.ZipFile(rc_fmu) as whole, zipfile.ZipFile(broken, "w") as file:
        for name in whole.namelist():
            file.writestr(name, b"" if name.startswith("binaries/") else whole.read(name))
    here = Path.cwd()
    with pytest.raises(FmuError, match=r"broken.fmu cannot be loaded: (?!.*noexec)"):
        Player(broken)
    monkeypatch.setattr(os, "statvfs", lambda _: SimpleNamespace(f_flag=os.ST_NOEXEC))
    with pytest.raises(FmuError, match=r"no code runs from that file system \(noexec\). Set TMPDIR"):
        Player(broken)
    monkeypatch.setattr(batch_library, "binary", lambda *_, **__: b"")
    with pytest.raises(FmuError, match=r"noexec"):
        batch_library.load("")
    assert Path.cwd() == here
