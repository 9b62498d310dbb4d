"""Where heat comes from and where it goes: the flows of all heat ports of a machine as paths between named places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...model.core.component import Component
from ...model.core.connect import Assembly, nets
from ...model.core.declare import Port
from ...model.parts.ports import HeatPort, OilPort

#: Flows below this share of the largest one are not told.
LEAST = 1e-3
#: What differs by less than this share is round-off.
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Path:
    """Heat that goes from one place to another: a part that makes it, a body, a way out, the room.

    Attributes:
        begins, ends: names of the places
        through: the part that it flows through, "" for none
        Q_flow: how much, above zero [W]
    """

    begins: str
    ends: str
    through: str
    Q_flow: float


def heat_flows(assembly: Assembly) -> list[str]:
    """Paths of the flows of all ports that heat crosses, as `flatten` takes them."""
    return [_flow(port) for port in assembly.ports().values() if isinstance(port, HeatPort | OilPort)]


def _flow(port: Port) -> str:
    """Path of the flow of a port that heat crosses, by itself or with oil."""
    return f"{port.name}.{'H_flow' if isinstance(port, OilPort) else 'Q_flow'}"


def heat_paths(assembly: Assembly, values: Mapping[str, float]) -> list[Path]:
    """All paths of heat, in the order of the parts.

    Args:
        assembly: the machine
        values: path -> value in SI: the flows of `heat_flows`, and the outputs of the parts
    """
    places = _places(assembly)
    every = [path for part in assembly.parts for path in _paths(part, places, values)]
    least = LEAST * max((path.Q_flow for path in every), default=0.0)
    return [path for path in every if path.Q_flow > least]


@dataclass(frozen=True)
class _Place:
    """A net of heat ports: the part that gives it its name, and whether that part keeps its temperature."""

    name: str
    kept: bool


#: All nets of oil ports together: what heat the oil takes along is told of the whole circuit.
_CIRCUIT = _Place("oil circuit", False)


def _places(assembly: Assembly) -> dict[str, _Place]:
    """The place of each port that heat crosses."""
    parts = {part.name: part for part in assembly.parts}
    found: dict[str, _Place] = {}
    for net in nets(assembly):
        if isinstance(net[0], HeatPort):
            owners = [parts[port.name.rpartition(".")[0]] for port in net]
            rules = [part for part in owners if _rules(part)] or owners
            place = _Place(rules[0].name, _rules(rules[0]) and not rules[0].states)
            found |= {port.name: place for port in net}
        elif isinstance(net[0], OilPort):
            found |= {port.name: _CIRCUIT for port in net}
    return found


def place_names(assembly: Assembly) -> dict[str, str]:
    """The body, oil or room whose temperature each port has that heat crosses."""
    return {port: place.name for port, place in _places(assembly).items()}


def _rules(part: Component) -> bool:
    """Whether a part gives its net a temperature: it stores heat, or is given one."""
    turns = any("w" in port.potentials() and port.flows() for port in part.ports.values())
    return bool(part.states or part.inputs) and not turns


def _paths(part: Component, places: Mapping[str, _Place], values: Mapping[str, float]) -> Iterator[Path]:
    """The paths that begin or end at a part, or go through it."""
    flows: dict[_Place, float] = {}
    for port in part.ports.values():
        if port.name in places:
            place = places[port.name]
            flows[place] = flows.get(place, 0.0) + values[_flow(port)]
    if _rules(part):
        if (by_oil := flows.pop(_CIRCUIT, 0.0)) and (own := next(iter(flows), None)):
            yield from _between(own.name, {_CIRCUIT: by_oil})
            flows[own] += by_oil
        if part.states:  # what a body takes in without storing it leaves the model
            yield from _between(f"{part.name}: outside", flows)
        return
    if len(flows) != 2 or abs(sum(flows.values())) > ROUND_OFF * max(map(abs, flows.values())):
        yield from _between(part.name, flows)
        return
    (begins, Q), (ends, _) = sorted(flows.items(), key=lambda item: -item[1])
    if not ends.kept:
        yield Path(begins.name, ends.name, part.name, Q)
        return
    for name, share in _ways(part, Q, values):
        yield Path(begins.name, name, part.name, share)
        yield Path(name, ends.name, part.name, share)


def _between(name: str, flows: Mapping[_Place, float]) -> Iterator[Path]:
    """What a part gives to places, and what it takes from them."""
    for place, Q in flows.items():
        yield Path(place.name, name, "", Q) if Q > 0 else Path(name, place.name, "", -Q)


def _ways(part: Component, Q: float, values: Mapping[str, float]) -> list[tuple[str, float]]:
    """Name and flow of each way through a part that leads out: convection and radiation where it tells them apart."""
    told = {key: values[f"{part.name}.{key}"] for key in part.outputs() if key.startswith("Q_flow_")}
    if told and abs(sum(told.values()) - Q) <= ROUND_OFF * abs(Q):
        return [(f"{part.name}: {key.removeprefix('Q_flow_')}", value) for key, value in told.items()]
    return [(part.name, Q)]
