"""Parts and the nets that connect their ports: what meets nothing, and what has no level."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..errors import StructureError, suggestion
from .component import Component, Equation
from .declare import Port, list_declared
from .solve import Unknown, column

Connection = tuple[str, ...]

#: Ports of a connection that a message shows.
SHOWN = 4


@dataclass(frozen=True)
class Assembly:
    """A model before flattening: parts by name, and connections, each a group of port paths that meet."""

    name: str
    doc: str
    parts: tuple[Component, ...]
    connections: tuple[Connection, ...]

    def ports(self) -> dict[str, Port]:
        """All ports by path, in the order of the parts."""
        return {port.name: port for part in self.parts for port in part.ports.values()}

    @cached_property
    def nets(self) -> list[list[Port]]:
        """The groups of ports that meet. Raises StructureError as `nets`."""
        ports = self.ports()
        if problems := _problems(self, ports):
            raise StructureError(problems)
        found = _merge_nets(self, ports)
        if problems := _open_ports(self.name, self.parts, found) or _clashes(self, found):
            raise StructureError(problems)
        return found


def nets(assembly: Assembly) -> list[list[Port]]:
    """The groups of ports that meet, single ports included, in the order of the parts.

    Connections that share a port are one net: so a machine is extended without a word about what it has. Where that
    would make one body of two that are written apart, it is more likely a slip, and refused.

    Raises:
        StructureError: all connections to ports that do not exist or of different types, and doubled part names; or
            else all ports and parts that have to be connected and are not
    """
    return assembly.nets


def _clashes(assembly: Assembly, nets: Sequence[Sequence[Port]]) -> list[str]:
    """What parts say of those that they meet."""
    owners = {port.name: part for part in assembly.parts for port in part.ports.values()}
    around = {port.name: net for net in nets for port in net}
    return [
        f"{assembly.name}: {problem}"
        for part in assembly.parts
        if type(part).clashes is not Component.clashes
        for problem in part.clashes(
            {
                key: [owners[other.name] for other in around[port.name] if owners[other.name] is not part]
                for key, port in part.ports.items()
            }
        )
    ]


def _merge_nets(assembly: Assembly, ports: dict[str, Port]) -> list[list[Port]]:
    """The ports of each net, connections that share one joined."""
    net_of = {path: [port] for path, port in ports.items()}
    for connection in assembly.connections:
        first = net_of[connection[0]]
        for path in connection[1:]:
            other = net_of[path]
            if other is not first:
                first.extend(other)
                for port in other:
                    net_of[port.name] = first
    order = {path: i for i, path in enumerate(ports)}
    unique = {id(net): net for net in net_of.values()}
    return [sorted(net, key=lambda port: order[port.name]) for net in unique.values()]


def _problems(assembly: Assembly, ports: dict[str, Port]) -> list[str]:
    names = Counter(part.name for part in assembly.parts)
    problems = [
        f'{assembly.name}: two parts are called "{n}". Rename one.'
        for n in sorted(n for n, count in names.items() if count > 1)
    ]
    absent = _absent(assembly)
    for connection in assembly.connections:
        written = ", ".join(connection[:SHOWN]) + (", ..." if len(connection) > SHOWN else "")
        problems += [f"{assembly.name}: connect [{written}] {p}" for p in _wrong(connection, ports, absent)]
    return problems or _short_circuits(assembly)


def _absent(assembly: Assembly) -> dict[str, str]:
    """Ports that a part of its type may have and this one has not: path -> what to do."""
    return {
        f"{part.name}.{key}": port.absent
        for part in assembly.parts
        for key, port in list_declared(type(part), Port).items()
        if key not in part.ports
    }


def _wrong(connection: Connection, ports: Mapping[str, Port], absent: Mapping[str, str]) -> Iterator[str]:
    """What is wrong with one connection."""
    missing = [path for path in dict.fromkeys(connection) if path not in ports]
    for path in missing:
        if path in absent:
            yield f'names "{path}", which is not there under the values of its part. {absent[path]}'
            continue
        owner = path.rpartition(".")[0]
        of_part = [known for known in ports if known.rpartition(".")[0] == owner]
        has = f" {owner} has {', '.join(of_part)}." if of_part else ""
        yield f'names "{path}", and there is no such port.{suggestion(path, ports) or has}'
    kinds: dict[str, str] = {}
    for path in connection:
        if path in ports:
            kinds.setdefault(type(ports[path]).__name__, path)
    if len(kinds) > 1:
        written = " and ".join(f"{path} is a {kind}" for kind, path in kinds.items())
        yield f"joins ports of different kinds: {written}. Connect ports of one kind."
    if len(connection) < 2:
        yield "names one port only. Name at least two that meet."
    for path in (path for path, times in Counter(connection).items() if times > 1):
        yield f"names {path} twice. Name it once."


def _short_circuits(assembly: Assembly) -> list[str]:
    """Ports named in two connections that hold different storages: one body would be made of two."""
    stores = {part.name for part in assembly.parts if part.states}
    seen: dict[str, set[str]] = {}
    problems = []
    for connection in assembly.connections:
        here = {path.rpartition(".")[0] for path in connection} & stores
        for path in connection:
            before = seen.setdefault(path, here)
            if (one := sorted(before - here)) and (other := sorted(here - before)):
                problems.append(
                    f"{assembly.name}: {path} is named in two connections, one with {one[0]} and one with {other[0]}: "
                    f"they would be one net. Name {path} in one of them. To join {one[0]} and {other[0]} on purpose, "
                    "name a port of each in one connection."
                )
    return problems


def _open_ports(model: str, parts: Sequence[Component], nets: Sequence[Sequence[Port]]) -> list[str]:
    """Parts that are connected to nothing, and ports that have to meet another and do not.

    Which those are, the type of the port says (`must_meet`), or the part: a gear's flange may stay open, where no
    torque acts. A part that is the whole model has nothing to meet.
    """
    if len(parts) < 2:
        return []
    alone = {net[0].name for net in nets if len(net) == 1}
    return [problem for part in parts for problem in _open(model, part, alone)]


def _open(model: str, part: Component, alone: set[str]) -> Iterator[str]:
    names = [port.name for port in part.ports.values()]
    if names and alone.issuperset(names):
        yield (
            f"{model}: {part.name} ({type(part).__name__}) is connected to nothing. "
            f"Connect {' or '.join(names)}, or take {part.name} out."
        )
        return
    for port in part.ports.values():
        kind = type(port)
        if port.needed and port.name in alone:
            yield f"{model}: {port.name} is connected to nothing: {kind.missing}. Connect it to {kind.source}."


def floating(
    model: str,
    ports: Mapping[str, Port],
    rows: Sequence[Equation],
    unknowns: Sequence[Unknown],
    columns: Sequence[Sequence[int]],
) -> list[str]:
    """Groups of ports that are connected with each other but with nothing that gives their potentials a level.

    All temperatures of a group without storage and room could rise together and no equation would notice.

    Args:
        model: its name, for messages
        ports: path -> port
        rows: the equations
        unknowns: what they are solved for
        columns: for each equation the places of the unknowns in it
    """
    levels: dict[int, tuple[Port, str]] = {}
    for c, unknown in enumerate(unknowns):
        path, _, name = unknown.name.rpartition(".")
        if path in ports and name in type(ports[path]).levels:
            levels[c] = (ports[path], name)
    problems = []
    for group in _groups(levels, columns):
        inside = set(group)
        touching = [rows[r].residual for r, row in enumerate(columns) if inside.intersection(row)]
        z = column([unknowns[c].symbol for c in group])
        slope = ca.jtimes(column(touching), z, ca.SX.ones(*z.shape))
        if _zero(slope):
            port, name = levels[group[0]]
            names = [levels[c][0].name for c in group]
            more = f" and {len(names) - 3} more" if len(names) > 3 else ""
            what, remedy = type(port).potentials()[name].doc, type(port).levels[name]
            problems.append(
                f"{model}: nothing gives {', '.join(names[:3])}{more} a {what}: all of it could rise together. "
                f"Connect {remedy}."
            )
    return problems


def _groups(levels: dict[int, tuple[Port, str]], columns: Sequence[Sequence[int]]) -> list[list[int]]:
    """Potentials that equations link, without those groups of which an equation determines one by itself."""
    leader = {c: c for c in levels}

    def root(c: int) -> int:
        while leader[c] != c:
            leader[c] = leader[leader[c]]
            c = leader[c]
        return c

    held = []
    for row in columns:
        linked = [c for c in row if c in levels]
        if linked and len(row) == 1:
            held.append(linked[0])
        for c in linked[1:]:
            leader[root(c)] = root(linked[0])
    anchored = {root(c) for c in held}
    groups: dict[int, list[int]] = {}
    for c in levels:
        groups.setdefault(root(c), []).append(c)
    return [group for key, group in groups.items() if key not in anchored]


def _zero(slope: object) -> bool:
    """Whether an expression vanishes, at a few places drawn at random."""
    free = ca.symvar(slope)
    function = ca.Function("slope", [column(free)], [slope])
    random = np.random.default_rng(0)
    values = np.array([function(random.uniform(0.5, 1.5, len(free))).full().ravel() for _ in range(3)])
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    return bool(np.isfinite(values).all() and size <= 1e-12)
