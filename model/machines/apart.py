"""A machine cut into pieces that exchange heat: each a machine of its own, for simulators that are coupled.

A cut goes through a net of heat ports. The piece with the body of that net keeps it and is given the heat flow rate of
every other piece; these are given the temperature of the body. Where the temperature is given from outside, each piece
is given it alike. Nets of any other kind are not cut.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ..core.connect import nets
from ..core.declare import Input, Parameter, Port, State, list_declared
from ..errors import ScenarioError, suggestion
from ..parts import PARTS
from ..parts.ports import AirPort, HeatPort
from .spec import PartSpec, Spec

#: Name of the piece of all parts that no other piece has.
REST = "gearbox"


@dataclass(frozen=True)
class Joint:
    """An output of one piece that is an input of another, by path."""

    giver: str
    output: str
    taker: str
    input: str


@dataclass(frozen=True)
class Pieces:
    """The pieces of a machine by name, what they pass to each other, and inputs that several of them are given alike.

    Attributes:
        shared: path of an input -> the pieces that have it
    """

    specs: Mapping[str, Spec]
    joints: tuple[Joint, ...]
    shared: Mapping[str, tuple[str, ...]]


def cut_machine(spec: Spec, groups: Mapping[str, Sequence[str]]) -> Pieces:
    """Cut a machine.

    Args:
        spec: the machine
        groups: name of a piece -> its parts; what is left is the piece `REST`

    Raises:
        ScenarioError: everything that is wrong with the groups at once: unknown parts, parts named twice, nets that
            cannot be cut
    """
    piece_of, problems = _pieces(spec, groups)
    if problems:
        raise ScenarioError(problems)
    cut = _Cut(spec, piece_of)
    for net in nets(spec.assembly()):
        cut.net(net)
    if cut.problems:
        raise ScenarioError(cut.problems)
    return cut.result()


def _pieces(spec: Spec, groups: Mapping[str, Sequence[str]]) -> tuple[dict[str, str], list[str]]:
    """The piece of every part, and what is wrong."""
    known = [part.name for part in spec.parts]
    piece_of: dict[str, str] = {}
    problems = []
    for name, part in ((name, part) for name, members in groups.items() for part in members):
        if part not in known:
            problems.append(f'{spec.name}: there is no part "{part}".{suggestion(part, known)}')
        elif part in piece_of:
            problems.append(f"{spec.name}: {part} is in {piece_of[part]} and in {name}. Name it once.")
        piece_of[part] = name
    problems += [
        f'{spec.name}: the name of an FMU is one word of letters, digits and _, not "{n}". Rename it.'
        for n in groups
        if not n.isidentifier()
    ]
    if REST in groups:
        problems.append(f'{spec.name}: "{REST}" holds all parts that are named nowhere. Call this one otherwise.')
    rest = [part for part in known if part not in piece_of]
    if not rest:
        problems.append(f"{spec.name}: no part is left for {REST}. Leave the shafts in it.")
    return piece_of | dict.fromkeys(rest, REST), problems


@dataclass
class _Cut:
    """Goes from net to net and collects what the pieces get."""

    spec: Spec
    piece_of: Mapping[str, str]
    problems: list[str] = field(default_factory=list)
    inside: list[tuple[str, ...]] = field(default_factory=list)
    #: (body, piece that is without it) -> ports there that have its temperature
    away: dict[tuple[str, str], list[Port]] = field(default_factory=dict)

    def net(self, net: Sequence[Port]) -> None:
        """Take up one net: as it is in one piece, or cut at its body."""
        by_piece: dict[str, list[Port]] = {}
        for port in net:
            by_piece.setdefault(self._piece(port), []).append(port)
        if len(by_piece) == 1:
            self.inside += [tuple(port.name for port in net)] if len(net) > 1 else []
            return
        bodies = [port for port in net if self._gives_temperature(port)]
        names = ", ".join(port.name for port in net)
        if not isinstance(net[0], HeatPort):
            self.problems.append(
                f"{self.spec.name}: [{names}] would be cut between {' and '.join(by_piece)}, and it is a"
                f" {type(net[0]).__name__}. Only nets of heat ports are cut: put these parts into one FMU."
            )
        elif not bodies:
            self.problems.append(
                f"{self.spec.name}: [{names}] would be cut between {' and '.join(by_piece)}, and no part of it is a"
                " body or a room. Put its parts into one FMU, or a HeatCapacity there."
            )
        else:
            here = self._piece(bodies[0])
            self.inside += [tuple(port.name for port in by_piece[here])] if len(by_piece[here]) > 1 else []
            for piece, ports in by_piece.items():
                if piece != here:
                    self.away.setdefault((_owner(bodies[0]), piece), []).extend(ports)

    def result(self) -> Pieces:
        """The pieces with what stands in them for the bodies of others, and for the heat of others."""
        parts = {piece: [p for p in self.spec.parts if self.piece_of[p.name] == piece] for piece in self._names()}
        connections: dict[str, list[tuple[str, ...]]] = {piece: [] for piece in parts}
        for paths in self.inside:
            connections[self.piece_of[paths[0].partition(".")[0]]].append(paths)
        joints: list[Joint] = []
        shared: dict[str, tuple[str, ...]] = {}
        for (body, piece), ports in self.away.items():
            home = self.piece_of[body]
            stand_in = self._stand_in(body, ports)
            parts[piece].append(stand_in)
            connections[piece] += _list_nets(stand_in, ports)
            if "T" in list_declared(self._type(body), Input):
                shared[f"{body}.T"] = (*shared.get(f"{body}.T", (home,)), piece)
                continue
            several = sum(where == piece and self.piece_of[b] == home for b, where in self.away) > 1
            source = f"{piece}_{body}" if several else piece
            parts[home].append(PartSpec(source, "PrescribedHeatFlow"))
            connections[home].append((f"{source}.heat", self._heat_port(body)))
            joints += [
                Joint(home, f"{body}.T", piece, f"{body}.T"),
                Joint(piece, f"{body}.Q_flow", home, f"{source}.Q_flow"),
            ]
        types = {**PARTS, **self.spec.types}
        specs = {
            piece: Spec(piece, f"{piece} of {self.spec.doc}", tuple(own), tuple(connections[piece]), types)
            for piece, own in parts.items()
        }
        return Pieces(specs, tuple(joints), shared)

    def _names(self) -> Iterator[str]:
        yield REST
        yield from dict.fromkeys(piece for piece in self.piece_of.values() if piece != REST)

    def _piece(self, port: Port) -> str:
        return self.piece_of[_owner(port)]

    def _type(self, part: str) -> type:
        return self.spec.types[self.spec.part(part).type]

    def _gives_temperature(self, port: Port) -> bool:
        kind = self._type(_owner(port))
        return isinstance(port, HeatPort) and "T" in {**list_declared(kind, State), **list_declared(kind, Input)}

    def _heat_port(self, body: str) -> str:
        """A heat port of a body that is none to moving air."""
        ports = list_declared(self._type(body), Port).items()
        return next(f"{body}.{key}" for key, p in ports if isinstance(p, HeatPort) and not isinstance(p, AirPort))

    def _stand_in(self, body: str, ports: Iterable[Port]) -> PartSpec:
        """The part of a body's name and temperature in a piece that is without it."""
        kind = "Room" if any(isinstance(port, AirPort) for port in ports) else "PrescribedTemperature"
        known = {**list_declared(PARTS[kind], Parameter), **list_declared(PARTS[kind], Input)}
        values = self.spec.part(body).values
        return PartSpec(body, kind, {key: value for key, value in values.items() if key in known})


def _list_nets(stand_in: PartSpec, ports: Sequence[Port]) -> list[tuple[str, ...]]:
    """The nets of a stand-in: one of moving air, one of the rest."""
    air = [port.name for port in ports if isinstance(port, AirPort)]
    rest = [port.name for port in ports if not isinstance(port, AirPort)]
    plain = "floor" if air else "heat"
    found = [(f"{stand_in.name}.air", *air)] if air else []
    return found + ([(f"{stand_in.name}.{plain}", *rest)] if rest else [])


def _owner(port: Port) -> str:
    return port.name.partition(".")[0]
