"""Expressions in named values: what they compute, and that they can do nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from gearheat.tools.verify.model_values import evaluate

VALUES = {"oil.T": 353.15, "room.T": 293.15, "x": np.array([1.0, 2.0, 4.0]), "y": np.array([3.0, 5.0, 9.0])}


def value(text: str):
    return evaluate(text, VALUES.__getitem__)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("oil.T - room.T", 60.0),
        ("-2**2 + 6 / 4", -2.5),
        ("sqrt(16) * cos(radians(60))", 2.0),
        ("slope(y, x)", 2.0),
        ("intercept(y, x)", 1.0),
        ("misfit(y, x)", 0.0),
        ("max(x) - min(x[1:])", 2.0),
        ("x[0] + y[-1]", 10.0),
        ("sum(x > 1)", 2),
        ("increasing(x) & (max(x) < 5)", True),
        ("all((x > 1) == (y >= 5))", True),
        ("decreasing(y)", False),
        ("1 < mean(x) <= 3", True),
    ],
)
def test_value(text: str, expected: float) -> None:
    assert value(text) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "open",
        "(lambda: 1)()",
        "x.sum()",
        "[1, 2]",
        "'text'",
        "max(x, axis=0)",
        "x if x else y",
        "1 !",
    ],
)
def test_nothing_but_arithmetic(text: str) -> None:
    with pytest.raises((ValueError, KeyError)):
        value(text)
