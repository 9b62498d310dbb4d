"""Cold starts from -35 degC, driven from either side, run through: alike in Python and FMU, and the energy is kept."""

from pathlib import Path

import numpy as np
import pytest
from for_each import thin
from gearheat.fmu.export import export
from gearheat.fmu.play import play
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

COLD = 238.15
HOURS = 4
DRIVES = [(rig, end) for rig in ("planetary", "helical_two_stage") for end in load(rig).spec.of_type("ShaftEnd")]
#: Rows of the simulation and of the FMU [s]: the first minute alone brings a third of the heat of the thick oil.
FINE, COARSE = 1.0, 60.0


def duty(rig: str, end: str) -> dict[str, float]:
    """Speed and torque of one shaft end where the rig works, in a room of -35 degC."""
    scenario = load(rig)
    at = steady(scenario.spec.flat(), scenario.operating_point)
    return {f"{end}.w": float(at[f"{end}.w"][0]), f"{end}.tau": float(at[f"{end}.tau"][0]), "room.T": COLD}


@pytest.mark.parametrize(("rig", "end"), thin(DRIVES, apart=2))
def test_a_cold_start_runs_through(rig: str, end: str, tmp_path: Path) -> None:
    flat = load(rig).spec.driven({end: ("w", "tau")}).flat()
    given, start = duty(rig, end), dict.fromkeys((q.name for q in flat.states), COLD)
    times = np.arange(0, HOURS * 3600 + FINE / 2, FINE)
    minutes = slice(None, None, int(COARSE / FINE))
    run = simulate(flat, join_phases([(HOURS * 3600.0, given)]), start=start, times=times)
    fmu = export(flat, tmp_path / "cold.fmu", start=given | start)
    played = play(fmu, {}, stop=times[-1], step=COARSE)
    assert np.abs(played["oil.T"] - run["oil.T"][minutes]).max() < 1e-3
    assert run.audit.residual < 1e-9
    loss, shed = run["efficiency.P_loss"], run["room.Q_flow"]
    assert loss.min() > 0 and loss[0] > 1.5 * loss[-1]  # thick oil brakes more
    assert (np.diff(run["oil.T"]) > -1e-6).all() and COLD + 10 < run["oil.T"][-1] < 400
    stored = played["energy.stored"] - played["energy.stored"][0]
    net = loss - shed
    heat = np.concatenate([[0.0], np.cumsum(net[1:] + net[:-1]) * FINE / 2])
    assert np.abs(heat[minutes] - stored).max() < 1e-3 * stored.max()


@pytest.mark.parametrize("end", ["carrier", "sun"])
def test_a_shaft_turned_by_next_to_nothing(end: str, tmp_path: Path) -> None:
    """200 rpm and 0.4 N.m at the sun, in oil so thick that the other side has to drive as well."""
    flat = load("planetary").spec.driven({end: ("w", "tau")}).flat()
    w = {"sun": 200.0, "carrier": 50.0}[end] * np.pi / 30
    given = {f"{end}.w": w, f"{end}.tau": 0.4, "room.T": COLD}
    start = dict.fromkeys((q.name for q in flat.states), COLD)
    run = simulate(flat, join_phases([(3600.0, given)]), start=start, times=[0.0, 3600.0])
    assert 20 < run["sun_bearing.P_loss"][0] < 300 and run["efficiency.eta"].min() >= 0
    assert run["efficiency.eta"].max() < 1e-6  # both shafts drive
    played = play(export(flat, tmp_path / "m.fmu", start=given | start), {}, stop=3600.0, step=60.0)
    for name in ("oil.T", "sun_bearing.P_loss"):
        assert played[name][[0, -1]] == pytest.approx(run[name], rel=1e-6)
