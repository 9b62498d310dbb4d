from __future__ import annotations

import errno
import json
import math
import os
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import numpy as np
import pytest
from gearheat.model.errors import DataError, SolveError
from gearheat.model.files import reading
from gearheat.tools.cli import __main__ as entry, app as cli
from gearheat.tools.show import console
from gearheat.tools.show.console import EVERY, as_json, cell, counting, folder, guard, table, writable, write


def test_json_holds_no_value_that_is_no_json():
    text = as_json({"a": np.array([1.0, math.nan]), "b": (np.float64(2.5), np.int64(3)), "c": {4: math.inf}, "d": None})
    assert json.loads(text) == {"a": [1.0, None], "b": [2.5, 3], "c": {"4": None}, "d": None}


def test_progress_without_a_terminal_is_a_line_now_and_then(capsys, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(console, "time", SimpleNamespace(monotonic=lambda: now[0]))
    with counting("rows", 20, done=2) as advance:
        for _ in range(9):
            now[0] += EVERY / 3
            advance(2)
    told = capsys.readouterr()
    assert told.err.splitlines() == ["8 of 20 rows (40%)", "14 of 20 rows (70%)", "20 of 20 rows (100%)"]
    assert told.out == ""


def test_a_file_is_there_whole_or_not_at_all(tmp_path):
    path = tmp_path / "a.txt"
    write(path, "before")
    with pytest.raises(UnicodeEncodeError):
        write(path, "\ud800")
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_places_that_cannot_be_written_are_told_together(tmp_path):
    with pytest.raises(DataError) as error:
        writable(tmp_path / "no" / "a", None, tmp_path, tmp_path / "fine")
    assert len(error.value.problems) == 2


def test_a_folder_is_made_with_its_parents(tmp_path):
    assert folder(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").touch()
    with pytest.raises(DataError, match="cannot be written"):
        folder(tmp_path / "file" / "b")


@pytest.mark.parametrize(
    ("raised", "code", "said"),
    [(SolveError(["one", "two"]), 2, "error: one\nerror: two\n"), (KeyboardInterrupt(), 130, "interrupted\n")],
)
def test_problems_become_exit_codes(capsys, raised, code, said):
    @guard
    def command() -> None:
        raise raised

    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == code
    assert capsys.readouterr().err == said


def test_what_is_not_foreseen_is_not_hidden():
    @guard
    def command() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        command()


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, ""), (math.nan, ""), (1.23456, "1.235"), (123456.7, "123457"), (1e-6, "1e-06"), (3, "3"), ("a", "a")],
)
def test_cells(value, text):
    assert cell(value) == text


def test_numbers_stand_right_and_words_left(capsys):
    table("T", ("name", "value", "unit"), [["a", 1.0, "K"], ["long name", 22.5, "N.m"], ["b", None, "W"]])
    lines = [line for line in capsys.readouterr().out.splitlines() if "N.m" in line or " K" in line]
    short, long = lines
    assert short.index("a") == long.index("long")
    assert short.index("1") + 1 == long.index("22.5") + 4
    assert short.index("K") == long.index("N.m")


def test_what_a_command_reads_is_not_written_over(tmp_path, capsys):
    source, link, other = (tmp_path / name for name in ("in.csv", "link.csv", "out.csv"))
    source.write_text("before")
    link.symlink_to(source)

    @guard
    def command(out: Path) -> None:
        reading(source)
        writable(out)
        write(out, "after")

    for out in (source, link, tmp_path / "." / "in.csv"):
        with pytest.raises(SystemExit) as ended:
            command(out)
        assert ended.value.code == 2
        assert "it is read by this command" in capsys.readouterr().err
    command(other)
    assert (source.read_text(), other.read_text()) == ("before", "after")
    write(source, "later")  # no command that reads it

    @guard
    def again() -> None:
        write(other, "made")
        reading(other)
        write(other, "made anew")

    again()
    assert other.read_text() == "made anew"
    assert source.read_text() == "later"


