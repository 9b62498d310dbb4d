"""From solved states to a result: outputs, laws outside their range, laws at work."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..core.flat import FlatModel
from ..errors import SolveError
from ..sources import LawInfo
from .algebra import algebra
from .result import Audit, Result, imbalance, list_unsolved, out_of_range, outside


def evaluate(
    flat: FlatModel, x: np.ndarray, u: np.ndarray, p: np.ndarray, warm: np.ndarray | None = None
) -> dict[str, np.ndarray]:
    """All output expressions, a column per row of the result, the implicit blocks solved.

    Args:
        flat: the model
        x: states, n_x by rows
        u: inputs, n_u by rows
        p: parameters, n_p by rows, or n_p
        warm: algebraic variables to begin with, n_z by rows

    Returns:
        "ode", "y", "residual", "supply", "throughput", "stored", "checked", "imbalance", each with one column per row

    Raises:
        SolveError: an implicit block has no solution
    """
    function, rows = flat.function, x.shape[1]
    p = p if p.ndim == 2 else np.tile(p[:, None], (1, rows))
    point = (x, algebra(flat).solve_rows(x, u, p, warm), u, p)
    values = function(*point) if rows > 1 else function(*(v[:, 0] for v in point))
    return {name: np.array(value) for name, value in zip(function.name_out(), values, strict=True)}


def evaluate_at(flat: FlatModel, x: np.ndarray, u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
    """The same at one point, each a vector.

    Args:
        flat: the model
        x, u, p: states, inputs and parameters, SI

    Raises:
        SolveError: an implicit block has no solution
    """
    values = evaluate(flat, *(np.asarray(v, dtype=float)[:, None] for v in (x, u, p)))
    return {name: value[:, 0] for name, value in values.items()}


def result(
    flat: FlatModel,
    kind: str,
    index: np.ndarray,
    x: np.ndarray,
    u: np.ndarray,
    evaluated: dict[str, np.ndarray],
    audit: Audit,
    tolerance: float = 0.0,
) -> Result:
    """One result from states, inputs and what `evaluate` made of them, audited.

    Args:
        flat: the model
        kind: "steady" or "transient"
        index: number or time of each row
        x, u: states and inputs, a column per row
        evaluated: what `evaluate` found there
        audit: energy of the whole run
        tolerance: of the integration

    Raises:
        SolveError: energy is not conserved, an implicit equation does not hold, an output is out of its range
    """
    groups = ((flat.states, x), (flat.inputs, u), (flat.outputs, evaluated["y"]))
    columns = {q.name: row for quantities, values in groups for q, row in zip(quantities, values, strict=True)}
    rows = zip(flat.residual_names, evaluated["residual"], strict=True)  # in units of their nominals
    implicit = {name: float(np.max(np.abs(row))) for name, row in rows}
    problems = [*out_of_range(flat, columns), *list_unsolved(implicit), *imbalance(flat, evaluated, audit, tolerance)]
    if problems:
        raise SolveError([f"{kind}: {problem}" for problem in problems])
    return Result(
        model=flat.name,
        kind=kind,
        index=index,
        columns=columns,
        units={name: flat.quantity(name).unit for name in columns},
        audit=audit,
        outside=outside(flat, evaluated),
        laws=cite_laws(flat.laws),
        implicit=implicit,
    )


def cite_laws(laws: Iterable[LawInfo]) -> tuple[str, ...]:
    """The laws at work with the place they come from, each once, in the order of use."""
    return tuple(dict.fromkeys(f"{law.name} ({law.source}, {law.where})" for law in laws))
