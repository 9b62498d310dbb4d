"""FMUs seen from C: the planetary rig as an FMU, the programs that check FMUs, and compilers with their sanitizers."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
from gearheat.fmu.export import export
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import FmuError
from gearheat.scenarios.load import load
from gearheat.tools.bench.c_importer import Compiler, includes, program, unpack

HERE = Path(__file__).parent / "fmu" / "importer"

#: How an FMU's source becomes a shared library, whatever the compiler.
LIBRARY = ("-std=c99", "-shared", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off")


@cache
def planetary() -> tuple[FlatModel, Mapping[str, float]]:
    """The planetary rig with speed and torque of the carrier given, and its operating point."""
    scenario = load("planetary")
    return scenario.spec.flat(), scenario.operating_point


@cache
def planetary_on_torques() -> tuple[FlatModel, Mapping[str, float]]:
    """The planetary rig with the torques of both shafts given, so that its speed is a state; balanced at the start."""
    scenario = load("planetary")
    flat = scenario.spec.driven({"carrier": ("tau",), "sun": ("tau",)}).flat()
    start = {n: v for n, v in scenario.operating_point.items() if flat.index[n][0] != "output"}
    return flat, {**start, "sun.tau": -612.7, "rotor.w": 104.7}


def unpacked(flat: FlatModel, folder: Path, start: Mapping[str, float] | None = None) -> Path:
    """The facts of a model's FMU, unpacked into a folder; beside them are `model.fmu` and `sources/all.c`."""
    folder.mkdir(parents=True, exist_ok=True)
    facts = unpack(export(flat, folder / "model.fmu", start=start), folder)
    whole = {name for relation in flat.relations if relation.low == relation.high for name in relation.parameters}
    lines = [line.split() for line in facts.read_text(encoding="utf-8").splitlines()]
    for words in lines:
        if words[0] == "variable" and words[-1] in whole:
            words[-2] = "0.0"  # a test that moves numbers at will leaves it alone
    facts.write_text("\n".join(map(" ".join, lines)) + "\n", encoding="utf-8")
    return facts


def unpacked_3(facts: Path, flat: FlatModel, start: Mapping[str, float] | None = None) -> Path:
    """The same facts for the model's FMU for FMI 3.0, whose source is unpacked into a folder `3` beside them."""
    folder = facts.parent / "3"
    fmu = export(flat, folder / "model.fmu", start=start, fmi=3)
    with zipfile.ZipFile(fmu) as file:
        file.extract("sources/all.c", folder)
    library, _, rest = facts.read_text(encoding="utf-8").split("\n", 2)
    token = fmpy.read_model_description(str(fmu)).instantiationToken
    (folder / "facts.txt").write_text(f"{library}\nguid {token}\n{rest}", encoding="utf-8")
    return folder / "facts.txt"


def library(facts: Path, compiler: Compiler, *options: str) -> Path:
    """The shared library of an unpacked FMU's source; of one for FMI 3.0, under functions of FMI 2.0."""
    source = facts.parent / "sources" / "all.c"
    if facts.parent.name != "3":
        return compiler([source], (*LIBRARY, *options), ".so")
    own = ("-DFMI3_OVERRIDE_FUNCTION_PREFIX", *includes())
    return compiler([source, HERE / "three.c"], (*LIBRARY, *own, *options), ".so")


@cache
def gcc() -> Compiler | None:
    """The system's gcc, if there is one."""
    if (path := shutil.which("gcc")) is None:
        return None
    told = subprocess.run([path, "--version"], capture_output=True, text=True, check=True)
    return Compiler((path,), told.stdout.splitlines()[0])


def sanitizer(name: str, folder: Path) -> Compiler | None:
    """The system's gcc, if it has a sanitizer."""
    (folder / "nothing.c").write_text("int main(void) { return 0; }\n")
    compiler = gcc()
    try:
        return compiler if compiler and compiler([folder / "nothing.c"], (f"-fsanitize={name}",)) else None
    except FmuError:
        return None


@cache
def checks(compiler: Compiler | None = None, *options: str) -> Path:
    """The program of all checks but the fuzzer."""
    return program(
        [HERE / n for n in ("main.c", "order.c", "runs.c", "long.c", "slopes.c", "trace.c")], options, compiler
    )


@cache
def fuzzer(compiler: Compiler | None = None, *options: str) -> Path:
    """The fuzzer."""
    return program([HERE / "fuzz.c"], options, compiler)


def told(*command: object) -> str:
    """What a program tells; it fails the test with that when it does not end well."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, f"{words[1:]} ends with {done.returncode}\n{done.stdout}\n{done.stderr[-4000:]}"
    return done.stdout


def check(facts: Path, *arguments: object) -> str:
    """What one check tells of one FMU."""
    return told(checks(), facts, *arguments)


def numbers(said: str) -> dict[str, np.ndarray]:
    """Rows of numbers by the word they begin with."""
    rows: dict[str, list[list[float]]] = {}
    for line in said.splitlines():
        word, *values = line.split()
        rows.setdefault(word, []).append([float.fromhex(value) for value in values])
    return {word: np.array(values) for word, values in rows.items()}
