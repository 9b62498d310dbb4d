"""Flat models made by hand: an FMU knows nothing of gears. Compiled FMUs are shared by the whole session."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from gearheat.fmu.export import export
from gearheat.model.core.flat import Check, FlatModel, Quantity
from gearheat.model.sources import LawInfo


def rc_circuit() -> FlatModel:
    """A capacitor charged through a resistor; closed form everywhere."""
    v, u, p = ca.SX.sym("v"), ca.SX.sym("u"), ca.SX.sym("p", 2)
    resistance, capacity = p[0], p[1]
    current = (u - v) / resistance
    loss = current**2 * resistance
    return FlatModel(
        name="rc",
        doc="a capacitor charged through a resistor",
        states=(Quantity("capacitor.v", "V", "voltage of the capacitor", nominal=10.0, start=1.0),),
        inputs=(Quantity("source.v", "V", "voltage of the source", nominal=10.0, start=5.0),),
        parameters=(
            Quantity("resistor.R", "ohm", "resistance", start=2.0, low=0.0, low_open=True),
            Quantity("capacitor.C", "F", "capacitance", start=3.0, low=0.0, low_open=True),
        ),
        outputs=(Quantity("resistor.i", "A", "current"), Quantity("resistor.P_loss", "W", "heat lost to the room")),
        x=v,
        u=u,
        p=p,
        ode=current / capacity,
        y=ca.vertcat(current, loss),
        residual=ca.SX(0, 1),
        residual_names=(),
        supply=u * current - loss,
        throughput=ca.fabs(u * current) + loss,
        stored=capacity * v**2 / 2,
        checks=(),
        checked=ca.SX(0, 1),
        laws=(),
    )


def shaft_and_heat() -> FlatModel:
    """Four temperatures with radiation, and a rotating inertia under a stiff speed governor (1 ms)."""
    x, u, p = ca.SX.sym("x", 5), ca.SX.sym("u", 3), ca.SX.sym("p", 8)
    oil, gears, cover, housing, w = ca.vertsplit(x)
    target, load, room = ca.vertsplit(u)
    c_oil, c_gears, c_cover, c_housing, inertia, gain, area, b_0 = ca.vertsplit(p)
    drive = gain * (target - w)
    viscous = b_0 * ca.exp(-0.03 * (oil - 313.15))
    friction = 0.02 * load + viscous * w
    q_go = 40.0 * (gears - oil)
    q_oc = 15.0 * (oil - cover)
    q_oh = 25.0 * (oil - housing)
    q_ch = 8.0 * (cover - housing)
    q_r = 5.67e-8 * 0.9 * area * (housing**4 - room**4)
    q_c = 6.0 * area * (ca.fmax(housing - room, 1e-3)) ** 1.25
    dw = (drive - load - friction) / inertia
    heats = [(q_go - q_oc - q_oh) / c_oil, (friction * w - q_go) / c_gears, (q_oc - q_ch) / c_cover]
    heats.append((q_oh + q_ch - q_r - q_c) / c_housing)
    temperatures = ("oil.T", "gears.T", "cover.T", "housing.T")
    law = LawInfo("viscous_torque", "Nobody2000", "eq. 1", ranges={"T": (273.15, 330.0)})
    return FlatModel(
        name="shaft and heat",
        doc="a shaft with friction that heats a small network",
        states=(
            *(
                Quantity(n, "K", f"temperature of {n}", nominal=10.0, start=293.15, low=0.0, low_open=True)
                for n in temperatures
            ),
            Quantity("shaft.w", "rad/s", "speed of the shaft", nominal=10.0, start=150.0),
        ),
        inputs=(
            Quantity("governor.w", "rad/s", "wanted speed", nominal=100.0, start=150.0),
            Quantity("load.tau", "N.m", "torque of the load", nominal=10.0, start=20.0),
            Quantity("room.T", "K", "temperature of the room", nominal=350.0, start=293.15, low=0.0, low_open=True),
        ),
        parameters=tuple(
            Quantity(n, unit, f"parameter {n}", start=start, low=0.0, low_open=True)
            for n, unit, start in (
                ("oil.C", "J/K", 4000.0),
                ("gears.C", "J/K", 9000.0),
                ("cover.C", "J/K", 3000.0),
                ("housing.C", "J/K", 20000.0),
                ("shaft.J", "kg.m2", 0.1),
                ("governor.K", "N.m.s/rad", 100.0),
                ("housing.A", "m2", 0.8),
                ("oil.b_0", "N.m.s/rad", 0.02),
            )
        ),
        outputs=(
            Quantity("gears.P_loss", "W", "friction power"),
            Quantity("housing.Q_flow", "W", "heat to the room"),
            Quantity("oil.dT", "K (difference)", "oil above the room"),
        ),
        x=x,
        u=u,
        p=p,
        ode=ca.vertcat(*heats, dw),
        y=ca.vertcat(friction * w, q_r + q_c, oil - room),
        residual=ca.SX(0, 1),
        residual_names=(),
        supply=drive * w - load * w - q_r - q_c,
        throughput=ca.fabs(drive * w) + ca.fabs(load * w) + ca.fabs(q_r + q_c),
        stored=c_oil * oil + c_gears * gears + c_cover * cover + c_housing * housing + inertia * w**2 / 2,
        checks=(Check("oil", law, "T", 273.15, 330.0),),
        checked=ca.vertcat(oil),
        laws=(law,),
    )


@pytest.fixture(scope="session")
def models() -> SimpleNamespace:
    return SimpleNamespace(rc=rc_circuit(), heat=shaft_and_heat())


@pytest.fixture(scope="session")
def rc_fmu(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.rc, tmp_path_factory.mktemp("fmu") / "rc.fmu")


@pytest.fixture(scope="session")
def heat_fmu(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(models.heat, tmp_path_factory.mktemp("fmu") / "heat.fmu")


@pytest.fixture(scope="session")
def heat_fmu_3(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same for FMI 3.0."""
    return export(models.heat, tmp_path_factory.mktemp("fmu") / "heat3.fmu", fmi=3)


