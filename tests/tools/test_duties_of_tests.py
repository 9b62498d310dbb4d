"""The duty of each test of a campaign: readings held for their dwell, a stop between them, the room as read."""

from pathlib import Path

import numpy as np
import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.study import Measured, read_study
from gearheat.tools.compare.campaign import Run, runs_of
from gearheat.tools.solve.settings import flat_of

HEADER = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_sun_Nm,T_oil_C,T_wall_C,T_amb_C"
ROWS = ("1,1,1,1,240,PAOR,100,1500,370,45,44,25", "2,1,1,2,90,PAOR,100,1500,380,47,45,27")


def first_run(study: Measured | None) -> Run:
    assert study is not None
    return runs_of(study.scenario, flat_of(study.scenario), study, "1")[0]


@pytest.fixture(scope="module")
def run() -> Run:
    """The first test of the shipped campaign."""
    return first_run(read_study(load("planetary")))


def test_signs_and_jumps(run: Run) -> None:
    np.testing.assert_array_equal(run.schedule.time / 60, [0, 240, 240, 245, 245, 335])
    n = np.array([102.6, 102.6, 0, 0, 102.5, 102.5])
    np.testing.assert_allclose(run.schedule.values["carrier.w"], n * np.pi / 30, rtol=1e-12)
    np.testing.assert_allclose(run.schedule.values["carrier.tau"], [1549.5, 1549.5, 0, 0, -1549.5, -1549.5])
    assert run.moments == (14400.0, 20100.0)


def test_the_room_stays_and_then_goes_in_one_line(run: Run) -> None:
    T, time = run.schedule.values["room.T"] - 273.15, run.schedule.time
    assert T[:3] == pytest.approx([25.18] * 3)
    assert T[-1] == pytest.approx(26.96)
    np.testing.assert_allclose(T[2:], 25.18 + (26.96 - 25.18) * (time[2:] - 14400) / (20100 - 14400))


def test_every_temperature_starts_as_the_room(run: Run) -> None:
    temperatures = {name: T for name, T in run.start.items() if name.endswith(".T")}
    assert {"oil.T", "gears.T", "carrier_body.T", "wall.T", "surface.T"} <= set(temperatures)
    assert list(temperatures.values()) == pytest.approx([25.18 + 273.15] * len(temperatures))


def test_columns_of_the_table_overrule_the_protocol(tmp_path: Path) -> None:
    lines = (HEADER + ",T_start_C,T_amb_start_C,stop_min", ROWS[0] + ",21,22,", ROWS[1] + ",21,22,20")
    (path := tmp_path / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    run = first_run(read_study(load("planetary"), path))
    np.testing.assert_array_equal(run.schedule.time / 60, [0, 240, 240, 260, 260, 350])
    assert run.schedule.values["room.T"][:2] - 273.15 == pytest.approx([22, 25])
    assert run.start["oil.T"] == pytest.approx(294.15)
