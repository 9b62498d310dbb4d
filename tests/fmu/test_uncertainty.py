"""Standard deviations of an FMU: closed form, Monte Carlo, saved states, both versions, and what is refused."""

import math
import subprocess
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu
from fmu_in_c import gcc
from gearheat.fmu.batch import Batch
from gearheat.fmu.equations import equations
from gearheat.fmu.export import export
from gearheat.fmu.leading import (
    SHORTFALL,
    Directions,
    Sensitivities,
    Uncertain,
    Uncertainty,
    leading,
    locate_deviations,
)
from gearheat.fmu.play import Player, play
from gearheat.fmu.variables import table
from gearheat.model.errors import FmuError
from gearheat.model.run.schedule import Schedule

from .test_states import go_on

Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]

#: The values of the circuit of conftest.py, and one standard deviation of each.
U, V_0, R, C = 5.0, 1.0, 2.0, 3.0
SD = {"resistor.R": 0.1, "capacitor.C": 0.09, "capacitor.v": 0.02}
CIRCUIT = Uncertain(
    tuple(Uncertainty(name, {name: sd}) for name, sd in SD.items()),
    ("capacitor.v", "resistor.i"),
)
#: So large that the circuit is not linear in them.
WIDE = {"resistor.R": 0.6, "capacitor.C": 0.6, "capacitor.v": 0.2}
#: Relative standard deviations in the machine of conftest.py; the last two move together.
HEAT = Uncertain(
    (
        Uncertainty("friction", {"oil.b_0": 0.002}),
        Uncertainty("area", {"housing.A": 0.08}),
        Uncertainty("capacities", {"oil.C": 200.0, "housing.C": 1000.0}),
    ),
    ("oil.T", "housing.T", "gears.P_loss"),
)


@pytest.fixture(scope="module")
def circuit(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.rc, tmp_path_factory.mktemp("sd") / "rc.fmu", uncertain=CIRCUIT)


@pytest.fixture(scope="module")
def machine(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.heat, tmp_path_factory.mktemp("sd") / "heat.fmu", uncertain=HEAT)


@pytest.fixture(scope="module")
def machine_3(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.heat, tmp_path_factory.mktemp("sd") / "heat3.fmu", uncertain=HEAT, fmi=3)


@pytest.fixture(scope="module")
def mixed(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Directions]:
    """The circuit with a mixture, and its directions."""
    told: list[Directions] = []
    wide = tuple(Uncertainty(name, {name: sd}) for name, sd in WIDE.items())
    what = Uncertain(wide, CIRCUIT.shown, mixture=True, tell=told.append)
    return export(models.rc, tmp_path_factory.mktemp("sd") / "mixed.fmu", uncertain=what), told[0]


