"""An SX function of CasADi for thousands of columns at once: every instruction once, as a numpy operation."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

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
    "TWICE": lambda x, out: np.multiply(x, 2.0, out),
    "INV": np.reciprocal,
    "SIN": np.sin,
    "COS": np.cos,
    "TAN": np.tan,
    "ATAN": np.arctan,
    "TANH": np.tanh,
    "FABS": np.fabs,
    "FMIN": np.fmin,
    "FMAX": np.fmax,
    "SIGN": np.sign,
    "EQ": np.equal,
    "NE": np.not_equal,
    "LT": np.less,
    "LE": np.less_equal,
    "NOT": np.logical_not,
    "AND": np.logical_and,
    "OR": np.logical_or,
    "IF_ELSE_ZERO": lambda condition, x, out: np.copyto(out, np.where(np.asarray(condition) != 0, x, 0.0)),
}
_BY_CODE = {getattr(ca, f"OP_{name}"): operation for name, operation in _OPERATIONS.items()}


class Columns:
    """A function of dense vectors, for m columns.

    Raises:
        NotImplementedError: an operation of the function has no counterpart in numpy
    """

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
            elif code in _BY_CODE:
                values = tuple(now[i] for i in takes)
                now[gives[0]] = work[gives[0]]
                self._program.append((_BY_CODE[code], (*values, now[gives[0]])))
            else:
                raise NotImplementedError(f"{function.name()}: CasADi operation {code} has no counterpart in numpy")

    def __call__(self, *inputs: np.ndarray) -> list[np.ndarray]:
        """Outputs (rows, m) for inputs (rows, m)."""
        for own, given in zip(self._in, inputs, strict=True):
            own[:] = given
        with np.errstate(all="ignore"):
            for operation, arguments in self._program:
                operation(*arguments)
        return [out.copy() for out in self._out]
