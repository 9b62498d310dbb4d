"""A scalar CasADi function as one straight-line C function over plain arrays."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import casadi as ca
from gearheat.model.errors import FmuError

#: C text of each scalar operation, by the name of CasADi's code.
_OPERATIONS = {
    "ASSIGN": "{0}",
    "ADD": "{0}+{1}",
    "SUB": "{0}-{1}",
    "MUL": "{0}*{1}",
    "DIV": "{0}/{1}",
    "NEG": "-{0}",
    "EXP": "exp({0})",
    "LOG": "log({0})",
    "POW": "pow({0},{1})",
    "CONSTPOW": "pow({0},{1})",
    "SQRT": "sqrt({0})",
    "SQ": "{0}*{0}",
    "TWICE": "{0}+{0}",
    "SIN": "sin({0})",
    "COS": "cos({0})",
    "TAN": "tan({0})",
    "ASIN": "asin({0})",
    "ACOS": "acos({0})",
    "ATAN": "atan({0})",
    "LT": "{0}<{1}",
    "LE": "{0}<={1}",
    "EQ": "{0}=={1}",
    "NE": "{0}!={1}",
    "NOT": "{0}==0",
    "AND": "{0}!=0&&{1}!=0",
    "OR": "{0}!=0||{1}!=0",
    "FLOOR": "floor({0})",
    "CEIL": "ceil({0})",
    "FMOD": "fmod({0},{1})",
    "FABS": "fabs({0})",
    "SIGN": "({0}>0)-({0}<0)",
    "COPYSIGN": "copysign({0},{1})",
    "IF_ELSE_ZERO": "{0}!=0?{1}:0",
    "ERF": "erf({0})",
    "FMIN": "fmin({0},{1})",
    "FMAX": "fmax({0},{1})",
    "INV": "1/{0}",
    "SINH": "sinh({0})",
    "COSH": "cosh({0})",
    "TANH": "tanh({0})",
    "ASINH": "asinh({0})",
    "ACOSH": "acosh({0})",
    "ATANH": "atanh({0})",
    "ATAN2": "atan2({0},{1})",
    "LOG1P": "log1p({0})",
    "EXPM1": "expm1({0})",
    "HYPOT": "hypot({0},{1})",
    "LIFT": "{0}",
}
#: Where the text for vectors is more than the same with the functions of wrapper/lanes.h.
_OF_LANES = {
    "LT": "lanes_true({0}<{1})",
    "LE": "lanes_true({0}<={1})",
    "EQ": "lanes_true({0}=={1})",
    "NE": "lanes_true({0}!={1})",
    "NOT": "lanes_true({0}==0)",
    "AND": "lanes_true(({0}!=0)&({1}!=0))",
    "OR": "lanes_true(({0}!=0)|({1}!=0))",
    "SIGN": "lanes_true({0}>0)-lanes_true({0}<0)",
    "IF_ELSE_ZERO": "lanes_only({0}!=0,{1})",
}
_FUNCTION_CALL = re.compile(r"^(?=[a-z])")


def _by_code(operations: Mapping[str, str]) -> dict[int, str]:
    return {getattr(ca, f"OP_{name}"): text for name, text in operations.items() if hasattr(ca, f"OP_{name}")}


#: Type of the numbers -> text of a constant, and of each operation by code.
_TEXTS = {
    "double": ("{0}", _by_code(_OPERATIONS)),
    "lanes": (
        "lanes_all({0})",
        _by_code({name: _FUNCTION_CALL.sub("lanes_", text) for name, text in _OPERATIONS.items()} | _OF_LANES),
    ),
}


def number(value: float) -> str:
    """A double as a C literal that reads back as the same double."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    text = repr(float(value))
    return f"({text})" if text.startswith("-") else text


def function(f: Any, prefix: str = "model_", kind: str = "double") -> str:
    """The C text of an SX function: static void prefix+name(const kind *in..., kind *out...).

    Args:
        f: the function
        prefix: what its name in C begins with
        kind: type of its numbers: double, or lanes for some rows side by side by wrapper/lanes.h

    Raises:
        FmuError: an operation has no C text
    """
    takes = [f"const {kind} *{f.name_in(i)}" for i in range(f.n_in())]
    gives = [f"{kind} *{f.name_out(i)}" for i in range(f.n_out())]
    shared = _shared_divisors(f)
    lines = [line for k in range(f.n_instructions()) for line in _instruction(f, k, shared, kind)]
    names = [f"a{i}" for i in range(f.sz_w())] + [name for name, first in shared.values() if first]
    declared = [f"  {kind} " + ", ".join(names[k : k + 20]) + ";" for k in range(0, len(names), 20)]
    read = {f.instruction_input(k)[0] for k in range(f.n_instructions()) if f.instruction_id(k) == ca.OP_INPUT}
    unused = [f"  (void){f.name_in(i)};" for i in range(f.n_in()) if i not in read]
    unused += [f"  (void){f.name_out(i)};" for i in range(f.n_out()) if f.nnz_out(i) == 0]
    head = f"static void {prefix}{f.name()}({', '.join(takes + gives)})"
    return "\n".join([head, "{", *declared, *unused, *lines, "}", ""])


def _shared_divisors(f: Any) -> dict[int, tuple[str, bool]]:
    """Division -> name of the reciprocal it multiplies by, and whether it is the first to use it.

    Only where several divide by the same value: derivatives repeat their function's divisors, and a division costs as
    much as several products.
    """
    version: dict[int, int] = {}  # a work variable holds one value after another
    users: dict[tuple[int, int], list[int]] = {}
    for k in range(f.n_instructions()):
        code = f.instruction_id(k)
        if code == ca.OP_DIV:
            divisor = f.instruction_input(k)[1]
            users.setdefault((divisor, version[divisor]), []).append(k)
        if code != ca.OP_OUTPUT:
            version[f.instruction_output(k)[0]] = k
    groups = [group for group in users.values() if len(group) > 1]
    return {k: (f"r{i}", k == group[0]) for i, group in enumerate(groups) for k in group}


def _instruction(f: Any, k: int, shared: Mapping[int, tuple[str, bool]], kind: str) -> list[str]:
    constant, texts = _TEXTS[kind]
    code, inputs, outputs = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
    if code == ca.OP_CONST:
        return [f"  a{outputs[0]}={constant.format(number(f.instruction_constant(k)))};"]
    if code == ca.OP_INPUT:
        return [f"  a{outputs[0]}={f.name_in(inputs[0])}[{inputs[1]}];"]
    if code == ca.OP_OUTPUT:
        return [f"  {f.name_out(outputs[0])}[{outputs[1]}]=a{inputs[0]};"]
    if code not in texts:
        raise FmuError(f"{f.name()}: CasADi operation {code} has no counterpart in C.")
    if k in shared:
        name, first = shared[k]
        reciprocal = [f"  {name}=1/a{inputs[1]};"] if first else []
        return [*reciprocal, f"  a{outputs[0]}=a{inputs[0]}*{name};"]
    return [f"  a{outputs[0]}={texts[code].format(*(f'a{i}' for i in inputs))};"]
