"""Model exchange: FMPy's own integrator on the derivatives gives what co-simulation gives."""

from collections.abc import Callable
from ctypes import c_double
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from gearheat.fmu.play import play

Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]


def test_model_exchange_gives_what_co_simulation_gives(heat_fmu: Path) -> None:
    signals = np.array(
        [(0.0, 150.0, 20.0), (600.0, 150.0, 20.0), (600.0, 180.0, 50.0), (1800.0, 180.0, 50.0)],
        dtype=[("time", float), ("governor.w", float), ("load.tau", float)],
    )
    names = ["oil.T", "housing.T", "shaft.w", "gears.P_loss", "energy.stored", "energy.supplied"]
    found = fmpy.simulate_fmu(
        str(heat_fmu),
        fmi_type="ModelExchange",
        stop_time=1800,
        output_interval=60,
        relative_tolerance=1e-8,
        input=signals,
        output=names,
        start_values={"room.T": 280.0},
    )
    inputs = {n: (signals["time"], signals[n]) for n in ("governor.w", "load.tau")}
    times = np.arange(0.0, 1801.0, 300.0)
    played = play(heat_fmu, inputs, 1800, 60, start={"room.T": 280.0}, tolerance=1e-8, record=names, output_times=times)
    for name in names:
        last = {t: found[name][np.flatnonzero(found["time"] == t)[-1]] for t in times}
        assert played[name] == pytest.approx(list(last.values()), rel=1e-6), name


def test_event_mode_asks_for_a_restart_after_a_jump_only(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu, FMU2Model).start()
    fmu = one.fmu
    assert fmu.newDiscreteStates() == (False, False, False, False, False, 0.0)
    one.set(source__v=1.0)
    assert fmu.newDiscreteStates()[3] is True
    assert fmu.newDiscreteStates()[3] is False
    fmu.enterContinuousTimeMode()
    one.set(source__v=1.5)
    fmu.enterEventMode()
    assert fmu.newDiscreteStates()[3] is False


def test_states_derivatives_and_nominals(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu, FMU2Model).start()
    fmu = one.fmu
    fmu.enterContinuousTimeMode()
    x, dx, nominal = ((c_double * 3)() for _ in range(3))
    fmu.getContinuousStates(x, 3)
    assert list(x) == [1.0, 0.0, 0.0]
    x[0] = 3.0
    fmu.setContinuousStates(x, 3)
    fmu.getDerivatives(dx, 3)
    assert list(dx) == pytest.approx([1 / 3, 5 * 1.0 - 2.0, 5 * 1.0 + 2.0])
    fmu.getNominalsOfContinuousStates(nominal, 3)
    assert nominal[0] == 10.0
    assert fmu.completedIntegratorStep() == (False, False)
    assert "2 values instead of 3" in one.refused(lambda: fmu.getDerivatives(dx, 2))[1]
    x[0] = float("nan")
    assert one.refused(lambda: fmu.setContinuousStates(x, 3))[0] == 2
    fmu.getContinuousStates(x, 3)
    assert x[0] == 3.0
    assert one.get("resistor.i") == [1.0]
