"""What holds for all tests."""

from pathlib import Path

import pytest

#: Files that take more than 10 s, the longest first. A parallel run hands out whole files in this order, then the rest:
#: what a file's tests share is made once, and no processor waits at the end for a long file that began late.
LONGEST = (
    "tools/test_every_rig.py",
    "static/test_readme.py",
    "challenge/test_hidden.py",
    "diagnose/infer/test_logs.py",
    "fmu/test_every_parameter.py",
    "tools/test_docs.py",
    "diagnose/test_readings_and_logs.py",
    "fmu/test_duties.py",
    "diagnose/test_pages.py",
    "fmu/test_operating_points.py",
    "diagnose/library/test_causes.py",
    "fmu/test_cold_start.py",
    "diagnose/infer/test_looks.py",
    "static/test_package.py",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first; the others, and the tests of a file, stay in their order."""
    here = Path(__file__).parent
    ranks = {here / name: rank for rank, name in enumerate(LONGEST)}
    items.sort(key=lambda item: ranks.get(item.path, len(ranks)))


@pytest.fixture(autouse=True)
def no_screen(monkeypatch):
    """Output is that of a pipe, whatever screen the tests run on: parallel runs tell their workers a width."""
    monkeypatch.delenv("COLUMNS", raising=False)
