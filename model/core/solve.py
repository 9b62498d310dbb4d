"""Symbolic solution of a square system of residuals, block by block.

The block-triangular form sorts the system. A block of one unknown that enters linearly is solved by hand; a larger
linear block by sparse elimination; a block that stays implicit is torn at the unknowns that carry a guess (losses,
which start at zero) and solved by a few unrolled Newton steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from ..errors import StructureError
from .eliminate import Factors, Singular, typical_sizes

NEWTON_STEPS = 3


@dataclass(frozen=True, eq=False)
class Unknown:
    """One unknown: symbol, name, typical size, and where Newton may start (None: never torn)."""

    symbol: Any
    name: str
    nominal: float = 1.0
    guess: float | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """One equation, lhs = rhs, with its name."""

    name: str
    lhs: Any
    rhs: Any

    @property
    def residual(self) -> Any:
        """lhs - rhs."""
        return self.lhs - self.rhs


@dataclass
class Solution:
    """Definitions in the order in which they can be evaluated, and the residuals that implicit blocks leave.

    `typical` holds a typical value of every symbol by its hash: it only steers the choice of pivots. Implicit blocks
    take `newton_steps` steps.
    """

    typical: Mapping[int, float]
    newton_steps: int = NEWTON_STEPS
    symbols: list[Any] = field(default_factory=list)
    definitions: list[Any] = field(default_factory=list)
    residuals: list[tuple[str, Any]] = field(default_factory=list)

    def define(self, symbol: Any, definition: Any) -> None:
        """Append one definition; it may use known symbols and those defined before."""
        self.symbols.append(symbol)
        self.definitions.append(definition)


def column(items: Sequence[Any]) -> Any:
    """A CasADi column of scalars, also of none."""
    return ca.vertcat(*items) if items else ca.SX(0, 1)


def incidence(rows: Sequence[Row], unknowns: Sequence[Unknown]) -> Any:
    """Sparsity of the residuals in the unknowns."""
    return ca.jacobian_sparsity(column([r.residual for r in rows]), column([u.symbol for u in unknowns]))


def solve(model: str, rows: Sequence[Row], unknowns: Sequence[Unknown], solution: Solution) -> None:
    """Add the definitions of all unknowns to a solution. The system must be structurally sound.

    Raises:
        StructureError: an implicit block has no unknown with a guess
    """
    _, row_order, column_order, row_blocks, column_blocks, _, _ = incidence(rows, unknowns).btf()
    for first, last, left, right in zip(row_blocks, row_blocks[1:], column_blocks, column_blocks[1:], strict=False):
        block_rows = [rows[i] for i in row_order[first:last]]
        block_unknowns = [unknowns[i] for i in column_order[left:right]]
        _solve_block(model, block_rows, block_unknowns, solution)


def _solve_block(model: str, rows: list[Row], unknowns: list[Unknown], solution: Solution) -> None:
    z = column([u.symbol for u in unknowns])
    if len(rows) == 1 and (definition := _explicit(rows[0], z)) is not None:
        solution.define(z, definition)
        return
    residual = column([r.residual for r in rows])
    matrix = ca.jacobian(residual, z)
    if not ca.depends_on(matrix, z):
        _eliminate(model, matrix, ca.substitute(residual, z, ca.SX.zeros(*z.shape)), unknowns, solution)
    else:
        _newton(model, rows, unknowns, solution)


def _explicit(row: Row, z: Any) -> Any:
    """The other side where one side is the unknown itself, else None."""
    for side, other in ((row.lhs, row.rhs), (row.rhs, row.lhs)):
        if ca.is_equal(ca.SX(side), z, 0) and not ca.depends_on(other, z):
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


def _newton(model: str, rows: list[Row], unknowns: list[Unknown], solution: Solution) -> None:
    """Tear the block at its unknowns with a guess, sort the rest, and iterate on the torn ones."""
    torn, tests, rest_rows, rest = _tear(model, rows, unknowns)
    inner = Solution(solution.typical, solution.newton_steps)
    if rest:
        solve(model, rest_rows, rest, inner)
    z = column([u.symbol for u in torn])
    (residual,) = _inline([r.residual for r in tests], inner)
    outer = column([s for s in ca.symvar(residual) if not ca.depends_on(s, z)])
    jacobian = ca.jacobian(residual, z)
    step = ca.Function("step", [z, outer], [residual, jacobian], {"cse": True})
    value = ca.SX([u.guess for u in torn])
    for _ in range(solution.newton_steps):
        r, j = step(value, outer)
        value = value - _linear_solve(model, j, r, torn, solution.typical)
    left, _ = step(value, outer)
    scale = [u.nominal for u in torn]
    solution.residuals += [(row.name, left[k] / scale[k]) for k, row in enumerate(tests)]
    for k, unknown in enumerate(torn):
        solution.define(unknown.symbol, value[k])
    for symbol, definition in zip(inner.symbols, inner.definitions, strict=True):
        solution.define(symbol, definition)
    solution.residuals += inner.residuals


def _tear(
    model: str, rows: list[Row], unknowns: list[Unknown]
) -> tuple[list[Unknown], list[Row], list[Row], list[Unknown]]:
    """Torn unknowns with the equations that define them (lhs is the unknown), and what remains of the block.

    A block of one unknown is torn at it, from its guess or its nominal.
    """
    if len(rows) == 1:
        u = unknowns[0]
        return [Unknown(u.symbol, u.name, u.nominal, u.nominal if u.guess is None else u.guess)], rows, [], []
    defining = {r.lhs.element_hash(): r for r in rows if r.lhs.is_symbolic()}
    torn = [u for u in unknowns if u.guess is not None and u.symbol.element_hash() in defining]
    if not torn:
        names = ", ".join(r.name for r in rows[:5])
        raise StructureError(
            f"{model}: the equations {names} are implicit and nonlinear. Give one of their unknowns a guess."
        )
    tests = [defining[u.symbol.element_hash()] for u in torn]
    return torn, tests, [r for r in rows if r not in tests], [u for u in unknowns if u not in torn]


def _inline(expressions: list[Any], solution: Solution) -> list[Any]:
    """Expressions with all definitions of a solution put in, as one column in a list."""
    stacked = column(expressions)
    if not solution.symbols:
        return [stacked]
    _, (result,) = ca.substitute_inplace(solution.symbols, solution.definitions, [stacked], False)
    return [result]


def _linear_solve(model: str, matrix: Any, right: Any, unknowns: list[Unknown], typical: Mapping[int, float]) -> Any:
    """z of matrix z = right, with the same elimination as a linear block."""
    stand_in = [Unknown(ca.SX.sym(u.name), u.name) for u in unknowns]
    solution = Solution(typical)
    _eliminate(model, matrix, -right, stand_in, solution)
    return _inline([u.symbol for u in stand_in], solution)[0]


def inline(expression: Any, solution: Solution) -> Any:
    """An expression column with all definitions of a solution put in."""
    return _inline([expression], solution)[0]