class Opened:
    """One instance of an FMU through FMPy, with the messages it sent as (status, category, text)."""

    def __init__(self, path: Path, folder: Path, kind: type = FMU2Slave, logging: bool = False, **changed: str) -> None:
        self.description = fmpy.read_model_description(str(path))
        variables = self.description.modelVariables
        self.refs = {v.name: v.valueReference for v in variables if v.type == "Real"}
        self.whole = {v.name: v.valueReference for v in variables if v.type != "Real"}
        self.messages: list[tuple[int, str, str]] = []
        fmpy.extract(str(path), str(folder))
        interface = self.description.coSimulation
        arguments = dict(guid=self.description.guid, instanceName="one") | changed
        self.fmu = kind(unzipDirectory=str(folder), modelIdentifier=interface.modelIdentifier, **arguments)
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda _, __, status, category, text: self.messages.append((status, category.decode(), text.decode()))
        )
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=logging)

    def start(self, tolerance: float | None = None, stop: float | None = None, **values: float) -> Opened:
        """To step complete or event mode, with values set by name (a dot is written __)."""
        self.set(**values)
        self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0, stopTime=stop)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        named = {n.replace("__", "."): v for n, v in values.items()}
        if reals := {n: v for n, v in named.items() if n not in self.whole}:
            self.fmu.setReal([self.refs[n] for n in reals], list(reals.values()))
        if whole := {n: int(v) for n, v in named.items() if n in self.whole}:
            self.fmu.setInteger([self.whole[n] for n in whole], list(whole.values()))

    def get(self, *names: str) -> list[float]:
        return list(self.fmu.getReal([self.refs[n] for n in names]))

    def everything(self) -> list[float]:
        return self.get(*self.refs)

    def refused(self, call: Callable[[], object]) -> tuple[int, str]:
        """Status and last message of a call that must not succeed."""
        self.messages.clear()
        with pytest.raises(FMICallException) as caught:
            call()
        return caught.value.status, self.messages[-1][2]


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Callable[..., Opened]]:
    """Opens any number of instances, and frees them at the end of the test."""
    made: list[Opened] = []

    def make(path: Path, kind: type = FMU2Slave, logging: bool = False, **changed: str) -> Opened:
        made.append(Opened(path, tmp_path / str(len(made)), kind, logging, **changed))
        return made[-1]

    yield make
    for one in made:
        one.fmu.freeInstance()
