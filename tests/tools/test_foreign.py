"""An FMU that another tool has made: it plays, or a message says why it cannot."""

from __future__ import annotations

import csv
import os
import stat
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from gearheat.fmu import apart, compiling, described
from gearheat.fmu.export import archive
from gearheat.fmu.play import Player
from gearheat.model.errors import FmuError

HERE = Path(__file__).parent / "foreign"
DUTY = "time [s],T_room [degC]\n0,20\n600,20\n"


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> bytes:
    made = tmp_path_factory.mktemp("foreign") / "tank"
    cache = compiling.cache_folder() / "zig"
    folders = {f"ZIG_{kind.upper()}_CACHE_DIR": str(cache / kind) for kind in ("global", "local")}
    target = ["-target", compiling.host_platform().targets[0]]
    command = [sys.executable, "-m", "ziglang", "cc", *target, "-O1", "-shared", "-fPIC", "-fvisibility=hidden"]
    subprocess.run([*command, "-o", made, HERE / "tank.c"], check=True, env={**os.environ, **folders})
    return made.read_bytes()


@pytest.fixture
def tank(library, tmp_path):
    """Writes the FMU, its description changed as a test wants it."""

    def write(*changes: tuple[str, str]) -> Path:
        text = (HERE / "tank.xml").read_text()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        platform = compiling.host_platform()
        path = tmp_path / "tank.fmu"
        content = {
            "modelDescription.xml": text.encode(),
            f"binaries/{fmpy.platform}/tank{platform.suffix}": library,
        }
        path.write_bytes(archive(content))
        return path

    return write


@pytest.fixture
def duty(tmp_path):
    (path := tmp_path / "duty.csv").write_text(DUTY)
    return path


def test_it_plays_with_differences_shown_without_the_offset(gearheat, tank, duty, tmp_path):
    out = tmp_path / "out.csv"
    answer = gearheat("play", tank(), "--trust", "--duty", duty, "-o", out, "--set", "k=0.6 1/min", "--json", "-")
    assert "running native code of Another tool" in answer.err
    assert answer.code == 0, answer.err
    with out.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time [s]", "T[1,2] [degC]", "T_room [degC]", "dT [K]"]
    assert [float(row["time [s]"]) for row in rows] == [60.0 * k for k in range(11)]
    left = 0.99**600 * (350 - 293.15)
    assert float(rows[-1]["T[1,2] [degC]"]) == pytest.approx(20 + left, rel=1e-8)
    assert float(rows[-1]["dT [K]"]) == pytest.approx(left, rel=1e-8)
    assert answer.json["units"]["dT"] == "K"


def test_it_is_run_again_although_it_cannot_be_reset(tank):
    with Player(tank()) as player:
        first, second = (player.run({}, 60, 60.0)["dT"].tolist() for _ in range(2))
    assert first == second
    assert first[1] < first[0]


def test_its_own_message_is_passed_on(gearheat, tank, duty, tmp_path):
    hot = ("--set", "T[1,2]=900 degC")
    answer = gearheat("play", tank(), "--trust", "--duty", duty, "-o", tmp_path / "out.csv", *hot)
    assert answer.code == 2
    assert "error: tank.fmu: the tank boils\n" in answer.err


def test_steps_of_one_length(tank):
    with Player(tank()) as player, pytest.raises(FmuError, match="to 100 s is not 60 s long"):
        player.run({}, 100, 60.0)


