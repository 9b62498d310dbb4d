"""All checks of the project in one command: `python -m gearheat.tools.check` in a checkout.

Names behind it choose: `python -m gearheat.tools.check lint types`.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...model.errors import suggestion
from ..show.console import BAD_INPUT, note

ROOT = Path(__file__).resolve().parents[2]
#: Name below `gearheat` -> file or folder.
PACKAGES = {
    "__init__.py": "tools/api/__init__.py",
    "__main__.py": "tools/api/__main__.py",
    "model": "model",
    "fmu": "fmu",
    "scenarios": "scenarios",
    "diagnose": "tools/diagnose",
    "tools": "tools",
}


def links(root: Path = ROOT) -> Path:
    """A folder that holds the packages under their importable names; mypy does not follow an editable install."""
    place = root / "build" / "mypy"
    (place / "gearheat").mkdir(parents=True, exist_ok=True)
    for package, folder in PACKAGES.items():
        link = place / "gearheat" / package
        if not link.exists():
            link.unlink(missing_ok=True)
            link.symlink_to(root / folder)
    return place


def steps() -> Iterator[tuple[str, Sequence[str]]]:
    """Name and command of every check; the tests hold those of floors, sizes and wheel contents."""
    python = sys.executable
    yield "lint", (python, "-m", "ruff", "check", ".")
    yield "format", (python, "-m", "ruff", "format", "--check", ".")
    yield "types", (python, "-m", "mypy", "-p", "gearheat")
    parallel = ("-n", "auto") if importlib.util.find_spec("xdist") else ()
    yield "tests", (python, "-m", "pytest", *parallel)


def main(chosen: Sequence[str] = ()) -> int:
    """Run the chosen checks or all, also after one has failed. Returns 1 if any failed, 2 outside a checkout."""
    if not (ROOT / "pyproject.toml").exists():
        note("error: the checks need a checkout of the project with `pip install -e .[test]`.")
        return BAD_INPUT
    known = dict(steps())
    if unknown := [name for name in chosen if name not in known]:
        note(
            "\n".join(
                f'error: there is no check "{n}".{suggestion(n, known)} Checks: {", ".join(known)}.' for n in unknown
            )
        )
        return BAD_INPUT
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")  # a test a core
    environment = {**threads, **os.environ, "MYPYPATH": str(links())}
    failed = []
    for name in chosen or known:
        note(f"== {name}: {' '.join(known[name][1:])}")
        began = time.perf_counter()
        code = subprocess.run(known[name], cwd=ROOT, env=environment, check=False).returncode
        note(f"== {name}: {'passed' if code == 0 else 'FAILED'} in {time.perf_counter() - began:.1f} s")
        if code:
            failed.append(name)
    note(f"== {'failed: ' + ', '.join(failed) if failed else 'all passed'}")
    return 1 if failed else 0
