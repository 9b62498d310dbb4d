"""Importers and masters of others run our FMUs: the table of the page on FMUs, `python tests/importers.py` prints it.

What is installed runs: FMPy always, other packages after `pip install "gearheat[importers]"`, programs that are on the
PATH. The error of an FMU is that of its temperatures after four hours, of a coupled system after an hour, against the
model integrated by CVODES.
"""

from __future__ import annotations

import ctypes
import math
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import fmpy
from fmpy.ssp.simulation import simulate_ssp
from fmpy.util import read_csv
from gearheat.fmu.export import export
from gearheat.fmu.ssp import ELEMENTS
from gearheat.model.core.flat import FlatModel
from gearheat.model.machines.spec import PartSpec, Spec
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.export.systems import groups_of, split_rig, write_system
from gearheat.tools.solve.settings import flat_of

#: Communication step of the FMUs and of the coupled system [s], and how long they run.
STEP, HOURS, COUPLED, HOUR = 60.0, 14400.0, 10.0, 3600.0

#: A warm oil bath that a cooler and a room cool, in three FMUs.
PLANT = Spec(
    "plant",
    "oil that a cooler and a room cool",
    (
        PartSpec("oil", "HeatCapacity", {"C": 5e3, "T": 340.0}),
        PartSpec("cooler", "ThermalConductor", {"G": 8.0}),
        PartSpec("shell", "CylinderCooling", {"A": 0.5, "emissivity": 0.9, "D": 0.3, "share_ends": 0.3}),
        PartSpec("room", "ClosedRoom", {"C": 2e5, "T": 290.0}),
        PartSpec("walls", "ThermalConductor", {"G": 60.0}),
        PartSpec("outdoors", "PrescribedTemperature", {"T": 280.0}),
    ),
    (
        ("oil.heat", "shell.surface", "cooler.a"),
        ("room.air", "shell.air"),
        ("room.floor", "cooler.b", "walls.a"),
        ("walls.b", "outdoors.heat"),
    ),
)
RIG = Scenario("plant", PLANT.doc, "network", Path(), PLANT, {}, {})
GROUPS = groups_of(["cooler", "room=room,walls,outdoors"])


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    importer: str
    interface: str
    error: float

    @property
    def text(self) -> str:
        """As the page has it: the error as the next power of ten above it."""
        bound = f"below 1e{math.floor(math.log10(max(self.error, 1e-12))) + 1} K"
        package = PACKAGES.get(self.importer)
        known = version(package) if package else _version(PROGRAMS[self.importer])
        return f"| {self.importer} | {known} | {self.interface} | {bound} |"


PACKAGES = {"FMPy": "FMPy", "fmpy.ssp": "FMPy", "libcosim": "libcosimpy", "ecos": "ecospy"}
#: Executables, and the option by which each tells its version.
PROGRAMS = {"fmusim": ("fmusim", "--version"), "FMI compliance checker": ("fmuCheck.linux64", "-v")}
KINDS = {"CoSimulation": "cs", "ModelExchange": "me"}
#: The checker takes explicit Euler steps in model exchange [s].
EULER = 1.0