def test_a_fmu_that_takes_any_step(tank):
    with Player(tank(('"false"/>', '"true"/>'))) as player:
        assert player.run({}, 100, 60.0).time.tolist() == [0, 60, 100]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"inputs": {"lid_open": ([0, 1], [0, 1])}}, '"lid_open" is of type Boolean'),
        ({"start": {"label": 1.0}}, '"label" is of type String'),
        ({"start": {"dT": 1.0}}, '"dT" is calculated'),
        ({"record": ["steps"]}, '"steps" is of type Integer'),
    ],
)
def test_only_real_numbers_are_given_and_recorded(tank, arguments, told):
    with Player(tank()) as player, pytest.raises(FmuError, match=told):
        player.run(**{"inputs": {}, **arguments}, stop=60, step=60.0)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (('fmiVersion="2.0"', 'fmiVersion="1.0"'), "this FMU is for FMI 1.0"),
        (('fmiVersion="2.0"', 'fmiVersion="4.0"'), "this FMU is for FMI 4.0"),
        (('tank" canHandleVariableCommunicationStepSize="false"', 'tank" needsExecutionTool="true"'), "Another tool"),
        (
            ("<CoSimulation", '<ModelExchange modelIdentifier="tank"/><!--'),
            "has no co-simulation",
        ),
    ],
)
def test_what_cannot_be_played_is_said(gearheat, tank, duty, tmp_path, change, told):
    changes = [change] if "ModelExchange" not in change[1] else [change, ('"false"/>', '"false"/>-->')]
    answer = gearheat("play", tank(*changes), "--duty", duty, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert told in answer.err
    assert "Traceback" not in answer.err


def test_its_code_runs_only_if_it_is_trusted(gearheat, tank, duty, tmp_path):
    answer = gearheat("play", tank(), "--duty", duty, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert "was not made by gearheat on this machine (but by Another tool)" in answer.err
    assert "Add --trust" in answer.err
    assert not (tmp_path / "out.csv").exists()


def _linked(file):
    entry = zipfile.ZipInfo("resources/link")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    file.writestr(entry, "/etc/hosts")


@pytest.mark.parametrize(
    ("add", "told"),
    [
        (lambda file: file.writestr("../beside.txt", "x"), 'holds "../beside.txt", which lies outside'),
        (lambda file: file.writestr("/beside.txt", "x"), 'holds "/beside.txt", which lies outside'),
        (lambda file: file.writestr("C:\\beside.txt", "x"), "lies outside"),
        (_linked, "is a link"),
        (lambda file: [file.writestr(f"resources/{k}", "") for k in range(10_001)], "At most 10000 are taken"),
        (lambda file: file.writestr("resources/zero", bytes(5 << 20)), "unpacks to 5 MiB. At most 4 MiB are taken"),
    ],
)
def test_archives_that_are_no_fmu_of_an_honest_tool(gearheat, tank, duty, tmp_path, monkeypatch, add, told):
    monkeypatch.setattr(described, "MOST_BYTES", 4 << 20)
    path = tank()
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        add(file)
    answer = gearheat("play", path, "--trust", "--duty", duty, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert told in answer.err


def test_a_binary_for_another_machine(gearheat, tank, duty, tmp_path):
    path = tank()
    path.write_bytes(
        archive({"modelDescription.xml": (HERE / "tank.xml").read_bytes(), "binaries/win32/tank.dll": b""})
    )
    answer = gearheat("play", path, "--duty", duty, "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert "binaries for win32" in answer.err
    assert "Ask its maker" in answer.err


@pytest.mark.parametrize(
    ("k", "words"),
    [
        (96, "tank.fmu: its code has crashed (signal"),
        (97, "tank.fmu: has not made a step in 6 s: its code hangs"),
        (98, "tank.fmu: its code has crashed (signal"),
        (99, "tank.fmu: its code has ended the program (exit code 0)"),
    ],
)
def test_code_that_ends_crashes_or_hangs_takes_nothing_with_it(gearheat, tank, duty, tmp_path, monkeypatch, k, words):
    if k == 97:
        monkeypatch.setattr(apart, "PATIENCE", 6.0)
    answer = gearheat("play", tank(), "--trust", "--duty", duty, "-o", tmp_path / "out.csv", "--set", f"k={k} 1/s")
    assert answer.code == 2
    assert words in answer.err
    assert not (tmp_path / "out.csv").exists()


def test_a_binary_of_the_cache_is_used_only_as_it_was_written(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(compiling, "_compile", lambda files, target, way: b"made")
    compiling.binary("int x;", compiling.host_platform())
    (kept,) = (tmp_path / "cache" / "gearheat" / "binaries").iterdir()
    monkeypatch.setattr(compiling, "_compile", lambda files, target, way: b"anew")
    asked = ("int x;", compiling.host_platform())
    assert compiling.binary(*asked) == b"made"
    content = kept.read_bytes()
    kept.write_bytes(content[:-1] + b"X")
    assert compiling.binary(*asked) == b"anew"
    if os.name != "nt":
        assert [folder.stat().st_mode & 0o77 for folder in (kept.parent, kept.parents[1])] == [0, 0]
        kept.parent.chmod(0o777)
        monkeypatch.setattr(compiling, "_compile", lambda files, target, way: b"third")
        assert compiling.binary(*asked) == b"third"


def test_a_user_without_a_home(monkeypatch):
    def nobody():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(compiling.Path, "home", nobody)
    assert compiling.cache_folder().name == "gearheat"
