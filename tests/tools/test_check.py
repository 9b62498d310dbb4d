from __future__ import annotations

import sys

import pytest
from gearheat.tools import check
from gearheat.tools.check import PACKAGES, VERSIONS, interpreter, links, lock_problems, main, steps

#: A lock of one package, and its hash.
LOCK = "a==1.2 \\\n    --hash=sha256:00\n"


def test_types_are_checked_through_links_to_every_package(tmp_path):
    for folder in PACKAGES.values():
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
        (tmp_path / folder / "__init__.py").touch()
    for _ in range(2):
        place = links(tmp_path)
    for package in PACKAGES:
        assert (place / "gearheat" / package / "__init__.py").is_file()


def test_all_kinds_of_check_are_there():
    assert list(steps()) == ["lint", "format", "types", "lock", "tests", "matrix"]


def test_a_check_that_does_not_exist(capfd):
    assert main(["lind"]) == 2
    assert 'Did you mean "lint"' in capfd.readouterr().err


@pytest.mark.parametrize(
    ("lock", "wanted", "problems"),
    [
        (LOCK, "a>=1", []),
        (LOCK, "A>=1", []),
        ("a==1.2\n", "a>=1", ["a==1.2 has no hash"]),
        (LOCK, "a>=2", [f"Python {version}: a==1.2 does not satisfy a>=2" for version in VERSIONS]),
        (LOCK, "b", [f"Python {version}: b is missing" for version in VERSIONS]),
        (LOCK, 'b; python_version < "3.12"', ["Python 3.11: b is missing"]),
        (LOCK.replace("2 ", '2 ; python_version >= "3.12" '), "a", ["Python 3.11: a is missing"]),
    ],
)
def test_a_lock_holds_a_hash_and_what_is_asked_under_every_version(lock, wanted, problems):
    assert lock_problems(lock, [wanted]) == problems


def test_the_lock_holds_what_the_project_asks_for():
    assert main(["lock"]) == 0


@pytest.fixture
def only_here(tmp_path, monkeypatch):
    """A PATH with a Python of the lowest version, which starts, and one of the next that is not what its name says."""
    for version in VERSIONS[:2]:
        path = tmp_path / f"python{version}"
        path.write_text(f"#!/bin/sh\necho {VERSIONS[0]}\n")
        path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/bin")
    return str(tmp_path / f"python{VERSIONS[0]}")


@pytest.mark.skipif(sys.platform == "win32", reason="the interpreters are scripts of a shell")
@pytest.mark.parametrize(("outcome", "code"), [("passed", 0), ("tests FAILED", 1)])
def test_the_matrix_tries_what_is_here_and_tells_what_is_not(only_here, monkeypatch, capfd, outcome, code):
    assert interpreter(VERSIONS[0]) == only_here
    tried = []
    monkeypatch.setattr(check, "try_version", lambda python, _: tried.append(python) or outcome)
    monkeypatch.setattr(check, "interpreter", lambda v: interpreter(v) if v in VERSIONS[:2] else None)
    assert main(["matrix"]) == code
    assert tried == [only_here]
    said = capfd.readouterr()
    assert outcome in said.out + said.err
    assert (said.out + said.err).count("missing: no interpreter on the PATH") == len(VERSIONS) - 1


def test_a_matrix_of_nothing_does_not_pass(monkeypatch):
    monkeypatch.setattr(check, "interpreter", lambda _: None)
    assert main(["matrix"]) == 1
