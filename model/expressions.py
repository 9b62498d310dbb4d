"""The direct way to CasADi's arithmetic on SX expressions.

CasADi's operators and functions ask of each operand whether it is a number, a matrix of numbers or an expression, by
some calls back into Python: 30 us, of which the operation itself takes 2. `shorten` gives operands that are expressions
or plain numbers the direct way, to the same expressions; all others go CasADi's own way.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import Any

import casadi as ca

#: Operators, by the names of their methods -> operation; those of arithmetic have a reflected one.
ARITHMETIC = {"add": ca.OP_ADD, "sub": ca.OP_SUB, "mul": ca.OP_MUL, "truediv": ca.OP_DIV, "pow": ca.OP_POW}
COMPARISON = {"lt": ca.OP_LT, "le": ca.OP_LE, "eq": ca.OP_EQ, "ne": ca.OP_NE}
#: Functions of one and of two operands.
ONE = ("sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "fabs", "floor")
TWO = ("fmin", "fmax", "atan2", "fmod")
#: Types of operands that go the direct way.
DIRECT = (ca.SX, float, int)
_Way = Callable[..., Any]


@cache
def shorten() -> None:
    """Give all operators and functions of this module the direct way, once in a process."""
    for name, operation in ARITHMETIC.items():
        for method, swapped in ((f"__{name}__", False), (f"__r{name}__", True)):
            setattr(ca.SX, method, _of_two(operation, getattr(ca.SX, method), swapped))
    for name, operation in COMPARISON.items():
        setattr(ca.SX, f"__{name}__", _of_two(operation, getattr(ca.SX, f"__{name}__")))
    for name in ONE:
        setattr(ca, name, _of_one(getattr(ca, f"OP_{name.upper()}"), getattr(ca, name)))
    for name in TWO:
        setattr(ca, name, _of_two(getattr(ca, f"OP_{name.upper()}"), getattr(ca, name)))


def as_expression(x: Any) -> Any:
    """An operand as an expression; one that is an expression as it is, which CasADi would copy with as many questions.

    Args:
        x: a number, a matrix of numbers or an expression
    """
    return x if type(x) is ca.SX else ca.SX(x)


def _of_one(operation: int, way: _Way) -> _Way:
    """A function of one expression, `way` for what is none."""

    @wraps(way)
    def direct(x: Any) -> Any:
        return ca.SX.unary(operation, x) if type(x) is ca.SX else way(x)

    return direct


def _of_two(operation: int, way: _Way, swapped: bool = False) -> _Way:
    """A function of two expressions or of one and a number, `way` for all else; `swapped` takes the last first."""

    @wraps(way)
    def direct(x: Any, y: Any) -> Any:
        if type(x) in DIRECT and type(y) in DIRECT and (type(x) is ca.SX or type(y) is ca.SX):
            return ca.SX.binary(operation, y, x) if swapped else ca.SX.binary(operation, x, y)
        return way(x, y)

    return direct
