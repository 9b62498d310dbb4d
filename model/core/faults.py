"""Does every unknown have an equation of its own, and if not: what does not come out even, in words and remedies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ..errors import StructureError
from ..expressions import as_expression
from .component import Equation
from .connect import Assembly, floating, nets
from .declare import Given, Port
from .reduce import Constraint, Known, tie
from .solve import Matching, Unknown

#: Names shown of a set.
SHOWN = 4


#: Problems told at once: what is wrong at one place shows at several.
MOST = 5


def check_structure(
    assembly: Assembly,
    rows: Sequence[Equation],
    unknowns: Sequence[Unknown],
    columns: Sequence[Sequence[int]],
    typical: Mapping[int, float],
) -> None:
    """Refuse a system unless every unknown has an equation of its own and every temperature a level.

    The message names the smallest sets that do not come out even. What is said twice of potentials is missing for
    flows, and the other way round: then the potentials are told.

    Args:
        assembly: the parts
        rows: all equations, rigid couplings reduced
        unknowns: all unknowns
        columns: for each equation the positions of its unknowns
        typical: typical value of every symbol by its hash

    Raises:
        StructureError: an unknown has no equation of its own, or a temperature no level
    """
    if problems := floating(assembly.name, assembly.ports(), rows, unknowns, columns):
        raise StructureError(problems)
    matching = Matching(columns, len(unknowns))
    if not matching.spare_rows and not matching.free_columns:
        return
    faults = Faults(assembly, rows, unknowns, columns, typical)
    much = [faults.too_much(c) for c in _apart(sorted(map(matching.too_many, matching.spare_rows), key=len))]
    little = [faults.too_little(c) for c in _joined(map(matching.too_few, matching.free_columns))]
    found = [*much, *little]
    told = [fault for fault in found if fault.potentials] or found
    raise StructureError(list(dict.fromkeys(problem for fault in told for problem in fault.problems))[:MOST])


def _apart(sets: Iterable[list[int]]) -> list[list[int]]:
    """Those of the sets that share nothing with one before: each is a fault of its own."""
    kept: list[list[int]] = []
    for chosen in sets:
        if not any(set(chosen) & set(other) for other in kept):
            kept.append(chosen)
    return kept


def _joined(sets: Iterable[list[int]]) -> list[list[int]]:
    """The sets, those that share something as one."""
    kept: list[set[int]] = []
    for chosen in sets:
        near = [other for other in kept if not other.isdisjoint(chosen)]
        kept = [other for other in kept if other not in near] + [set(chosen).union(*near)]
    return [sorted(chosen) for chosen in kept]


@dataclass(frozen=True)
class Fault:
    """What is wrong with one set, and whether it is about potentials of ports with a flow (speeds, temperatures)."""

    problems: tuple[str, ...]
    potentials: bool


class Faults:
    """Tells what is wrong with some equations or unknowns of a model.

    Args:
        assembly: the parts
        rows: all equations
        unknowns: all unknowns
        columns: for each equation the positions of its unknowns
        typical: typical value of every symbol by its hash
    """

    def __init__(
        self,
        assembly: Assembly,
        rows: Sequence[Equation],
        unknowns: Sequence[Unknown],
        columns: Sequence[Sequence[int]],
        typical: Mapping[int, float],
    ) -> None:
        self.model, self.rows, self.unknowns, self.columns = assembly.name, rows, unknowns, columns
        self.known = Known.of(assembly, typical)
        self.nets = nets(assembly)
        inputs = [(f"{part.name}.{k}", d, part.is_input(k)) for part in assembly.parts for k, d in part.inputs.items()]
        self.givable = [path for path, _, given in inputs if not given]
        self.chosen = {path for path, d, given in inputs if given and isinstance(d, Given)}

    def too_much(self, chosen: Sequence[int]) -> Fault:
        """Equations at the chosen positions that are one more than their unknowns."""
        inside = sorted({c for r in chosen for c in self.columns[r]})
        rows, unknowns = [self.rows[r] for r in chosen], [self.unknowns[c] for c in inside]
        relation = tie(rows, unknowns, self.known)
        said = [r for r in rows if not r.name.startswith("sum of ")] or rows
        given = self._inputs_of(rows) if relation is None else list(relation.inputs)
        twice, naming = self._twice(unknowns, said)
        if relation is None and any(not type(net[0]).flows() for net in twice):
            given, said = [], naming  # everything hangs on what is given, but that is not what is said twice
        elif relation is None:  # a long way through losses: what is given at its ends says more than all of it
            said = [r for r in said if self._inputs_of([r])] or said
        said.sort(key=lambda r: not self._inputs_of([r]))
        parts = {r.name.partition(": ")[0] for r in said}
        ports = [] if given else [port for net in twice for port in _list_ports(net, parts)]
        ports = ports or self._ends(unknowns, parts)
        where = f" (at {some([p.name for p in ports])})" if ports else ""
        what, remedy = self._contradiction(relation, given, ports)
        text = f"{self.model}: {what}\nToo much is said in {some([r.name for r in said])}{where}.\n{remedy}."
        levels = {name for net in self.nets if type(net[0]).flows() for name in _of_net(net)}
        return Fault((text,), not levels.isdisjoint(u.name for u in unknowns))

    def _contradiction(
        self, relation: Constraint | None, given: Sequence[str], ports: Sequence[Port]
    ) -> tuple[str, str]:
        """What some equations say too much, and what to do about it."""
        held = [] if relation is None else [relation.states[k] for k in relation.acting]
        states, owners = [f"{part.name}.{key}" for part, key in held], name_all([part.name for part, _ in held])
        ways = [self._drop(given)] if given else []
        if relation is not None and given and states:
            ways += [f"leave {owners} out"]
        if relation is not None and len(given) + len(states) > 1:
            ways += [words for words in dict.fromkeys(type(p).instead for p in ports) if words]
        if states and given:
            what = f"{name_all(states)} is a state, but tied rigidly to {name_all(given)}, which is given."
        elif states:
            what = f"{name_all(states)} is a state, but what it is tied to holds it at one value."
            ways = [f"Free {owners} or leave it out; where a loop closes, its ratios have to fit"]
        elif len(given) > 1:
            what = f"{name_all(given)} are given, but one of them follows from the rest."
        elif given:
            what = f"{given[0]} is given, but what it is tied to holds it at one value."
            ways += ["free what holds it; where a loop closes, its ratios have to fit"]
        elif relation is not None and any(type(p).flows() for p in ports):
            what = "two equations say the same, so nothing says what flows on either way."
            ways = [f"Take {name_all(list(dict.fromkeys(map(_owner, ports))), 'or')} away"]
            ways += [words for words in dict.fromkeys(type(p).divides for p in ports) if words]
        else:
            what = "two equations say the same or contradict each other."
            ways = [
                f"Connect {name_all([p.name for p in ports], 'or')} elsewhere" if ports else "Take one of them away"
            ]
        return what, ", or ".join(ways)

    def _drop(self, given: Sequence[str]) -> str:
        """How not to give one of some inputs: by the part's choice, or without the part."""
        free = [path for path in given if path in self.chosen]
        parts = dict.fromkeys(path.rpartition(".")[0] for path in given if path not in self.chosen)
        ways = [f"Do not give {name_all(free, 'or')}"] if free else []
        ways += [f"{'t' if free else 'T'}ake {name_all(list(parts), 'or')} away"] if parts else []
        return ", or ".join(ways)

    def _inputs_of(self, rows: Sequence[Equation]) -> list[str]:
        """The inputs that stand in some equations."""
        held = {s.element_hash() for row in rows for s in ca.symvar(as_expression(row.residual))}
        return [path for h, path in self.known.inputs.items() if h in held]

    def _twice(self, unknowns: Sequence[Unknown], said: Sequence[Equation]) -> tuple[list[list[Port]], list[Equation]]:
        """Nets of which two of some equations name a potential as one of their sides, and these equations."""
        sides = [(side.element_hash(), r) for r in said for side in (r.lhs, r.rhs) if side.is_symbolic()]
        names = {u.symbol.element_hash(): u.name for u in unknowns}
        levels = {name for net in self.nets for name in _of_net(net)}
        count = Counter(symbol for symbol, _ in sides if names.get(symbol) in levels)
        twice = {symbol for symbol, times in count.items() if times > 1}
        met = [net for net in self.nets if not {names[symbol] for symbol in twice}.isdisjoint(_of_net(net))]
        return met, [r for symbol, r in sides if symbol in twice]

    def _ends(self, unknowns: Sequence[Unknown], parts: set[str]) -> list[Port]:
        """Ports of some parts whose flow, or the potentials of whose net, are among some unknowns.

        Parts that pass a potential on from one port to another are left out where others end it.
        """
        names = {u.name for u in unknowns}
        ports = [
            port
            for net in self.nets
            for port in _list_ports(net, parts)
            if not names.isdisjoint((*_of_net(net), *(f"{port.name}.{k}" for k in type(port).flows())))
        ]
        ports = [port for port in ports if type(port).flows()] or ports
        owners = [_owner(port) for port in ports]
        ends = [port for port, owner in zip(ports, owners, strict=True) if owners.count(owner) == 1]
        return ends or ports

    def too_little(self, chosen: Sequence[int]) -> Fault:
        """Unknowns at the chosen positions that have fewer equations than they are."""
        names = {self.unknowns[c].name: None for c in chosen}
        if deaf := self._deaf(names):
            return Fault(tuple(self._describe(net) for net in deaf), True)
        levels = [name for net in self.nets if type(net[0]).flows() for name in _of_net(net) if name in names]
        givable = [path for path in self.givable if path in names]
        inside = set(chosen)
        missing = len(inside) - sum(1 for row in self.columns if not inside.isdisjoint(row))
        several = f"{missing} of " if 1 < missing < len(givable) else ""
        which = f"{several}{name_all(givable, 'and' if missing == len(givable) else 'or')}"
        remedy = f"Give {which}, or connect" if givable else "Give a value, connect"
        what = some(levels or givable or sorted(names, key=lambda name: name.count(".")))
        text = (
            f"{self.model}: {len(self.rows)} equations for {len(self.unknowns)} unknowns.\n"
            f"Nothing determines {what}.\n{remedy} a source or a storage."
        )
        return Fault((text,), bool(levels))

    def _deaf(self, names: Mapping[str, None]) -> list[list[Port]]:
        """Nets of one port, or of ports without a flow, whose potentials, among some unknowns, are only read."""
        sides = [side for row in self.rows for side in (row.lhs, row.rhs)]
        said = {side.element_hash() for side in sides if side.is_symbolic()}
        found = []
        for net in self.nets:
            open_ended = [k for k in type(net[0]).potentials() if f"{net[0].name}.{k}" in names]
            if not open_ended or any(net[0].symbols[k].element_hash() in said for k in open_ended):
                continue
            if len(net) == 1 or not type(net[0]).flows():
                found.append(net)
        return found

    def _describe(self, net: Sequence[Port]) -> str:
        kind, names = type(net[0]), [port.name for port in net]
        if len(net) == 1:
            return f"{self.model}: {names[0]} is connected to nothing: {kind.missing}. Connect it to {kind.source}."
        return f"{self.model}: {some(names)} meet readers only: {kind.missing}. Connect them to {kind.source}."


def _of_net(net: Sequence[Port]) -> list[str]:
    """The names of the potentials of a net: those of its first port."""
    return [f"{net[0].name}.{k}" for k in type(net[0]).potentials()]


def _owner(port: Port) -> str:
    return port.name.rpartition(".")[0]


def _list_ports(net: Sequence[Port], parts: set[str]) -> list[Port]:
    """The ports of a net that belong to some parts."""
    return [port for port in net if _owner(port) in parts]


def some(names: Sequence[str]) -> str:
    """The first few of any number of names, and how many more there are."""
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more


def name_all(names: Sequence[str], word: str = "and") -> str:
    """All names, the last two with a word between them.

    Args:
        names: any number
        word: what stands before the last
    """
    return f" {word} ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))