def rows() -> Iterator[Row]:
    """The table, of what is installed here."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        flat, fmus = _fmus(folder)
        exact = _exact(flat, HOURS)
        system = folder / "plant.ssp"
        write_system(RIG, split_rig(RIG, GROUPS, {}), system)
        whole = _exact(flat_of(RIG), HOUR)
        for fmi, fmu in fmus.items():
            for kind in ("CoSimulation", "ModelExchange"):
                yield Row("FMPy", f"FMI {fmi}.0 {kind}", _apart(_by_fmpy(fmu, kind), exact))
        yield Row("fmpy.ssp", f"SSP 1.0, step {COUPLED:g} s", _apart(_ssp_by_fmpy(system), whole))
        for name, run, couple in (("libcosim", _by_libcosim, _ssp_by_libcosim), ("ecos", _by_ecos, _ssp_by_ecos)):
            with suppress(PackageNotFoundError):
                version(PACKAGES[name])
                for fmi in (2, 3) if name == "ecos" else (2,):  # libcosim knows FMI 1.0 and 2.0
                    yield Row(name, f"FMI {fmi}.0 CoSimulation", _apart(run(fmus[fmi]), exact))
                yield Row(name, f"SSP 1.0, step {COUPLED:g} s", _apart(couple(system), whole))
        yield from _programs(fmus, exact, folder)


def _programs(fmus: Mapping[int, Path], exact: Mapping[str, float], folder: Path) -> Iterator[Row]:
    """The rows of executables that are here."""
    for kind in KINDS:
        if shutil.which("fmusim"):
            files = {fmi: _by_fmusim(fmu, kind, folder / f"{fmi}.csv") for fmi, fmu in fmus.items()}
            assert files[2].read_bytes() == files[3].read_bytes()  # every output, to the 16 digits that it writes
            for fmi, file in files.items():
                yield Row("fmusim", f"FMI {fmi}.0 {kind}", _apart(_last_of(file), exact))
    for kind, step in zip(KINDS, (STEP, EULER), strict=True):
        if shutil.which("fmuCheck.linux64"):
            file = _by_checker(fmus[2], kind, step, folder / "checked.csv")
            yield Row("FMI compliance checker", f"FMI 2.0 {kind}, step {step:g} s", _apart(_last_of(file), exact))


def _fmus(folder: Path) -> tuple[FlatModel, Mapping[int, Path]]:
    """The planetary rig at its operating point, for both versions of the standard."""
    scenario = load("planetary")
    flat = scenario.spec.flat()
    start = dict(scenario.operating_point)
    return flat, {fmi: export(flat, folder / f"planetary_{fmi}.fmu", start=start, fmi=fmi) for fmi in (2, 3)}


def _exact(flat: FlatModel, stop: float) -> dict[str, float]:
    """Temperatures at the end by CVODES."""
    duty = join_phases([(stop, {q.name: q.start for q in flat.inputs})])
    found = simulate(flat, duty, times=[stop])
    return {q.name: float(found[q.name][-1]) for q in flat.states}


def _apart(found: Mapping[str, float], exact: Mapping[str, float]) -> float:
    """The largest difference of what was read."""
    assert found
    return max(abs(value - exact[name]) for name, value in found.items())


def _by_fmpy(fmu: Path, kind: str) -> dict[str, float]:
    found = fmpy.simulate_fmu(
        str(fmu), stop_time=HOURS, output_interval=STEP, fmi_type=kind, relative_tolerance=1e-6, output=["oil.T"]
    )
    return {"oil.T": float(found["oil.T"][-1])}


def _last_of(file: Path) -> dict[str, float]:
    return {"oil.T": float(read_csv(str(file))["oil.T"][-1])}


def _version(program: tuple[str, str]) -> str:
    """The first number that a program tells of itself."""
    told = subprocess.run(program, capture_output=True, text=True, check=False)
    return re.findall(r"\d+(?:\.\d+)+", told.stdout + told.stderr)[0]


def _by_fmusim(fmu: Path, kind: str, out: Path) -> Path:
    options = f"--interface-type {KINDS[kind]} --stop-time {HOURS} --output-interval {STEP} --tolerance 1e-6"
    words = [*options.split(), "--solver", "cvode", "--output-file", str(out), str(fmu)]
    subprocess.run(["fmusim", *words], check=True, capture_output=True)
    return out


def _by_checker(fmu: Path, kind: str, step: float, out: Path) -> Path:
    """It finds nothing wrong in the file, nor in what the FMU answers."""
    options = f"-k {KINDS[kind]} -h {step} -n {HOURS / STEP:.0f} -s {HOURS}"
    words = ["fmuCheck.linux64", *options.split(), "-o", str(out), str(fmu)]
    checked = subprocess.run(words, check=True, capture_output=True, text=True)
    assert re.findall(r"(\d+) (?:warning|error)", checked.stderr, flags=re.IGNORECASE) == ["0"] * 3, checked.stderr
    return out


def driven(system: Path, stop: float, step: float, values: Mapping[str, float] | None = None) -> Any:
    """Columns of fmpy.ssp, which sets an input that nobody gives to zero."""
    duty = {q.name: q.start for q in flat_of(RIG).inputs} | dict(values or {})
    given = {name: lambda time, value=value: value for name, value in duty.items()}
    return simulate_ssp(str(system), stop_time=stop, step_size=step, input=given)


def _ssp_by_fmpy(system: Path) -> dict[str, float]:
    found = driven(system, HOUR, COUPLED)
    return {"oil.T": float(found["gearbox.oil.T"][-1]), "room.T": float(found["room.room.T"][-1])}


def _libcosim() -> Any:
    """Its class of an execution, told to be quiet."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

    log_output_level(CosimLogLevel.ERROR)
    return CosimExecution


def _by_libcosim(fmu: Path) -> dict[str, float]:
    run = _libcosim().from_step_size(STEP * 1e9)
    from libcosimpy.CosimSlave import CosimLocalSlave

    run.add_local_slave(CosimLocalSlave(str(fmu), "box"))
    return {"oil.T": _last(run, HOURS, {0: 0})[0]}


def _ssp_by_libcosim(system: Path) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(system) as file:
        file.extractall(folder)
        run = _libcosim().from_ssp_file(str(Path(folder) / ELEMENTS), int(COUPLED * 1e9))
        names = {info.name.decode(): info.index for info in run.slave_infos()}
        oil, room = _last(run, HOUR, {names["gearbox"]: 0, names["room"]: 0})
    return {"oil.T": oil, "room.T": room}


def _last(run: Any, stop: float, wanted: Mapping[int, int]) -> list[float]:
    """Values of a variable of each slave at the end."""
    from libcosimpy.CosimObserver import CosimObserver

    observer = CosimObserver.create_last_value()
    run.add_observer(observer)
    assert run.simulate_until(stop * 1e9)
    return [observer.last_real_values(slave_index=i, variable_references=[ref])[0] for i, ref in wanted.items()]


def _ecos() -> Any:
    """Its class of a simulation; it needs a library that the package tbb brings to a place of its own."""
    for path in sorted(Path(sys.prefix, "lib").glob("libtbb.so.12*")):
        ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
    from ecospy.EcosSimulation import EcosSimulation

    return EcosSimulation


def _by_ecos(fmu: Path) -> dict[str, float]:
    simulation = _ecos()
    from ecospy.EcosSimulationStructure import EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("box", str(fmu))
        with simulation(structure=structure, step_size=STEP) as run:
            run.init()
            run.step(round(HOURS / STEP))
            return {"oil.T": run.get_real("box::oil.T")}


def _ssp_by_ecos(system: Path) -> dict[str, float]:
    alone = system.with_stem("alone")
    with zipfile.ZipFile(system) as whole, zipfile.ZipFile(alone, "w") as file:
        for name in whole.namelist():
            file.writestr(name, whole.read(ELEMENTS if name == "SystemStructure.ssd" else name))
    with _ecos()(ssp_path=str(alone), step_size=COUPLED) as run:
        run.init()
        run.step(round(HOUR / COUPLED))
        return {"oil.T": run.get_real("gearbox::oil.T"), "room.T": run.get_real("room::room.T")}


if __name__ == "__main__":
    table = [row.text for row in rows()]
    print("\n".join(["| importer | version | interface | error |", "|---|---|---|---|", *table]))
