"""The direct way to CasADi's arithmetic ends where its own way does; a part of equal values is made once."""

import operator
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from for_each import for_each
from gearheat.model import expressions
from gearheat.model.core.component import make
from gearheat.model.errors import ScenarioError
from small_parts import Conductor

expressions.shorten()
OPERATORS = {name: getattr(operator, name) for name in (*expressions.ARITHMETIC, *expressions.COMPARISON)}
FUNCTIONS = {name: getattr(ca, name) for name in (*expressions.ONE, *expressions.TWO)}
X, Y = ca.SX.sym("x"), ca.SX.sym("y", 2)
#: Expressions, also constant and sparse ones, and what stands beside them.
LEFT = (X, Y, X * X + 1, ca.SX(0.0), ca.SX(2.0), ca.SX(ca.Sparsity.lower(2)))
RIGHT = (*LEFT, 2.0, 0, 0.5, -1.5, float("inf"))


def own(name: str) -> Callable[..., Any]:
    """CasADi's own operator or function."""
    given = getattr(ca.SX, f"__{name}__", None) if name in OPERATORS else FUNCTIONS[name]
    return given.__wrapped__  # type: ignore[no-any-return]


def text(found: Any) -> str:
    return f"{found} {ca.SX(found).sparsity()}"


def agree(direct: Callable[..., Any], way: Callable[..., Any], *operands: Any) -> None:
    try:
        wanted = text(way(*operands))
    except RuntimeError:
        with pytest.raises(RuntimeError):
            direct(*operands)
    else:
        assert text(direct(*operands)) == wanted


@for_each(OPERATORS)
def test_operators(name: str) -> None:
    for x in LEFT:
        for y in RIGHT:
            agree(OPERATORS[name], own(name), x, y)
            if name in expressions.ARITHMETIC and not isinstance(y, ca.SX):
                agree(OPERATORS[name], lambda a, b: getattr(ca.SX, f"__r{name}__").__wrapped__(b, a), y, x)


@for_each(expressions.ONE)
def test_functions_of_one(name: str) -> None:
    for x in (*LEFT, 0.5, np.array([0.2, 0.3]), ca.DM(0.5)):
        agree(FUNCTIONS[name], own(name), x)


@for_each(expressions.TWO)
def test_functions_of_two(name: str) -> None:
    for x in LEFT:
        for y in RIGHT:
            agree(FUNCTIONS[name], own(name), x, y)
            agree(FUNCTIONS[name], own(name), y, x)
    assert FUNCTIONS[name](0.5, 2.0) == own(name)(0.5, 2.0)


@for_each([np.array([1.0, 2.0]), np.float64(2.0), ca.DM(2.0)])
def test_other_operands_go_casadis_own_way(other: Any) -> None:
    for name, direct in OPERATORS.items():
        assert str(direct(Y, other)) == str(own(name)(Y, other))


def test_a_part_is_made_once_of_equal_values() -> None:
    first = make(Conductor, "foot", {"G": 3.0})
    assert make(Conductor, "foot", {"G": 3.0}) is first and first.values["G"] == 3.0
    for other in (make(Conductor, "foot", {"G": 4.0}), make(Conductor, "wall", {"G": 3.0})):
        assert other is not first
    for _ in range(2):  # what is refused is refused again
        with pytest.raises(ScenarioError, match="G is missing"):
            make(Conductor, "foot", {})