@pytest.fixture(scope="module")
def mixed_machine_3(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    what = replace(HEAT, mixture=True)
    return export(models.heat, tmp_path_factory.mktemp("sd") / "mixed3.fmu", uncertain=what, fmi=3)


@pytest.mark.parametrize("resistance", (R, 2 * R))
def test_closed_form_of_the_circuit(circuit: Path, resistance: float) -> None:
    """v = u + (v_0 - u) exp(-t / R C); a parameter set to another value keeps its relative uncertainty."""
    start = {"resistor.R": resistance}
    run = play(circuit, {}, 20.0, 0.5, start=start, record=["capacitor.v.sd", "resistor.i.sd"], tolerance=1e-6)
    s = run.time / (resistance * C)
    left = (V_0 - U) * np.exp(-s)
    by_rate, by_start = left * s, np.exp(-s) * SD["capacitor.v"]  # dv / d ln R = dv / d ln C, dv
    r, c = SD["resistor.R"] / R, SD["capacitor.C"] / C
    v_sd = np.sqrt((r * by_rate) ** 2 + (c * by_rate) ** 2 + by_start**2)
    by_r, by_c = (left - by_rate) / resistance * r, -by_rate / resistance * c  # i = (u - v) / R = -left / R
    i_sd = np.sqrt(by_r**2 + by_c**2 + (by_start / resistance) ** 2)
    assert run["capacitor.v.sd"] == pytest.approx(v_sd, rel=2e-3)
    assert run["resistor.i.sd"] == pytest.approx(i_sd, rel=2e-3)


def test_closed_form_of_a_mixture(mixed: tuple[Path, Directions]) -> None:
    """Three circuits with the weights of Gauss and Hermite's rule, each linear in the directions that are left."""
    fmu, found = mixed
    run = play(fmu, {}, 20.0, 0.5, start={"resistor.R": 2 * R}, record=["capacitor.v.sd"], tolerance=1e-6)
    assert [side.node for side in found.sides] == pytest.approx([-math.sqrt(3), math.sqrt(3)]) and found.count == 2
    factors = np.array([[1.0, 1.0], *(side.factors for side in found.sides)])
    first = V_0 + np.array([0.0, *(side.states[0] for side in found.sides)])
    s = run.time / (2 * R * C * factors.prod(axis=1)[:, None])  # (nodes, times)
    v, left = U + (first[:, None] - U) * np.exp(-s), (first[:, None] - U) * np.exp(-s)
    by_rate = left * s
    moves = np.vstack([found.parameters, found.states]).T
    slopes = [by_rate * (r / R + c / C) + np.exp(-s) * x for r, c, x in moves]
    weights = np.array([[4.0], [1.0], [1.0]]) / 6
    apart = v - (weights * v).sum(axis=0)
    expected = np.sqrt((weights * (sum(slope**2 for slope in slopes) + apart**2)).sum(axis=0))
    assert run["capacitor.v.sd"] == pytest.approx(expected, rel=2e-3)
    assert found.off is not None and found.off > 0.03


def test_a_switch_is_seen_by_the_export(models: SimpleNamespace) -> None:
    """y = tanh((x - 1 h) / w) at x = a t / 2 is nearly linear in a as long as x is uncertain by far less than w."""
    t, a, w = models.rc.x, models.rc.p[0], 900.0
    y = ca.vertcat(ca.tanh((t - 3600.0) / w), 0.0)
    switch = replace(models.rc, ode=a / 2, y=y, supply=a * 0, throughput=a * 0, stored=a * 0)
    model, variables = equations(switch), table(switch, deviating=CIRCUIT.shown)
    small, large = (
        leading(switch, model, variables, Uncertain((Uncertainty("rate", {"resistor.R": sd}),), (), mixture=True))
        for sd in (0.02, 0.5)
    )
    assert small.off is not None and large.off is not None and small.off < 0.1 < large.off
    assert (large.parameters == 0).all() and large.sides[1].factors[0] == pytest.approx(math.exp(math.sqrt(3) * 0.25))
    assert Sensitivities(model, large.count, large.moving, locate_deviations(variables)).move.n_in() == 9


def test_monte_carlo(models: SimpleNamespace, machine: Path) -> None:
    """Five times the standard error of a standard deviation that is drawn is allowed."""
    rows, times = 800, np.array([300.0, 1200.0, 3600.0, 7200.0])
    z = np.random.default_rng(5).standard_normal((rows, len(HEAT.reasons)))
    starts = {q.name: q.start for q in models.heat.parameters}
    drawn = {path: starts[path] + sd * z[:, k] for k, r in enumerate(HEAT.reasons) for path, sd in r.changes.items()}
    batch = Batch(models.heat)
    found = batch.warmup(Schedule(np.array([0.0, 7200.0]), {}), *batch.vectors(drawn), times=times)
    run = play(machine, {}, 7200.0, 60.0, record=[f"{name}.sd" for name in HEAT.shown], output_times=times)
    for name in HEAT.shown:
        assert run[f"{name}.sd"] == pytest.approx(found[name].std(axis=0, ddof=1), rel=5 / math.sqrt(2 * rows))


def test_leading_directions_leave_little_out(models: SimpleNamespace) -> None:
    """Two reasons that act alike take one direction, which is as large as both."""
    alike = (Uncertainty("one", {"oil.b_0": 0.002}), Uncertainty("other", {"oil.b_0": 0.001}))
    model, variables = equations(models.heat), table(models.heat, deviating=HEAT.shown)
    found = leading(models.heat, model, variables, Uncertain(alike, HEAT.shown))
    assert found.count == 1 and found.shortfall is not None and found.shortfall <= SHORTFALL
    place = [q.name for q in models.heat.parameters].index("oil.b_0")
    assert found.parameters[place, 0] == pytest.approx(math.hypot(0.002, 0.001))


def test_a_step_costs_less_than_three_plain_ones(models: SimpleNamespace) -> None:
    """Counted in operations: a sensitivity step beside each step of the solver."""
    model, variables = equations(models.heat), table(models.heat, deviating=HEAT.shown)
    found = leading(models.heat, model, variables, HEAT)
    added = Sensitivities(model, found.count, found.moving, locate_deviations(variables)).move
    assert added.n_instructions() < 2 * model.step.n_instructions()


def test_saved_states_carry_the_sensitivities(opened: Open, machine: Path) -> None:
    one, other = opened(machine).start(), opened(machine)
    go_on(one, 0)
    state = one.fmu.getFMUState()
    saved, first = one.fmu.serializeFMUState(state), go_on(one, 10)
    one.fmu.setFMUState(state)
    again = one.fmu.getFMUState()
    assert one.fmu.serializeFMUState(again) == saved
    assert go_on(one, 10) == first
    restored = other.fmu.deserializeFMUState(saved)
    other.fmu.setFMUState(restored)
    assert go_on(other, 10) == first
    assert one.get("oil.T.sd")[0] > 0
    one.fmu.reset()
    assert one.start().get("oil.T.sd") == [0.0]
    for instance, kept in ((one, state), (one, again), (other, restored)):
        instance.fmu.freeFMUState(kept)


def test_saved_states_carry_a_mixture(opened: Open, mixed: tuple[Path, Directions]) -> None:
    def go_on(one: Opened) -> list[list[float]]:
        rows = []
        for k in range(4):
            one.set(source__v=5.0 + k)
            one.fmu.doStep(10.0 + k, 1.0)
            rows.append(one.everything())
        return rows

    one, other = opened(mixed[0]).start(), opened(mixed[0])
    one.fmu.doStep(0.0, 10.0)
    state = one.fmu.getFMUState()
    saved, first = one.fmu.serializeFMUState(state), go_on(one)
    restored = other.fmu.deserializeFMUState(saved)
    for instance, at in ((one, state), (other, restored)):
        instance.fmu.setFMUState(at)
        assert go_on(instance) == first
        instance.fmu.freeFMUState(at)


@pytest.mark.parametrize("fmu", ("machine", "mixed_machine_3"))
def test_a_steady_start_has_the_deviations_of_rest(fmu: str, request: pytest.FixtureRequest) -> None:
    machine, names = request.getfixturevalue(fmu), [f"{name}.sd" for name in HEAT.shown]
    steady, long = (
        play(machine, {}, stop, stop, start={"start": item}, record=names) for stop, item in ((1.0, 2.0), (1e6, 1.0))
    )
    assert steady.values[0] == pytest.approx(long.values[-1], rel=1e-4)


def test_both_versions_give_the_same_numbers(machine: Path, machine_3: Path) -> None:
    names = [f"{name}.sd" for name in HEAT.shown]
    first, second = (play(path, {}, 3600.0, 60.0, record=names) for path in (machine, machine_3))
    assert (first.values == second.values).all() and first.values[-1].min() > 0
    assert validate_fmu(str(machine)) == [] and validate_fmu(str(machine_3)) == []


def test_the_states_are_those_of_the_plain_fmu(machine: Path, mixed_machine_3: Path, heat_fmu: Path) -> None:
    names = ["oil.T", "housing.T", "gears.P_loss"]
    plain, *uncertain = (play(path, {}, 3600.0, 60.0, record=names) for path in (heat_fmu, machine, mixed_machine_3))
    assert all((plain.values == other.values).all() for other in uncertain)


def test_what_is_not_supported_is_refused(opened: Open, machine: Path) -> None:
    one = opened(machine).start()
    sd, room = one.refs["oil.T.sd"], one.refs["room.T"]
    status, text = one.refused(lambda: one.fmu.getDirectionalDerivative([sd], [room], [1.0]))
    assert status == 2 and "of oil.T.sd no derivative is known" in text
    status, text = one.refused(lambda: one.fmu.getRealOutputDerivatives([sd], [1]))
    assert status == 2 and "of oil.T.sd no derivative is known" in text
    status, text = one.refused(lambda: one.set(oil__T__sd=1.0))
    assert status == 3 and "oil.T.sd is calculated" in text
    with pytest.raises(Exception, match="instantiate"):
        opened(machine, FMU2Model)


def test_what_makes_no_deviation_is_refused(models: SimpleNamespace, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match=r"cap\.v is no state and no output"):
        export(models.rc, tmp_path / "rc.fmu", uncertain=Uncertain(CIRCUIT.reasons, ("cap.v",)))
    idle = (Uncertainty("nothing", {"resistor.R": 0.0, "sink.G": 1.0}),)
    with pytest.raises(FmuError, match="no parameter with an uncertainty has an effect"):
        export(models.rc, tmp_path / "rc.fmu", uncertain=Uncertain(idle, CIRCUIT.shown))


def test_the_source_compiles_without_a_warning(machine: Path, tmp_path: Path) -> None:
    if not (compiler := gcc()):
        pytest.skip("there is no gcc")
    with zipfile.ZipFile(machine) as file:
        file.extract("sources/all.c", tmp_path)
    options = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "-o", tmp_path / "all.o")
    subprocess.run([*compiler.command, *options, tmp_path / "sources" / "all.c"], check=True)


def test_the_page_says_what_the_deviations_contain(machine: Path, mixed: tuple[Path, Directions]) -> None:

    with zipfile.ZipFile(machine) as file:
        page = file.read("documentation/index.html").decode()
    assert "<td>friction</td><td><code>oil.b_0</code> +0.002 N.m.s/rad</td>" in page
    assert "serves FMI 2.0 co-simulation on every platform" in page
    assert "Not contained are the uncertainty of inputs" in page and "combinations are integrated" in page
    assert "deviation may be far too small" in page
    with zipfile.ZipFile(mixed[0]) as file:
        page = file.read("documentation/index.html").decode()
    assert "that of the mixture of the three" in page and "far too small" not in page
    with Player(machine) as player:
        assert {f"{name}.sd" for name in HEAT.shown} < set(player.described.variables)
