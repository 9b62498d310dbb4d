"""The C sources of a batch: the model's functions, staged for many rows, and the fixed drivers over rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from itertools import pairwise
from typing import Any

import casadi as ca
from gearheat.model.core.flat import FlatModel

from . import emit, rosenbrock
from .equations import equations
from .variables import Table, table

#: What a steady row holds behind the model's outputs: supply [W], throughput [W], law arguments outside their range,
#: largest residual of the implicit equations.
EXTRA = 4

#: Warm-ups choose their steps freely, which suits a method of higher order than that of an FMU with its short steps.
METHOD = rosenbrock.RODAS4


def steady_source(flat: FlatModel) -> str:
    """The C text for steady states.

    The equations come in three stages, each computed when what it depends on changes: `fixed` (p) -> k, `given`
    (u, p, k) -> c, and `rates`, `balance` (with the Jacobian's entries that are not zero) and `outputs` of
    (x, u, p, k, c).

    Raises:
        FmuError: an operation has no C text
    """
    outside = sum((ca.logic_or(flat.checked[i] < c.low, flat.checked[i] > c.high) for i, c in enumerate(flat.checks)))
    implicit = ca.mmax(ca.fabs(ca.SX(flat.residual))) if flat.residual_names else 0
    jacobian = ca.jacobian(flat.ode, flat.x)
    places = jacobian.sparsity().get_triplet()
    parts = [flat.ode, jacobian.nz[:], ca.vertcat(flat.y, flat.supply, flat.throughput, outside, implicit)]
    (ode, entries, y), c, c_values = _hoisted(parts, ca.vertcat(flat.u, flat.p))
    (c_values,), k, k_values = _hoisted([c_values], flat.p)
    place, names = [flat.x, flat.u, flat.p, k, c], list("xupkc")
    functions = [
        _function("fixed", [flat.p], ["p"], [k_values], ["k"]),
        _function("given", place[1:4], names[1:4], [c_values], ["c"]),
        _function("rates", place, names, [ode], ["dx"]),
        _function("balance", place, names, [ode, entries], ["dx", "entries"]),
        _function("outputs", place, names, [y], ["y"]),
    ]
    sizes = {**_sizes(flat), "NYR": y.numel(), "NK": k.numel(), "NC": c.numel(), "NJ": entries.numel()}
    pattern = [
        _array("int", f"model_{name}", map(str, place)) for name, place in zip(("row", "column"), places, strict=True)
    ]
    tables = [*_ranges(table(flat)), *pattern]
    return _text(sizes, ["batch.h"], [*tables, *map(emit.function, functions)], ["batch_steady.c"])


def warmup_source(flat: FlatModel, most_steps: int) -> str:
    """The C text for warm-ups: the equations of the FMU with its audit, and its solver.

    `most_steps` is where it gives up between two points of the schedule or the output.

    Raises:
        FmuError: an operation has no C text, or the stored energy depends on an input
    """
    model = equations(flat)
    x_new, error, slope, h = rosenbrock.step(model.ode, model.x, model.u, METHOD)
    (x_new, error, y, ode), c, c_values = _hoisted([x_new, error[:-1], model.y, model.ode], model.p)
    place = [model.x, model.u, slope, model.p, c, h]
    step = _function("step", place, ["x", "u", "slope", "p", "c", "h"], [x_new, error], ["x_new", "error"])
    functions = [
        emit.function(_function("constants", [model.p], ["p"], [c_values], ["c"])),
        emit.function(step, "lanes_", "lanes"),
        emit.function(
            _function("outputs", [model.x, model.u, model.p, c], ["x", "u", "p", "c"], [y, ode], ["y", "dx"])
        ),
    ]
    sizes = {**_sizes(flat), "NX": ode.numel(), "NY": y.numel(), "NC": c.numel()}
    sizes |= {"ORDER": METHOD.order, "MAX_STEPS": most_steps}
    drivers = ["batch_instance.h", "trial.c", "batch_warmup.c"]
    return _text(sizes, ["batch.h", "lanes.h"], [*_ranges(table(flat)), *functions], drivers)


def _hoisted(parts: Sequence[Any], given: Any) -> tuple[list[Any], Any, Any]:
    """Columns without what depends on the symbols `given` alone; new symbols for that; and that."""
    columns = [ca.densify(ca.SX(part)) for part in parts]
    ends = [0]
    for column in columns:
        ends.append(ends[-1] + column.numel())
    rest, symbols, values = ca.extract_parametric(ca.cse(ca.vertcat(*columns)), given)
    rest = ca.cse(rest)
    cut = [rest[a:b] for a, b in pairwise(ends)]
    return cut, ca.vertcat(ca.SX(0, 1), *symbols), ca.vertcat(ca.SX(0, 1), *values)


def _function(name: str, inputs: list[Any], names_in: list[str], outputs: list[Any], names_out: list[str]) -> Any:
    return ca.Function(name, inputs, [ca.densify(o) for o in outputs], names_in, names_out, {"cse": True})


def _sizes(flat: FlatModel) -> dict[str, int]:
    return {
        "N": len(flat.states),
        "NU": len(flat.inputs),
        "NP": len(flat.parameters),
        "N_OUTPUTS": len(flat.outputs),
    }


def _text(sizes: Mapping[str, int], above: Sequence[str], generated: Sequence[str], below: Sequence[str]) -> str:
    """Sizes, the fixed text above the generated tables and functions, these, and the fixed text below them."""
    defined = "".join(f"#define {name} {value}\n" for name, value in sizes.items())
    return "\n".join([defined, *map(_fixed, above), *generated, *map(_fixed, below)])


def _fixed(name: str) -> str:
    return (files("gearheat.fmu") / "wrapper" / name).read_text(encoding="utf-8")


def _ranges(variables: Table) -> list[str]:
    """Nominals and ranges of the states, those of the audit included, and of the inputs."""
    rows = [*variables.of("state"), *variables.of("input")]
    columns = {
        "nominal": [v.quantity.nominal for v in rows],
        "low": [v.bounds[0] for v in rows],
        "high": [v.bounds[1] for v in rows],
    }
    return [_array("double", f"model_{name}", map(emit.number, column)) for name, column in columns.items()]


def _array(kind: str, name: str, values: Iterable[str]) -> str:
    return f"static const {kind} {name}[] = {{{', '.join([*values, '0'])}}};  /* 0: never empty */"
