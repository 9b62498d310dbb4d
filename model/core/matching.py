"""Which equation determines which unknown, and the smallest sets in which that does not come out even."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching


class Matching:
    """As many pairs of an equation and one of its unknowns as there can be.

    Args:
        columns: for each equation the positions of its unknowns
        width: number of unknowns
    """

    def __init__(self, columns: Sequence[Sequence[int]], width: int) -> None:
        self.columns = columns
        ends = np.cumsum([0, *map(len, columns)])
        flat = np.fromiter((c for row in columns for c in row), dtype=np.int32, count=int(ends[-1]))
        matrix = csr_matrix((np.ones(len(flat)), flat, ends), shape=(len(columns), width))
        self.column_of = maximum_bipartite_matching(matrix, perm_type="column")
        self.row_of = np.full(width, -1)
        paired = np.flatnonzero(self.column_of >= 0)
        self.row_of[self.column_of[paired]] = paired
        self._transposed = matrix.T.tocsr()

    @property
    def spare_rows(self) -> list[int]:
        """Equations that are left over."""
        return [int(r) for r in np.flatnonzero(self.column_of < 0)]

    @property
    def free_columns(self) -> list[int]:
        """Unknowns that are left over."""
        return [int(c) for c in np.flatnonzero(self.row_of < 0)]

    def too_many(self, row: int) -> list[int]:
        """The smallest set of equations around a spare one that has one unknown less than equations.

        Every unknown of the set is paired inside it, so no equation can leave it without making the rest sound.
        """
        return self._closure(row, self.columns, self.row_of)

    def too_few(self, column: int) -> list[int]:
        """The unknowns around a free one that have, all together, one equation less than unknowns."""
        t = self._transposed
        rows = [t.indices[t.indptr[c] : t.indptr[c + 1]] for c in range(t.shape[0])]
        return self._closure(column, rows, self.column_of)

    @staticmethod
    def _closure(start: int, across: Sequence[Any], partner: np.ndarray) -> list[int]:
        """All of one side that alternating paths from one of them lead to."""
        seen, todo = {start}, [start]
        while todo:
            for other in across[todo.pop()]:
                back = int(partner[other])
                if back >= 0 and back not in seen:
                    seen.add(back)
                    todo.append(back)
        return sorted(seen)


def columns_of(sparsity: Any) -> list[list[int]]:
    """For each row of a CasADi sparsity its columns."""
    found: list[list[int]] = [[] for _ in range(sparsity.shape[0])]
    for i, j in zip(*sparsity.get_triplet(), strict=True):
        found[i].append(j)
    return found
