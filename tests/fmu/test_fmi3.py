"""FMI 3.0: the same model as with 2.0 bit by bit, valid, complete, and what it has not refused by name."""

import ctypes
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import fmpy
import numpy as np
import pytest
from binary_formats import elf
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3ScheduledExecution, FMU3Slave
from fmpy.validation import validate_fmu
from fmu_in_c import gcc, planetary
from gearheat.fmu.compiling import platforms
from gearheat.fmu.description import terminals
from gearheat.fmu.equations import equations
from gearheat.fmu.play import play
from gearheat.fmu.source import headers_of_3
from gearheat.fmu.variables import table
from gearheat.model.errors import FmuError
from lxml import etree

DISCARD, ERROR = 2, 3
DUTY = np.array(
    [(0.0, 150.0, 20.0), (600.0, 150.0, 20.0), (600.0, 180.0, 50.0), (1800.0, 180.0, 50.0)],
    dtype=[("time", float), ("governor.w", float), ("load.tau", float)],
)


class Instance:
    """One instance of the FMU through FMPy, with the messages it sent."""

    def __init__(self, path: Path, folder: Path, kind: type = FMU3Slave, **options: Any) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables if v.type == "Float64"}
        self.said: list[str] = []
        fmpy.extract(str(path), str(folder))
        token, name = self.description.guid, self.description.coSimulation.modelIdentifier
        self.fmu = kind(guid=token, unzipDirectory=str(folder), modelIdentifier=name, instanceName="one")
        self.fmu.instantiate(logMessage=lambda _, __, ___, text: self.said.append(text.decode()), **options)

    def start(self, **values: float) -> "Instance":
        """Out of initialization mode, with values set by name (a dot is written __)."""
        self.set(**values)
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        self.fmu.setFloat64([self.refs[n.replace("__", ".")] for n in values], list(values.values()))

    def get(self, *names: str) -> list[float]:
        return list(self.fmu.getFloat64([self.refs[n] for n in names]))

    def run(self, begin: int, count: int = 5) -> list[list[float]]:
        rows = []
        for k in range(begin, begin + count):
            self.set(load__tau=20.0 + k)
            self.fmu.doStep(30.0 * k, 30.0)
            rows.append(self.get(*self.refs))
        return rows

    def refused(self, call: Callable[[], object]) -> tuple[int, str]:
        """Status and last message of a call that must not succeed."""
        with pytest.raises(FMICallException) as caught:
            call()
        return caught.value.status, self.said[-1]


@pytest.fixture
def made(heat_fmu_3: Path, tmp_path: Path) -> Iterator[Callable[..., Instance]]:
    """Makes any number of instances, and frees them at the end of the test."""
    instances: list[Instance] = []

    def make(kind: type = FMU3Slave, **options: Any) -> Instance:
        instances.append(Instance(heat_fmu_3, tmp_path / str(len(instances)), kind, **options))
        return instances[-1]

    yield make
    for one in instances:
        one.fmu.freeInstance()


