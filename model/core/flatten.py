"""From parts and connections to a flat model: explicit but for the algebraic variables of its implicit blocks."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any

import casadi as ca

from ..sources import LawInfo, LawUse, recording
from .component import Balance, Component, Equation
from .connect import Assembly, nets
from .declare import Declaration, Variable
from .equations import check_symbols, energies_of, rows_of
from .faults import check_structure
from .flat import Check, FlatModel, Quantity
from .reduce import reduce
from .solve import Solution, Unknown, column, inline, pattern_of, scaled_residual, solve, start_of


def flatten(assembly: Assembly, *, flows: Iterable[str] = ()) -> FlatModel:
    """Alias the potentials of each net, balance its flows, sort all equations and solve them block by block.

    Args:
        assembly: parts and their connections
        flows: paths of flows of ports that are outputs as well ("foot.a.Q_flow")

    Raises:
        StructureError: ports that do not exist, too few or too many equations, a singular or unsolvable block
    """
    rows, unknowns, alias = _nets(assembly)
    checks: list[tuple[Check, Any]] = []
    laws: dict[LawInfo, None] = {}
    for part in assembly.parts:
        with recording() as uses:
            rows += rows_of(part)
        uses = [*part.uses, *uses]
        checks += _checks(part, uses)
        laws |= dict.fromkeys(use.law for use in uses)
        unknowns += _unknowns(part)
    aliased = _Alias(alias)
    lefts, rights = aliased([r.lhs for r in rows]), aliased([r.rhs for r in rows])
    rows = [replace(r, lhs=lhs, rhs=rhs) for r, lhs, rhs in zip(rows, lefts, rights, strict=True)]
    unknowns = _without_idle(assembly, rows, unknowns)
    check_symbols(rows, unknowns, assembly.parts)
    typical = _typical(assembly, unknowns)
    reduced = reduce(assembly, rows, unknowns, typical)
    check_structure(assembly, reduced.rows, reduced.unknowns, reduced.columns, typical)
    solution = Solution(typical)
    solve(assembly.name, reduced.rows, reduced.unknowns, solution, pattern_of(reduced.columns))
    return _flat_model(assembly, solution, aliased, checks, tuple(laws), reduced.joined, frozenset(flows))


class _Alias:
    """Replaces the potential of every port by the one symbol of its net.

    Scalars are replaced in one call: its cost grows with the number of ports, whatever it is given.
    """

    def __init__(self, pairs: list[tuple[Any, Any]]) -> None:
        self.old = column([old for old, _ in pairs])
        self.new = column([new for _, new in pairs])

    def __call__(self, expressions: list[Any]) -> list[Any]:
        (replaced,) = ca.substitute([ca.densify(column(expressions))], [self.old], [self.new])
        return list(replaced.nonzeros())


def _nets(assembly: Assembly) -> tuple[list[Equation], list[Unknown], list[tuple[Any, Any]]]:
    """Flow balances, the unknowns of the nets, and which port symbols are the same."""
    rows: list[Equation] = []
    unknowns, alias = [], []
    for net in nets(assembly):
        first = net[0]
        for name, d in type(first).potentials().items():
            unknowns.append(Unknown(first.symbols[name], f"{first.name}.{name}", d.nominal, unit=d.unit))
            alias += [(port.symbols[name], first.symbols[name]) for port in net[1:]]
        for name, flow in type(first).flows().items():
            unknowns += [
                Unknown(port.symbols[name], f"{port.name}.{name}", flow.nominal, unit=flow.unit) for port in net
            ]
            rows.append(Balance.of(f"sum of {name} at {first.name}", (port.symbols[name] for port in net)))
    return rows, unknowns, alias


def _without_idle(assembly: Assembly, rows: Sequence[Equation], unknowns: Sequence[Unknown]) -> list[Unknown]:
    """The unknowns without what ports bring that may stay open, do so, and are read under no choice of their part."""
    ports = [net[0] for net in nets(assembly) if len(net) == 1 and not net[0].needed and not type(net[0]).flows()]
    open_ends = {f"{port.name}.{name}" for port in ports for name in type(port).potentials()}
    if not open_ends:
        return list(unknowns)
    read = {s.element_hash() for s in ca.symvar(column([side for r in rows for side in (r.lhs, r.rhs)]))}
    return [u for u in unknowns if u.name not in open_ends or u.symbol.element_hash() in read]


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
    declared = [*part.variables.items(), *((k, d) for k, d in part.inputs.items() if not part.is_input(k))]
    for k, d in declared:
        guess = d.guess if isinstance(d, Variable) else None
        found.append(Unknown(part.symbols[k], f"{part.name}.{k}", d.nominal, guess, d.unit))
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
    flows: Container[str],
) -> FlatModel:
    parts = assembly.parts
    states = [(part, k) for part in parts for k in part.states if f"{part.name}.{k}" not in joined]
    inputs = [(part, k) for part in parts for k in part.inputs if part.is_input(k)]
    parameters = [(part, k) for part in parts for k in part.parameters]
    outputs = [*_outputs(parts, joined), *_flows(assembly, flows)]
    related = [pair for part in parts for pair in (*part.all_relations(), *part.relations_with(parts))]
    energies = [energies_of(part) for part in parts]
    supplies = aliased([power for powers, _ in energies for power in powers])
    expressions = {
        "ode": column([part.derivatives[k] for part, k in states]),
        "y": column([symbol for symbol, _ in outputs]),
        "residual": column([test.residual for test in solution.tests]),
        "supply": sum(supplies, ca.SX(0)),
        "throughput": sum((ca.fabs(power) for power in supplies), ca.SX(0)),
        "stored": sum(aliased([stored for _, stored in energies]), ca.SX(0)),
        "checked": column(aliased([value for _, value in checks])),
        "imbalance": column(aliased(_imbalances(parts))),
    }
    together = inline(ca.vertcat(*expressions.values()), solution)
    ends = [0, *accumulate(e.numel() for e in expressions.values())]
    found = dict(zip(expressions, ca.vertsplit(together, ends), strict=True))
    found["residual"], names = scaled_residual(solution, found["residual"])
    return FlatModel(
        name=assembly.name,
        doc=assembly.doc,
        states=_quantities(states, "states"),
        inputs=_quantities(inputs, "inputs"),
        parameters=_quantities(parameters, "parameters"),
        outputs=tuple(quantity for _, quantity in outputs),
        algebraic=tuple(Quantity(u.name, u.unit, "", u.nominal, start_of(u)) for u in solution.torn),
        x=column([part.symbols[k] for part, k in states]),
        z=column([u.symbol for u in solution.torn]),
        u=column([part.symbols[k] for part, k in inputs]),
        p=column([part.symbols[k] for part, k in parameters]),
        residual_names=names,
        checks=tuple(check for check, _ in checks),
        laws=laws,
        joined=tuple(joined.values()),
        derived={f"{part.name}.{k}": part.follows_from(part.symbols[k]) for part in parts for k in part.derived},
        relations=tuple(relation for relation, _ in related),
        related=column([value for _, value in related]),
        balanced=tuple(part.name for part in parts),
        **found,
    )


def _quantities(items: list[tuple[Component, str]], kind: str) -> tuple[Quantity, ...]:
    return tuple(getattr(part, kind)[k].quantity(f"{part.name}.{k}", part.values[k]) for part, k in items)


def _outputs(parts: Iterable[Component], joined: Mapping[str, str]) -> list[tuple[Any, Quantity]]:
    """Symbol and quantity of every output of the parts."""
    shown = ((part, k, d) for part in parts for k, d in _list_outputs(part, joined).items())
    return [(part.symbols[k], _output(part, k, d, joined)) for part, k, d in shown]


def _flows(assembly: Assembly, flows: Container[str]) -> list[tuple[Any, Quantity]]:
    """Symbol and quantity of the flows of ports that are asked for."""
    every = ((port, k, d) for port in assembly.ports().values() for k, d in type(port).flows().items())
    return [(port.symbols[k], d.quantity(path)) for port, k, d in every if (path := f"{port.name}.{k}") in flows]


def _list_outputs(part: Component, joined: Mapping[str, str]) -> dict[str, Declaration]:
    """The outputs of a part, behind those of its states that follow others."""
    following: dict[str, Declaration] = {k: d for k, d in part.states.items() if f"{part.name}.{k}" in joined}
    return {**following, **part.outputs()}


def _output(part: Component, key: str, declaration: Declaration, joined: Mapping[str, str]) -> Quantity:
    path = f"{part.name}.{key}"
    quantity = declaration.quantity(path, part.values[key] if key in part.derived else 0.0)
    return replace(quantity, doc=f"{quantity.doc}; {joined[path]}") if path in joined else quantity


def _imbalances(parts: Sequence[Component]) -> list[Any]:
    """Power that enters each part through its ports and from outside, less what its states gain [W]."""
    storing = {part.name: part for part in parts if part.states}
    stored = column([part.stored_energy() for part in storing.values()])
    states = column([part.symbols[k] for part in storing.values() for k in part.states])
    rates = column([part.derivatives[k] for part in storing.values() for k in part.states])
    gained = dict(zip(storing, ca.densify(ca.jtimes(stored, states, rates)).nonzeros(), strict=True))
    entering = [sum((p.power() for p in part.ports.values()), sum(part.supplied_power(), ca.SX(0))) for part in parts]
    return [power - gained.get(part.name, 0.0) for part, power in zip(parts, entering, strict=True)]
