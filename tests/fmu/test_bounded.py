"""Every communication step ends in bounded time: done, or refused by name with the instance as it was."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2LastSuccessfulTime
from fmu_in_c import planetary, planetary_on_torques
from gearheat.fmu.export import export

DISCARD, ERROR = 2, 3
#: Processor time [s] that no communication step of a rig may need.
MOST = 1.0
Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    flat, start = planetary()
    return export(flat, tmp_path_factory.mktemp("bounded") / "driven.fmu", start=start)


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Torques are given that do not hold the speed: the machine runs away within minutes."""
    flat, start = planetary_on_torques()
    return export(flat, tmp_path_factory.mktemp("bounded") / "turning.fmu", start=start)


def timed_step(one: Opened, at: float, step: float) -> int:
    """Status of a step, which takes no longer than it may."""
    began, status = time.process_time(), 0
    try:
        one.fmu.doStep(at, step)
    except FMICallException as error:
        status = error.status
    assert time.process_time() - began < MOST
    return status


def test_a_machine_that_overheats_is_refused_at_once(opened: Open, driven: Path) -> None:
    one = opened(driven).start(carrier__w=1e4, carrier__tau=2000.0)
    at = 0.0
    while (status := timed_step(one, at, 60.0)) == 0:
        at += 60.0
        assert at < 600, "this machine cannot go on"
    before = one.everything()
    assert status == DISCARD
    assert "gears.T becomes infinite or leaves its range" in one.messages[-1][2]
    for _ in range(3):
        assert timed_step(one, at, 60.0) == ERROR
        assert "refused because of gears.T" in one.messages[-1][2]
    assert one.everything() == before


def test_a_refused_step_may_be_shorter_or_have_other_inputs(opened: Open, driven: Path) -> None:
    one = opened(driven).start(carrier__w=1e4, carrier__tau=2000.0)
    assert [timed_step(one, 0.0, 3600.0) for _ in range(2)] == [DISCARD, ERROR]
    saved = one.fmu.getFMUstate()
    assert timed_step(one, 0.0, 0.5) == 0
    one.fmu.setFMUstate(saved)
    assert timed_step(one, 0.0, 3600.0) == ERROR, "the same step from the same state"
    one.set(carrier__w=26.0)
    assert timed_step(one, 0.0, 3600.0) == 0
    one.fmu.freeFMUstate(saved)


def test_a_result_out_of_its_declared_range_is_refused(opened: Open, models: Any, tmp_path: Path) -> None:
    """A capacitor said never to be discharged, whose source falls below its voltage."""
    current, loss = models.rc.outputs
    flat = replace(models.rc, outputs=(replace(current, low=0.0, high=3.0), loss))
    one = opened(export(flat, tmp_path / "rc.fmu")).start()
    assert timed_step(one, 0.0, 60.0) == 0
    assert one.get("resistor.i")[0] >= 0.0, "round-off at the end of the range is not out of it"
    kept = one.get("capacitor.v", "resistor.P_loss")
    one.set(source__v=4.0)
    assert [timed_step(one, 60.0, 1.0) for _ in range(2)] == [DISCARD, ERROR]
    assert "resistor.i would be -0.4" in one.messages[0][2]
    assert "must be at least 0 and at most 3" in one.messages[0][2]
    assert "refused because of resistor.i" in one.messages[1][2]
    assert one.refused(lambda: one.get("resistor.i"))[0] == DISCARD
    assert one.fmu.getRealStatus(fmi2LastSuccessfulTime) == 60.0
    one.set(source__v=5.0)
    assert one.get("capacitor.v", "resistor.P_loss") == kept
    assert timed_step(one, 60.0, 1.0) == 0
    wrong = opened(tmp_path / "rc.fmu")
    with pytest.raises(FMICallException):
        wrong.start(source__v=0.0)
    assert "fmi2ExitInitializationMode: resistor.i is -0.5 A" in wrong.messages[-1][2]


def test_a_machine_that_runs_away_ends_for_a_master_that_halves_its_steps(opened: Open, turning: Path) -> None:
    one = opened(turning).start()
    one.set(sun__tau=-560.0)
    at, step, refused = 0.0, 60.0, 0
    while step > 1e-9 and at < 3600.0:
        if timed_step(one, at, step) == 0:
            at += step
        else:
            step, refused = step / 2, refused + 1
    assert refused > 30
    assert at < 3600.0
