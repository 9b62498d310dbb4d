"""Parts and the nets that connect their ports."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..errors import StructureError, suggestion
from .component import Component
from .declare import Port

Connection = tuple[str, ...]


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


def nets(assembly: Assembly) -> list[list[Port]]:
    """The groups of ports that meet, single ports included, in the order of the parts.

    Raises:
        StructureError: all connections to ports that do not exist or of different types, and doubled part names
    """
    ports = assembly.ports()
    problems = _problems(assembly, ports)
    if problems:
        raise StructureError(problems)
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


def _problems(assembly: Assembly, ports: dict[str, Port]) -> Iterable[str]:
    names = [part.name for part in assembly.parts]
    problems = [
        f'{assembly.name}: two parts are called "{n}". Rename one.'
        for n in sorted({n for n in names if names.count(n) > 1})
    ]
    for connection in assembly.connections:
        written = ", ".join(connection)
        missing = [path for path in connection if path not in ports]
        problems += [
            f'{assembly.name}: connect [{written}]: there is no port "{p}".{suggestion(p, ports)}' for p in missing
        ]
        kinds = {type(ports[path]).__name__ for path in connection if path in ports}
        if len(kinds) > 1:
            problems.append(
                f"{assembly.name}: connect [{written}] joins ports of different kinds ({', '.join(sorted(kinds))})."
            )
        if len(connection) < 2:
            problems.append(f"{assembly.name}: connect [{written}] names one port only. Name at least two.")
    return problems
