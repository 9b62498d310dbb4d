"""The figures of a batch: there, and of the size that is promised."""

from __future__ import annotations

from gearheat.tools.bench.throughput import measure


def test_throughput_and_error_of_a_batch() -> None:
    """By the time of the processor, which other work on the machine does not lengthen; half of the goals."""
    found = measure(rows=4000, warmups=100, swept=500, threads=(1, 2), repeats=2)
    steady, warmup = found["steady"], found["warmup_330_min"]
    assert set(steady["rows_per_s"]) == set(warmup["rows_per_s"]) == {"1", "2"}
    assert steady["rows_per_core_s"] > 50_000, found
    assert warmup["rows_per_core_s"] > 500, found
    assert warmup["error_K"] <= 1e-4
    assert found["sweep"]["rows"] == 500
    assert found["sweep"]["rows_per_s"] > 0
