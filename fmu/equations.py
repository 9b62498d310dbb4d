"""What an FMU computes, as a handful of CasADi functions: the model with its audit, one solver step, derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import FmuError

from . import rosenbrock


@dataclass(frozen=True)
class Equations:
    """The model of an FMU: dx/dt = ode(x, u, p), y = y(x, u, p), with audit states and outputs appended.

    Attributes:
        x, u, p: SX symbols
        ode, y: SX columns in the order of the variable table
        checked: the law arguments with a range
        related: what the relations between parameters are told by, of p alone
    """

    x: Any
    u: Any
    p: Any
    ode: Any
    y: Any
    checked: Any
    related: Any

    @cached_property
    def _hoisted(self) -> tuple[list[Any], Any, Any, Any]:
        """ode, y, checked, step and error without what depends on parameters alone; that; the symbols it is put in."""
        ode, y, checked = ca.cse([self.ode, self.y, self.checked])
        x_new, error, slope, h = rosenbrock.step(ode, self.x, self.u)
        parts = [ode, y, checked, x_new, error[:-1]]
        sizes = [0]
        for part in parts:
            sizes.append(sizes[-1] + part.shape[0])
        whole = ca.cse(ca.densify(ca.vertcat(*parts)))
        whole, symbols, constants = ca.extract_parametric(whole, self.p)
        whole = ca.cse(whole)
        parts = [whole[a:b] for a, b in pairwise(sizes)]
        return parts, ca.vertcat(ca.SX(0, 1), *symbols), ca.vertcat(ca.SX(0, 1), *constants), (slope, h)

    @cached_property
    def constants(self) -> Any:
        """(p) -> c: everything that depends on parameters alone, computed once when they change."""
        _, _, values, _ = self._hoisted
        return _function("constants", [self.p], [values], ["p"], ["c"])

    @cached_property
    def step(self) -> Any:
        """(x, u, slope, p, c, h) -> (x_new, error): one step of the solver; the last state has no error estimate."""
        (_, _, _, x_new, error), c, _, (slope, h) = self._hoisted
        inputs = [self.x, self.u, slope, self.p, c, h]
        return _function("step", inputs, [x_new, error], ["x", "u", "slope", "p", "c", "h"], ["x_new", "error"])

    @cached_property
    def outputs(self) -> Any:
        """(x, u, p, c) -> (y, dx)."""
        (ode, y, *_), c, _, _ = self._hoisted
        return _function("outputs", [self.x, self.u, self.p, c], [y, ode], ["x", "u", "p", "c"], ["y", "dx"])

    @cached_property
    def rates(self) -> Any:
        """(x, u, p, c) -> dx, for ModelExchange, whose integrator asks for nothing else."""
        (ode, *_), c, _, _ = self._hoisted
        return _function("rates", [self.x, self.u, self.p, c], [ode], ["x", "u", "p", "c"], ["dx"])

    @cached_property
    def arguments(self) -> Any:
        """(x, u, p, c) -> the law arguments that have a range."""
        (_, _, checked, *_), c, _, _ = self._hoisted
        return _function("arguments", [self.x, self.u, self.p, c], [checked], ["x", "u", "p", "c"], ["checked"])

    @cached_property
    def directional(self) -> Any:
        """(x, u, p, c, x_dot, u_dot, p_dot, c_dot) -> (y_dot, dx_dot): derivative in a direction."""
        (ode, y, *_), c, _, _ = self._hoisted
        point = [self.x, self.u, self.p, c]
        dots = [ca.SX.sym(f"{n}_dot", v.shape[0]) for n, v in zip("xupc", point, strict=True)]
        both = ca.jtimes(ca.vertcat(y, ode), ca.vertcat(*point), ca.vertcat(*dots))
        ny = y.shape[0]
        names = ["x", "u", "p", "c", "x_dot", "u_dot", "p_dot", "c_dot"]
        return _function("directional", point + dots, [both[:ny], both[ny:]], names, ["y_dot", "dx_dot"])

    @cached_property
    def constants_directional(self) -> Any:
        """(p, p_dot) -> c_dot: how the hoisted constants change with the parameters."""
        _, _, values, _ = self._hoisted
        p_dot = ca.SX.sym("p_dot", self.p.shape[0])
        dot = ca.jtimes(values, self.p, p_dot)
        return _function("constants_directional", [self.p, p_dot], [dot], ["p", "p_dot"], ["c_dot"])

    @cached_property
    def relations(self) -> Any:
        """(p) -> the values by which the relations between parameters are told."""
        return _function("relations_of", [self.p], [self.related], ["p"], ["related"])

    @property
    def functions(self) -> tuple[Any, ...]:
        """All functions the C code needs."""
        own = (self.constants, self.step, self.outputs, self.rates, self.arguments)
        return (*own, self.directional, self.constants_directional, self.relations)


def _function(name: str, inputs: list[Any], outputs: list[Any], names_in: list[str], names_out: list[str]) -> Any:
    dense = [ca.densify(ca.SX(value)) for value in outputs]
    return ca.Function(name, inputs, dense, names_in, names_out, {"cse": True})


def equations(flat: FlatModel) -> Equations:
    """The model an FMU computes, from a flat model.

    Raises:
        FmuError: the stored energy depends on an input, so it is no energy of the states
    """
    if ca.depends_on(ca.SX(flat.stored), flat.u):
        raise FmuError(f"{flat.name}: the stored energy depends on an input. It must be a function of the states.")
    rate = ca.mtimes(ca.jacobian(flat.stored, flat.x), flat.ode)
    outputs = [flat.y, flat.stored, flat.supply - rate, _outside(flat)]
    if flat.residual_names:
        outputs.append(ca.mmax(ca.fabs(ca.SX(flat.residual))))
    return Equations(
        x=ca.vertcat(flat.x, ca.SX.sym("supplied"), ca.SX.sym("throughput")),
        u=flat.u,
        p=flat.p,
        ode=ca.densify(ca.vertcat(flat.ode, flat.supply, flat.throughput)),
        y=ca.densify(ca.vertcat(*outputs)),
        checked=ca.densify(ca.vertcat(ca.SX(0, 1), flat.checked)),
        related=ca.densify(ca.vertcat(ca.SX(0, 1), flat.related)),
    )


def _outside(flat: FlatModel) -> Any:
    """Number of law arguments outside their range."""
    checked = ca.SX(flat.checked)
    return sum((ca.logic_or(checked[i] < c.low, checked[i] > c.high) for i, c in enumerate(flat.checks)), ca.SX(0))
