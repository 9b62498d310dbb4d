"""What the parts of a machine do, found by their type and the nets they meet in: no part is known by its name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ..core.component import SOUND, Component, Faults
from ..core.declare import Output, Parameter, Port, list_declared
from ..errors import ScenarioError
from ..files import tables
from ..parts.ports import Flange, HeatPort, Lubricant, OilLevel, ShaftReading
from .spec import Spec

#: Causes by which parts of a role may fail, where their class says no more.
FAULTS: Mapping[str, Faults] = tables("model.machines", "faults.toml")

#: Roles of parts that brake a shaft, as a component class states them.
BRAKES = ("teeth", "bearing", "seal", "churning")


@dataclass(frozen=True)
class Place:
    """Parts that sit at one place: on one shaft and between the same bodies, so that no instrument tells them apart.

    Args:
        name: of the parts, in words
        parts: their names
        shaft, inner, outer: ports of the shaft and of the two bodies that take the heat; inner and outer may meet
        lubricant: port of what lubricates, "" where there is nothing
    """

    name: str
    parts: tuple[str, ...]
    shaft: str
    inner: str
    outer: str
    lubricant: str


@dataclass(frozen=True)
class Roles:
    """A machine by what its parts do; names of parts where nothing else is said.

    Args:
        spec: the machine
        places: role ("teeth", "bearing", "seal", "churning") -> places with such parts; where no part moves the oil,
            the first shaft end stands for all that does
        bath: the oil that lubricates most parts, or else the grease; "" without any
        oil, viscosity: paths of its temperature and viscosity; of a body and "" where there is no lubricant
        oil_heat: port of its heat
        shaft: the part whose shaft's speed and torque say what the machine does: w and tau of what is given first
        speed, torque: paths of both
        room: the first room, "" without one
        surfaces: parts between a body and the room's air
        foundation: conductors from bodies to a room
        coolers: coolers, and conductors from oil to the room around a housing, or to what keeps its temperature
        oil_side: conductors between the oil and bodies
        contacts, walls: between bodies: joints, gaps and gaskets, and what is of solid material
        inside, outside: bodies that teeth and inner rings heat, and those of the housing
        thermostats: parts that keep their temperature, switches: those that open coolers at some temperature
    """

    spec: Spec
    places: Mapping[str, tuple[Place, ...]]
    bath: str
    oil: str
    viscosity: str
    oil_heat: str
    shaft: str
    speed: str
    torque: str
    room: str
    surfaces: tuple[str, ...]
    foundation: tuple[str, ...]
    coolers: tuple[str, ...]
    oil_side: tuple[str, ...]
    contacts: tuple[str, ...]
    walls: tuple[str, ...]
    inside: tuple[str, ...]
    outside: tuple[str, ...]
    thermostats: tuple[str, ...]
    switches: tuple[str, ...]

    @staticmethod
    def of(spec: Spec) -> Roles:
        """The roles in a machine. Raises ScenarioError where nothing turns or nothing stores heat."""
        return _find_roles(_Nets(spec))

    @property
    def reading(self) -> str:
        """Port that reads speed and torque of the shaft."""
        return self.reading_of(self.shaft)

    def reading_of(self, part: str) -> str:
        """Port of a part that reads speed and torque."""
        return f"{part}.{next(iter(list_declared(self.nets.classes[part], ShaftReading)))}"

    def value(self, path: str) -> Any:
        """What the rig file says of a parameter, or its default."""
        part, _, key = path.partition(".")
        stated = self.spec.part(part).values
        return stated[key] if key in stated else list_declared(self.nets.classes[part], Parameter)[key].default

    def conductance(self, conductor: str) -> float:
        """What the rig file makes of a conductor between bodies [W/K]."""
        part: Any = self.nets.classes[conductor](conductor, **self.spec.part(conductor).values)
        return float(part.number_at(part.conductance(), part.values))

    @property
    def ends(self) -> tuple[str, ...]:
        """Shaft ends."""
        return self.having("shaft_end")

    @property
    def cooling(self) -> tuple[str, ...]:
        """Paths that scale what the machine gives to its surroundings."""
        return (*self.air_side, *self.scaled(*self.foundation))

    @property
    def air_side(self) -> tuple[str, ...]:
        """Those of surfaces and coolers, which a day changes: draught, humidity, what stands around."""
        paths = self.scaled(*self.surfaces, *self.coolers)
        told = (f"{name}.emissivity" for name in self.surfaces if f"{name}.A" not in paths)
        return (*paths, *told)

    @property
    def daily(self) -> tuple[str, ...]:
        """What differs from day to day: the air side, or all cooling where there is none."""
        return self.air_side or self.cooling

    def having(self, *roles: str) -> tuple[str, ...]:
        """Names of all parts with one of the roles that their classes state."""
        return tuple(p.name for p in self.spec.parts if self.spec.types[p.type].role in roles)

    @cached_property
    def nets(self) -> _Nets:
        """Who meets whom."""
        return _Nets(self.spec)

    def at(self, port: str, *roles: str) -> str:
        """Name of the first part with one of the roles that a port meets, "" for none."""
        met = {p.partition(".")[0] for p in (port, *self.nets.met(port))}
        return next((name for name in self.having(*roles) if name in met), "")

    def room_of(self, surface: str) -> str:
        """The room that takes the heat of a port's body, the first room where it is not known."""
        for part in (*self.surfaces, *self.foundation):
            ports = self.nets.ports(part, HeatPort)
            if surface in ports or set(self.nets.met(surface)) & set(ports):
                return next((room for p in ports if (room := self.at(p, "room"))), self.room)
        return self.room

    def bodies_of(self, conductor: str) -> tuple[str, ...]:
        """Heat ports of a conductor that meet no room and nothing that keeps its temperature."""
        return tuple(p for p in self.nets.ports(conductor, HeatPort) if not self.at(p, "room", "thermostat"))

    @property
    def wetted(self) -> tuple[str, ...]:
        """Conductors between the oil and the housing."""
        outside = set(self.outside)
        return tuple(c for c in self.oil_side if {self.at(p, "body") for p in self.bodies_of(c)} & outside)

    def parts(self, role: str) -> tuple[str, ...]:
        """Names of all parts at the places of a role."""
        return tuple(name for place in self.places[role] for name in place.parts)

    def failing(self, cause: str) -> dict[str, dict[str, float]]:
        """Parts that a cause acts in by their own parameters: place -> path -> exponent of the cause's factor."""
        place = {name: p.name for found in self.places.values() for p in found for name in p.parts}
        failing: dict[str, dict[str, float]] = {}
        for p in self.spec.parts:
            kind = self.spec.types[p.type]
            for key, exponent in faults_of(kind).get(cause, {}).items():
                if key in list_declared(kind, Parameter) and self.value(path := f"{p.name}.{key}"):
                    failing.setdefault(place.get(p.name, p.name), {})[path] = exponent
        return failing

    def scaled(self, *parts: str) -> tuple[str, ...]:
        """Paths of the parameters that scale what the parts do."""
        return tuple(f"{p}.{key}" for p in parts for key in self.spec.types[self.spec.part(p).type].scale)


