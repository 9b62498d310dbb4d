"""Directional derivatives of every listed unknown in every mode, and output derivatives, against differences."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave

Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]
INPUTS = ("governor.w", "load.tau", "room.T")


def in_mode(one: Opened, mode: str) -> Opened:
    one.fmu.setupExperiment()
    one.fmu.enterInitializationMode()
    if mode == "initialization":
        return one
    one.fmu.exitInitializationMode()
    if mode == "continuous":
        one.fmu.enterContinuousTimeMode()
    return one


def differences(one: Opened, unknown: list[str], known: str, size: float) -> np.ndarray:
    """Central differences by setting the value; only in initialization mode everything can be set."""
    (value,) = one.get(known)
    sides = []
    for sign in (1, -1):
        one.fmu.setReal([one.refs[known]], [value + sign * size])
        sides.append(np.array(one.get(*unknown)))
    one.fmu.setReal([one.refs[known]], [value])
    return (sides[0] - sides[1]) / (2 * size)


MODES = [("initialization", FMU2Slave), ("step", FMU2Slave), ("initialization", FMU2Model), ("event", FMU2Model)]
MODES += [("continuous", FMU2Model)]


@pytest.mark.parametrize(("mode", "kind"), MODES)
def test_directional_derivatives_of_every_unknown(opened: Open, heat_fmu: Path, mode: str, kind: type) -> None:
    start = dict(oil__T=320.0, gears__T=335.0, cover__T=310.0, housing__T=305.0, shaft__w=140.0)
    truth = opened(heat_fmu)
    truth.set(**start)
    in_mode(truth, "initialization")
    one = opened(heat_fmu, kind)
    one.set(**start)
    in_mode(one, mode)
    structure = one.description
    unknown = [u.variable.name for u in (*structure.outputs, *structure.derivatives)]
    states = [u.variable.derivative.name for u in structure.derivatives]
    parameters = [v.name for v in structure.modelVariables if v.causality == "parameter" and v.name in one.refs]
    for known in (*INPUTS, *states, *parameters):
        (value,) = truth.get(known)
        expected = differences(truth, unknown, known, 1e-5 * (abs(value) + 1))
        found = one.fmu.getDirectionalDerivative([one.refs[n] for n in unknown], [one.refs[known]], [1.0])
        noise = 1e-15 * 3e4 / (1e-5 * (abs(value) + 1))  # round-off of powers up to 30 kW in the differences
        assert found == pytest.approx(expected, rel=1e-5, abs=5 * noise), known


def test_directions_add_up(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    refs, unknown = one.refs, [one.refs["gears.P_loss"], one.refs["der(oil.T)"]]
    single = [
        np.array(one.fmu.getDirectionalDerivative(unknown, [refs[k]], [1.0])) for k in ("load.tau", "oil.T", "shaft.w")
    ]
    known = [refs[k] for k in ("load.tau", "oil.T", "shaft.w")]
    both = one.fmu.getDirectionalDerivative(unknown, known, [2.0, -3.0, 0.5])
    assert both == pytest.approx(2 * single[0] - 3 * single[1] + 0.5 * single[2], rel=1e-13)


def test_directions_that_make_no_sense_are_refused(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    r, derive = one.refs, one.fmu.getDirectionalDerivative
    assert "is calculated" in one.refused(lambda: derive([r["oil.dT"]], [r["gears.P_loss"]], [1.0]))[1]
    assert "is given" in one.refused(lambda: derive([r["room.T"]], [r["room.T"]], [1.0]))[1]
    assert "not finite" in one.refused(lambda: derive([r["oil.dT"]], [r["room.T"]], [float("nan")]))[1]
    assert "unknown value reference" in one.refused(lambda: derive([999], [r["room.T"]], [1.0]))[1]


def test_output_derivatives_are_rates_of_the_outputs(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start(tolerance=1e-9)
    room, names = [one.refs["room.T"]], ["oil.T", "oil.dT", "gears.P_loss", "energy.stored", "energy.supplied"]
    one.fmu.setRealInputDerivatives(room, [1], [0.02])
    one.fmu.doStep(0, 60)
    rates = one.fmu.getRealOutputDerivatives([one.refs[n] for n in names], [1] * len(names))
    before = np.array(one.get(*names))
    one.fmu.doStep(60, 1e-3)
    assert rates == pytest.approx((np.array(one.get(*names)) - before) / 1e-3, rel=1e-4, abs=1e-6)
    assert "no output" in one.refused(lambda: one.fmu.getRealOutputDerivatives(room, [1]))[1]
    assert "order 2" in one.refused(lambda: one.fmu.getRealOutputDerivatives([one.refs["oil.T"]], [2]))[1]


def test_input_derivatives_carry_the_input_on(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu).start(tolerance=1e-9, source__v=1.0)
    source = [one.refs["source.v"]]
    one.fmu.setRealInputDerivatives(source, [1], [1.0])
    for k in range(3):
        one.fmu.doStep(2.0 * k, 2.0)
    assert one.get("source.v")[0] == pytest.approx(7.0, rel=1e-14)
    assert one.get("capacitor.v")[0] == pytest.approx(1 + 6 - 6 + 6 * np.exp(-1.0), abs=1e-6)
    assert "order 0" in one.refused(lambda: one.fmu.setRealInputDerivatives(source, [0], [1.0]))[1]
    other = [one.refs["capacitor.v"]]
    assert "no input" in one.refused(lambda: one.fmu.setRealInputDerivatives(other, [1], [1.0]))[1]


def test_a_second_derivative_of_an_input_is_ignored_with_one_warning(opened: Open, rc_fmu: Path) -> None:
    one, other = (opened(rc_fmu).start(source__v=1.0) for _ in range(2))
    source = [one.refs["source.v"]]
    for k in range(3):
        one.fmu.setRealInputDerivatives(source * 2, [1, 2], [1.0, 5.0])
        other.fmu.setRealInputDerivatives(source, [1], [1.0])
        for fmu in (one.fmu, other.fmu):
            fmu.doStep(2.0 * k, 2.0)
    assert one.everything() == other.everything()
    ((status, _, text),) = one.messages
    assert status == 1
    assert "order 2 of source.v is ignored" in text
