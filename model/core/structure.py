"""Structural analysis: does every unknown have an equation of its own, and who is at fault if not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching

from ..errors import StructureError

SHOWN = 5


def check_structure(model: str, incidence: Any, equations: Sequence[str], unknowns: Sequence[str]) -> None:
    """Raise StructureError, naming the equations and unknowns at fault, unless a perfect matching exists.

    Args:
        model: name of the model, for the message
        incidence: casadi.Sparsity, a row per equation, a column per unknown
        equations: names of the rows
        unknowns: names of the columns
    """
    rows, columns = incidence.get_triplet()
    matrix = csr_matrix((np.ones(len(rows)), (rows, columns)), shape=incidence.shape)
    column_of_row = maximum_bipartite_matching(matrix, perm_type="column")
    row_of_column = np.full(len(unknowns), -1)
    matched = np.flatnonzero(column_of_row >= 0)
    row_of_column[column_of_row[matched]] = matched
    if (column_of_row >= 0).all() and (row_of_column >= 0).all():
        return
    problem = f"{model}: {len(equations)} equations for {len(unknowns)} unknowns."
    if free := _at_fault(matrix.T.tocsr(), row_of_column, column_of_row):
        problem += f"\nNothing determines {_some(unknowns, free)}: give a value, connect a source or a storage."
    if spare := _at_fault(matrix, column_of_row, row_of_column):
        problem += f"\nToo much is said in {_some(equations, spare)}: take one away, for example a second source."
    raise StructureError(problem)


def _at_fault(adjacent: csr_matrix, partner: np.ndarray, partner_back: np.ndarray) -> list[int]:
    """Nodes of one side without a partner, and those that alternating paths from them could rob of theirs."""
    todo = np.flatnonzero(partner < 0).tolist()
    seen = set(todo)
    while todo:
        node = todo.pop()
        for other in adjacent.indices[adjacent.indptr[node] : adjacent.indptr[node + 1]]:
            rival = int(partner_back[other])
            if rival >= 0 and rival not in seen:
                seen.add(rival)
                todo.append(rival)
    return sorted(seen)


def _some(names: Sequence[str], chosen: Sequence[int]) -> str:
    """The first few names, those nearest to a user (of parts, not of their ports) first."""
    sorted_names = sorted((names[i] for i in chosen), key=lambda name: name.count("."))
    more = f" and {len(chosen) - SHOWN} more" if len(chosen) > SHOWN else ""
    return ", ".join(sorted_names[:SHOWN]) + more
