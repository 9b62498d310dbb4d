"""A scalar CasADi function for many columns at once.

Few columns are run one by one by CasADi; many share one numpy call for every instruction, which is several times
faster for hundreds of columns.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

#: Array function of each scalar operation, by the name of CasADi's code.
_OPERATIONS: dict[str, Any] = {
    "ASSIGN": np.positive,
    "ADD": np.add,
    "SUB": np.subtract,
    "MUL": np.multiply,
    "DIV": np.divide,
    "NEG": np.negative,
    "EXP": np.exp,
    "LOG": np.log,
    "LOG1P": np.log1p,
    "EXPM1": np.expm1,
    "POW": np.power,
    "CONSTPOW": np.power,
    "SQRT": np.sqrt,
    "SQ": np.square,
    "INV": np.reciprocal,
    "SIN": np.sin,
    "COS": np.cos,
    "TAN": np.tan,
    "ATAN": np.arctan,
    "ATAN2": np.arctan2,
    "TANH": np.tanh,
    "FABS": np.fabs,
    "SIGN": np.sign,
    "FMIN": np.fmin,
    "FMAX": np.fmax,
    "HYPOT": np.hypot,
    "LT": np.less,
    "LE": np.less_equal,
    "EQ": np.equal,
    "NE": np.not_equal,
    "NOT": np.logical_not,
    "AND": np.logical_and,
    "OR": np.logical_or,
}
_BY_CODE = {getattr(ca, f"OP_{name}"): operation for name, operation in _OPERATIONS.items()}

#: Operations of one argument that take it twice.
_TWICE = {ca.OP_TWICE: np.add}

#: Number of columns from which numpy is the faster one.
MANY = 64

#: Outputs (rows, columns) for inputs (rows, columns).
Evaluate = Callable[..., list[np.ndarray]]


@lru_cache(maxsize=32)
def over_columns(function: Any, m: int) -> Evaluate:
    """An SX function of dense vectors, for m columns; the latest ones are kept.

    Raises:
        NotImplementedError: an operation of the function has no counterpart in numpy
    """
    return Columns(function, m) if m >= MANY else Mapped(function, m)


class Mapped:
    """A function, run for one column after the other, without conversions."""

    def __init__(self, function: Any, m: int) -> None:
        self._function = function.map(m)
        self._buffer, self._call = self._function.buffer()
        self._in = [np.zeros((m, function.size1_in(i))) for i in range(function.n_in())]
        self._out = [np.zeros((m, function.size1_out(i))) for i in range(function.n_out())]
        for i, array in enumerate(self._in):
            self._buffer.set_arg(i, array.data)
        for i, array in enumerate(self._out):
            self._buffer.set_res(i, array.data)

    def __call__(self, *inputs: np.ndarray) -> list[np.ndarray]:
        """Outputs (rows, m) for inputs (rows, m)."""
        for own, given in zip(self._in, inputs, strict=True):
            own[:] = given.T
        self._call()
        return [out.T.copy() for out in self._out]


class Columns:
    """A function, run for all columns at once, one instruction after the other."""

    def __init__(self, function: Any, m: int) -> None:
        self._in = [np.zeros((function.size1_in(i), m)) for i in range(function.n_in())]
        self._out = [np.zeros((function.size1_out(i), m)) for i in range(function.n_out())]
        work = np.zeros((function.sz_w(), m))
        now: dict[int, Any] = {}  # work place -> where its value lies at this point of the program
        self._program: list[tuple[Any, tuple[Any, ...]]] = []
        for k in range(function.n_instructions()):
            code, takes, gives = (getattr(function, f"instruction_{what}")(k) for what in ("id", "input", "output"))
            if code == ca.OP_CONST:
                now[gives[0]] = float(function.instruction_constant(k))
            elif code == ca.OP_INPUT:
                now[gives[0]] = self._in[takes[0]][takes[1]]
            elif code == ca.OP_OUTPUT:
                self._program.append((np.positive, (now[takes[0]], self._out[gives[0]][gives[1]])))
            else:
                operation, values = _operation(function, code, [now[i] for i in takes])
                now[gives[0]] = work[gives[0]]
                self._program.append((operation, (*values, now[gives[0]])))

    def __call__(self, *inputs: np.ndarray) -> list[np.ndarray]:
        """Outputs (rows, m) for inputs (rows, m)."""
        for own, given in zip(self._in, inputs, strict=True):
            own[:] = given
        with np.errstate(all="ignore"):
            for operation, arguments in self._program:
                operation(*arguments)
        return [out.copy() for out in self._out]


def _operation(function: Any, code: int, values: list[Any]) -> tuple[Any, list[Any]]:
    """The array function of an instruction and its arguments."""
    if code in _TWICE:
        return _TWICE[code], values * 2
    if code == ca.OP_IF_ELSE_ZERO:
        return _if_else_zero, values
    if code not in _BY_CODE:
        raise NotImplementedError(f"{function.name()}: CasADi operation {code} has no counterpart in numpy")
    return _BY_CODE[code], values


def _if_else_zero(condition: Any, value: Any, out: np.ndarray) -> None:
    out[:] = np.where(np.asarray(condition) != 0, value, 0.0)
