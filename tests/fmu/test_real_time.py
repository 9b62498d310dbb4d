"""FMUs for real time: as many steps of the solver as are asked for, near the adaptive run, and sources of C90."""

import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from gearheat.fmu.compiling import host_platform
from gearheat.fmu.export import export
from gearheat.fmu.play import play
from gearheat.fmu.stack import CALL, RED_ZONE, deepest_stack
from gearheat.model.core.flat import Quantity
from gearheat.model.errors import FmuError
from gearheat.model.run.schedule import join_phases
from gearheat.tools.bench.c_importer import Compiler
from gearheat.tools.export.real_time import measure

Opened = Any  # the class of conftest.py
Open = Callable[..., Opened]

#: The longest communication step [s].
STEP = 0.01


@pytest.fixture(scope="module")
def real_time(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.heat, tmp_path_factory.mktemp("real_time") / "heat.fmu", real_time=STEP)


@pytest.fixture(scope="module")
def in_c90(real_time: Path) -> Path:
    """The same FMU with the binary of a compiler of C90, which must have nothing to say."""
    path, binary = real_time.with_name("c90.fmu"), f"binaries/{host_platform().name}/shaft_and_heat.so"
    options = ("-std=c90", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC", "-ffp-contract=off")
    with zipfile.ZipFile(real_time) as file:
        held = {name: file.read(name) for name in file.namelist()}
    source = real_time.with_name("all.c")
    source.write_bytes(held["sources/all.c"])
    held[binary] = Compiler.zig().made([source], options)
    with zipfile.ZipFile(path, "w") as file:
        for name, content in held.items():
            file.writestr(name, content)
    return path


def steps_of(one: Opened, at: float, step: float) -> int:
    """How many steps the solver makes of a communication step, as it says."""
    one.messages.clear()
    one.fmu.doStep(at, step)
    (found,) = [text for _, category, text in one.messages if category == "logSolver"]
    done, rejected = re.search(r"(\d+) steps, (\d+) rejected", found).groups()
    assert rejected == "0"
    return int(done)


@pytest.mark.parametrize("fmu", ["real_time", "in_c90"])
def test_a_step_takes_the_steps_it_asks_for(fmu: str, opened: Open, request: pytest.FixtureRequest) -> None:
    one = opened(request.getfixturevalue(fmu), logging=True).start()
    assert [steps_of(one, at, STEP) for at in STEP * np.arange(3)] == [1, 1, 1]
    one.set(governor__w=20.0)  # a jump far from what the shaft, of 1 ms, can follow at once
    assert steps_of(one, 3 * STEP, STEP) == 1
    assert steps_of(one, 4 * STEP, 6.5 * STEP) == 7
    assert steps_of(one, 10.5 * STEP, 0.1 * STEP) == 1


def test_fixed_steps_end_where_adaptive_ones_do(real_time: Path, heat_fmu: Path) -> None:
    """Over a warm-up with a jump, behind which the shaft is ten times faster than the steps."""
    duty = join_phases([(40.0, {"governor.w": 150.0}), (40.0, {"governor.w": 50.0})])
    inputs = {name: (duty.time, values) for name, values in duty.values.items()}
    names = ["oil.T", "gears.T", "housing.T", "shaft.w"]
    fixed, adaptive = (play(path, inputs, 80.0, 1.0, record=names, tolerance=1e-9) for path in (real_time, heat_fmu))
    assert np.abs(fixed.values - adaptive.values).max() < 5e-4


def test_messages_of_c90_are_those_of_c99(real_time: Path, in_c90: Path, opened: Open) -> None:
    told = []
    for path in (real_time, in_c90):
        one = opened(path).start(stop=1.0)
        calls = (
            lambda one=one: one.fmu.doStep(0.25, STEP),
            lambda one=one: one.fmu.doStep(0.0, 2.0),
            lambda one=one: one.set(room__T=-1.0),
            lambda one=one: one.fmu.getReal([9999]),
            lambda one=one: one.fmu.deserializeFMUState(b"short"),
        )
        told.append([one.refused(call) for call in calls])
    assert told[0] == told[1]
    assert "starts at 0.25 s, but the instance is at 0 s" in told[0][0][1] and "9999" in told[0][3][1]
    with pytest.raises(Exception, match="instantiate"):
        opened(in_c90, FMU2Slave, guid="g" * 200)


def test_newton_has_a_bound(models: SimpleNamespace, opened: Open, tmp_path: Path) -> None:
    """At a triple root each step is two thirds of the one before: some thirty to 1e-5, before a run but not in it."""
    z, u = ca.SX.sym("z"), models.rc.u
    own = {"z": z, "algebraic": (Quantity("z", "1", "cube root", start=1.0),), "residual_names": ("cube",)}
    flat = replace(models.rc, residual=z**3 - u, **own)
    path, few = export(flat, tmp_path / "cube.fmu", real_time=STEP), 1e-15
    opened(path).start(source__v=few).fmu.doStep(0.0, STEP)
    one = opened(path).start()
    one.fmu.doStep(0.0, STEP)
    one.set(source__v=few)
    status, text = one.refused(lambda: one.fmu.doStep(STEP, STEP))
    assert status == 2 and '"cube" has no solution at its begin' in text


def test_what_the_export_tells(models: SimpleNamespace, real_time: Path) -> None:
    with zipfile.ZipFile(real_time) as file:
        code = file.read("sources/all.c").decode()
    duty = join_phases([(8.0, {"governor.w": 150.0}), (8.0, {"governor.w": 50.0})])
    told = measure(real_time, code, models.heat, duty, {}, 2, STEP)
    checks = {what.partition(":")[0]: result for what, result in told.checks}
    assert checks["temperature"] == "below 1e-3 K" and checks["speed"] == "below 1e-7 rad/s"
    assert told.evaluations == 0 and 1000 < told.stack < 10_000
    assert told.as_dict()["stack_bytes"] == told.stack and told.rows[0][1] == "1"


SMALL = """
static int deep(volatile char *text)
{
    volatile char own[2000];
    own[text[0]] = 1;
    return own[0];
}

static int other(int k)
{
    volatile char own[5000];
    own[k] = 1;
    return own[0]; /* calls deep() as little as "deep(" */
}

int root(int k)
{
    volatile char own[300];
    own[k] = 1;
    return k ? deep(own) : 0;
}

int rest(int k)
{
    return other(k);
}
"""


def test_the_deepest_stack() -> None:
    assert 2300 <= deepest_stack(SMALL, "root") < 2300 + RED_ZONE + 5 * CALL
    assert 5000 <= deepest_stack(SMALL, "rest") < 5000 + RED_ZONE + 5 * CALL
    with pytest.raises(FmuError, match="undeclared"):
        deepest_stack("int root(void)\n{\n    return x;\n}\n", "root")
