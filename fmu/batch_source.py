"""The C sources of a batch: the model's functions, staged for many rows, and the fixed drivers over rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import casadi as ca

from ..model.core.flat import FlatModel
from . import emit, rosenbrock
from .equations import equations, full, hoist
from .fixed import wrapper
from .source import define_macros, newton_constants
from .variables import table

#: What a steady row holds behind the model's outputs: supply [W], throughput [W], law arguments outside their range,
#: largest residual of the implicit equations.
EXTRA = 4

#: Warm-ups choose their steps freely, which suits a method of higher order than that of an FMU with its short steps.
METHOD = rosenbrock.RODAS4


def steady_source(flat: FlatModel) -> str:
    """The C text for steady states: rows side by side in lanes, and one by one what is unusual.

    The equations come in three stages, each computed when what it depends on changes: `fixed` (p) -> first part of c,
    `given` (u, p, first part) -> second part, and `rates`, `equations` (with the Jacobian's entries that are not zero),
    `algebra` (the implicit ones and their Jacobian in z) and `outputs` of (x, z, u, p, c).

    Raises:
        FmuError: an operation has no C text
    """
    outside = sum((ca.logic_or(flat.checked[i] < c.low, flat.checked[i] > c.high) for i, c in enumerate(flat.checks)))
    implicit = ca.mmax(ca.fabs(ca.SX(flat.residual))) if flat.residual_names else 0
    whole = ca.vertcat(flat.ode, flat.residual)
    jacobian = ca.jacobian(whole, ca.vertcat(flat.x, flat.z))
    places = jacobian.sparsity().get_triplet()
    inner = ca.densify(ca.jacobian(flat.residual, flat.z))
    y = ca.vertcat(flat.y, flat.supply, flat.throughput, outside, implicit)
    parts, given, c_values = hoist([whole, jacobian.nz[:], y, flat.residual, inner[:]], ca.vertcat(flat.u, flat.p))
    whole, entries, y, residual, inner = parts
    (c_values,), fixed, k_values = hoist([c_values], flat.p)
    place, names = [flat.x, flat.z, flat.u, flat.p, ca.vertcat(fixed, given)], list("xzupc")
    functions = [
        full("fixed", [flat.p], [k_values], ["p"], ["k"]),
        full("given", [flat.u, flat.p, fixed], [c_values], ["u", "p", "k"], ["c"]),
        full("rates", place, [whole], names, ["r"]),
        full("equations", place, [whole, entries], names, ["r", "entries"]),
        full("algebra", place, [residual, inner], names, ["r", "J"]),
        full("outputs", place, [y], names, ["y"]),
    ]
    nk = fixed.numel()
    sizes = {**_sizes(flat), "NYR": y.numel(), "NK": nk, "NC": nk + given.numel(), "NJ": entries.numel()}
    pattern = [
        _array("int", f"model_{name}", map(str, place)) for name, place in zip(("row", "column"), places, strict=True)
    ]
    beside = [emit.function(f, "lanes_", "lanes") for f in functions if f.name() not in ("fixed", "rates")]
    generated = [*_ranges(flat), *pattern, *map(emit.function, functions), *beside]
    return _text(sizes, ["batch.h", "lanes.h"], generated, ["newton.c", "batch_steady.c", "batch_straight.c"])


def relations_source(flat: FlatModel) -> str:
    """The C text that judges rows of parameters; nothing where the model has no relations.

    Raises:
        FmuError: an operation has no C text
    """
    if not flat.relations:
        return ""
    limits = {"low": [r.low for r in flat.relations], "high": [r.high for r in flat.relations]}
    ends = [
        f"static const double model_relation_{end}[] = {{{', '.join(map(emit.number, numbers))}}};"
        for end, numbers in limits.items()
    ]
    above = [f"#define N_RELATIONS {len(flat.relations)}", wrapper("batch.h")]
    return "\n".join([*above, *ends, emit.function(flat.relation_function), wrapper("batch_relations.c")])


def warmup_source(flat: FlatModel, most_steps: int) -> str:
    """The C text for warm-ups: the equations of the FMU with its audit, and its solver.

    Args:
        flat: the model
        most_steps: steps after which it gives up between two points of the schedule or the output

    Raises:
        FmuError: an operation has no C text, or the stored energy depends on an input
    """
    model = equations(flat)
    x_new, z_new, error, slope, h = rosenbrock.step(model.ode, model.residual, model.x, model.z, model.u, METHOD)
    inner = ca.densify(ca.jacobian(model.residual, model.z))
    parts, c, c_values = hoist([x_new, z_new, error[:-1], model.y, model.ode, model.residual, inner[:]], model.p)
    x_new, z_new, error, y, ode, residual, inner = parts
    place, names = [model.x, model.z, model.u, model.p, c], list("xzupc")
    inputs, names_in = [model.x, model.z, model.u, slope, model.p, c, h], ["x", "z", "u", "slope", "p", "c", "h"]
    step = full("step", inputs, [x_new, z_new, error], names_in, ["x_new", "z_new", "error"])
    functions = [
        emit.function(full("constants", [model.p], [c_values], ["p"], ["c"])),
        emit.function(step, "lanes_", "lanes"),
        emit.function(full("algebra", place, [residual, inner], names, ["r", "J"])),
        emit.function(full("outputs", place, [y, ode], names, ["y", "dx"])),
    ]
    sizes = {**_sizes(flat), "NX": ode.numel(), "NY": y.numel(), "NC": c.numel()}
    sizes |= {"ORDER": METHOD.order, "MAX_STEPS": most_steps}
    drivers = ["newton.c", "batch_instance.h", "trial.c", "batch_warmup.c"]
    return _text(sizes, ["batch.h", "lanes.h"], [*_ranges(flat), *functions], drivers)


def _sizes(flat: FlatModel) -> dict[str, int]:
    return {
        "N": len(flat.states),
        "NZ": len(flat.algebraic),
        "NU": len(flat.inputs),
        "NP": len(flat.parameters),
        "N_OUTPUTS": len(flat.outputs),
    }


def _text(sizes: Mapping[str, Any], above: Sequence[str], generated: Sequence[str], below: Sequence[str]) -> str:
    """Sizes, the fixed text above the generated tables and functions, these, and the fixed text below them."""
    return "\n".join(
        [define_macros({**sizes, **newton_constants()}), *map(wrapper, above), *generated, *map(wrapper, below)]
    )


def _ranges(flat: FlatModel) -> list[str]:
    """Nominals and ranges of the states, those of the audit included, and of the inputs; algebraic variables."""
    variables = table(flat)
    rows = [*variables.of("state"), *variables.of("input")]
    columns = {
        "nominal": [v.quantity.nominal for v in rows],
        "low": [v.bounds[0] for v in rows],
        "high": [v.bounds[1] for v in rows],
        "z_start": [q.start for q in flat.algebraic],
        "z_nominal": [q.nominal for q in flat.algebraic],
    }
    return [_array("double", f"model_{name}", map(emit.number, column)) for name, column in columns.items()]


def _array(kind: str, name: str, values: Iterable[str]) -> str:
    return f"static const {kind} {name}[] = {{{', '.join([*values, '0'])}}};  /* 0: never empty */"
