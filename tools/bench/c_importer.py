"""A small FMI 2.0 importer in C, for measuring and for tests: it knows the standard, and nothing of this project.

An importer is a few C files beside `importer/importer.c`, compiled by ziglang into a program; it is told about an FMU
by a text of facts, one line for each variable, read from the FMU's own description.
"""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from ...fmu.compiling import cache_folder, host_platform, store
from ...model.errors import FmuError

#: The importer's own sources; programs add theirs.
HERE = Path(str(files("gearheat.tools.bench").joinpath("importer")))

_KINDS = {"input": "u", "output": "y", "parameter": "p"}


@dataclass(frozen=True)
class Compiler:
    """A C compiler: its command, and a name that changes when its output may."""

    command: tuple[str, ...]
    name: str

    @classmethod
    def zig(cls, target: str | None = None) -> Compiler:
        """The compiler of the ziglang package, for the host when no target is given."""
        target = target or host_platform().targets[0]
        return cls((sys.executable, "-m", "ziglang", "cc", "-target", target), f"zig {version('ziglang')} {target}")

    def __call__(self, sources: Sequence[Path], options: Sequence[str], suffix: str = "") -> Path:
        """Compile and link sources into one file, once for the same text of all of them and of their headers.

        Raises:
            FmuError: the compiler does not start, or refuses
        """
        key = hashlib.sha256()
        near = sorted({h for s in (*sources, HERE / "importer.h") for h in s.parent.glob("*.h")})
        for part in (self.name, *options, *(p.read_text(encoding="utf-8") for p in (*sources, *near))):
            key.update(part.encode() + b"\0")
        stored = cache_folder() / "programs" / f"{key.hexdigest()}{suffix}"
        if not stored.exists():
            store(stored, self.made(sources, options))
            stored.chmod(0o755)
        return stored

    def made(self, sources: Sequence[Path], options: Sequence[str]) -> bytes:
        """Compile and link without keeping the result."""
        environment = dict(os.environ)
        for variable, name in (("ZIG_GLOBAL_CACHE_DIR", "global"), ("ZIG_LOCAL_CACHE_DIR", "local")):
            environment.setdefault(variable, str(cache_folder() / "zig" / name))
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder) / "made"
            command = [*self.command, *options, "-o", str(made), *map(str, sources), "-lm"]
            try:
                run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
            except OSError as error:
                raise FmuError(f"{self.command[0]} does not start ({error.strerror}).") from error
            if run.returncode != 0:
                raise FmuError(f"{self.name} refuses {sources[0].name}:\n{run.stderr[:2000]}")
            return made.read_bytes()


def includes() -> tuple[str, ...]:
    """Compiler options that find the standard's headers and the importer's own."""
    return ("-I", str(files("fmpy").joinpath("c-code")), "-I", str(HERE))


def program(sources: Sequence[Path], options: Sequence[str] = (), compiler: Compiler | None = None) -> Path:
    """The importer with some more sources as a program; their `main` is its entry.

    Args:
        sources: C files beside the importer's own
        options: more compiler options, behind those every program gets
        compiler: ziglang for the host when not given
    """
    compiler = compiler or Compiler.zig()
    windows = "windows" in compiler.name
    system = () if windows else ("-D_GNU_SOURCE", "-pthread", "-ldl")
    usual = ("-std=c99", "-O2", "-g", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", *system, *includes())
    return compiler([HERE / "importer.c", *sources], (*usual, *options), ".exe" if windows else "")


def unpack(fmu: Path, folder: Path, library: Path | None = None) -> Path:
    """Unpack an FMU into a folder and write the facts about it there.

    Args:
        library: the binary to use instead of the FMU's own for this machine

    Returns:
        the file of facts
    """
    with zipfile.ZipFile(fmu) as file:
        file.extractall(folder)
        root = ET.fromstring(file.read("modelDescription.xml"))
    path = folder / "facts.txt"
    path.write_text(facts(root, library or binary(root, folder)), encoding="utf-8")
    return path


def binary(root: ET.Element, folder: Path) -> Path:
    """The binary of an unpacked FMU for this machine."""
    simulation = root.find("CoSimulation")
    if simulation is None:
        raise FmuError("this FMU is not for co-simulation.")
    host = host_platform()
    return folder / "binaries" / host.name / (simulation.get("modelIdentifier", "") + host.suffix)


def facts(root: ET.Element, library: Path) -> str:
    """What an importer in C has to know of an FMU: library, identification, then a line for each real number.

    A line reads: reference, kind, start, lowest, highest, nominal, swing of a test, name. Kinds are x for a state, d
    for its derivative, u, y and p; states and derivatives stand in the order of the model structure.
    """
    variables = root.findall("ModelVariables/ScalarVariable")
    rates = [variables[int(u.get("index", "0")) - 1] for u in root.findall("ModelStructure/Derivatives/Unknown")]
    states = [variables[int(_real(v).get("derivative", "0")) - 1] for v in rates]
    chosen = [("x", v) for v in states] + [("d", v) for v in rates]
    known = {v.get("name") for _, v in chosen}
    others = [v for v in variables if v.get("name") not in known and v.find("Real") is not None]
    chosen += [(_KINDS[v.get("causality", "")], v) for v in others]
    lines = [f"library {library}", f"guid {root.get('guid')}"]
    for kind, variable in chosen:
        real = _real(variable)
        start, low, high = (float(real.get(k, d)) for k, d in (("start", "nan"), ("min", "-inf"), ("max", "inf")))
        nominal = float(real.get("nominal", "1"))
        numbers = (start, low, high, nominal, _swing(start, nominal, real.get("unit", "1")))
        text = " ".join(f"{number!r}" for number in numbers)
        lines.append(f"variable {variable.get('valueReference')} {kind} {text} {variable.get('name')}")
    return "\n".join(lines) + "\n"


def _real(variable: ET.Element) -> Mapping[str, str]:
    real = variable.find("Real")
    if real is None:
        raise FmuError(f"{variable.get('name')} is not a real number.")
    return real.attrib


def _swing(start: float, nominal: float, unit: str) -> float:
    """How far a test may move a variable from its start value: 5 K, or a tenth of its size."""
    if unit == "K":
        return 5.0
    return 0.1 * abs(start) if math.isfinite(start) and start else 0.1 * nominal
