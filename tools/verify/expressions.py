"""Expressions in named values, as tables of published numbers write them: arithmetic, comparisons and a few functions.

"P_loss / carrier.P", "max(mu) < 0.05" and "slope(alphaA_W_K, T_oil_C - T_amb_C)" are expressions. Nothing but numbers,
names, the operators and the functions below is known, so a file of numbers cannot run a program.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np


def _line(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.polyfit(x, y, 1)


def _misfit(y: np.ndarray, x: np.ndarray) -> float:
    return float(np.linalg.norm(y - np.polyval(_line(y, x), x)))


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "min": np.min,
    "max": np.max,
    "mean": np.mean,
    "sum": np.sum,
    "abs": np.abs,
    "all": np.all,
    "any": np.any,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "radians": np.radians,
    "increasing": lambda x: bool(np.all(np.diff(x) > 0)),
    "decreasing": lambda x: bool(np.all(np.diff(x) < 0)),
    "slope": lambda y, x: _line(y, x)[0],
    "intercept": lambda y, x: _line(y, x)[1],
    "misfit": _misfit,  # norm of what a straight line through y over x leaves
}
CONSTANTS: Mapping[str, float] = {"pi": float(np.pi)}
OPERATORS: Mapping[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.USub: operator.neg,
    ast.Invert: operator.invert,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
}


def evaluate(text: str, value_of: Callable[[str], Any]) -> Any:
    """The value of an expression: a number, a truth value, or an array of either.

    Args:
        text: the expression
        value_of: name, dotted or not, -> number or array

    Raises:
        ValueError: it is no expression, with what is wrong
    """
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        raise ValueError(f'"{text}" is no expression. Write for example "oil.T - room.T"') from None
    with np.errstate(all="ignore"):
        return _Evaluation(text, value_of).of(tree)


class _Evaluation:
    """One evaluation, node by node."""

    def __init__(self, text: str, value_of: Callable[[str], Any]) -> None:
        self.text, self.value_of = text, value_of

    def of(self, node: ast.AST) -> Any:
        """The value of one node."""
        match node:
            case ast.Constant(value=int() | float()):
                found = node.value
            case ast.Name() | ast.Attribute():
                found = self._named(node)
            case ast.Call(func=ast.Name(id=name), keywords=[]) if name in FUNCTIONS:
                found = FUNCTIONS[name](*map(self.of, node.args))
            case ast.UnaryOp(op=op) if type(op) in OPERATORS:
                found = OPERATORS[type(op)](self.of(node.operand))
            case ast.BinOp(op=op) if type(op) in OPERATORS:
                found = OPERATORS[type(op)](self.of(node.left), self.of(node.right))
            case ast.Compare():
                found = self._compared(node)
            case ast.Subscript(slice=ast.Slice() as part):
                ends = [end and self.of(end) for end in (part.lower, part.upper, part.step)]
                found = self.of(node.value)[slice(*ends)]
            case ast.Subscript():
                found = self.of(node.value)[self.of(node.slice)]
            case _:
                names = ", ".join(FUNCTIONS)
                raise ValueError(f'"{ast.unparse(node)}" in "{self.text}" is not known. Functions: {names}')
        return found

    def _named(self, node: ast.AST) -> Any:
        name = ast.unparse(node)
        return CONSTANTS[name] if name in CONSTANTS else self.value_of(name)

    def _compared(self, node: ast.Compare) -> Any:
        terms = [self.of(term) for term in (node.left, *node.comparators)]
        found: Any = True
        for op, left, right in zip(node.ops, terms, terms[1:], strict=False):
            if type(op) not in OPERATORS:
                raise ValueError(f'the comparison in "{self.text}" is not known. Write <, <=, >, >= or ==')
            found = found & OPERATORS[type(op)](left, right)
        return found
