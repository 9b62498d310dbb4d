"""From parts and connections to an explicit flat model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca

from ..sources import LawInfo, LawUse, recording
from .component import Component
from .connect import Assembly, nets
from .declare import Declaration
from .equations import check_symbols, energies_of, rows_of
from .flat import Check, FlatModel, Quantity
from .reduce import reduce
from .solve import NEWTON_STEPS, Row, Solution, Unknown, column, inline, solve
from .structure import check_structure


def flatten(assembly: Assembly, newton_steps: int = NEWTON_STEPS) -> FlatModel:
    """Alias the potentials of each net, balance its flows, sort all equations and solve them block by block.

    Args:
        assembly: parts and their connections
        newton_steps: of implicit blocks, from their guesses

    Raises:
        StructureError: ports that do not exist, too few or too many equations, a singular or unsolvable block
    """
    rows, unknowns, alias = _nets(assembly)
    checks: list[tuple[Check, Any]] = []
    laws: dict[LawInfo, None] = {}
    for part in assembly.parts:
        with recording() as uses:
            rows += rows_of(part)
        checks += _checks(part, uses)
        laws |= dict.fromkeys(use.law for use in uses)
        unknowns += _unknowns(part)
    aliased = _Alias(alias)
    rows = [Row(r.name, aliased(r.lhs), aliased(r.rhs)) for r in rows]
    check_symbols(rows, unknowns, assembly.parts)
    typical = _typical(assembly, unknowns)
    reduced = reduce(assembly, rows, unknowns, typical)
    check_structure(assembly, reduced.rows, reduced.unknowns, typical)
    solution = Solution(typical, newton_steps)
    solve(assembly.name, reduced.rows, reduced.unknowns, solution)
    return _flat_model(assembly, solution, aliased, checks, tuple(laws), reduced.joined)


class _Alias:
    """Replaces the potential of every port by the one symbol of its net."""

    def __init__(self, pairs: list[tuple[Any, Any]]) -> None:
        self.old = column([old for old, _ in pairs])
        self.new = column([new for _, new in pairs])

    def __call__(self, expression: Any) -> Any:
        return ca.substitute(ca.SX(expression), self.old, self.new) if self.old.numel() else ca.SX(expression)


def _nets(assembly: Assembly) -> tuple[list[Row], list[Unknown], list[tuple[Any, Any]]]:
    """Flow balances, the unknowns of the nets, and which port symbols are the same."""
    rows, unknowns, alias = [], [], []
    for net in nets(assembly):
        first = net[0]
        for name, d in type(first).potentials().items():
            unknowns.append(Unknown(first.symbols[name], f"{first.name}.{name}", d.nominal))
            alias += [(port.symbols[name], first.symbols[name]) for port in net[1:]]
        for name, flow in type(first).flows().items():
            unknowns += [Unknown(port.symbols[name], f"{port.name}.{name}", flow.nominal) for port in net]
            total = sum((port.symbols[name] for port in net), ca.SX(0))
            rows.append(Row(f"sum of {name} at {first.name}", total, ca.SX(0)))
    return rows, unknowns, alias


def _typical(assembly: Assembly, unknowns: list[Unknown]) -> dict[int, float]:
    """A typical value of every symbol by its hash: what is given where something is, else the nominal."""
    typical = {u.symbol.element_hash(): u.nominal for u in unknowns}
    for part in assembly.parts:
        for key, d in part.inputs.items():
            typical[part.symbols[key].element_hash()] = part.values[key] or d.nominal
        for key in (*part.parameters, *part.states):
            typical[part.symbols[key].element_hash()] = part.values[key]
    return typical


def _unknowns(part: Component) -> list[Unknown]:
    found = [Unknown(part.derivatives[k], f"der({part.name}.{k})", d.nominal) for k, d in part.states.items()]
    found += [Unknown(part.symbols[k], f"{part.name}.{k}", d.nominal, d.guess) for k, d in part.variables.items()]
    found += [
        Unknown(part.symbols[k], f"{part.name}.{k}", d.nominal) for k, d in part.inputs.items() if not part.is_input(k)
    ]
    return found


def _checks(part: Component, uses: list[LawUse]) -> list[tuple[Check, Any]]:
    return [
        (Check(part.name, use.law, name, *use.law.ranges[name]), ca.SX(value))
        for use in uses
        for name, value in use.arguments.items()
    ]


def _flat_model(
    assembly: Assembly,
    solution: Solution,
    aliased: _Alias,
    checks: list[tuple[Check, Any]],
    laws: tuple[LawInfo, ...],
    joined: Mapping[str, str],
) -> FlatModel:
    parts = assembly.parts
    states = [(part, k) for part in parts for k in part.states if f"{part.name}.{k}" not in joined]
    inputs = [(part, k) for part in parts for k in part.inputs if part.is_input(k)]
    parameters = [(part, k) for part in parts for k in part.parameters]
    outputs = [(part, k, d) for part in parts for k, d in _shown(part, joined).items()]
    x = column([part.symbols[k] for part, k in states])
    energies = [energies_of(part) for part in parts]
    supplies = [aliased(power) for powers, _ in energies for power in powers]
    expressions = [
        column([part.derivatives[k] for part, k in states]),
        column([part.symbols[k] for part, k, _ in outputs]),
        column([residual for _, residual in solution.residuals]),
        sum(supplies, ca.SX(0)),
        sum((ca.fabs(power) for power in supplies), ca.SX(0)),
        sum((aliased(stored) for _, stored in energies), ca.SX(0)),
        column([aliased(value) for _, value in checks]),
    ]
    sizes = [e.numel() for e in expressions]
    together = inline(ca.vertcat(*expressions), solution)
    ode, y, residual, supply, throughput, stored, checked = ca.vertsplit(together, [0, *_cumulative(sizes)])

    def quantities(items: list[tuple[Component, str]], kind: str) -> tuple[Quantity, ...]:
        return tuple(getattr(part, kind)[k].quantity(f"{part.name}.{k}", part.values[k]) for part, k in items)

    return FlatModel(
        name=assembly.name,
        doc=assembly.doc,
        states=quantities(states, "states"),
        inputs=quantities(inputs, "inputs"),
        parameters=quantities(parameters, "parameters"),
        outputs=tuple(_output(f"{part.name}.{k}", d, joined) for part, k, d in outputs),
        x=x,
        u=column([part.symbols[k] for part, k in inputs]),
        p=column([part.symbols[k] for part, k in parameters]),
        ode=ode,
        y=y,
        residual=residual,
        residual_names=tuple(name for name, _ in solution.residuals),
        supply=supply,
        throughput=throughput,
        stored=stored,
        checks=tuple(check for check, _ in checks),
        checked=checked,
        laws=laws,
        joined=tuple(joined.values()),
    )


def _shown(part: Component, joined: Mapping[str, str]) -> dict[str, Declaration]:
    """The outputs of a part, behind those of its states that follow others."""
    following: dict[str, Declaration] = {k: d for k, d in part.states.items() if f"{part.name}.{k}" in joined}
    return {**following, **part.outputs()}


def _output(path: str, declaration: Declaration, joined: Mapping[str, str]) -> Quantity:
    quantity = declaration.quantity(path)
    return replace(quantity, doc=f"{quantity.doc}; {joined[path]}") if path in joined else quantity


def _cumulative(sizes: list[int]) -> list[int]:
    total, ends = 0, []
    for size in sizes:
        total += size
        ends.append(total)
    return ends