def held(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


def test_fmpy_finds_no_problem_and_the_other_files_keep_their_schema(heat_fmu_3: Path) -> None:
    assert validate_fmu(str(heat_fmu_3)) == []
    content, schemas = held(heat_fmu_3), Path(fmpy.__file__).parent / "schema" / "fmi3"
    files = {
        "sources/buildDescription.xml": "fmi3BuildDescription.xsd",
        "terminalsAndIcons/terminalsAndIcons.xml": "fmi3TerminalsAndIcons.xsd",
    }
    for name, schema in files.items():
        etree.XMLSchema(etree.parse(schemas / schema)).assertValid(etree.fromstring(content[name]))
    assert content["terminalsAndIcons/icon.png"].startswith(b"\x89PNG")
    assert "model.png" not in content
    assert b"FMI 3.0" in content["documentation/index.html"]
    assert not any(b"fmi2" in text for name, text in content.items() if not name.startswith("binaries"))


def test_value_references_are_unique_over_all_types(heat_fmu_3: Path) -> None:
    root = etree.fromstring(held(heat_fmu_3)["modelDescription.xml"])
    references = [v.get("valueReference") for v in root.find("ModelVariables")]
    assert len(references) == len(set(references)) > 20
    known = {v.get("valueReference") for v in root.find("ModelVariables") if v.get("causality") != "independent"}
    on = {r for unknown in root.find("ModelStructure") for r in unknown.get("dependencies").split()}
    assert on <= known
    (dT,) = root.findall("ModelVariables/Float64[@name='oil.dT']")
    assert dT.get("relativeQuantity") == "true"


@pytest.mark.skipif(sys.platform != "linux", reason="reads a binary of Linux")
def test_every_declared_function_is_exported_and_nothing_else(heat_fmu_3: Path) -> None:
    declared = set(
        re.findall(r"^FMI3_Export fmi3\w+TYPE\s+(fmi3\w+);", headers_of_3()["fmi3Functions.h"], re.MULTILINE)
    )
    assert len(declared) > 70
    (library,) = [data for name, data in held(heat_fmu_3).items() if name.startswith("binaries/x86_64-linux/")]
    assert elf(library).exported == declared


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_results_are_those_of_fmi_2_bit_by_bit(heat_fmu: Path, heat_fmu_3: Path, kind: str) -> None:
    found = [
        fmpy.simulate_fmu(
            str(path),
            fmi_type=kind,
            stop_time=1800,
            output_interval=60,
            relative_tolerance=1e-7,
            input=DUTY,
            start_values={"room.T": 280.0, "oil.C": 4100.0},
        )
        for path in (heat_fmu, heat_fmu_3)
    ]
    assert found[0].dtype == found[1].dtype
    assert len(found[0]) > 30
    assert found[0].tobytes() == found[1].tobytes()


def test_the_player_plays_it_and_holds_inputs(heat_fmu: Path, heat_fmu_3: Path) -> None:
    steps = {n: (DUTY["time"], DUTY[n]) for n in ("governor.w", "load.tau")}
    of_2, of_3 = (play(path, steps, 1800, 60, start={"room.T": 280.0}) for path in (heat_fmu, heat_fmu_3))
    assert of_2.names == of_3.names
    assert of_2.values.tobytes() == of_3.values.tobytes()
    ramp = {"room.T": (np.array([0.0, 60.0]), np.array([280.0, 286.0]))}
    assert play(heat_fmu_3, ramp, 60, 10)["room.T"].tolist() == [280, 281, 282, 283, 284, 285, 285]


def test_adjoints_are_the_transposed_jacobian(made: Callable[..., Instance]) -> None:
    start = dict(oil__T=320.0, gears__T=335.0, cover__T=310.0, housing__T=305.0, shaft__w=140.0)
    for one in (made().start(**start), made(FMU3Model).start(**start)):
        structure, refs = one.description, one.refs
        unknown = [u.variable.valueReference for u in (*structure.outputs, *structure.derivatives)]
        states = [u.variable.derivative.name for u in structure.derivatives]
        given = [v.name for v in structure.modelVariables if v.causality in ("input", "parameter") and v.name in refs]
        known = [refs[name] for name in (*states, *given)]
        along = [one.fmu.getDirectionalDerivative(unknown, [k], [1.0]) for k in known]
        n = len(known)
        back = [one.fmu.getAdjointDerivative([u], known, [1.0], n) for u in unknown]
        scale = np.abs(along).max(axis=1, keepdims=True)
        assert np.count_nonzero(along) > 60
        assert (np.abs(np.array(along) - np.array(back).T) <= 1e-13 * scale).all()
        seeds = np.cos(np.arange(len(unknown)))
        assert one.fmu.getAdjointDerivative(unknown, known, seeds, n) == pytest.approx(
            np.array(along) @ seeds, rel=1e-12
        )
    adjoint = one.fmu.getAdjointDerivative
    assert "is calculated" in one.refused(lambda: adjoint(unknown, [refs["oil.dT"]], seeds, 1))[1]
    assert "is given" in one.refused(lambda: adjoint([refs["room.T"]], known, [1.0], n))[1]
    assert "12 values instead of" in one.refused(lambda: adjoint(unknown, known, seeds[:12], n))[1]


def test_adjoints_of_a_model_with_implicit_equations(models: SimpleNamespace) -> None:
    """The circuit with two voltages in between that only equations hold; <J dot, bar> = <dot, J' bar>."""
    z = ca.SX.sym("z", 2)
    R, C = ca.vertsplit(models.rc.p)
    residual = ca.vertcat(z[0] + R * z[0] ** 3 - models.rc.u + z[1], z[1] - models.rc.x * ca.exp(-C * z[0]))
    flat = replace(models.rc, z=z, residual=residual, residual_names=("a", "b"), ode=(z[0] + z[1]) / C)
    model, rng = equations(flat), np.random.default_rng(1)
    x, z_at, u, p = ([0.7, 0.0, 0.0], [0.3, 0.2], [0.9], [2.0, 3.0])
    c = model.constants(p)
    dots = [rng.normal(size=v.numel()) for v in (model.x, model.u, model.p)]
    bars = [rng.normal(size=v.numel()) for v in (model.y, model.ode)]
    out = model.directional(x, z_at, u, p, c, *dots, model.constants_directional(p, dots[2]))
    *back, c_bar = model.adjoint(x, z_at, u, p, c, *bars)
    back[2] += model.constants_adjoint(p, c_bar)
    forward = sum(float(bar @ np.array(o).ravel()) for bar, o in zip(bars, out, strict=True))
    backward = sum(float(dot @ np.array(b).ravel()) for dot, b in zip(dots, back, strict=True))
    assert abs(forward) > 0.1
    assert backward == pytest.approx(forward, rel=1e-12)


def test_a_serialised_state_goes_on_in_another_instance(made: Callable[..., Instance]) -> None:
    one, other = made().start(oil__C=3333.0), made()
    one.run(0)
    state = one.fmu.getFMUState()
    saved = one.fmu.serializeFMUState(state)
    other.fmu.setFMUState(other.fmu.deserializeFMUState(saved))
    going_on = one.run(5)
    assert other.run(5) == going_on
    one.fmu.setFMUState(state)
    assert one.run(5) == going_on
    one.fmu.freeFMUState(state)
    damaged = saved[:100] + bytes([saved[100] ^ 1]) + saved[101:]
    assert other.refused(lambda: other.fmu.deserializeFMUState(damaged))[1].startswith("fmi3DeserializeFMUState: ")


def test_time_is_a_variable_that_can_be_read_only(made: Callable[..., Instance]) -> None:
    one = made().start()
    one.fmu.doStep(0.0, 7.0)
    assert one.get("time", "oil.C", "time", "time", "room.T", "time") == [7.0, 4000.0, 7.0, 7.0, 293.15, 7.0]
    assert one.get("time") == [7.0]
    assert one.refused(lambda: one.set(time=1.0))[0] == ERROR
    assert made().get("oil.T", "gears.C") == [293.15, 9000.0]


def test_event_mode_is_used_where_it_was_asked_for(made: Callable[..., Instance]) -> None:
    plain, one = made().start(), made(eventModeUsed=True)
    one.start()
    assert one.refused(lambda: one.fmu.doStep(0.0, 30.0))[0] == ERROR
    rows = []
    for k in range(5):
        one.set(load__tau=20.0 + k)
        assert one.fmu.updateDiscreteStates() == (False, False, False, False, False, 0.0)
        one.fmu.enterStepMode()
        assert one.fmu.doStep(30.0 * k, 30.0) == (False, False, False, 30.0 * (k + 1))
        rows.append(one.get(*one.refs))
        one.fmu.enterEventMode()
    assert rows == plain.run(0)
    assert "eventModeUsed" in plain.refused(plain.fmu.enterEventMode)[1]
    exchange = made(FMU3Model).start()
    exchange.set(load__tau=44.0)
    assert [exchange.fmu.updateDiscreteStates()[3] for _ in range(2)] == [True, False]
    exchange.fmu.enterContinuousTimeMode()
    assert (exchange.fmu.getNumberOfContinuousStates(), exchange.fmu.getNumberOfEventIndicators()) == (7, 0)


def test_a_refused_step_leaves_the_time_as_it_was(made: Callable[..., Instance]) -> None:
    one = made().start(housing__C=1e-9, load__tau=0.0)
    one.fmu.doStep(0.0, 1.0)
    one.set(load__tau=-1e12)
    before = one.get(*one.refs)
    status, text = one.refused(lambda: one.fmu.doStep(1.0, 1.0))
    assert status in (DISCARD, ERROR)
    assert text.startswith("fmi3DoStep: ")
    assert one.get(*one.refs) == before
    one.set(load__tau=0.0)
    assert one.fmu.doStep(1.0, 1.0) == (False, False, False, 2.0)


def test_output_derivatives_are_rates(made: Callable[..., Instance]) -> None:
    one = made().start()
    one.fmu.doStep(0.0, 60.0)
    assert one.fmu.getOutputDerivatives([one.refs["oil.T"]], [1]) == one.get("der(oil.T)")
    assert "order 2" in one.refused(lambda: one.fmu.getOutputDerivatives([one.refs["oil.T"]], [2]))[1]


def test_what_it_has_not_is_refused_by_name(made: Callable[..., Instance], heat_fmu_3: Path, tmp_path: Path) -> None:
    one = made().start()
    fmu = one.fmu
    for kind in ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "Boolean"):
        getter = getattr(fmu, f"get{kind}")
        assert getter([]) == []
        assert one.refused(lambda getter=getter: getter([0])) == (
            ERROR,
            f"fmi3Get{kind}: unknown value reference; no variable is of this type.",
        )
        assert one.refused(lambda k=kind: getattr(fmu, f"set{k}")([0], [1]))[0] == ERROR
    assert "oil.T is a real number" in one.refused(lambda: fmu.getInt32([0]))[1]
    assert "oil.T is a real number" in one.refused(lambda: fmu.setInt64([0], [1]))[1]
    for call in (lambda: fmu.getString([0]), lambda: fmu.getBinary([0]), lambda: fmu.setBinary([0], [b"x"])):
        assert one.refused(call)[0] == ERROR
    for call in (lambda: fmu.getClock([0]), lambda: fmu.setClock([0], [True]), fmu.enterConfigurationMode):
        assert one.refused(call)[0] == ERROR
    assert "structural parameters" in one.refused(fmu.exitConfigurationMode)[1]
    three = (ctypes.c_double * 1)(), (ctypes.c_uint64 * 1)(), (ctypes.c_int * 1)()
    assert one.refused(lambda: fmu.fmi3GetIntervalDecimal(fmu.component, None, 1, three[0], three[2]))[0] == ERROR
    assert one.refused(lambda: fmu.fmi3GetShiftFraction(fmu.component, None, 1, three[1], three[1]))[0] == ERROR
    assert one.refused(lambda: fmu.fmi3EvaluateDiscreteStates(fmu.component))[0] == ERROR
    assert one.refused(lambda: fmu.fmi3ActivateModelPartition(fmu.component, 0, 0.0))[0] == ERROR
    n = ctypes.c_size_t()
    assert one.refused(lambda: fmu.fmi3GetNumberOfVariableDependencies(fmu.component, 0, ctypes.byref(n)))[0] == ERROR
    for kind, options in ((FMU3ScheduledExecution, {}), (FMU3Slave, {"requiredIntermediateVariables": [0]})):
        with pytest.raises(Exception, match="Failed to instantiate"):
            Instance(heat_fmu_3, tmp_path / kind.__name__, kind, **options)


