"""Sparse elimination of symbolic linear systems: diagonal pivots in min-fill order, as straight-line code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca


def min_fill_order(pattern: Sequence[set[int]]) -> list[int]:
    """Order of diagonal pivots by Markowitz' rule: smallest (row count - 1) (column count - 1) first.

    Args:
        pattern: for each row the columns that are not zero; the diagonal always counts as not zero
    """
    rows = [set(row) | {i} for i, row in enumerate(pattern)]
    left = set(range(len(rows)))
    order = []
    while left:
        columns = {k: [i for i in left if k in rows[i] and i != k] for k in left}
        pivot = min(sorted(left), key=lambda k: len(columns[k]) * (len(rows[k] & left) - 1))
        order.append(pivot)
        left.remove(pivot)
        for i in columns[pivot]:
            rows[i] |= rows[pivot] & left
    return order


class SparseLU:
    """Factors of a square SX matrix without pivoting; `solve` is substitution only, so many right sides share them.

    Meant for I - h J of a stiff differential equation with h small enough to be accurate, where the diagonal is a safe
    pivot; whoever runs the code checks that its result is finite.
    """

    def __init__(self, matrix: Any) -> None:
        n = matrix.shape[0]
        self._rows: list[dict[int, Any]] = [{} for _ in range(n)]
        for i, j, value in zip(*matrix.sparsity().get_triplet(), matrix.nonzeros(), strict=True):
            self._rows[i][j] = value
        self._order = min_fill_order([set(row) for row in self._rows])
        self._inverse: list[Any] = [None] * n
        self._lower: list[list[tuple[int, Any]]] = [[] for _ in range(n)]
        self._factor()

    def _factor(self) -> None:
        left = set(self._order)
        for k in self._order:
            left.remove(k)
            upper = {j: v for j, v in self._rows[k].items() if j in left}
            self._inverse[k] = 1 / self._rows[k][k]
            self._rows[k] = upper
            for i in sorted(left):
                if k not in self._rows[i]:
                    continue
                factor = self._rows[i].pop(k) * self._inverse[k]
                self._lower[k].append((i, factor))
                for j, value in upper.items():
                    self._rows[i][j] = self._rows[i].get(j, 0) - factor * value

    def solve(self, right: Any) -> Any:
        """The column x of matrix x = right."""
        b = [right[i] for i in range(len(self._order))]
        for k in self._order:
            for i, factor in self._lower[k]:
                b[i] = b[i] - factor * b[k]
        for k in reversed(self._order):
            for j, value in self._rows[k].items():
                b[k] = b[k] - value * b[j]
            b[k] = b[k] * self._inverse[k]
        return ca.vertcat(*b)
