"""The wheel holds every module and data file; the README's commands are the ones that are run."""

import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[2]


def tracked(*patterns: str) -> set[str]:
    """Files of the project below its packages, as paths inside the wheel."""
    tops = ("model", "fmu", "scenarios", "tools")
    files = [p for top in tops for pattern in patterns for p in (ROOT / top).rglob(pattern)]
    return {in_wheel(p) for p in files if "__pycache__" not in p.parts}


def in_wheel(path: Path) -> str:
    """Where a file of the project stands in the wheel: the API is `gearheat` itself."""
    name = path.relative_to(ROOT).as_posix()
    return "gearheat/" + name.replace("tools/api/", "", 1)


def test_wheel_contents(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "-q", "-w", str(tmp_path), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    held = set(zipfile.ZipFile(wheel).namelist())
    folders = (
        "fmu/templates",
        *(f"tools/{room}/templates" for room in ("build", "compare", "describe", "show", "verify")),
        *(f"tools/docs/pages/{kind}" for kind in ("tutorials", "howto", "reference")),
        "tools/diagnose/report/templates",
        "tools/show/vendor",
    )
    wanted = tracked("*.py", "py.typed", "*.toml", "*.csv", "*.c", "*.h", "*.schema.json")
    wanted |= {in_wheel(p) for folder in folders for p in (ROOT / folder).glob("*")}
    wanted |= {in_wheel(p) for p in (ROOT / "tools/docs/pages").rglob("*.*")}
    wanted -= (benches := {name for name in wanted if name.startswith("gearheat/tools/bench/")})
    assert benches and not benches & held, "developers' benches are in the wheel"
    assert wanted <= held, f"missing in the wheel: {sorted(wanted - held)}"
    assert not [name for name in held if not name.startswith("gearheat")], "the wheel holds foreign files"


def test_the_sdist_holds_tests_benches_and_what_tells_of_the_project() -> None:
    given = (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines()
    assert {"graft tests", "graft tools/bench", "include CHANGELOG.md CITATION.cff CONTRIBUTING.md"} <= set(given)


def test_readme_names_the_commands_that_are_run() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    command = (ROOT / ".ci/run").read_text(encoding="utf-8").splitlines()[-1]
    assert command in readme, "the last line of .ci/run is the README's test command"
