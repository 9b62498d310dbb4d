"""Saved states: restored exactly, in the same instance, in another one, in another process; foreign bytes refused."""

import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi2 import FMU2Model

Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]


def go_on(one: Opened, begin: int, count: int = 10) -> list[list[float]]:
    rows = []
    for k in range(begin, begin + count):
        one.set(load__tau=20 + 10 * math.sin(k))
        one.fmu.setRealInputDerivatives([one.refs["room.T"]], [1], [0.001 * k])
        one.fmu.doStep(30.0 * k, 30.0)
        rows.append(one.everything())
    return rows


def test_rollback_is_bit_equal(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start(tolerance=1e-6)
    go_on(one, 0)
    state = one.fmu.getFMUState()
    first = go_on(one, 10)
    one.fmu.setFMUState(state)
    one.set(oil__C=1.0)
    one.fmu.setFMUState(state)
    assert go_on(one, 10) == first
    one.fmu.freeFMUState(state)


def test_a_state_moves_to_another_instance(opened: Open, heat_fmu: Path) -> None:
    one, other = opened(heat_fmu).start(oil__C=3333.0), opened(heat_fmu)
    go_on(one, 0)
    state = one.fmu.getFMUState()
    other.fmu.setFMUState(state)
    assert go_on(other, 10) == go_on(one, 10)
    one.fmu.freeFMUState(state)


def test_bytes_are_restored_in_a_new_process(opened: Open, heat_fmu: Path, tmp_path: Path) -> None:
    one = opened(heat_fmu).start()
    go_on(one, 0)
    state = one.fmu.getFMUState()
    saved = one.fmu.serializeFMUState(state)
    one.fmu.freeFMUState(state)
    assert len(saved) < 2048
    (tmp_path / "saved").write_bytes(saved)
    script = f"""
import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from conftest import Opened
from test_states import go_on
one = Opened(Path({str(heat_fmu)!r}), Path({str(tmp_path / "new")!r}))
one.fmu.setFMUState(one.fmu.deserializeFMUState(Path({str(tmp_path / "saved")!r}).read_bytes()))
print(repr(go_on(one, 10)))
"""
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert eval(said) == go_on(one, 10)


def test_damaged_and_foreign_bytes_are_refused(opened: Open, heat_fmu: Path, rc_fmu: Path) -> None:
    one, foreign = opened(heat_fmu).start(), opened(rc_fmu).start()
    saved = one.fmu.serializeFMUState(one.fmu.getFMUState())
    other = foreign.fmu.serializeFMUState(foreign.fmu.getFMUState())
    damaged = saved[:100] + bytes([saved[100] ^ 1]) + saved[101:]
    for content, reason in (
        (damaged, "damaged"),
        (saved[:50], "too short"),
        (b"x" * len(saved), "no saved state"),
        (other + bytes(len(saved)), "another FMU"),
    ):
        assert reason in one.refused(lambda c=content: one.fmu.deserializeFMUState(c))[1]


def test_a_state_of_the_other_interface_is_refused(opened: Open, heat_fmu: Path) -> None:
    slave, model = opened(heat_fmu).start(), opened(heat_fmu, FMU2Model).start()
    assert "other interface" in model.refused(lambda: model.fmu.setFMUState(slave.fmu.getFMUState()))[1]


@pytest.mark.parametrize("kind", ["instantiated", "initialization"])
def test_a_state_keeps_the_mode(opened: Open, rc_fmu: Path, kind: str) -> None:
    one = opened(rc_fmu)
    if kind == "initialization":
        one.fmu.setupExperiment()
        one.fmu.enterInitializationMode()
    state = one.fmu.getFMUState()
    one.set(capacitor__v=3.0)
    if kind == "instantiated":
        one.fmu.setupExperiment()
        one.fmu.enterInitializationMode()
    one.fmu.exitInitializationMode()
    one.fmu.doStep(0, 1)
    one.fmu.setFMUState(state)
    if kind == "instantiated":
        one.fmu.enterInitializationMode()
    assert one.get("capacitor.v") == [1.0]
    one.fmu.exitInitializationMode()
