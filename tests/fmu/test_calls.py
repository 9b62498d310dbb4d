"""The interface's rules: what may be called when, what is refused and with which words, and that nothing leaks over."""

import ctypes
import dataclasses
import math
import random
import threading
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2LastSuccessfulTime, fmi2Terminated
from gearheat.fmu.export import export

DISCARD, ERROR = 2, 3
Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]


def test_wrong_guid_is_refused(opened: Open, rc_fmu: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(Exception, match="Failed to instantiate"):
        opened(rc_fmu, guid="{00000000-0000-0000-0000-000000000000}")


def test_calls_in_the_wrong_mode_are_refused_and_change_nothing(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu)
    fmu = one.fmu
    assert one.refused(lambda: fmu.doStep(0, 1)) == (ERROR, 'fmi2DoStep is not allowed in the mode "instantiated".')
    for call in (fmu.exitInitializationMode, fmu.terminate, lambda: one.get("capacitor.v"), fmu.cancelStep):
        assert one.refused(call)[0] == ERROR
    one.start()
    for call in (fmu.setupExperiment, fmu.enterInitializationMode, fmu.exitInitializationMode):
        assert one.refused(call)[0] == ERROR
    assert 'cannot be set in the mode "step complete"' in one.refused(lambda: one.set(capacitor__v=1.0))[1]
    fmu.doStep(0, 1)
    fmu.terminate()
    assert one.refused(lambda: fmu.doStep(1, 1))[0] == ERROR
    assert one.get("capacitor.v")[0] == pytest.approx(5 - 4 * math.exp(-1 / 6), abs=1e-4)
    assert one.refused(lambda: one.set(source__v=1.0))[0] == ERROR


def test_functions_of_the_other_interface_are_refused(opened: Open, rc_fmu: Path) -> None:
    exchange = opened(rc_fmu, FMU2Model).start()
    exchange.fmu.enterContinuousTimeMode()
    assert (
        'cannot be set in the mode "continuous-time mode"' in exchange.refused(lambda: exchange.set(resistor__R=1.0))[1]
    )
    exchange.set(source__v=1.0)
    assert exchange.refused(exchange.fmu.exitInitializationMode)[0] == ERROR


def test_unknown_and_calculated_references_are_refused(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu).start()
    fmu = one.fmu
    assert "unknown value reference 999" in one.refused(lambda: fmu.getReal([999]))[1]
    assert "unknown value reference 999" in one.refused(lambda: fmu.setReal([999], [1.0]))[1]
    assert "resistor.i is calculated" in one.refused(lambda: one.set(resistor__i=1.0))[1]
    assert "capacitor.v is a real number" in one.refused(lambda: fmu.getInteger([0]))[1]
    assert "no variable is of this type" in one.refused(lambda: fmu.getBoolean([0]))[1]
    assert fmu.getReal([]) == []


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_values_that_are_not_finite_are_refused_by_name(opened: Open, rc_fmu: Path, value: float) -> None:
    one = opened(rc_fmu).start()
    before = one.everything()
    status, text = one.refused(lambda: one.set(source__v=value))
    assert status == ERROR
    assert "source.v" in text
    assert "not finite" in text
    assert "resistor.R" in one.refused(lambda: one.set(source__v=1.0, resistor__R=value))[1]
    assert one.everything() == before
    order = one.refused(lambda: one.fmu.setRealInputDerivatives([one.refs["source.v"]], [1], [value]))[1]
    assert "source.v" in order


def test_values_out_of_range_are_refused_by_name(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu)
    assert "oil.C" in one.refused(lambda: one.set(oil__C=-1.0))[1]
    assert "oil.T" in one.refused(lambda: one.set(oil__T=0.0))[1]
    one.start().fmu.doStep(0, 1)
    assert "room.T = 0 K is out of range. It must be above 0 K." in one.refused(lambda: one.set(room__T=0.0))[1]


@pytest.mark.parametrize("kind", [FMU2Slave, FMU2Model])
@pytest.mark.parametrize("value", [-5.0, math.nan, math.inf, -1e-300])
def test_a_start_value_out_of_range_is_refused_when_initialization_is_left(
    opened: Open, heat_fmu: Path, kind: type, value: float
) -> None:
    one = opened(heat_fmu, kind)
    one.set(room__T=value)
    status, told = one.refused(one.start)
    assert status == ERROR
    assert "room.T = " in told
    assert ("is out of range. It must be above 0 K" if math.isfinite(value) else "is not finite") in told
    other = opened(heat_fmu, kind)
    other.set(room__T=value)
    other.start(room__T=280.0)  # a valid one has followed
    assert other.get("room.T") == [280.0]


@pytest.mark.parametrize("value", [0.0])
def test_an_input_keeps_its_value_while_a_master_initializes(opened: Open, heat_fmu: Path, value: float) -> None:
    """Masters fill inputs with zeros before they have values, and take any status but fmi2OK for a failure."""
    expected = run(opened(heat_fmu).start(room__T=280.0), 3)
    one = opened(heat_fmu)
    one.set(room__T=280.0)
    for _ in range(2):
        reference, number = (ctypes.c_uint * 1)(one.refs["room.T"]), (ctypes.c_double * 1)(value)
        assert one.fmu.dll.fmi2SetReal(one.fmu.component, reference, ctypes.c_size_t(1), number) == 0
    one.start(room__T=value)
    (told,) = one.messages
    assert told[:2] == (1, "logStatusWarning")
    assert "room.T" in told[2]
    assert "stays at 280 K" in told[2]
    assert one.get("room.T") == [280.0]
    assert run(one, 3) == expected


def test_zero_waits_for_the_first_exchange_of_values_and_no_longer(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    assert "room.T" in one.refused(lambda: one.set(room__T=-1.0))[1]
    one.set(room__T=0.0)
    assert one.get("room.T") == [293.15]
    one.fmu.doStep(0, 1)
    assert one.refused(lambda: one.set(room__T=0.0))[0] == ERROR
    exchange = opened(heat_fmu, FMU2Model).start()
    assert exchange.refused(lambda: exchange.set(room__T=0.0))[0] == ERROR


def test_a_slope_that_leads_an_input_out_of_its_range_is_refused(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    one.fmu.setRealInputDerivatives([one.refs["room.T"]], [1], [-1.0])
    one.fmu.doStep(0, 200)
    before = one.everything()
    status, text = one.refused(lambda: one.fmu.doStep(200, 100))
    assert (status, "leads room.T out of its range (above 0 K)" in text) == (DISCARD, True)
    assert one.refused(lambda: one.fmu.doStep(200, 100))[0] == ERROR
    assert one.everything() == before
    one.fmu.doStep(200, 50)


def test_a_refused_step_that_is_repeated_from_a_state_set_back_is_discarded_again(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    one.fmu.setRealInputDerivatives([one.refs["room.T"]], [1], [-1.0])
    one.fmu.doStep(0, 200)
    saved = one.fmu.getFMUstate()
    for _ in range(2):
        assert one.refused(lambda: one.fmu.doStep(200, 100))[0] == DISCARD
        one.fmu.setFMUstate(saved)
    one.fmu.doStep(200, 50)


def test_set_order_does_not_matter(opened: Open, heat_fmu: Path) -> None:
    values = {"oil__C": 5000.0, "housing__A": 0.5, "room__T": 280.0, "load__tau": 33.0, "governor__w": 99.0}
    values |= {"oil__T": 300.0, "shaft__w": 90.0}
    seen = set()
    for seed in range(6):
        names = list(values)
        random.Random(seed).shuffle(names)
        one = opened(heat_fmu)
        for name in names:
            one.set(**{name: values[name]})
        one.start()
        one.fmu.doStep(0, 30)
        seen.add(tuple(one.everything()))
    assert len(seen) == 1


def run(one: Opened, count: int = 20, step: float = 30.0) -> list[list[float]]:
    rows = []
    for k in range(count):
        one.set(load__tau=20.0 + 10 * math.sin(k))
        one.fmu.doStep(k * step, step)
        rows.append(one.everything())
    return rows


def test_reset_is_a_fresh_instance(opened: Open, heat_fmu: Path) -> None:
    fresh = run(opened(heat_fmu).start())
    used = opened(heat_fmu).start(tolerance=1e-3, oil__C=99.0, room__T=250.0, oil__T=400.0)
    run(used, 7)
    used.fmu.setRealInputDerivatives([used.refs["room.T"]], [1], [0.01])
    used.fmu.reset()
    assert run(used.start()) == fresh


def test_instances_are_independent(opened: Open, heat_fmu: Path) -> None:
    alone = run(opened(heat_fmu).start())
    one, other = opened(heat_fmu).start(), opened(heat_fmu).start(oil__C=100.0, governor__w=300.0)
    rows = []
    for k in range(20):
        one.set(load__tau=20.0 + 10 * math.sin(k))
        one.fmu.doStep(k * 30.0, 30.0)
        other.fmu.doStep(k * 7.0, 7.0)
        rows.append(one.everything())
    assert rows == alone


def test_instances_run_in_threads(opened: Open, heat_fmu: Path) -> None:
    expected = run(opened(heat_fmu).start(), 200)
    many = [opened(heat_fmu).start() for _ in range(8)]
    found: dict[int, list] = {}
    threads = [threading.Thread(target=lambda i=i: found.update({i: run(many[i], 200)})) for i in range(8)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(found[i] == expected for i in range(8))


def test_a_refused_step_leaves_the_state_as_it_was(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start(housing__C=1e-9, load__tau=0.0)
    one.fmu.doStep(0, 1)
    before = one.everything()
    one.set(load__tau=-1e12)
    with_load = one.everything()
    status, text = one.refused(lambda: one.fmu.doStep(1, 1))
    assert status in (DISCARD, ERROR)
    assert "Nothing has changed" in text
    assert any(name in text for name in ("oil.T", "gears.T", "housing.T", "cover.T", "shaft.w"))
    assert one.everything() == with_load
    assert one.fmu.getRealStatus(fmi2LastSuccessfulTime) == 1.0
    assert one.fmu.getBooleanStatus(fmi2Terminated) is False
    one.set(load__tau=0.0)
    assert one.everything() == before
    one.fmu.doStep(1, 1)


def test_clock_tolerates_round_off_only(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu).start(stop=10.0)
    fmu = one.fmu
    fmu.doStep(3e-12, 1.0)
    assert "the instance is at" in one.refused(lambda: fmu.doStep(1.5, 1.0))[1]
    assert one.refused(lambda: fmu.doStep(1.0, -1.0))[0] == ERROR
    assert one.refused(lambda: fmu.doStep(1.0, math.nan))[0] == ERROR
    before = one.get("capacitor.v")
    fmu.doStep(1.0, 0.0)
    assert one.get("capacitor.v") == before
    for past in (10.0, 9.001):
        status, text = one.refused(lambda h=past: fmu.doStep(1.0, h))
        assert (status, "passes the stop time 10 s" in text) == (ERROR, True)
    fmu.doStep(1.0, 9.0 + 1e-12)
    assert "stop time" in one.refused(lambda: fmu.doStep(10.0, 1.0))[1]


def test_a_million_tenths_of_a_second_add_up(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu).start()
    step, component, time = one.fmu.dll.fmi2DoStep, one.fmu.component, 0.0
    for _ in range(1_000_000):
        assert step(component, time, 0.1, 1) == 0
        time += 0.1
    assert one.get("capacitor.v")[0] == pytest.approx(5.0, abs=1e-9)


def test_a_step_of_eleven_days(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu).start()
    one.fmu.doStep(0, 1e6)
    rates = one.get("der(oil.T)", "der(gears.T)", "der(cover.T)", "der(housing.T)", "der(shaft.w)")
    assert max(map(abs, rates)) < 1e-6


def test_bad_experiments_are_refused(opened: Open, rc_fmu: Path) -> None:
    one = opened(rc_fmu)
    for arguments in (dict(tolerance=0.0), dict(tolerance=math.nan), dict(startTime=math.inf)):
        assert one.refused(lambda a=arguments: one.fmu.setupExperiment(**a))[0] == ERROR
    assert "before the start time" in one.refused(lambda: one.fmu.setupExperiment(startTime=5.0, stopTime=1.0))[1]


def test_log_categories_filter(opened: Open, heat_fmu: Path) -> None:
    def categories(setup: Callable[[Opened], None], logging: bool) -> set[str]:
        one = opened(heat_fmu, logging=logging)
        setup(one)
        one.start(oil__T=340.0)
        one.fmu.doStep(0, 1)
        return {category for _, category, _ in one.messages}

    assert categories(lambda _: None, False) == set()
    assert categories(lambda _: None, True) == {"logStatusWarning", "logSolver"}
    assert categories(lambda o: o.fmu.setDebugLogging(True, ["logSolver"]), False) == {"logSolver"}
    assert categories(lambda o: o.fmu.setDebugLogging(True, []), False) == {"logStatusWarning", "logSolver"}
    assert categories(lambda o: o.fmu.setDebugLogging(False, []), True) == set()
    one = opened(heat_fmu)
    assert "unknown category" in one.refused(lambda: one.fmu.setDebugLogging(True, ["logEverything"]))[1]


def test_a_law_outside_its_range_is_told_once(opened: Open, heat_fmu: Path) -> None:
    one = opened(heat_fmu, logging=True).start(oil__T=340.0)
    for k in range(5):
        one.fmu.doStep(k, 1)
    warnings = [text for status, category, text in one.messages if category == "logStatusWarning"]
    assert warnings == ["oil: T of viscous_torque (Nobody2000, eq. 1) = 340 is outside 273.15 .. 330 at t = 0 s."]
    assert one.get("validity.count") == [1.0]
    assert opened(heat_fmu).start().get("validity.count") == [0.0]


def test_a_law_that_a_part_uses_twice_is_told_once(opened: Open, models: SimpleNamespace, tmp_path: Path) -> None:
    heat = models.heat
    twice = dataclasses.replace(heat, checks=heat.checks * 2, checked=ca.vertcat(heat.checked, heat.checked + 1))
    path = export(twice, tmp_path / "twice.fmu")
    one = opened(path, logging=True).start(oil__T=329.5)
    one.set(governor__w=500.0)
    one.fmu.doStep(0, 600)
    assert one.get("validity.count") == [2.0]
    assert len([text for _, category, text in one.messages if category == "logStatusWarning"]) == 1
    with zipfile.ZipFile(path) as file:
        page = file.read("documentation/index.html").decode()
    assert page.count("<td>273.15 .. 330</td>") == 1
