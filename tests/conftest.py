"""What holds for all tests."""

import pytest


@pytest.fixture(autouse=True)
def no_screen(monkeypatch):
    """Output is that of a pipe, whatever screen the tests run on: parallel runs tell their workers a width."""
    monkeypatch.delenv("COLUMNS", raising=False)
