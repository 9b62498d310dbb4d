"""Symbolic solution of a square system of residuals, block by block.

The block-triangular form sorts the system. A block of one unknown that enters linearly is solved by hand; a larger
linear block by sparse elimination. A block that stays implicit is torn: some of its unknowns stay algebraic variables,
tested by as many of its equations, and define the rest. A system that does not come out even is matched: which
equation determines which unknown, and the smallest sets in which that fails.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching, min_weight_full_bipartite_matching

from ..errors import StructureError
from .component import Balance, Equation
from .eliminate import Factors, Singular, typical_sizes

#: Cost of letting an equation determine an unknown that one side of it gives.
EXPLICIT = 1.0
#: Cost of letting an equation determine an unknown in which it is linear.
LINEAR = 2.0
#: Cost of letting an equation determine an unknown in which it is nonlinear.
NONLINEAR = 100.0
#: What it costs on top of these where the equation gives a torn unknown, which it is to test.
DEFINES_TORN = 1e4
#: What it costs to test a torn unknown by an equation that it is not in.
ABSENT = 1e6


@dataclass(frozen=True, eq=False)
class Unknown:
    """One unknown: symbol, name, typical size, and where an iteration may start (None: from the typical size)."""

    symbol: Any
    name: str
    nominal: float = 1.0
    guess: float | None = None
    unit: str = "1"


@dataclass
class Solution:
    """Definitions in the order in which they can be evaluated; torn unknowns and the equations that test them.

    `typical` holds a typical value of every symbol by its hash: it only steers the choice of pivots.
    """

    typical: Mapping[int, float]
    symbols: list[Any] = field(default_factory=list)
    definitions: list[Any] = field(default_factory=list)
    torn: list[Unknown] = field(default_factory=list)
    tests: list[Equation] = field(default_factory=list)

    def define(self, symbol: Any, definition: Any) -> None:
        """Append one definition; it may use known symbols and those defined before.

        Args:
            symbol: the unknown (SX, 1)
            definition: its value as an expression (SX, 1)
        """
        self.symbols.append(symbol)
        self.definitions.append(definition)


def column(items: Sequence[Any]) -> Any:
    """A CasADi column of scalars, also of none."""
    return ca.vertcat(*items) if items else ca.SX(0, 1)


def incidence(rows: Sequence[Equation], unknowns: Sequence[Unknown]) -> Any:
    """Sparsity of the residuals in the unknowns.

    Args:
        rows: the n equations
        unknowns: m of their symbols
    """
    return ca.jacobian_sparsity(column([r.residual for r in rows]), column([u.symbol for u in unknowns]))


def solve(
    model: str, rows: Sequence[Equation], unknowns: Sequence[Unknown], solution: Solution, pattern: Any = None
) -> None:
    """Add the definitions of all unknowns to a solution. The system must be structurally sound.

    Args:
        model: its name, for messages
        rows: the equations
        unknowns: as many as equations
        solution: takes up the definitions, in order
        pattern: their incidence, where it is known

    Raises:
        StructureError: a linear block is singular
    """
    _, row_order, column_order, row_blocks, column_blocks, _, _ = (pattern or incidence(rows, unknowns)).btf()
    for first, last, left, right in zip(row_blocks, row_blocks[1:], column_blocks, column_blocks[1:], strict=False):
        block_rows = [rows[i] for i in row_order[first:last]]
        block_unknowns = [unknowns[i] for i in column_order[left:right]]
        _solve_block(model, block_rows, block_unknowns, solution)


def _solve_block(model: str, rows: list[Equation], unknowns: list[Unknown], solution: Solution) -> None:
    if len(rows) == 1 and (definition := _explicit(rows[0], unknowns[0].symbol)) is not None:
        solution.define(unknowns[0].symbol, definition)
        return
    z, residual = column([u.symbol for u in unknowns]), column([r.residual for r in rows])
    matrix = ca.jacobian(residual, z)
    if not ca.depends_on(matrix, z):
        _eliminate(model, matrix, ca.substitute(residual, z, ca.SX.zeros(*z.shape)), unknowns, solution)
    else:
        _tear(model, rows, unknowns, solution)


def _explicit(row: Equation, z: Any) -> Any:
    """The other terms of a balance, the other side where one side is the unknown itself, else None."""
    if isinstance(row, Balance):
        return row.rest(z)
    own = z.element_hash()
    for side, other in ((row.lhs, row.rhs), (row.rhs, row.lhs)):
        if side.is_symbolic() and side.element_hash() == own and not ca.depends_on(other, z):
            return other
    return None


def _eliminate(model: str, matrix: Any, constant: Any, unknowns: list[Unknown], solution: Solution) -> None:
    """Solve matrix z + constant = 0."""
    try:
        z = Factors(matrix, typical_sizes(matrix, solution.typical)).solve(-constant)
    except Singular as error:
        names = ", ".join(unknowns[c].name for c in error.columns[:5])
        raise StructureError(
            f"{model}: the equations for {names} say the same twice. Give one of these a value."
        ) from None
    for unknown, value in zip(unknowns, z.nonzeros(), strict=True):
        solution.define(unknown.symbol, value)


def _tear(model: str, rows: list[Equation], unknowns: list[Unknown], solution: Solution) -> None:
    """Keep some unknowns of a block as algebraic variables, define the rest by them, and test what is left.

    Torn are the unknowns with a guess; without any, as few as make the rest linear. What is still implicit after that
    is torn again.
    """
    torn = [u for u in unknowns if u.guess is not None] or _nonlinear(rows, unknowns)
    rest = [u for u in unknowns if u not in torn]
    tests = _tests(rows, torn, rest)
    solution.torn += torn
    solution.tests += tests
    if rest:
        solve(model, [r for r in rows if r not in tests], rest, solution)


def _nonlinear(rows: list[Equation], unknowns: list[Unknown]) -> list[Unknown]:
    """Unknowns of which at least one is in every nonlinear term, those first that are in most of them."""
    z = column([u.symbol for u in unknowns])
    entries = _entries(rows, z)
    of_entry = np.array(entries.sparsity().get_triplet()[1], dtype=int)
    entry, by = np.array(ca.jacobian_sparsity(entries.nz[:], z).get_triplet(), dtype=int).reshape(2, -1)
    pairs = np.unique(np.sort(np.stack([of_entry[entry], by], axis=1), axis=1), axis=0)
    chosen: list[int] = []
    while len(pairs):
        most = int(np.argmax(np.bincount(pairs.ravel(), minlength=len(unknowns))))
        chosen.append(most)
        pairs = pairs[(pairs != most).all(axis=1)]
    return [unknowns[i] for i in sorted(chosen)]


def _tests(rows: list[Equation], torn: list[Unknown], rest: list[Unknown]) -> list[Equation]:
    """The equations that are left over when each remaining unknown has got one, best one that gives it explicitly."""
    if not rest:
        return list(rows)
    z = column([u.symbol for u in rest])
    entries = _entries(rows, z)
    places = list(zip(*entries.sparsity().get_triplet(), strict=True))
    curved = set(zip(*ca.jacobian_sparsity(entries.nz[:], z).get_triplet(), strict=True))
    own, kept = ({u.symbol.element_hash(): j for j, u in enumerate(group)} for group in (rest, torn))
    costs = np.empty(len(places))
    for k, (i, j) in enumerate(places):
        sides = [side.element_hash() for side in (rows[i].lhs, rows[i].rhs) if side.is_symbolic()]
        costs[k] = NONLINEAR if (k, j) in curved else LINEAR
        if any(own.get(side) == j for side in sides):
            costs[k] = EXPLICIT
        if any(side in kept for side in sides):
            costs[k] += DEFINES_TORN
    row, col = np.array(places, dtype=int).reshape(-1, 2).T
    graph = csr_matrix((costs, (col, row)), shape=(len(rest), len(rows)))
    taken = set(min_weight_full_bipartite_matching(graph)[1].tolist())
    return [row for i, row in enumerate(rows) if i not in taken]


def _entries(rows: list[Equation], z: Any) -> Any:
    """Derivatives of the residuals of some equations."""
    return ca.jacobian(column([r.residual for r in rows]), z)


def inline(expression: Any, solution: Solution) -> Any:
    """An expression column with all definitions of a solution put in.

    Args:
        expression: a column (n)
        solution: the definitions
    """
    if not solution.symbols:
        return expression
    _, (result,) = ca.substitute_inplace(solution.symbols, solution.definitions, [expression], False)
    return result


def scaled_residual(solution: Solution, residual: Any) -> tuple[Any, tuple[str, ...]]:
    """Residuals of the tests in units of what typical deviations of the torn unknowns make of them, and their names.

    They are put in the order in which each depends on its own torn unknown, so that the diagonal of their Jacobian is
    where elimination may begin.

    Args:
        solution: its torn unknowns and their definitions
        residual: of the tests (SX, k)
    """
    if not solution.torn:
        return residual, ()
    nominals = np.array([u.nominal for u in solution.torn])
    matrix = ca.jacobian(residual, column([u.symbol for u in solution.torn]))
    typical = dict(solution.typical) | {u.symbol.element_hash(): start_of(u) for u in solution.torn}
    rows, columns = matrix.sparsity().get_triplet()
    size = np.zeros(matrix.shape)
    size[rows, columns] = np.abs(typical_sizes(matrix, typical)) * nominals[columns]
    whole = size.sum(axis=1, keepdims=True)
    whole[whole == 0.0] = 1.0
    cost = np.full(matrix.shape, ABSENT)
    cost[rows, columns] = -np.log(np.maximum(size / whole, 1e-300)[rows, columns])
    _, test = linear_sum_assignment(cost.T)
    return residual[test.tolist()] / ca.DM(whole[test]), tuple(solution.tests[i].name for i in test)


def start_of(unknown: Unknown) -> float:
    """Where an iteration for an unknown starts: its guess, or its typical size."""
    return unknown.nominal if unknown.guess is None else unknown.guess


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


def pattern_of(columns: Sequence[Sequence[int]]) -> Any:
    """The square CasADi sparsity of rows with entries in some columns each."""
    row = [i for i, places in enumerate(columns) for _ in places]
    return ca.Sparsity.triplet(len(columns), len(columns), row, [j for places in columns for j in places])
