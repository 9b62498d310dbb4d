from __future__ import annotations

import json
import math

import numpy as np
import pytest
from gearheat.model.errors import DataError, SolveError
from gearheat.tools.console import as_json, cell, folder, guarded, table, writable, write


def test_json_holds_no_value_that_is_no_json():
    text = as_json({"a": np.array([1.0, math.nan]), "b": (np.float64(2.5), np.int64(3)), "c": {4: math.inf}, "d": None})
    assert json.loads(text) == {"a": [1.0, None], "b": [2.5, 3], "c": {"4": None}, "d": None}


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
    @guarded
    def command() -> None:
        raise raised

    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == code
    assert capsys.readouterr().err == said


def test_what_is_not_foreseen_is_not_hidden():
    @guarded
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