def test_output_follows_links(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("before")
    link.symlink_to(target)
    write(link, "after")
    assert link.is_symlink() and target.read_text() == "after"


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices of Unix")
def test_pipes_and_devices_are_written_through(tmp_path):
    pipe, got = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: got.append(pipe.read_text()))
    reader.start()
    writable(pipe, Path("/dev/null"))
    write(pipe, "through")
    reader.join(10)
    assert got == ["through"] and pipe.is_fifo()
    write(Path("/dev/null"), "gone")
    assert Path("/dev/null").is_char_device()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
@pytest.mark.skipif(sys.platform == "win32", reason="streams of Unix")
@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1"])
def test_the_streams_of_the_process_are_written_through(tmp_path, name):
    program = (
        "from pathlib import Path; from gearheat.tools.show.console import writable, write\n"
        f"out = Path({name!r}); print('one'); writable(out); write(out, 'two\\n'); print('three')"
    )
    command = [sys.executable, "-c", program]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == "one\ntwo\nthree\n"
    (log := tmp_path / "log").write_text("zero\n")
    with log.open("a") as end:  # as >> of a shell
        subprocess.run(command, stdout=end, check=True)
    assert log.read_text() == "zero\none\ntwo\nthree\n"
    assert list(tmp_path.iterdir()) == [log]


@pytest.mark.skipif(sys.platform == "win32", reason="streams of Unix")
@pytest.mark.parametrize(
    "command", [("sweep", "--vary", "room.T=10..20 degC", "--sample", 2), ("map", "--grid", "2x2")]
)
def test_a_table_goes_to_the_standard_output(command):
    words = [command[0], "helical_two_stage", *map(str, command[1:]), "-o", "/dev/stdout", "--json", "/dev/null"]
    program = [sys.executable, "-c", "from gearheat.tools.cli.__main__ import main; main()", *words]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    assert "room.T [degC],oil.T [degC]" in done.stdout or "input.w [rpm],output.tau [N.m]" in done.stdout
    assert not Path("/dev/stdout.part").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["list"], "standard output or a temporary file: No space left on device. Make room, or set TMPDIR."),
        (["steady", "--help"], "standard output: No space left on device. Make room."),
        (["--version"], "standard output: No space left on device. Make room."),
    ],
)
def test_a_full_device_is_a_message(arguments, said):
    command = [sys.executable, "-c", "from gearheat.tools.cli.__main__ import main; main()", *arguments]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == f"error: {said}\n"


def test_a_full_disk_is_a_message(capsys):
    @guard
    def command() -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/tmp/gearheat-x")

    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith("error: /tmp/gearheat-x: No space left")


def test_ctrl_c_while_the_program_loads(monkeypatch, capsys):
    def program():
        raise KeyboardInterrupt

    monkeypatch.setitem(sys.modules, "gearheat.tools.cli.app", SimpleNamespace(program=program))
    with pytest.raises(SystemExit) as ended:
        entry.main()
    assert ended.value.code == 130
    assert capsys.readouterr().err == "interrupted\n"


@pytest.mark.parametrize(("name", "read"), [("steady", 1), ("docs", 3)])
def test_a_named_command_stands_alone_unless_it_runs_others(monkeypatch, name: str, read: int):
    asked = mock.Mock(registered_commands=[SimpleNamespace(name=each) for each in ("steady", "docs", "list")])
    monkeypatch.setattr(cli, "app", asked)
    monkeypatch.setattr(sys, "argv", ["gearheat", name])
    cli.program()
    asked.assert_called_once()
    assert len(asked.registered_commands) == read


def test_a_narrow_screen_never_breaks_a_number(capsys):
    columns = ("name", "value", "unit", "doc", "source")
    rows = [
        ("cooling.share_top", -123456.789, "W", "a long meaning " * 6, "a source " * 9),
        ("x", 1.5e-7, "", "b", "c"),
    ]
    for width in (80, 60, 40, 32):
        table("Narrow", columns, rows, width=width)
        printed = capsys.readouterr().out
        for whole in ("cooling.share_top", cell(-123456.789), cell(1.5e-7)):
            assert whole in printed, width
        assert max(map(len, printed.split("left out")[0].splitlines())) <= width
        assert ("left out for want of room" in printed) == (width < 80), width
    table("Wide", columns, rows, width=160)
    assert "left out" not in capsys.readouterr().out
