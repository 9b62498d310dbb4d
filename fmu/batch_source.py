"""The C source of a batch: the FMU's own, the functions of the steady state, and the driver over rows."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from typing import Any

import casadi as ca
from gearheat.model.core.flat import FlatModel

from . import emit
from .equations import equations
from .source import source
from .variables import table

#: What a steady row holds behind the model's outputs: supply [W], throughput [W], law arguments outside their range,
#: largest residual of the implicit equations.
EXTRA = 4


@dataclass(frozen=True)
class _Steady:
    """The steady equations in three stages, each computed only when what it depends on changes.

    Attributes:
        x, u, p: SX symbols
        k: symbols of what depends on parameters alone, with `k_values` (p)
        c: symbols of what depends on inputs and parameters alone, with `c_values` (u, p, k)
        ode, jacobian, y: SX columns in x, u, p and c; the Jacobian by columns
    """

    x: Any
    u: Any
    p: Any
    k: Any
    k_values: Any
    c: Any
    c_values: Any
    ode: Any
    jacobian: Any
    y: Any

    def functions(self) -> tuple[Any, ...]:
        """The CasADi functions fixed, given, rates, balance and outputs."""
        place, names = [self.x, self.u, self.p, self.k, self.c], list("xupkc")
        return (
            _function("fixed", [self.p], ["p"], [self.k_values], ["k"]),
            _function("given", place[1:4], names[1:4], [self.c_values], ["c"]),
            _function("rates", place, names, [self.ode], ["dx"]),
            _function("balance", place, names, [self.ode, self.jacobian], ["dx", "jacobian"]),
            _function("outputs", place, names, [self.y], ["y"]),
        )


def _function(name: str, inputs: list[Any], names_in: list[str], outputs: list[Any], names_out: list[str]) -> Any:
    return ca.Function(name, inputs, [ca.densify(o) for o in outputs], names_in, names_out, {"cse": True})


def _steady(flat: FlatModel) -> _Steady:
    """The steady equations of a model, with all that does not depend on the states taken out of them."""
    outside = ca.SX(0)
    for i, check in enumerate(flat.checks):
        outside += ca.logic_or(flat.checked[i] < check.low, flat.checked[i] > check.high)
    implicit = ca.mmax(ca.fabs(ca.SX(flat.residual))) if flat.residual_names else ca.SX(0)
    jacobian = ca.vec(ca.densify(ca.jacobian(flat.ode, flat.x)))
    parts = [ca.densify(flat.ode), jacobian, ca.vertcat(flat.y, flat.supply, flat.throughput, outside, implicit)]
    ends = [0]
    for part in parts:
        ends.append(ends[-1] + part.numel())
    whole, c, c_values = _hoisted(ca.vertcat(*parts), ca.vertcat(flat.u, flat.p))
    c_values, k, k_values = _hoisted(c_values, flat.p)
    ode, jacobian, y = (whole[a:b] for a, b in pairwise(ends))
    return _Steady(flat.x, flat.u, flat.p, k, k_values, c, c_values, ode, jacobian, y)


def _hoisted(expression: Any, given: Any) -> tuple[Any, Any, Any]:
    """An expression without what depends on the symbols `given` alone; new symbols for that; and that."""
    rest, symbols, values = ca.extract_parametric(ca.cse(ca.densify(expression)), given)
    return ca.cse(rest), ca.vertcat(ca.SX(0, 1), *symbols), ca.vertcat(ca.SX(0, 1), *values)


def batch_source(flat: FlatModel) -> str:
    """The whole C text: the model's functions and solver as in its FMU, then those of the batch.

    Raises:
        FmuError: an operation has no C text
    """
    steady = _steady(flat)
    sizes = {
        "N_OUTPUTS": len(flat.outputs),
        "NYR": len(flat.outputs) + EXTRA,
        "NK_REST": steady.k.numel(),
        "NC_REST": steady.c.numel(),
    }
    defined = "".join(f"#define {name} {value}\n" for name, value in sizes.items())
    functions = [emit.function(f, prefix="rest_") for f in steady.functions()]
    driver = (files("gearheat.fmu") / "wrapper" / "batch.c").read_text(encoding="utf-8")
    return "\n".join([source(flat, equations(flat), table(flat)), defined, *functions, driver])
