"""The source inside an FMU: complete, without warnings, and the same model again whatever compiler builds it."""

import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace

import fmpy
import numpy as np
import pytest
from fmu_in_c import LIBRARY, check, checks, gcc, library, numbers, planetary, told, unpacked
from gearheat.fmu.compiling import FLAGS, host_platform
from gearheat.model.errors import FmuError
from gearheat.tools.bench.c_importer import Compiler, includes

MODELS = ("rc", "heat", "planetary")

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the libraries are loaded by a program of Linux")


@pytest.fixture(scope="module")
def facts(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("sources")
    made = {"rc": (models.rc, None), "heat": (models.heat, None), "planetary": planetary()}
    with pytest.MonkeyPatch.context() as environment:  # optimised, as for those who get it
        environment.delenv("GEARHEAT_COMPILE", raising=False)
        return {name: unpacked(flat, folder / name, start) for name, (flat, start) in made.items()}


def rebuilt(facts: Path, compiler: Compiler, folder: Path, *options: str) -> str:
    """What the FMU computes when its source is built again."""
    built = library(facts, compiler, *options)
    head, rest = facts.read_text().split("\n", 1)
    assert head.startswith("library ")
    (folder / "facts.txt").write_text(f"library {built}\n{rest}")
    return told(checks(), folder / "facts.txt", "trace")


@pytest.mark.parametrize("model", MODELS)
def test_the_same_tools_give_the_same_bits(facts: dict[str, Path], model: str, tmp_path: Path) -> None:
    """With the flags of the export, written out here by a stranger who only has the FMU and ziglang."""
    source = facts[model].parent / "sources" / "all.c"
    options = ("-O2", *(flag for flag in FLAGS))
    built = Compiler.zig()([source], options, ".so")
    (own,) = (facts[model].parent / "binaries" / host_platform().name).iterdir()
    assert built.read_bytes() == own.read_bytes()
    assert rebuilt(facts[model], Compiler.zig(), tmp_path, "-O2", "-g", "-fno-sanitize=all") == check(
        facts[model], "trace"
    )


@pytest.mark.parametrize("model", MODELS)
def test_the_systems_compiler_gives_the_same_numbers(facts: dict[str, Path], model: str, tmp_path: Path) -> None:
    if not (compiler := gcc()):
        pytest.skip("there is no gcc")
    names = [line.split() for line in facts[model].read_text().splitlines()[2:]]
    names.sort(key=lambda words: "xduyp".index(words[2]))
    rounded = np.array(["residual" in words[-1] for words in names])  # these hold nothing but round-off
    found = numbers(rebuilt(facts[model], compiler, tmp_path, "-O2", "-Wall", "-Wextra", "-Werror"))["values"]
    expected = numbers(check(facts[model], "trace"))["values"]
    scale = np.maximum(np.abs(expected).max(axis=0), 1e-300)
    apart = np.abs(found - expected).max(axis=0) / scale
    assert apart[~rounded].max() < 1e-12, [words[-1] for words, a in zip(names, apart, strict=True) if a > 1e-12]
    assert np.abs(found - expected)[:, rounded].max() < 1e-8


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("tool", ["gcc", "clang"])
def test_no_warning(facts: dict[str, Path], model: str, tool: str, tmp_path: Path) -> None:
    compiler = gcc() if tool == "gcc" else Compiler.zig()
    if compiler is None:
        pytest.skip("there is no gcc")
    options = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-c", "-o", str(tmp_path / "all.o"))
    source = facts[model].parent / "sources" / "all.c"
    done = subprocess.run([*compiler.command, *options, str(source)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_warning_would_be_told(tmp_path: Path) -> None:
    (tmp_path / "all.c").write_text("static int unused(int a) { return 1; }\n")
    with pytest.raises(FmuError, match="unused"):
        Compiler.zig()([tmp_path / "all.c"], (*LIBRARY, "-Wall", "-Wextra", "-Werror"), ".so")


LINKED = """
#include "fmi2Functions.h"
#include "fmi3Functions.h"
#include <stdio.h>
#include <stdlib.h>
extern fmi2InstantiateTYPE one_fmi2Instantiate, two_fmi2Instantiate;
extern fmi2GetRealTYPE one_fmi2GetReal, two_fmi2GetReal;
extern fmi2SetupExperimentTYPE one_fmi2SetupExperiment, two_fmi2SetupExperiment;
extern fmi2EnterInitializationModeTYPE one_fmi2EnterInitializationMode, two_fmi2EnterInitializationMode;
extern fmi3InstantiateCoSimulationTYPE shaft_and_heat_fmi3InstantiateCoSimulation;
extern fmi3GetFloat64TYPE shaft_and_heat_fmi3GetFloat64;

int main(int n, char **guid)
{
    fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
    fmi2Component one = one_fmi2Instantiate("one", fmi2CoSimulation, guid[1], "", &callbacks, 0, 0);
    fmi2Component two = two_fmi2Instantiate("two", fmi2CoSimulation, guid[2], "", &callbacks, 0, 0);
    fmi3Instance three = shaft_and_heat_fmi3InstantiateCoSimulation("three", guid[3], "", 0, 0, 0, 0, NULL, 0, NULL,
                                                                    NULL, NULL);
    fmi2ValueReference r = 0;
    double value[3];
    if (n != 4 || !one || !two || !three) return 1;
    one_fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0), two_fmi2SetupExperiment(two, 0, 0.0, 0.0, 0, 0.0);
    one_fmi2EnterInitializationMode(one), two_fmi2EnterInitializationMode(two);
    if (one_fmi2GetReal(one, &r, 1, value) || two_fmi2GetReal(two, &r, 1, value + 1)) return 2;
    if (shaft_and_heat_fmi3GetFloat64(three, &r, 1, value + 2, 1)) return 3;
    printf("%g %g %g", value[0], value[1], value[2]);
    return 0;
}
"""


def test_the_sources_of_three_fmus_link_into_one_program(
    rc_fmu: Path, heat_fmu: Path, heat_fmu_3: Path, tmp_path: Path
) -> None:
    """Two of FMI 2.0 with the prefix their user gives, one of 3.0 with its own name."""
    sources, guids = [tmp_path / "main.c"], []
    sources[0].write_text(LINKED)
    for name, fmu in (("one_", rc_fmu), ("two_", heat_fmu), ("", heat_fmu_3)):
        with zipfile.ZipFile(fmu) as file:
            text = file.read("sources/all.c").decode()
        sources.append(tmp_path / f"part{len(sources)}.c")
        sources[-1].write_text((f"#define FMI2_FUNCTION_PREFIX {name}\n" if name else "") + text)
        guids.append(fmpy.read_model_description(str(fmu)).guid)
    made = tmp_path / "linked"
    made.write_bytes(Compiler.zig().made(sources, ("-O0", *includes())))
    made.chmod(0o755)
    assert subprocess.run([made, *guids], capture_output=True, text=True, check=True).stdout == "1 293.15 293.15"
