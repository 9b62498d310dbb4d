"""All checks of the project in one command: `python -m gearheat.tools.check` in a checkout.

Names behind it choose: `python -m gearheat.tools.check lint types`. `matrix`, which makes an environment for each
version of Python, runs only when it is named.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from ...model.errors import suggestion
from ..show.console import BAD_INPUT, note, table

ROOT = Path(__file__).resolve().parents[2]
#: Name below `gearheat` -> file or folder.
PACKAGES = {
    "__init__.py": "tools/api/__init__.py",
    "__init__.pyi": "tools/api/__init__.pyi",
    "__main__.py": "tools/api/__main__.py",
    "model": "model",
    "fmu": "fmu",
    "scenarios": "scenarios",
    "tools": "tools",
}
#: The tests' environment: a version and hashes of every package.
LOCK = ROOT / "tests" / "requirements.lock"
#: Versions of Python that the project is made for.
VERSIONS = ("3.11", "3.12", "3.13", "3.14")
#: The part of the suite that runs under each of them: a minute or two.
FAST = ("tests/core", "tests/laws", "tests/machines", "tests/parts", "tests/run")
#: Checks that run only when they are named.
NAMED = ("matrix",)


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


def requirements(extra: str = "") -> Iterator[str]:
    """What pyproject.toml asks for: the build's and the project's packages, or those of an extra and all it names."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        known = tomllib.load(file)
    project = known["project"]
    if not extra:
        yield from (*known["build-system"]["requires"], *project["dependencies"])
    for text in project["optional-dependencies"].get(extra, ()):
        name, bracket, rest = text.partition("[")
        if bracket and name == project["name"]:
            for other in rest.rstrip("]").split(","):
                yield from requirements(other)
        else:
            yield text


def lock_problems(lock: str, wanted: Iterable[str]) -> list[str]:
    """What is wrong with a lock file, without asking any registry.

    Args:
        lock: its text, as pip reads it
        wanted: requirements that it must satisfy under each of `VERSIONS`
    """
    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name

    lines = [line for line in lock.replace("\\\n", " ").splitlines() if line.strip() and not line.startswith("#")]
    pins = [Requirement(line.partition(" --hash=")[0]) for line in lines]
    problems = [f"{pin} has no hash" for pin, line in zip(pins, lines, strict=True) if "--hash=sha256:" not in line]
    asked = [Requirement(text) for text in wanted]
    for version in VERSIONS:
        here = {"python_version": version, "python_full_version": f"{version}.0"}
        held = {canonicalize_name(pin.name): pin for pin in pins if not pin.marker or pin.marker.evaluate(here)}
        for one in (one for one in asked if not one.marker or one.marker.evaluate(here)):
            pin = held.get(canonicalize_name(one.name))
            if pin is None:
                problems.append(f"Python {version}: {one.name} is missing")
            elif not one.specifier.contains(str(pin.specifier).removeprefix("==")):
                problems.append(f"Python {version}: {pin.name}{pin.specifier} does not satisfy {one}")
    return problems


def check_lock() -> int:
    """Compare the lock file with pyproject.toml."""
    problems = lock_problems(LOCK.read_text(encoding="utf-8"), [*requirements(), *requirements("test")])
    for problem in problems:
        note(f"error: {LOCK.name}: {problem}. Renew it, see CONTRIBUTING.md.")
    return len(problems)


def interpreter(version: str) -> str | None:
    """A Python of a version on the PATH that starts and is of that version."""
    if (path := shutil.which(f"python{version}")) is None:
        return None
    ask = [path, "-c", "import sys; print('{}.{}'.format(*sys.version_info))"]
    return path if subprocess.run(ask, capture_output=True, text=True, check=False).stdout.strip() == version else None


def try_version(python: str, folder: Path) -> str:
    """Install the checkout into a new environment and use it; the step that fails, or "passed"."""
    place = folder / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    installed = str(place)
    steps = {
        "environment": (python, "-m", "venv", str(folder)),
        "install": (installed, "-m", "pip", "install", "-q", "-e", f"{ROOT}[test]"),
        "import": (installed, "-c", "import gearheat.tools.cli"),
        "command": (str(place.with_name("gearheat")), "steady", "planetary"),
        "tests": (installed, "-m", "pytest", "-p", "no:cacheprovider", *FAST),
    }
    return next((f"{name} FAILED" for name, words in steps.items() if run(*words)), "passed")


def run_matrix() -> int:
    """Try every version of Python that is here. Returns how many failed, 1 if there is none; none here never passes."""
    outcomes = {}
    for version in VERSIONS:
        began, python = time.perf_counter(), interpreter(version)
        if python is None:
            outcomes[version] = ("missing: no interpreter on the PATH", "")
            continue
        note(f"== matrix: Python {version}")
        with tempfile.TemporaryDirectory() as folder:
            outcome = try_version(python, Path(folder))
        outcomes[version] = (outcome, f"{time.perf_counter() - began:.0f} s")
    table("Versions of Python", ("version", "outcome", "time"), [(v, *found) for v, found in outcomes.items()])
    tried = [outcome for outcome, _ in outcomes.values() if not outcome.startswith("missing")]
    return len(tried) - tried.count("passed") if tried else 1


def run(*words: str) -> int:
    """Run a command in the checkout, one thread a process; its exit code."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    note(f"== {' '.join(words[1:])}")
    environment = {**threads, **os.environ, "MYPYPATH": f"{links()}{os.pathsep}{ROOT / 'tests'}"}
    return subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode


def steps() -> dict[str, Callable[[], int]]:
    """Name -> check, which returns 0 if all is well; the tests hold those of floors, sizes and wheel contents."""
    python = sys.executable
    files = ("-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder")  # in the order of tests/conftest.py
    parallel = files if importlib.util.find_spec("xdist") else ()
    return {
        "lint": lambda: run(python, "-m", "ruff", "check", "."),
        "format": lambda: run(python, "-m", "ruff", "format", "--check", "."),
        "types": lambda: run(python, "-m", "mypy", "-p", "gearheat", "-p", "challenge"),
        "lock": check_lock,
        "tests": lambda: run(python, "-m", "pytest", *parallel, "--durations=20"),
        "matrix": run_matrix,
    }


def main(chosen: Sequence[str] = ()) -> int:
    """Run the chosen checks or all, also after one has failed. Returns 1 if any failed, 2 outside a checkout."""
    if not (ROOT / "pyproject.toml").exists():
        note("error: the checks need a checkout of the project with `pip install -e .[test]`.")
        return BAD_INPUT
    known = steps()
    if unknown := [name for name in chosen if name not in known]:
        note(
            "\n".join(
                f'error: there is no check "{n}".{suggestion(n, known)} Checks: {", ".join(known)}.' for n in unknown
            )
        )
        return BAD_INPUT

    def attempt(name: str) -> bool:
        began = time.perf_counter()
        code = known[name]()
        note(f"== {name}: {'passed' if code == 0 else 'FAILED'} in {time.perf_counter() - began:.1f} s")
        return code == 0

    links()  # before two checks make them at once
    wanted = chosen or [name for name in known if name not in NAMED]
    with ThreadPoolExecutor(2) as pool:  # the tests begin while one processor looks at types
        failed = [name for name, passed in zip(wanted, pool.map(attempt, wanted), strict=True) if not passed]
    note(f"== {'failed: ' + ', '.join(failed) if failed else 'all passed'}")
    return 1 if failed else 0
