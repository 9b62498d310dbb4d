"""What all benches share: a clock, the figures in `bench.toml`, and environments of their own for peers."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from jinja2 import Environment, PackageLoader, StrictUndefined

from ...model.errors import DataError
from ...model.files import tables
from ..show.console import cell

T = TypeVar("T")

#: Goals and peers.
TABLES: dict[str, Any] = tables("tools.bench", "bench.toml")

#: The program as a process of its own.
PROGRAM = (sys.executable, "-m", "gearheat.tools.cli")

_TEMPLATES = Environment(
    loader=PackageLoader("gearheat.tools.bench"), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
)
_TEMPLATES.filters["cell"] = cell


def timed(work: Callable[[], T], clock: Callable[[], float] = time.process_time) -> tuple[float, T]:
    """Seconds that work takes, and its result.

    Args:
        work: what is measured
        clock: processor time, or that of the wall
    """
    began = clock()
    result = work()
    return clock() - began, result


def environment(folder: Path, peer: str, installs: Sequence[Sequence[str]], base: str = sys.executable) -> Path:
    """The interpreter of a new environment.

    Args:
        folder: where it is made
        peer: what it is for
        installs: arguments of pip install, one call after the other
        base: interpreter to begin with

    Raises:
        DataError: it cannot be made here
    """
    place = folder / f"with_{peer}"
    python = place / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    calls = [[str(python), "-m", "pip", "install", "-q", *arguments] for arguments in installs]
    for command in ([base, "-m", "venv", str(place)], *calls):
        run(command, folder, f"{peer} cannot be installed")
    return python


def run(command: Sequence[str], folder: Path, problem: str, env: dict[str, str] | None = None) -> str:
    """Last line that a program prints.

    Args:
        command: its words
        folder: where it works
        problem: what is said where it fails
        env: its environment; that of this program if None

    Raises:
        DataError: it fails
    """
    done = subprocess.run(command, cwd=folder, env=env, check=False, capture_output=True, text=True)
    if done.returncode:
        raise DataError(f"{problem}: {done.stderr.strip().splitlines()[-1]}")
    return (done.stdout.splitlines() or [""])[-1]


def script(folder: Path, name: str, **values: object) -> Path:
    """A program of `templates`, written into a folder.

    Args:
        folder: where it is written
        name: of the program, without ending
        values: what its template asks for
    """
    path = folder / f"{name}.py"
    path.write_text(_TEMPLATES.get_template(f"{name}.py.jinja").render(values), encoding="utf-8")
    return path


def rows(name: str, found: Mapping[str, Any]) -> list[list[str]]:
    """The rows of a table, what and value, as one of `templates` tells figures.

    Args:
        name: of the template, without ending
        found: the figures
    """
    text = _TEMPLATES.get_template(f"{name}.txt.jinja").render(found)
    return [line.split(" | ") for line in text.splitlines()]
