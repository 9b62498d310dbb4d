"""The equations of a part, collected: what goes wrong inside them is told by part and equation, without a traceback."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca

from ..errors import GearheatError, StructureError, suggestion
from ..expressions import as_expression
from .component import Component, Equation
from .solve import Unknown, column

#: The place in its own sources that CasADi puts before a message.
PLACE = re.compile(r"^\S+\.[ch]pp:\d+: ")
#: What CasADi says where Python has to decide by the value of a symbol.
UNDECIDED = ("truth value", "__bool__")
#: What CasADi says of an argument that is neither a number nor a symbol.
KIND = "Wrong number or type of arguments"


def rows_of(part: Component) -> list[Equation]:
    """The equations of a part, named "part: equation".

    Args:
        part: the part

    Raises:
        StructureError: the part has no equations, names what it does not declare, decides by the value of a symbol, or
            gives a side that is no scalar; with the equation behind which that happens
    """
    rows: list[Equation] = []
    try:
        for e in part.equations():
            rows.append(_row(part, e))
    except GearheatError:
        raise
    except Exception as error:  # whatever a part's author got wrong
        after = f'after equation "{rows[-1].name.partition(": ")[2]}" of ' if rows else ""
        raise StructureError(_describe_error(part, f"{part.name}: {after}{type(part).__name__}", error)) from None
    if not rows and (part.ports or part.symbols):
        raise StructureError(
            f"{part.name}: {type(part).__name__} has no equations. Write a method equations() that yields one for each "
            "of its unknowns."
        )
    return rows


def _row(part: Component, e: Equation) -> Equation:
    for side in (e.lhs, e.rhs):
        if as_expression(side).numel() != 1:
            shape = " x ".join(map(str, ca.SX(side).shape))
            raise StructureError(
                f'{part.name}: a side of equation "{e.name}" has the shape {shape}. Each side is one number: yield an '
                "equation for every component."
            )
    return replace(e, name=f"{part.name}: {e.name}")


def energies_of(part: Component) -> tuple[list[Any], Any]:
    """Powers that enter the model through a part [W], and the energy it stores [J].

    Args:
        part: the part

    Raises:
        StructureError: as `rows_of`
    """
    try:
        return list(part.supplied_power()), part.stored_energy()
    except GearheatError:
        raise
    except Exception as error:  # whatever a part's author got wrong
        where = f"{part.name}: supplied_power or stored_energy of {type(part).__name__}"
        raise StructureError(_describe_error(part, where, error)) from None


def _describe_error(part: Component, where: str, error: Exception) -> str:
    """An error inside the equations of a part in words."""
    if isinstance(error, KeyError | AttributeError) and (missing := _find_undeclared(part, error)):
        if missing == "equations":
            return f"{where} has no equations. Write a method equations() that yields them."
        known = [*part.symbols, *part.ports, *part.choices]
        return (
            f'{where}: "{missing}" is not declared, or not there under its choices.{suggestion(missing, known)} '
            f"Declare it in the class (Parameter, Variable, ...) or correct the name."
        )
    if any(words in str(error) for words in UNDECIDED):
        return (
            f"{where}: Python has to decide by the value of a symbol (if, and, or, max), which it does not have yet. "
            "Use smooth functions (gearheat.model.laws.smooth) or casadi.if_else, or a Choice."
        )
    if KIND in str(error):
        return f"{where}: a side or an argument is neither a number nor a symbol. Yield one equation for every number."
    said = PLACE.sub("", str(error).strip()) or type(error).__name__
    return f"{where}: {' '.join(said.split()).rstrip('.')}. Correct what follows: its sides are scalars."


def _find_undeclared(part: Component, error: KeyError | AttributeError) -> str:
    """The name that was asked for and is not there."""
    if isinstance(error, KeyError):
        return str(error.args[0]) if error.args else ""
    if "has no equations" in str(error):
        return "equations"
    return str(error.name) if error.obj is part else ""


def check_symbols(rows: Sequence[Equation], unknowns: Sequence[Unknown], parts: Sequence[Component]) -> None:
    """Refuse equations that cannot be solved whatever their structure.

    No number comes of functions that take a symbol for a number (`math.sqrt`).

    Args:
        rows: the equations
        unknowns: what they are solved for
        parts: the components, with what each declares

    Raises:
        StructureError: an equation holds a symbol that no part declares, or no number
    """
    known = {u.symbol.element_hash() for u in unknowns}
    known |= {s.element_hash() for part in parts for s in (*part.symbols.values(), *part.derivatives.values())}
    whole = column([r.residual for r in rows])
    strange = {s.element_hash() for s in ca.symvar(whole)} - known
    if strange:
        held = {s: r for r in rows for s in ca.symvar(as_expression(r.residual)) if s.element_hash() in strange}
        raise StructureError(
            [
                f'{r.name}: the symbol "{s.name()}" is not declared by any part. Declare it in the class (Parameter, '
                "Variable, Input, ...), or take it from a port."
                for s, r in held.items()
            ]
        )
    if _no_number(whole):
        raise StructureError(
            [
                f"{r.name}: a side is not a number. Use CasADi's functions (casadi.sqrt, not math.sqrt) on symbols."
                for r in rows
                if _no_number(r.residual)
            ]
        )


def _no_number(expression: Any) -> bool:
    """Whether a constant in an expression is not a number."""
    f = ca.Function("f", [column(ca.symvar(as_expression(expression)))], [expression])
    constants = (k for k in range(f.n_instructions()) if f.instruction_id(k) == ca.OP_CONST)
    return any(math.isnan(f.instruction_constant(k)) for k in constants)
