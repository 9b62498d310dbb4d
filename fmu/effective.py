"""The parameters of a model that have an effect: only these become parameters of an FMU."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate
from typing import Any

import casadi as ca

from ..model.core.flat import FlatModel
from ..model.run.fast import once

#: Operations through which a parameter acts although the derivative is zero: it decides when something happens.
_SWITCHES = frozenset(
    getattr(ca, f"OP_{name}")
    for name in ("LT", "LE", "EQ", "NE", "NOT", "AND", "OR", "FLOOR", "CEIL", "FMOD", "SIGN", "IF_ELSE_ZERO")
)


def effective(flat: FlatModel, start: Mapping[str, float] | None = None) -> FlatModel:
    """The model without the parameters that cannot move any rate, output, checked argument or relation.

    A parameter goes where the model does not hold it, or where its derivative is zero as an expression, as that of a
    share of heat whose two ways end in one body. One that has no effect only at the present values stays.

    Args:
        flat: the model
        start: values that replace those of the model; a parameter that goes is replaced by its value
    """
    parts, column = _parts(flat)
    moving = _moving(flat)
    kept = [i for i in range(len(flat.parameters)) if i in moving]
    if len(kept) == len(flat.parameters):
        return flat
    values = {q.name: q.start for q in flat.parameters} | dict(start or {})
    old = ca.vertsplit(flat.p)
    symbols = {i: ca.SX.sym(flat.parameters[i].name) for i in kept}
    new = [symbols.get(i, ca.SX(values[q.name])) for i, q in enumerate(flat.parameters)]
    column = ca.substitute(column, ca.vertcat(*old), ca.vertcat(*new))
    sizes = [0, *accumulate(ca.SX(part).numel() for part in parts)]
    ode, y, residual, supply, throughput, stored, checked, related = ca.vertsplit(column, sizes)
    return replace(
        flat,
        parameters=tuple(flat.parameters[i] for i in kept),
        p=ca.vertcat(ca.SX(0, 1), *symbols.values()),
        **{"ode": ode, "y": y, "residual": residual, "supply": supply},
        **{"throughput": throughput, "stored": stored, "checked": checked, "related": related},
        balanced=(),
        imbalance=ca.SX(0, 1),
    )


def _parts(flat: FlatModel) -> tuple[list[Any], Any]:
    """All expressions of a model, and one column of them."""
    parts = [flat.ode, flat.y, flat.residual, flat.supply, flat.throughput, flat.stored, flat.checked, flat.related]
    return parts, ca.vertcat(ca.SX(0, 1), *(ca.SX(part) for part in parts))


@once
def _moving(flat: FlatModel) -> set[int]:
    """Positions of the parameters with an effect."""
    p, (_, column) = flat.p, _parts(flat)
    held = _columns(ca.jacobian_sparsity(column, p))
    moving = _columns(ca.sparsify(ca.jacobian(ca.cse(column), p)).sparsity())
    return moving | _switching(column, p) if held - moving else moving


def _columns(sparsity: Any) -> set[int]:
    """Columns that hold anything."""
    return set(sparsity.get_triplet()[1])


def _switching(column: Any, p: Any) -> set[int]:
    """Positions of the parameters that reach a comparison or another operation without a useful derivative."""
    own = {q.element_hash() for q in ca.vertsplit(p)}
    rest = [s for s in ca.symvar(column) if s.element_hash() not in own]
    f = ca.Function("model", [p, ca.vertcat(ca.SX(0, 1), *rest)], [column])
    reached: dict[int, frozenset[int]] = {}
    found: set[int] = set()
    for k in range(f.n_instructions()):
        operation, takes, gives = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if operation == ca.OP_INPUT:
            reached[gives[0]] = frozenset({takes[1]}) if takes[0] == 0 else frozenset()
        elif operation != ca.OP_OUTPUT:
            on = frozenset[int]().union(*(reached.get(i, frozenset()) for i in takes))
            reached[gives[0]] = on
            if operation in _SWITCHES:
                found |= on
    return found
