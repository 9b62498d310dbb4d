"""The source inside an FMU: complete, without warnings, and the same model again whatever compiler builds it."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from fmu_in_c import LIBRARY, check, checks, gcc, library, numbers, planetary, told, unpacked
from gearheat.fmu.compiling import FLAGS, host_platform
from gearheat.model.errors import FmuError
from gearheat.tools.c_importer import Compiler

MODELS = ("rc", "heat", "planetary")

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the libraries are loaded by a program of Linux")


@pytest.fixture(scope="module")
def facts(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("sources")
    made = {"rc": (models.rc, None), "heat": (models.heat, None), "planetary": planetary()}
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
