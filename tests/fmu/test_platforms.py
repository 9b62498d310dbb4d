"""The binaries of all platforms: what they offer and need, and that the library of Windows computes the same."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from binary_formats import Library, elf, pe, universal
from fmu_in_c import HERE, checks, numbers, planetary, told
from gearheat.fmu import compiling
from gearheat.fmu.export import export
from gearheat.tools.bench.c_importer import Compiler, program, unpack

#: What every binary offers: the functions of FMI 2.0, and nothing else.
FUNCTIONS = 44


def binary(fmu: Path, platform: str) -> bytes:
    with zipfile.ZipFile(fmu) as file:
        (name,) = [n for n in file.namelist() if n.startswith(f"binaries/{platform}/")]
        return file.read(name)


def only_the_standard(library: Library, mark: str = "", linker: frozenset[str] = frozenset()) -> None:
    offered = library.exported - linker
    assert len(offered) == FUNCTIONS
    assert {name for name in offered if not name.startswith(mark + "fmi2")} == set()


@pytest.mark.parametrize("model", ["rc", "planetary"])
def test_linux_needs_an_old_c_library_and_its_mathematics(model: str, models: SimpleNamespace, tmp_path: Path) -> None:
    flat, start = planetary() if model == "planetary" else (models.rc, None)
    library = elf(binary(export(flat, tmp_path / "m.fmu", start=start, platform="linux64"), "linux64"))
    only_the_standard(library)
    assert library.processor == "x86_64"
    assert library.needed <= {"libc.so.6", "libm.so.6"}
    versions = {tuple(int(n) for n in v.removeprefix("GLIBC_").split(".")) for v in library.versions}
    assert versions
    assert max(versions) <= (2, 17)


def test_macos_has_both_processors_and_needs_the_system_alone(models: SimpleNamespace, tmp_path: Path) -> None:
    libraries = universal(binary(export(models.rc, tmp_path / "m.fmu", platform="darwin64"), "darwin64"))
    assert [library.processor for library in libraries] == ["x86_64", "aarch64"]
    for library in libraries:
        only_the_standard(library, "_", frozenset({"___dso_handle", "__mh_dylib_header"}))  # the linker's own marks
        assert library.system <= (11, 0)
        assert library.needed == {"/usr/lib/libSystem.B.dylib"}
    assert libraries[1].signed, "macOS kills a program that loads unsigned code on this processor"


#: What generated code may call, of one argument and of two.
ONE = (
    "fabs",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "exp",
    "log",
    "floor",
    "ceil",
    "sinh",
    "cosh",
    "tanh",
)
ONE += ("asinh", "acosh", "atanh", "erf", "log1p", "expm1", "isnan", "isfinite")
TWO = ("pow", "fmod", "atan2", "hypot", "fmin", "fmax", "copysign")


@pytest.mark.parametrize("platform", ["win64", "win32"])
def test_windows_has_all_the_mathematics(platform: str) -> None:
    """What is taken from its C library is named one by one, as the compiler's own is not built."""
    calls = " + ".join(["much[9]", *(f"{name}(x)" for name in ONE), *(f"{name}(x, y)" for name in TWO)])
    body = f"double much[9999]; much[n] = x; return {calls};"
    code = f"#include <math.h>\n__declspec(dllexport) double fmi2(double x, double y, int n) {{ {body} }}"
    library = pe(compiling.binary(code, compiling.PLATFORMS[platform]))
    assert library.exported == {"fmi2"}
    assert all(name.startswith("api-ms-win-crt-") for name in library.needed)


@cache
def wine() -> str | None:
    """The program that runs 64-bit programs of Windows; Debian's wine64 is not in the path."""
    places = ["wine64", "/usr/lib/wine/wine64", "wine"]
    return next((found for place in places if (found := shutil.which(place))), None)


def in_windows(folder: Path, *command: object) -> str:
    """What a program of Windows tells, run in a folder."""
    environment = {**os.environ, "WINEPREFIX": str(folder / "prefix"), "WINEDEBUG": "-all"}
    environment["WINEDLLOVERRIDES"] = "mscoree,mshtml="
    words = [str(wine()), *map(str, command)]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, f"{words} ends with {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done.stdout


def apart(found: np.ndarray, expected: np.ndarray, rounded: np.ndarray) -> float:
    """Largest difference in a column relative to its largest value; `rounded` columns hold nothing but round-off."""
    scale = np.abs(expected).max(axis=0)
    scale[rounded] = np.inf
    scale[scale == 0] = 1.0
    return float((np.abs(found - expected).max(axis=0) / scale).max())


@pytest.mark.skipif(wine() is None, reason="wine is not installed: the library of Windows is not run")
@pytest.mark.skipif(sys.platform != "linux", reason="wine is used on Linux")
def test_windows_computes_what_linux_computes(tmp_path: Path) -> None:
    flat, start = planetary()
    fmu = export(flat, tmp_path / "m.fmu", start=start, platform="linux64,win64,win32")
    for platform, processor in (("win64", "x86_64"), ("win32", "x86")):
        library = pe(binary(fmu, platform))
        only_the_standard(library)
        assert library.processor == processor
        assert all(re.match(r"kernel32|ntdll|api-ms-win-crt-", name) for name in library.needed), library.needed
    facts = unpack(fmu, tmp_path)
    (_, rest) = facts.read_text().split("\n", 1)
    (tmp_path / "windows.txt").write_text("library binaries\\win64\\planetary.dll\n" + rest)
    sources = [HERE / name for name in ("main.c", "order.c", "trace.c")]
    importer = program(sources, (), Compiler.zig("x86_64-windows-gnu"))
    assert "refused" in in_windows(tmp_path, importer, "windows.txt", "birth")
    in_windows(tmp_path, importer, "windows.txt", "order", "oil.Q_flow_external", "-1e9")
    found = numbers(in_windows(tmp_path, importer, "windows.txt", "trace"))
    expected = numbers(told(checks(), facts, "trace"))
    names = [line.split()[-1] for line in rest.splitlines()[1:]]
    order = sorted(range(len(names)), key=lambda i: "xduyp".index(rest.splitlines()[1 + i].split()[2]))
    residual = np.array(["residual" in names[i] for i in order])
    assert apart(found["values"], expected["values"], residual) < 1e-12
    outputs = np.array([rest.splitlines()[1 + i].split()[2] == "y" for i in order])
    assert apart(found["slopes"], expected["slopes"], residual[outputs]) < 1e-11  # differences of like numbers
    assert apart(found["along"], expected["along"], np.zeros(0, dtype=int)) < 1e-11
    assert np.abs(found["values"][:, residual] - expected["values"][:, residual]).max() < 1e-8
