from __future__ import annotations

from gearheat.tools.bench import _imports, _integration


def test_the_fmu_is_ten_times_faster_than_scipy_at_no_larger_error():
    found = _integration("planetary", "1,16,26")
    assert found["tests"] == 3
    assert found["fmu_error_K"] < 1e-3
    assert found["ratio"] >= 10, found


def test_what_the_help_imports_is_seen():
    assert _imports("typer")
    assert not _imports("casadi")