def takes_power(kind: type[Component]) -> bool:
    """Whether a part tells the power that it takes from a shaft in the machine: a pump, a jet, an added loss."""
    return "P" in list_declared(kind, Output) and "shaft" in list_declared(kind, Port)


def faults_of(kind: type[Component]) -> Faults:
    """Causes by which a part of a type may fail; none where neither its class nor its role declares any."""
    return FAULTS.get(kind.role, SOUND) if kind.faults is None else kind.faults


class _Nets:
    """The nets of a machine, and who meets whom."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.classes: dict[str, type[Component]] = {p.name: spec.types[p.type] for p in spec.parts}
        self.net: dict[str, int] = {}
        for number, group in enumerate(spec.connections):
            met = {self.net[port] for port in group if port in self.net}
            for port, old in self.net.items():
                if old in met:
                    self.net[port] = number
            self.net |= dict.fromkeys(group, number)

    def met(self, port: str) -> list[str]:
        """The ports of a port's net."""
        return [p for p, number in self.net.items() if number == self.net.get(port)]

    def meet(self, a: str, b: str) -> bool:
        """Whether two ports meet."""
        return a in self.net and self.net.get(a) == self.net.get(b)

    def met_by(self, part: str) -> set[int]:
        """Numbers of the heat nets that a part meets."""
        return self.heat_nets([part])

    def ports(self, part: str, kind: type[Port]) -> list[str]:
        """Connected ports of a kind."""
        return [path for key in list_declared(self.classes[part], kind) if (path := f"{part}.{key}") in self.net]

    def ports_of_lubricant(self, part: str) -> list[str]:
        """Connected ports of a part that carry a lubricant."""
        return self.ports(part, Lubricant)

    def of(self, *roles: str) -> tuple[str, ...]:
        return tuple(name for name, cls in self.classes.items() if cls.role in roles)

    def heat_nets(self, parts: Iterable[str]) -> set[int]:
        return {self.net[port] for part in parts for port in self.ports(part, HeatPort)}

    @cached_property
    def bath(self) -> str:
        """What lubricates most, oil before grease."""
        users = [self.net[port] for part in self.classes for port in self.ports(part, Lubricant)]
        for role in ("bath", "grease"):
            if found := self.of(role):
                return max(found, key=lambda name: sum(self.net[p] in users for p in self.ports(name, Lubricant)))
        return ""

    @property
    def tap(self) -> str:
        """Port of the bath's lubricant, "" without a bath."""
        return (
            next((f"{self.bath}.{key}" for key in list_declared(self.classes[self.bath], Lubricant)), "")
            if self.bath
            else ""
        )

    def brakes(self, role: str) -> tuple[Place, ...]:
        """The places of a role."""
        found: dict[tuple[int, ...], Place] = {}
        for part in self.of(role):
            shafts, heats = self.ports(part, Flange), self.ports(part, HeatPort)
            if not shafts or not heats:
                continue
            lubricant = next(iter(self.ports(part, Lubricant)), self.tap)
            place = Place(part, (part,), min(shafts, key=self.shaft_rank), heats[0], heats[-1], lubricant)
            key = tuple(self.net[port] for port in (place.shaft, place.inner, place.outer))
            if (known := found.get(key)) is not None:
                place = replace(known, name=f"{known.name}, {part}", parts=(*known.parts, part))
            found[key] = place
        return tuple(found.values())

    def shaft_rank(self, port: str) -> int:
        """Shaft ends first, what is held last."""
        met = {self.spec.part(p.partition(".")[0]).type for p in self.met(port)}
        if any(self.spec.types[kind].role == "shaft_end" for kind in met):
            return 0
        return 2 if "FixedFlange" in met else 1

    def shaft(self) -> str:
        """The shaft end or clutch of which the torque is given, or else the speed."""
        able = {name for name in self.of("shaft_end", "clutch") if list_declared(self.classes[name], ShaftReading)}
        readers = [p for p in self.spec.parts if p.name in able]
        if not readers:
            raise ScenarioError(
                f"{self.spec.name}: there is no shaft end, so nothing says how it turns. Add a ShaftEnd."
            )
        clutches = {p.name for p in readers if self.classes[p.name].role == "clutch"}
        return min(readers, key=lambda p: 0 if p.name in clutches else 1 if p.values.get("given") else 2).name

    def body_of(self, net: int) -> str:
        """The body or oil whose heat meets in a net."""
        return next((name for name in self.of("bath", "body") if self.net.get(f"{name}.heat") == net), "")

    def inside_outside(self, contacts: Iterable[str], outer: set[int]) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Bodies that teeth and inner rings heat and what hangs on them, and those of the housing."""
        hot = {self.net[p] for part in self.of("teeth") for p in self.ports(part, HeatPort)}
        hot |= {self.net[f"{p}.inner"] for p in self.of("bearing", "seal") if f"{p}.inner" in self.net}
        grown = True
        while grown:
            joined = {n for c in contacts if self.heat_nets([c]) & outer for n in self.heat_nets([c])} - hot - outer
            outer, grown = outer | joined, bool(joined)
        bodies = self.of("body")
        outside = tuple(b for b in bodies if self.heat_nets([b]) & outer)
        return tuple(b for b in bodies if b not in outside), outside


def _find_roles(nets: _Nets) -> Roles:
    """All roles in the nets of a machine."""
    rooms, keeping = nets.of("room"), nets.of("thermostat")
    air, kept = nets.heat_nets(rooms), nets.heat_nets(keeping)
    oil = nets.net.get(f"{nets.bath}.heat", -1)
    conductors = nets.of("conductor", "jet")
    ends = {c: nets.heat_nets([c]) for c in conductors}
    surfaces = nets.of("surface")
    # beside a housing that cools, what takes heat from the oil itself to the room is its cooler
    direct = [c for c in conductors if surfaces and oil in ends[c] and ends[c] & air]
    exchangers = tuple(c for c in conductors if c in direct or faults_of(nets.classes[c]).get("cooling.cooler"))
    foundation = tuple(c for c in conductors if ends[c] & air and c not in exchangers)
    kept_by = tuple(c for c in conductors if ends[c] & kept and c not in (*foundation, *exchangers))
    inner = [c for c in conductors if c not in (*foundation, *kept_by, *exchangers)]
    oil_side = tuple(c for c in inner if oil in ends[c] or nets.ports(c, Lubricant) or nets.ports(c, OilLevel))
    between = tuple(c for c in inner if c not in oil_side)
    contacts = tuple(c for c in between if "cooling.contact" in faults_of(nets.classes[c]))
    outer = (nets.heat_nets([*surfaces, *foundation]) - air) - {oil}
    inside, outside = nets.inside_outside(between, outer)
    if not (warm := nets.body_of(oil) or next(iter((*inside, *outside)), "")):
        raise ScenarioError(f"{nets.spec.name}: nothing stores heat. Add an OilBath or a HeatCapacity.")
    shaft = nets.shaft()
    clutch = nets.classes[shaft].role == "clutch"
    places = {role: nets.brakes(role) for role in BRAKES}
    flanges = [port for end in nets.of("shaft_end") for port in nets.ports(end, Flange)]
    if nets.bath and flanges and not places["churning"]:
        places["churning"] = (Place(nets.bath, (), flanges[0], f"{warm}.heat", f"{warm}.heat", nets.tap),)
    return Roles(
        spec=nets.spec,
        places=places,
        bath=nets.bath,
        oil=f"{warm}.T",
        viscosity=f"{nets.bath}.nu" if nets.bath else "",
        oil_heat=f"{warm}.heat",
        shaft=shaft,
        speed=f"{shaft}.w_a" if clutch else f"{shaft}.w",
        torque=f"{shaft}.tau",
        room=next(iter(rooms), ""),
        surfaces=surfaces,
        foundation=foundation,
        coolers=(*kept_by, *nets.of("cooler"), *exchangers),
        oil_side=oil_side,
        contacts=contacts,
        walls=tuple(c for c in between if c not in contacts),
        inside=inside,
        outside=outside,
        thermostats=keeping,
        switches=nets.of("switch"),
    )
