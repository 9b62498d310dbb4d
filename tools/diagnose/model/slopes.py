"""Derivatives by few of many directions: those that are not zero."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

#: Derivatives of a value of each row that are not zero: direction -> of each row (n,).
Slope = dict[int, np.ndarray]


def same(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]) -> bool:
    """Whether both change the same to the same."""
    return one.keys() == other.keys() and all(np.array_equal(v, other[path]) for path, v in one.items())


def total(terms: Sequence[tuple[np.ndarray | float, Slope]]) -> Slope:
    """Slopes, each times its weight."""
    found: Slope = {}
    for weight, slope in terms:
        for i, own in slope.items():
            found[i] = found[i] + weight * own if i in found else weight * own
    return found
