"""The file: what is in it, that it is built by fixed means, and that failures are told."""

import ctypes
import os
import re
import resource
import struct
import subprocess
import sys
import threading
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu import compiling
from gearheat.fmu.export import archive, export
from gearheat.fmu.play import Player, play
from gearheat.model.core.flat import FlatModel, Quantity
from gearheat.model.errors import FmuError
from pages import problems_of

linux = pytest.mark.skipif(sys.platform != "linux", reason="reads a binary of Linux")


def content(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


def binary_of(path: Path) -> tuple[str, bytes]:
    ((name, data),) = [(n, d) for n, d in content(path).items() if n.startswith("binaries/")]
    return name, data


def test_what_an_fmu_holds(heat_fmu: Path) -> None:
    held = content(heat_fmu)
    assert next(iter(held)) == "modelDescription.xml"
    assert {"model.png", "documentation/index.html", "sources/all.c"} < set(held)
    assert held["model.png"].startswith(b"\x89PNG")
    page = held["documentation/index.html"].decode()
    assert problems_of(page) == []
    for text in ("governor.w", "1432.39 rpm", "20 degC", "above 0", "viscous_torque", "Nobody2000", "energy.supplied"):
        assert text in page, text


def exported_symbols(library: bytes) -> set[str]:
    """Names a 64-bit ELF library defines for others."""
    table, count = struct.unpack_from("<Q", library, 0x28)[0], struct.unpack_from("<H", library, 0x3C)[0]
    sections = [struct.unpack_from("<IIQQQQIIQQ", library, table + 64 * i) for i in range(count)]
    (symbols,) = [s for s in sections if s[1] == 11]
    names = sections[symbols[6]][4]
    found = set()
    for at in range(symbols[4], symbols[4] + symbols[5], 24):
        name, info, _, section = struct.unpack_from("<IBBH", library, at)
        if section and info >> 4:
            found.add(library[names + name : library.index(b"\0", names + name)].decode())
    return found


@linux
def test_only_the_functions_of_the_standard_are_exported(rc_fmu: Path) -> None:
    symbols = exported_symbols(binary_of(rc_fmu)[1])
    assert len(symbols) == 44
    assert all(name.startswith("fmi2") for name in symbols)


@linux
def test_the_binary_needs_an_old_c_library_and_nothing_else(heat_fmu: Path) -> None:
    library = binary_of(heat_fmu)[1]
    versions = {tuple(map(int, v.split(b"."))) for v in re.findall(rb"GLIBC_([\d.]+)", library)}
    assert versions
    assert max(versions) <= (2, 17)


def zig(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """The compiler with the headers it brings: for a target of its own, not for what the machine has."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", compiling.host_platform().targets[0], *arguments]
    cache = compiling.cache_folder() / "zig"
    folders = {f"ZIG_{kind.upper()}_CACHE_DIR": str(cache / kind) for kind in ("global", "local")}
    return subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, **folders}, **options
    )


def test_the_source_compiles_without_a_warning(heat_fmu: Path, rc_fmu: Path, tmp_path: Path) -> None:
    for number, path in enumerate((heat_fmu, rc_fmu)):
        source = tmp_path / f"all{number}.c"
        source.write_bytes(content(path)["sources/all.c"])
        flags = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "-O0")
        assert zig(*flags, "-o", str(tmp_path / "all.o"), str(source)).stderr == ""


def test_the_source_gives_the_binary_again_optimised_or_not(
    models: SimpleNamespace, heat_fmu: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both give the same digits."""
    cache = compiling.cache_folder() / "zig"
    for kind in ("global", "local"):
        monkeypatch.setenv(f"ZIG_{kind.upper()}_CACHE_DIR", str(cache / kind))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    source = content(heat_fmu)["sources/all.c"].decode()
    host, quick = compiling.host_platform(), binary_of(heat_fmu)[1]
    assert compiling.binary(source, host, ways=(compiling.QUICK,)) == quick
    assert len(list((tmp_path / "gearheat" / "binaries").iterdir())) == 1
    monkeypatch.delenv("GEARHEAT_COMPILE")
    optimised = export(models.heat, tmp_path / "heat.fmu")
    assert compiling.binary(source, host) == binary_of(optimised)[1] != quick
    runs = [play(fmu, {}, 7200, 60) for fmu in (heat_fmu, optimised)]
    assert all(runs[0][name].tobytes() == runs[1][name].tobytes() for name in ("oil.T", "gears.P_loss"))


@linux
def test_no_undefined_behaviour(heat_fmu: Path, tmp_path: Path) -> None:
    """The compiler's sanitizer ends the program at the first undefined operation."""
    held, (name, _) = content(heat_fmu), binary_of(heat_fmu)
    (tmp_path / "all.c").write_bytes(held["sources/all.c"])
    made = zig("-shared", "-fPIC", "-O1", "-fsanitize=undefined", "-o", "a.so", "all.c", "-lm", cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    checked = tmp_path / "checked.fmu"
    checked.write_bytes(archive({**held, name: (tmp_path / "a.so").read_bytes()}))
    script = f"""
import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from fmpy.fmi2 import FMU2Model
from conftest import Opened
import test_derivatives, test_states
one = Opened(Path({str(checked)!r}), Path({str(tmp_path / "one")!r}), logging=True).start()
state = one.fmu.getFMUState()
test_states.go_on(one, 0)
saved = one.fmu.serializeFMUState(state)
one.fmu.setFMUState(one.fmu.deserializeFMUState(saved))
test_states.go_on(one, 0)
one.fmu.getDirectionalDerivative([one.refs["gears.P_loss"]], [one.refs["oil.b_0"]], [1.0])
one.fmu.getRealOutputDerivatives([one.refs["gears.P_loss"]], [1])
one.fmu.terminate(); one.fmu.reset(); one.fmu.freeInstance()
other = Opened(Path({str(checked)!r}), Path({str(tmp_path / "two")!r}), FMU2Model).start()
other.fmu.newDiscreteStates(); other.fmu.enterContinuousTimeMode(); other.everything(); other.fmu.freeInstance()
print("done")
"""
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert said.stdout.strip() == "done", said.stderr


@linux
def test_ten_thousand_instances_leave_nothing_behind(opened: Callable[..., Any], heat_fmu: Path) -> None:
    one = opened(heat_fmu)
    dll, guid = one.fmu.dll, one.description.guid.encode()
    dll.fmi2Instantiate.restype = ctypes.c_void_p

    def cycle(count: int) -> None:
        for _ in range(count):
            component = dll.fmi2Instantiate(b"x", 1, guid, b"", ctypes.byref(one.callbacks), 0, 0)
            dll.fmi2FreeInstance(component)

    cycle(1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    cycle(10_000)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1024  # kB; an instance has 3 kB


def test_a_model_without_inputs_parameters_and_outputs(tmp_path: Path) -> None:
    x, none = ca.SX.sym("x"), ca.SX.sym("none", 0)
    empty = ca.SX(0, 1)
    flat = FlatModel(
        name="decay",
        doc="",
        states=(Quantity("x", "J", "energy", start=2.0),),
        inputs=(),
        parameters=(),
        outputs=(),
        x=x,
        u=none,
        p=none,
        ode=-x / 5,
        y=empty,
        residual=empty,
        residual_names=(),
        supply=-x / 5,
        throughput=ca.fabs(x) / 5,
        stored=x,
        checks=(),
        checked=empty,
        laws=(),
    )
    played = play(export(flat, tmp_path / "decay.fmu"), {}, 10, 1, tolerance=1e-9)
    assert played["x"] == pytest.approx(2 * np.exp(-played.time / 5), abs=1e-7)


def test_a_folder_with_spaces_and_umlauts(models: SimpleNamespace, tmp_path: Path) -> None:
    path = export(models.rc, tmp_path / "Öl und Wärme" / "rc 1.fmu")
    assert len(play(path, {}, 1, 1).time) == 2


def test_a_place_that_cannot_be_written(models: SimpleNamespace, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(FmuError, match="cannot be written"):
        export(models.rc, tmp_path / "file" / "rc.fmu")
    with pytest.raises(FmuError, match="cannot be written"):
        export(models.rc, tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file"]


def test_a_source_that_does_not_compile() -> None:
    with pytest.raises(FmuError, match=r"compiling for .* failed: .*error"):
        compiling.binary("int wrong = ;", compiling.host_platform())


def test_platforms_are_made_side_by_side_and_a_failure_is_told() -> None:
    both, met = compiling.platforms("linux64,win64"), threading.Barrier(2, timeout=30)

    def build(platform: compiling.Platform) -> bytes:
        met.wait()  # none ends before the other has begun
        return platform.name.encode()

    told: list[tuple[str, float]] = []
    made = compiling.compile_all(build, both, lambda done, share: told.append((done, share)))
    assert made == {"linux64": b"linux64", "win64": b"win64"}
    assert [share for _, share in told] == [0.5, 1.0]
    with pytest.raises(FmuError, match="compiling for x86_64-linux"):
        compiling.compile_all(lambda p: compiling.binary("int wrong = ;", p), both[:1], lambda done, share: None)


def test_platforms_by_name() -> None:
    assert [p.name for p in compiling.platforms("win64, linux64,win64")] == ["win64", "linux64"]
    assert [p.name for p in compiling.platforms("all")] == ["linux64", "win64", "win32", "darwin64", "aarch64-linux"]
    with pytest.raises(FmuError, match="Did you mean"):
        compiling.platforms("linux46")


def test_an_fmu_for_another_machine_is_refused(rc_fmu: Path, tmp_path: Path) -> None:
    held, (name, data) = content(rc_fmu), binary_of(rc_fmu)
    del held[name]
    other = tmp_path / "other.fmu"
    other.write_bytes(archive({**held, "binaries/win32/rc.dll": data}))
    with pytest.raises(FmuError, match="binaries for win32, none for this machine"):
        Player(other)


def test_libraries_of_two_processors_are_joined() -> None:
    def thin(processor: int, length: int) -> bytes:
        return struct.pack("<III", 0xFEEDFACF, processor, 3) + bytes(length)

    parts = [thin(0x01000007, 20000), thin(0x0100000C, 500)]
    joined = compiling._join(parts)
    magic, count = struct.unpack_from(">II", joined)
    assert (magic, count) == (0xCAFEBABE, 2)
    for i, part in enumerate(parts):
        processor, _, offset, size, alignment = struct.unpack_from(">IIIII", joined, 8 + 20 * i)
        assert processor == struct.unpack_from("<I", part, 4)[0]
        assert offset % 2**alignment == 0
        assert joined[offset : offset + size] == part
