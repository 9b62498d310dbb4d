"""What an FMU computes, as a handful of CasADi functions: the model with its audit, one solver step, derivatives.

Only parameters that have an effect become parameters of an FMU.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any

import casadi as ca
import numpy as np

from ..model.core.eliminate import Factors
from ..model.core.flat import FlatModel
from ..model.errors import FmuError
from ..model.run.fast import once
from . import rosenbrock

#: Operations through which a parameter acts although the derivative is zero: it decides when something happens.
_SWITCHES = frozenset(
    getattr(ca, f"OP_{name}")
    for name in ("LT", "LE", "EQ", "NE", "NOT", "AND", "OR", "FLOOR", "CEIL", "FMOD", "SIGN", "IF_ELSE_ZERO")
)


#: Derivatives below this share of the largest, in nominals, may be round-off of terms that cancel.
FELT = 1e-9


def effective(flat: FlatModel, start: Mapping[str, float] | None = None) -> FlatModel:
    """The model without the parameters that cannot move any rate, output, checked argument or relation.

    A parameter goes where the model does not hold it, or where its derivative is zero as an expression, as that of a
    share of heat whose two ways end in one body. One that has no effect only at the present values stays.

    Args:
        flat: the model
        start: values that replace those of the model; a parameter that goes is replaced by its value
    """
    moving = _moving(flat)
    return _keep(flat, [i for i in range(len(flat.parameters)) if i in moving], start)


def fix(flat: FlatModel, constants: Collection[str], start: Mapping[str, float] | None = None) -> FlatModel:
    """The model with some parameters as constants: without what follows from them, or must hold between them alone.

    Args:
        flat: the model
        constants: names of the parameters
        start: values that replace those of the model
    """
    hidden = set(constants)
    found = _keep(flat, [i for i, q in enumerate(flat.parameters) if q.name not in hidden], start)
    derived = {name: those for name, those in flat.derived.items() if not hidden & {*those}}
    shown = [i for i, q in enumerate(flat.outputs) if q.name not in flat.derived or q.name in derived]
    told = [i for i, relation in enumerate(flat.relations) if not {*relation.parameters} <= hidden]
    return replace(
        found,
        outputs=tuple(flat.outputs[i] for i in shown),
        y=ca.SX(found.y)[shown],
        derived=derived,
        relations=tuple(flat.relations[i] for i in told),
        related=ca.SX(found.related)[told],
    )


def _keep(flat: FlatModel, kept: Sequence[int], start: Mapping[str, float] | None) -> FlatModel:
    """The model with some of its parameters, and numbers in place of the others."""
    if len(kept) == len(flat.parameters):
        return flat
    parts, column = _parts(flat)
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
    moving = _felt(flat, column)
    held = _columns(ca.jacobian_sparsity(column, p))
    if doubtful := sorted(held - moving):
        slopes = ca.sparsify(ca.jacobian(ca.cse(column), p[doubtful])).sparsity()
        moving |= {doubtful[k] for k in _columns(slopes)}
    return moving | _switching(column, p) if held - moving else moving


def _felt(flat: FlatModel, column: Any) -> set[int]:
    """Positions of the parameters with a derivative, beyond round-off, at a point near the start.

    One sweep backwards finds them all; the others are looked at as expressions, which costs far more.
    """
    random = np.random.default_rng(0)
    x, z, u, p = (flat.starts(kind) for kind in ("state", "algebraic", "input", "parameter"))
    weights = ca.SX(ca.DM(random.uniform(1.0, 2.0, column.numel())))
    slope = ca.densify(ca.jtimes(column, flat.p, weights, True))
    found = ca.Function("felt", flat.point, [slope])(x * random.uniform(0.98, 1.02, len(x)), z, u, p).full().ravel()
    size = np.abs(found * np.array([q.nominal for q in flat.parameters]))
    return set(np.flatnonzero(size > FELT * np.nanmax(size, initial=0.0)).tolist())


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


@dataclass(frozen=True)
class Equations:
    """The model of an FMU: dx/dt = ode, 0 = residual, y with audit states and outputs appended.

    Attributes:
        x, z, u, p: SX symbols
        ode, residual, y: SX columns in the order of the variable table, functions of x, z, u, p
        checked: the law arguments with a range
        related: what the relations between parameters are told by, of p alone
        audit: whether the last two states are those of the audit
    """

    x: Any
    z: Any
    u: Any
    p: Any
    ode: Any
    residual: Any
    y: Any
    checked: Any
    related: Any
    audit: bool = True

    @cached_property
    def hoisted(self) -> tuple[dict[str, Any], Any, Any, Any]:
        """All results without what depends on parameters alone; that; the symbols it is put in; slope and h."""
        ode, residual, y, checked = ca.cse([self.ode, self.residual, self.y, self.checked])
        x_new, z_new, error, slope, h = rosenbrock.step(ode, residual, self.x, self.z, self.u)
        parts = {"ode": ode, "residual": residual, "jacobian": ca.densify(ca.jacobian(residual, self.z))[:], "y": y}
        parts |= {"checked": checked, "x_new": x_new, "z_new": z_new, "error": error[:-1] if self.audit else error}
        cut, symbols, constants = hoist(list(parts.values()), self.p)
        return dict(zip(parts, cut, strict=True)), symbols, constants, (slope, h)

    def _of_point(self, name: str, results: dict[str, str]) -> Any:
        """(x, z, u, p, c) -> some of the results, by the names they get."""
        found, c, _, _ = self.hoisted
        point = [self.x, self.z, self.u, self.p, c]
        return full(name, point, [found[r] for r in results], ["x", "z", "u", "p", "c"], list(results.values()))

    @cached_property
    def constants(self) -> Any:
        """(p) -> c: everything that depends on parameters alone, computed once when they change."""
        _, _, values, _ = self.hoisted
        return full("constants", [self.p], [values], ["p"], ["c"])

    @cached_property
    def step(self) -> Any:
        """(x, z, u, slope, p, c, h) -> (x_new, z_new, error): one step of the solver; no error of the last state."""
        found, c, _, (slope, h) = self.hoisted
        inputs = [self.x, self.z, self.u, slope, self.p, c, h]
        results = ["x_new", "z_new", "error"]
        return full("step", inputs, [found[r] for r in results], ["x", "z", "u", "slope", "p", "c", "h"], results)

    @cached_property
    def algebra(self) -> Any:
        """(x, z, u, p, c) -> (r, J): the implicit equations and their Jacobian in z, by columns."""
        return self._of_point("algebra", {"residual": "r", "jacobian": "J"})

    @cached_property
    def outputs(self) -> Any:
        """(x, z, u, p, c) -> (y, dx)."""
        return self._of_point("outputs", {"y": "y", "ode": "dx"})

    @cached_property
    def rates(self) -> Any:
        """(x, z, u, p, c) -> dx, for ModelExchange, whose integrator asks for nothing else."""
        return self._of_point("rates", {"ode": "dx"})

    @cached_property
    def arguments(self) -> Any:
        """(x, z, u, p, c) -> the law arguments that have a range."""
        return self._of_point("arguments", {"checked": "checked"})

    @cached_property
    def directional(self) -> Any:
        """(x, z, u, p, c, x_dot, u_dot, p_dot, c_dot) -> (y_dot, dx_dot): derivative in a direction, z following."""
        found, c, _, _ = self.hoisted
        given = {"x": self.x, "u": self.u, "p": self.p, "c": c}
        dots = {f"{name}_dot": ca.SX.sym(f"{name}_dot", v.shape[0]) for name, v in given.items()}
        moved = ca.vertcat(*given.values())
        z_dot = -Factors(ca.jacobian(found["residual"], self.z)).solve(
            ca.jtimes(found["residual"], moved, ca.vertcat(*dots.values()))
        )
        whole = ca.vertcat(found["y"], found["ode"])
        both = ca.jtimes(whole, ca.vertcat(moved, self.z), ca.vertcat(*dots.values(), z_dot))
        ny = found["y"].shape[0]
        point = {"x": self.x, "z": self.z, "u": self.u, "p": self.p, "c": c} | dots
        return full("directional", list(point.values()), [both[:ny], both[ny:]], list(point), ["y_dot", "dx_dot"])

    @cached_property
    def constants_directional(self) -> Any:
        """(p, p_dot) -> c_dot: how the hoisted constants change with the parameters."""
        _, _, values, _ = self.hoisted
        p_dot = ca.SX.sym("p_dot", self.p.shape[0])
        dot = ca.jtimes(values, self.p, p_dot)
        return full("constants_directional", [self.p, p_dot], [dot], ["p", "p_dot"], ["c_dot"])

    @cached_property
    def adjoint(self) -> Any:
        """(x, z, u, p, c, y_bar, dx_bar) -> (x_bar, u_bar, p_bar, c_bar): the transposed of `directional`."""
        found, c, _, _ = self.hoisted
        given = {"x": self.x, "u": self.u, "p": self.p, "c": c}
        bars = {name: ca.SX.sym(name, found[result].shape[0]) for name, result in (("y_bar", "y"), ("dx_bar", "ode"))}
        moved, whole, residual = ca.vertcat(*given.values()), ca.vertcat(found["y"], found["ode"]), found["residual"]
        bar = ca.vertcat(*bars.values())
        r_bar = -Factors(ca.jacobian(residual, self.z).T).solve(ca.jtimes(whole, self.z, bar, True))
        both = ca.jtimes(ca.vertcat(whole, residual), moved, ca.vertcat(bar, r_bar), True)
        sizes = np.cumsum([0, *(v.shape[0] for v in given.values())]).tolist()
        point = {"x": self.x, "z": self.z, "u": self.u, "p": self.p, "c": c} | bars
        results = [both[a:b] for a, b in pairwise(sizes)]
        return full("adjoint", list(point.values()), results, list(point), [f"{name}_bar" for name in given])

    @cached_property
    def constants_adjoint(self) -> Any:
        """(p, c_bar) -> p_bar: the transposed of `constants_directional`."""
        _, _, values, _ = self.hoisted
        c_bar = ca.SX.sym("c_bar", values.shape[0])
        bar = ca.jtimes(values, self.p, c_bar, True)
        return full("constants_adjoint", [self.p, c_bar], [bar], ["p", "c_bar"], ["p_bar"])

    @cached_property
    def relations(self) -> Any:
        """(p) -> the values by which the relations between parameters are told."""
        return full("relations_of", [self.p], [self.related], ["p"], ["related"])

    @property
    def functions(self) -> tuple[Any, ...]:
        """All functions the C code needs."""
        own = (self.constants, self.step, self.algebra, self.outputs, self.rates, self.arguments)
        return (*own, self.directional, self.constants_directional, self.relations)

    @property
    def adjoint_functions(self) -> tuple[Any, ...]:
        """Those that FMI 3.0 needs besides."""
        return (self.adjoint, self.constants_adjoint)


def hoist(parts: Sequence[Any], given: Any) -> tuple[list[Any], Any, Any]:
    """Columns without what depends on the symbols `given` alone; new symbols for that; and that.

    Args:
        parts: SX columns
        given: SX symbols
    """
    columns = [ca.densify(ca.SX(part)) for part in parts]
    ends = [0, *accumulate(column.numel() for column in columns)]
    rest, symbols, values = ca.extract_parametric(ca.cse(ca.vertcat(*columns)), given)
    rest = ca.cse(rest)
    cut = [rest[a:b] for a, b in pairwise(ends)]
    return cut, ca.vertcat(ca.SX(0, 1), *symbols), ca.vertcat(ca.SX(0, 1), *values)


def full(name: str, inputs: list[Any], outputs: list[Any], names_in: list[str], names_out: list[str]) -> Any:
    """A CasADi function whose results are full, and equal expressions in them computed once.

    Args:
        name: of the function
        inputs: SX symbols
        outputs: SX expressions in them
        names_in, names_out: names of both
    """
    dense = [ca.densify(ca.SX(value)) for value in outputs]
    return ca.Function(name, inputs, dense, names_in, names_out, {"cse": True})


def equations(flat: FlatModel, audit: bool = True) -> Equations:
    """The model an FMU computes, from a flat model.

    Args:
        flat: the model
        audit: whether the energy across the boundary is integrated, by two states behind the model's own

    Raises:
        FmuError: the stored energy depends on more than the states
    """
    if ca.depends_on(ca.SX(flat.stored), ca.vertcat(flat.u, flat.z)):
        raise FmuError(f"{flat.name}: the stored energy must be a function of the states and parameters alone.")
    rate = ca.mtimes(ca.jacobian(flat.stored, flat.x), flat.ode)
    outputs = [flat.y, flat.stored, flat.supply - rate, _outside(flat)]
    if flat.residual_names:
        outputs.append(ca.mmax(ca.fabs(ca.SX(flat.residual))))
    return Equations(
        x=ca.vertcat(flat.x, *((ca.SX.sym("supplied"), ca.SX.sym("throughput")) if audit else ())),
        z=flat.z,
        u=flat.u,
        p=flat.p,
        ode=ca.densify(ca.vertcat(flat.ode, *((flat.supply, flat.throughput) if audit else ()))),
        residual=ca.densify(flat.residual),
        y=ca.densify(ca.vertcat(*outputs)),
        checked=ca.densify(ca.vertcat(ca.SX(0, 1), flat.checked)),
        related=ca.densify(ca.vertcat(ca.SX(0, 1), flat.related)),
        audit=audit,
    )


def _outside(flat: FlatModel) -> Any:
    """Number of law arguments outside their range."""
    checked = ca.SX(flat.checked)
    return sum((ca.logic_or(checked[i] < c.low, checked[i] > c.high) for i, c in enumerate(flat.checks)), ca.SX(0))
