"""Kills and interrupts at any moment of every long command: `python tests/kills.py 60` tries so many, and tells.

A command that is killed or interrupted leaves no process and no file that is half written. Repeated in its folder it
ends with the bytes of a run that nobody disturbed, and has collected what was left. Moments are drawn by processor
time, so that other work on the machine does not move them. On Linux only: processes are looked for in /proc.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from film_tables import CASE
from gearheat.model.files import DAY

#: From Ctrl-C to the end at most, on a machine with other work [s]; 2 s on a quiet one.
LIMIT = 10.0
#: How long a process may outlive the one that has started it [s].
OUTLIVES = 20.0
_TICK = os.sysconf("SC_CLK_TCK")
_DUTY = "".join(f"{k},{100 + 50 * (k % 2)},1500,25\n" for k in range(1500))
_LOG = "".join(f"{600 * k},{1000 + 400 * (k % 9 > 4)},{3000 + 50 * (k % 7)},{55 + k % 5},20\n" for k in range(300))
#: Files that commands read.
FILES = {
    "duty.csv": f"time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n{_DUTY}",
    "log.csv": f"time_s,n_hss_rpm,T_hss_Nm,T_sump_C,T_nacelle_C\n{_LOG}",
    "case.toml": CASE,
}
#: What is disturbed; {files} is the folder of those.
COMMANDS = {
    "simulate": "simulate planetary --duty {files}/duty.csv -o out.csv",
    "sweep": "sweep planetary --vary carrier.tau=500§N.m..2700§N.m --sample 40000 -o out.csv",
    "map": "map planetary --grid 6x6 -o out.csv --plot out.svg",
    "run": "run planetary --out out --tests 1-4 --jobs 2",
    "export": "export planetary -o out.fmu --platform host --extras beside",
    "play": "play {files}/planetary.fmu --duty {files}/duty.csv -o out.csv",
    "page": "page planetary -o out.html",
    "calibrate": "calibrate planetary --grid MINR-5 --free cooling.A --free foot.G --json out.json",
    "verify": "verify helical_two_stage --html out.html --json out.json",
    "diagnose": "diagnose {rigs}/planetary/measured.csv --rig planetary --quick --json out.json",
    "replay": "replay wind_turbine --fit {files}/log.csv -o out.svg",
    "film": "film {files}/case.toml --grid 2x2x2 --nodes 61 -o out.csv",
}


#: Files that hold what is done so far, for the next run to go on.
GROWING = {"film": "out.csv.part", "sweep": "out.csv.part"}


@dataclass(frozen=True)
class Undisturbed:
    """What a run leaves that nobody disturbs, and the processor time it takes [s]."""

    files: Mapping[str, bytes]
    cost: float


def words_of(command: str, files: Path) -> list[str]:
    """The words of a command line."""
    text = COMMANDS[command].format(files=files, rigs=Path(__file__).parents[1] / "scenarios" / "rigs")
    return [sys.executable, "-m", "gearheat", *(word.replace("§", " ") for word in text.split())]


def start(words: Sequence[str], place: Path) -> subprocess.Popen[bytes]:
    """A command in a session of its own, with a folder for its work and one for temporary files."""
    for name in ("work", "temporary"):
        (place / name).mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "TMPDIR": str(place / "temporary")}
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
    return subprocess.Popen(words, cwd=place / "work", env=environment, **quiet)


def session(leader: int) -> dict[int, float]:
    """Processor time [s] of each living process of a session."""
    found = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, *rest = path.read_text().rpartition(")")[2].split()
            if int(rest[2]) == leader and state != "Z":
                found[int(path.parent.name)] = (int(rest[10]) + int(rest[11])) / _TICK
    return found


def contents(folder: Path) -> dict[str, bytes]:
    """All files in a folder, hidden ones included."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def undisturbed(command: str, files: Path, place: Path) -> Undisturbed:
    """Run a command to its end."""
    process, cost = start(words_of(command, files), place), 0.0
    while process.poll() is None:
        cost = max(cost, sum(session(process.pid).values()))
        time.sleep(0.05)
    if process.returncode != 0:
        raise SystemExit(f"{command}: exit code {process.returncode} without a disturbance")
    return Undisturbed(contents(place / "work"), cost)


