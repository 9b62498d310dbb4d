"""Small files that would never end, or end the program: refused at once, or read as they are meant."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest
from gearheat.scenarios.shipped import RIGS

WHOLE = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
HEAD = 'kind = "network"\ndoc = "x"\n[drive]\n[operating_point]\nsource = "assumed: x"\n'
FOOT = 'G = "3 W/K"'
#: Longest time to an answer [s] of processor time.
LIMIT = 10.0


def doubling(levels: int) -> str:
    """Assemblies that hold two of the next."""
    part = '[assembly.a{0}.part.{2}]\nuse = "a{1}"\n'
    chain = "".join(part.format(k, k + 1, name) for k in range(levels) for name in "xy")
    return f'{HEAD}[part.a]\nuse = "a0"\n{chain}[assembly.a{levels}.part.x]\ntype = "Room"\n'


#: Rig files -> words of the answer.
FILES = {
    "two of the next": (doubling(40), "more than 10000 parts"),
    "forty braces": (f'{HEAD}[part."x{"_{a,b}" * 40}"]\ntype = "Room"\n', "more than 10000 names"),
    "a range": (f'{HEAD}[part."b{{1..9999999999}}"]\ntype = "Room"\n', "more than 10000 names"),
    "a range of long numbers": (f'{HEAD}[part."b{{1..{"9" * 5000}}}"]\ntype = "Room"\n', "more than 10000 names"),
    "a net": (WHOLE.replace("[connect]", f'[connect]\n"x{"_{a,b}" * 40}" = ["oil.heat"]'), "more than 10000 names"),
    "ports": (WHOLE.replace("[connect]", f'[connect]\nx = ["oil{"_{a,b}" * 40}"]'), "more than 10000 names"),
    "an integer of 5000 digits": (f"x = {'9' * 5000}\n{WHOLE}", "too many digits"),
    "lists in lists": (f"x = {'[' * 990}{']' * 990}\n{WHOLE}", "too deep in each other"),
    "a tower in a number": (WHOLE.replace(FOOT, 'G = "9**9**9**9 W/K"', 1), "does not fit W/K"),
    "a tower in a unit": (WHOLE.replace(FOOT, 'G = "3 W**9**9**9**9"', 1), "does not fit W/K"),
    "a tower in brackets": (WHOLE.replace(FOOT, 'G = "3 (9**9**9**9) W/K"', 1), "does not fit W/K"),
    "a tower of carets": (WHOLE.replace(FOOT, 'G = "3 W^9^9^9^9"', 1), "does not fit W/K"),
    "a large exponent": (WHOLE.replace(FOOT, 'G = "3 (10 W)**999999999"', 1), "does not fit W/K"),
    "brackets in brackets": (WHOLE.replace(FOOT, f'G = "3 {"(" * 5000}W"', 1), "does not fit W/K"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_file_that_would_never_end(gearheat, tmp_path, kind):
    text, words = FILES[kind]
    assert text != WHOLE
    (tmp_path / "rig.toml").write_text(text)
    began = time.process_time()
    answer = gearheat("steady", tmp_path / "rig.toml")
    assert answer.code == 2
    assert words in answer.err
    assert time.process_time() - began < LIMIT


@pytest.mark.parametrize(
    ("times", "rows"), [(("0", "60", "60.00000000000001", "90"), 4), (("0", "59.9999999999", "60", "90"), 4)]
)
def test_a_jump_that_is_written_with_rounding(tmp_path, times, rows):
    from gearheat.scenarios.duty import read_duty
    from gearheat.scenarios.load import load

    speeds = ("100", "100", "200", "200")
    (tmp_path / "duty.csv").write_text(
        "time [min],carrier.w [rpm]\n" + "".join(f"{t},{w}\n" for t, w in zip(times, speeds, strict=True))
    )
    schedule = read_duty(tmp_path / "duty.csv", load("planetary").inputs())
    assert len(schedule.time) == rows
    assert schedule.time[1] == schedule.time[2]


@pytest.mark.parametrize("end", ["1e-15", "1e-300", "1e-9"])
def test_a_duty_that_lasts_next_to_no_time(gearheat, tmp_path, end):
    (tmp_path / "duty.csv").write_text(f"time [min],carrier.w [rpm]\n0,100\n{end},100\n")
    answer = gearheat("simulate", "planetary", "--duty", tmp_path / "duty.csv", "-o", tmp_path / "out.csv")
    assert answer.code == 2 and "lasts no time" in answer.err


@pytest.mark.parametrize("name", [r"$\frac{$.toml", "$x$ $.toml", "mü.toml", "100 % _^.toml"])
def test_a_picture_of_a_rig_with_any_name(gearheat, tmp_path, name):
    (tmp_path / name).write_text(WHOLE, encoding="utf-8")
    answer = gearheat("steady", tmp_path / name, "--plot", tmp_path / "out.svg")
    assert answer.code == 0, answer.err


def test_want_of_memory_is_said(capsys):
    from gearheat.tools.show.console import guard

    @guard
    def command():
        raise MemoryError

    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == 2 and "not enough memory" in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="streams are closed otherwise there")
@pytest.mark.parametrize("stream", [1, 2])
def test_a_closed_stream(stream):
    command = [sys.executable, "-m", "gearheat", "list"]
    done = subprocess.run(command, check=False, preexec_fn=lambda: os.close(stream), capture_output=True, text=True)
    assert done.returncode == 0 and "Traceback" not in done.stderr


def test_a_screen_of_ascii(tmp_path):
    (tmp_path / "mü.toml").write_text("x = 1", encoding="utf-8")
    ascii_only = {
        **os.environ,
        "PYTHONIOENCODING": "ascii",
        "LC_ALL": "C",
        "PYTHONUTF8": "0",
        "PYTHONCOERCECLOCALE": "0",
    }
    command = [sys.executable, "-m", "gearheat", "steady", str(tmp_path / "mü.toml")]
    done = subprocess.run(command, check=False, env=ascii_only, capture_output=True)
    assert done.returncode == 2 and b"Traceback" not in done.stderr and b"toml" in done.stderr
