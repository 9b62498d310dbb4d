"""Sparse elimination of symbolic linear systems, as straight-line expressions.

Pivots come in the order of least fill (Markowitz 1957). Counts are kept per row and per column and candidates wait in a
heap, so that the cost grows with the entries that change, not with the size of the matrix.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import Any

import casadi as ca
import numpy as np

#: A pivot is at least this share of the largest entry of its row (threshold pivoting, Duff, Erisman and Reid 2017).
THRESHOLD = 1e-3
#: What is left of a difference is round-off below this share of its terms.
ROUND_OFF = 1e-12
#: Changed counts of a row or column renew the waiting candidates in it only up to this length: longer ones are no
#: candidates before they are short, and renewing a hub at every step would make the cost quadratic.
SHORT = 32


class Singular(ArithmeticError):
    """A matrix without an inverse.

    Attributes:
        rows, columns: indices of what is left when no pivot can be found
    """

    def __init__(self, rows: Sequence[int], columns: Sequence[int]) -> None:
        super().__init__(f"no pivot is left in rows {list(rows)} and columns {list(columns)}")
        self.rows, self.columns = tuple(rows), tuple(columns)


class Factors:
    """L U factors of a square SX matrix. Each right-hand side costs one substitution, so many may share them.

    With `sizes` any entry that is not small in its row may be a pivot. Without, pivots are taken on the diagonal
    whatever its value: meant for I - h J of a stiff differential equation with h small enough to be accurate; whoever
    runs the code checks that its result is finite.

    Args:
        matrix: SX, square (n x n)
        sizes: typical value of each stored entry of the matrix, in CasADi's order; see `typical_sizes`

    Raises:
        Singular: some rows say the same, at the typical values or whatever the values
    """

    def __init__(self, matrix: Any, sizes: Sequence[float] | None = None) -> None:
        places = list(zip(*matrix.sparsity().get_triplet(), strict=True))
        n = matrix.shape[0]
        self._rows: list[dict[int, Any]] = [{} for _ in range(n)]
        for (i, j), value in zip(places, matrix.nonzeros(), strict=True):
            self._rows[i][j] = value
        self._open = _Open(places, n, sizes)
        self._order: list[tuple[int, int]] = []
        self._inverse: list[Any] = []
        self._lower: list[list[tuple[int, Any]]] = []
        self._upper: list[list[tuple[int, Any]]] = []
        for _ in range(n):
            self._eliminate(*self._open.pivot())

    @property
    def operations(self) -> int:
        """Products that the factors and one right-hand side take."""
        pairs = zip(self._lower, self._upper, strict=True)
        return sum(len(lower) * (len(upper) + 2) + len(upper) + 1 for lower, upper in pairs)

    def _eliminate(self, i: int, j: int) -> None:
        inverse = 1 / self._rows[i].pop(j)
        upper, lower = list(self._rows[i].items()), []
        for r in self._open.below(i, j):
            row = self._rows[r]
            factor = row.pop(j) * inverse
            lower.append((r, factor))
            for c, value in upper:
                row[c] = row.get(c, 0) - factor * value
        self._open.eliminate(i, j)
        self._order.append((i, j))
        self._inverse.append(inverse)
        self._lower.append(lower)
        self._upper.append(upper)

    def solve(self, right: Any) -> Any:
        """x of matrix x = right, column by column (n x m)."""
        columns = ca.horzsplit(ca.SX(right))
        return ca.horzcat(*map(self._column, columns)) if columns else ca.SX(right)

    def _column(self, right: Any) -> Any:
        b = ca.densify(right).nonzeros()
        for (i, _), lower in zip(self._order, self._lower, strict=True):
            for r, factor in lower:
                b[r] = b[r] - factor * b[i]
        x = list(b)
        for k in reversed(range(len(b))):
            i, j = self._order[k]
            value = b[i]
            for c, entry in self._upper[k]:
                value = value - entry * x[c]
            x[j] = value * self._inverse[k]
        return ca.vertcat(ca.SX(0, 1), *x)


class _Open:
    """Pattern and typical values of what is not eliminated yet, and the candidates for the next pivot."""

    def __init__(self, places: Sequence[tuple[int, int]], n: int, sizes: Sequence[float] | None) -> None:
        self._diagonal = sizes is None
        self._left = set(range(n)), set(range(n))  # rows and columns
        self._columns: list[set[int]] = [set() for _ in range(n)]
        self._size: list[dict[int, float]] = [{} for _ in range(n)]
        for (i, j), size in zip(places, [0.0] * len(places) if sizes is None else sizes, strict=True):
            self._columns[j].add(i)
            self._size[i][j] = size
        self._terms = [{j: abs(size) for j, size in row.items()} for row in self._size]
        self._heap: list[tuple[tuple[int, bool], int, int]] = []
        self._refill()

    def pivot(self) -> tuple[int, int]:
        """Row and column of the entry of least fill; of equals a large one in its row, then the first."""
        for _ in range(2):  # the second time among all that is left: an entry may have become large in its row since
            while self._heap:
                cost, i, j = heappop(self._heap)
                if j not in self._size[i]:
                    continue
                if (now := self._cost(i, j)) > cost:
                    heappush(self._heap, (now, i, j))
                elif self._diagonal or self._large(i, j):
                    return i, j
            self._refill()
        raise Singular(*map(sorted, self._left))

    def below(self, i: int, j: int) -> list[int]:
        """The other rows with an entry in a column."""
        return sorted(self._columns[j] - {i})

    def eliminate(self, i: int, j: int) -> None:
        """Take out a pivot's row and column and add the fill."""
        upper, below = self._size[i], self.below(i, j)
        pivot = upper.pop(j)
        self._left[0].discard(i)
        self._left[1].discard(j)
        self._size[i] = {}
        for c in upper:
            self._columns[c].discard(i)
        self._columns[j] = set()
        for r in below:
            self._subtract(r, j, upper, pivot)
        self._renew(below, upper)

    def _subtract(self, r: int, j: int, upper: Mapping[int, float], pivot: float) -> None:
        """Row r less its multiple of the pivot's row."""
        size, terms = self._size[r], self._terms[r]
        ratio = size.pop(j) / (pivot or 1.0)
        for c, value in upper.items():
            term = ratio * value
            terms[c] = max(terms[c], abs(term)) if c in size else abs(term)
            size[c] = size.get(c, 0.0) - term
            self._columns[c].add(r)

    def _renew(self, rows: Iterable[int], columns: Iterable[int]) -> None:
        """Let the entries of changed rows and columns wait at their new cost."""
        if self._diagonal:
            changed = [(k, k) for k in {*rows, *columns}]
        else:
            short_rows = [r for r in rows if len(self._size[r]) <= SHORT]
            short_columns = [c for c in columns if len(self._columns[c]) <= SHORT]
            changed = [(r, c) for r in short_rows for c in self._size[r]]
            changed += [(r, c) for c in short_columns for r in self._columns[c]]
        for i, j in changed:
            if j in self._size[i]:
                heappush(self._heap, (self._cost(i, j), i, j))

    def _refill(self) -> None:
        entries = [(i, j) for i, row in enumerate(self._size) for j in row if i == j or not self._diagonal]
        self._heap = [(self._cost(i, j), i, j) for i, j in entries]
        heapify(self._heap)

    def _cost(self, i: int, j: int) -> tuple[int, bool]:
        """The most fill a pivot can make, and whether it is small in its row.

        The large entry of a balance is the one of its own node: with it the pattern stays symmetric, and fill low. A
        row of two makes one other entry of either, so its order decides.
        """
        row = self._size[i]
        small = len(row) > SHORT or (len(row) > 2 and abs(row[j]) < max(map(abs, row.values())) / 2)
        return (len(row) - 1) * (len(self._columns[j]) - 1), small

    def _large(self, i: int, j: int) -> bool:
        row = self._size[i]
        least = max(THRESHOLD * max(map(abs, row.values())), ROUND_OFF * self._terms[i][j])
        return abs(row[j]) > least


def typical_sizes(matrix: Any, typical: Mapping[int, float]) -> list[float]:
    """Typical value of each stored entry of a matrix, in CasADi's order.

    They only steer the choice of pivots, so an entry that cannot be had counts as 1.

    Args:
        matrix: SX
        typical: a typical value of each symbol by its hash; 1 for others
    """
    entries = matrix.nonzeros()
    if all(e.is_symbolic() or e.is_constant() for e in entries):
        values = [typical.get(e.element_hash(), 1.0) if e.is_symbolic() else float(e) for e in entries]
        return [value if np.isfinite(value) else 1.0 for value in values]
    free = ca.symvar(matrix)
    point = [typical.get(symbol.element_hash(), 1.0) for symbol in free]
    sizes = ca.Function("sizes", [ca.vertcat(ca.SX(0, 1), *free)], [ca.vertcat(ca.SX(0, 1), *entries)])
    found = np.array(sizes(point)).ravel()
    return [value if np.isfinite(value) else 1.0 for value in found.tolist()]