def disturb(
    command: str, files: Path, place: Path, known: Undisturbed, share: float, how: int
) -> tuple[list[str], float]:
    """Disturb a command once, then repeat it: what is wrong, and how long it lived on [s]; NAN where it was faster.

    Args:
        command: key of `COMMANDS`
        files: folder of the files it reads
        place: folder of the run
        known: of an undisturbed run
        share: of the processor time at which it is disturbed
        how: signal
    """
    process = start(words_of(command, files), place)
    while process.poll() is None and sum(session(process.pid).values()) < share * known.cost:
        time.sleep(0.02)
    faster, began = process.poll() is not None, time.monotonic()
    if not faster:
        (os.killpg if how == signal.SIGINT else os.kill)(process.pid, how)
    code, lived = process.wait(120), time.monotonic() - began
    wrong = [] if faster or code in (130, -how, 0) else [f"exit code {code}"]
    if how == signal.SIGINT and lived > LIMIT:
        wrong.append(f"ends {lived:.1f} s after Ctrl-C")
    while left := session(process.pid):
        if time.monotonic() - began > OUTLIVES:
            wrong.append(f"{len(left)} processes live on")
            os.killpg(process.pid, signal.SIGKILL)
            break
        time.sleep(0.1)
    wrong += _look(command, place, known, told_to_end=how == signal.SIGINT or faster)
    old = time.time() - 2 * DAY
    for path in [*(place / "temporary").rglob("*"), *(place / "work").rglob(".*")]:
        os.utime(path, (old, old))
    if (code := start(words_of(command, files), place).wait(1200)) != 0:
        wrong.append(f"exit code {code} when repeated")
    after = contents(place / "work")
    wrong += [f"{name} differs when repeated" for name, content in known.files.items() if after.get(name) != content]
    wrong += [f"{name} is left when repeated" for name in after.keys() - known.files.keys()]
    wrong += [f"temporary {name} is left when repeated" for name in contents(place / "temporary")]
    return wrong, float("nan") if faster else lived


def _look(command: str, place: Path, known: Undisturbed, *, told_to_end: bool) -> list[str]:
    """What must not lie there right behind the end: halves of files, and where it could clear up hidden ones."""
    found = contents(place / "work")
    shown = {name: content for name, content in found.items() if not any(p.startswith(".") for p in Path(name).parts)}
    halves = [n for n, content in shown.items() if n != GROWING.get(command) and known.files.get(n) != content]
    wrong = [f"{name} is half written" for name in halves]
    if told_to_end:
        wrong += [f"{name} is left" for name in found.keys() - shown.keys()]
        wrong += [f"temporary {name} is left" for name in contents(place / "temporary")]
    return wrong


def main(count: int, chosen: Sequence[str]) -> int:
    """Disturb the chosen commands by turns, and print what was found."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs of a shell may be told to ignore it
    rng, bad = random.Random(0), 0
    with tempfile.TemporaryDirectory() as folder:
        files = Path(folder) / "files"
        files.mkdir()
        for name, text in FILES.items():
            (files / name).write_text(text)
        subprocess.run(
            words_of("export", files)[:-2] + ["-o", files / "planetary.fmu"], check=True, capture_output=True
        )
        known = {c: undisturbed(c, files, Path(folder) / c) for c in chosen}
        for k in range(count):
            command, how = chosen[k // 2 % len(chosen)], (signal.SIGKILL, signal.SIGINT)[k % 2]
            share = rng.uniform(0.05, 0.95)
            wrong, lived = disturb(command, files, Path(folder) / f"{k}", known[command], share, how)
            bad += bool(wrong)
            print(
                f"{command}, {how.name} at {share:.0%}, {lived:.1f} s: {'; '.join(wrong) or 'same bytes'}", flush=True
            )
    print(f"{count} disturbed, {bad} with something wrong")
    return min(bad, 1)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2:] or [*COMMANDS]))
