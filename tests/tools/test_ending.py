"""The program ends soon after Ctrl-C whatever library runs, workers end with it, and nothing is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import nullcontext

import pytest
from gearheat.model import files
from gearheat.model.files import DAY, replacing
from gearheat.tools.show import ending

#: From Ctrl-C to the end [s].
LIMIT = 2.0
#: Work that keeps Ctrl-C from whom it is meant for, or does not look for it.
KEEPING = {
    "swallows it": """while True:
            try: print("on", flush=True); time.sleep(60)
            except KeyboardInterrupt: pass""",
    "runs in C": "print('on', flush=True); hashlib.pbkdf2_hmac('sha256', b'', b'', 10**9)",
    "waits for threads": "threading.Thread(target=time.sleep, args=(60,)).start(); print(flush=True); time.sleep(60)",
    "is idle": "print('on', flush=True); time.sleep(60)",
}
SCRIPT = """
import hashlib, threading, time
from gearheat.tools.show.ending import ending_well
from gearheat.model.files import replacing
from pathlib import Path
import tempfile
with ending_well():
    with replacing(Path("table.csv")), tempfile.TemporaryDirectory():
        {}
"""


@pytest.fixture
def started(tmp_path):
    """A process that can be interrupted, in an empty folder, with a temporary folder of its own."""
    found = []
    heard = signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs of a shell may be told to ignore it

    def start(*arguments, first=True):
        for name in ("work", "temporary"):
            (tmp_path / name).mkdir(exist_ok=True)
        environment = {**os.environ, "TMPDIR": str(tmp_path / "temporary")}
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        found.append(subprocess.Popen([sys.executable, *arguments], cwd=tmp_path / "work", env=environment, **pipes))
        if first:
            found[-1].stdout.readline()
        return found[-1]

    yield start
    signal.signal(signal.SIGINT, heard)
    for process in found:
        process.kill()
        process.communicate()


def interrupted(process):
    """Exit code and time to the end of a process that is told Ctrl-C."""
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    return process.wait(60), time.monotonic() - began


@pytest.mark.skipif(os.name == "nt", reason="processes are interrupted otherwise there")
@pytest.mark.parametrize("work", KEEPING)
def test_ctrl_c_ends_whatever_runs(started, tmp_path, work):
    code, seconds = interrupted(started("-c", SCRIPT.format(KEEPING[work])))
    assert (code, seconds < LIMIT) == (130, True)
    assert not list((tmp_path / "work").iterdir()) + list((tmp_path / "temporary").iterdir())


@pytest.mark.skipif(os.name == "nt", reason="processes are interrupted otherwise there")
@pytest.mark.parametrize("module", ["gearheat.tools.show.ending", "gearheat.tools.cli.app"])
def test_ctrl_c_while_the_program_loads(started, module):
    """Also where what imports makes another exception of it, as enumerations and named tuples do."""
    script = f"""if True:
        import os, signal, sys
        class Finder:
            def find_spec(self, name, *_):
                try:
                    if name == {module!r}:
                        os.kill(os.getpid(), signal.SIGINT)
                except KeyboardInterrupt:
                    raise RuntimeError("lost") from None
        sys.meta_path.insert(0, Finder())
        from gearheat.tools.cli.__main__ import main
        main()"""
    process = started("-c", script, first=False)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "interrupted\n")


@pytest.mark.skipif(os.name == "nt", reason="processes are interrupted otherwise there")
def test_ctrl_c_ends_an_integration(started, tmp_path):
    rows = "".join(f"{k},{100 + 50 * (k % 2)},1500,25\n" for k in range(200_000))
    head = "time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n"
    (tmp_path / "duty.csv").write_text(head + rows)
    process = started(
        "-m", "gearheat", "simulate", "planetary", "--duty", tmp_path / "duty.csv", "-o", "out.csv", first=False
    )
    time.sleep(6)
    code, seconds = interrupted(process)
    assert (code, seconds < LIMIT) == (130, True)
    assert not list((tmp_path / "work").iterdir())


@pytest.mark.skipif(not os.path.isdir("/proc"), reason="looks for processes there")
def test_workers_end_with_their_parent(started):
    script = (
        "import time\nfrom gearheat.tools.compare.campaign import crew\n"
        "if __name__ == '__main__':\n    with crew(1 + 1) as pool:\n"
        "        pool.submit(int).result()\n"
        "        print(*pool._processes, flush=True)\n"
        "        time.sleep(60)\n"
    )
    process = started("-c", script, first=False)
    workers = [int(word) for word in process.stdout.readline().split()]
    assert len(workers) == 2
    process.kill()
    until = time.monotonic() + 20
    while any(alive(worker) for worker in workers) and time.monotonic() < until:
        time.sleep(0.1)
    assert not any(alive(worker) for worker in workers)


def alive(process: int) -> bool:
    try:
        with open(f"/proc/{process}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def aged(path):
    os.utime(path, (time.time() - 2 * DAY,) * 2)
    return path


def test_what_killed_processes_have_left_is_collected(tmp_path, monkeypatch):
    (old := tmp_path / ".table.csv.abcd1234").write_text("half")
    (fresh := tmp_path / ".table.csv.abcd5678").write_text("half")
    (other := tmp_path / ".tables.csv.abcd1234").write_text("another")
    aged(old), aged(other)
    with replacing(tmp_path / "table.csv") as beside:
        beside.write_text("whole")
    assert {path.name for path in tmp_path.iterdir()} == {"table.csv", fresh.name, other.name}


def test_temporary_folders_of_killed_processes_are_collected(tmp_path, monkeypatch):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    names = {f"gearheat-{dead.pid}-old": False, f"gearheat-{os.getpid()}-mine": True, "gearheat-x": True, "a": True}
    for name in names:
        (tmp_path / name).mkdir()
        aged(tmp_path / name)
    (tmp_path / f"gearheat-{dead.pid}-new").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(ending, "_listening", nullcontext)
    with ending.ending_well():
        own = tempfile.gettempdir()
        assert own != str(tmp_path) and os.stat(own).st_mode & 0o77 == 0
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {name for name, stays in names.items() if stays} | {f"gearheat-{dead.pid}-new"}


def test_files_of_a_process_that_ends_at_once_are_removed(tmp_path):
    with replacing(tmp_path / "a") as beside:
        files.remove_unfinished()
        assert not beside.exists()
        beside.write_text("")