def test_terminals_read_back() -> None:
    """Shaft ends and heat ports of a rig, and every variable of theirs is one that can be connected."""
    flat = planetary()[0]
    known = {v.name: v for v in table(flat)}
    root = etree.fromstring(terminals(table(flat)))
    found = {
        t.get("name"): {m.get("memberName"): (m.get("variableName"), m.get("variableKind")) for m in t}
        for t in root.iterfind("Terminals/Terminal")
    }
    assert found["carrier"] == {"w": ("carrier.w", "signal"), "tau": ("carrier.tau", "inflow")}
    assert found["sun"] == {"w": ("sun.w", "signal"), "tau": ("sun.tau", "inflow")}
    assert found["oil"] == {"T": ("oil.T", "signal"), "Q_flow": ("oil.Q_flow_external", "inflow")}
    assert found["room"] == {"T": ("room.T", "signal"), "Q_flow": ("room.Q_flow", "outflow")}
    assert len(found) == 8
    for members in found.values():
        assert all(known[name].causality in ("input", "output") for name, _ in members.values())


def test_platforms_have_the_names_of_fmi_3() -> None:
    names = ["x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"]
    assert [p.name for p in platforms("all", 3)] == names
    assert [p.name for p in platforms("win64,darwin64", 3)] == names[2:]
    assert {p.name for p in platforms("host", 3)} <= set(names)
    with pytest.raises(FmuError, match='"win32" is unknown'):
        platforms("win32", 3)


def test_the_source_compiles_without_a_warning(heat_fmu_3: Path, tmp_path: Path) -> None:
    if not (compiler := gcc()):
        pytest.skip("there is no gcc")
    for name, text in headers_of_3().items():
        (tmp_path / name).write_text(text)
    (tmp_path / "all.c").write_bytes(held(heat_fmu_3)["sources/all.c"])
    options = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only")
    subprocess.run([*compiler.command, *options, tmp_path / "all.c"], check=True)
