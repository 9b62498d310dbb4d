"""Where shafts, teeth and couplings of any machine lie in a plane: from its parts and the flanges that meet."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...model.core.component import Component
from ...model.core.connect import Assembly, nets
from ...model.parts.ports import Flange
from ...model.parts.shaft import FixedFlange

#: Distance of two meshes on one shaft.
STEP = 1.5
#: Half the width of a set between shafts in line.
HALF = 0.8
#: Sum of the radii of the pair with the largest centre distance.
SPREAD = 2.2
#: The smallest radius.
LEAST = 0.22
#: Room beside a set in line, from its middle.
SIDE = 0.5
#: From the outermost mesh to the middle of the wall.
MARGIN = 0.95


@dataclass
class Shaft:
    """What turns as one: a line from `origin` along `axis`, from `low` to `high`.

    `closed` says at which ends it meets a set in line, so that nothing stands there.
    """

    parts: tuple[str, ...]
    origin: np.ndarray
    axis: np.ndarray
    group: int
    at: list[float] = field(default_factory=list)
    low: float = 0.0
    high: float = 0.0
    closed: set[str] = field(default_factory=set)

    @property
    def flat(self) -> bool:
        """Whether it lies from left to right, and not from above to below."""
        return bool(abs(self.axis[0]) > 0.5)

    def point(self, s: float, aside: float = 0.0) -> np.ndarray:
        """The place at a distance along the shaft and beside it, below it or to its right."""
        return np.asarray(self.origin + s * self.axis + aside * np.array((0.0, -1.0) if self.flat else (1.0, 0.0)))

    def beside(self, aside: float) -> Shaft:
        """A line beside it."""
        return Shaft((), self.point(0.0, aside), self.axis, self.group)


@dataclass(frozen=True)
class Mesh:
    """A part that joins shafts: two on parallel or crossed axes with radii, or those in line with a set between them.

    Attributes:
        part: which one
        shafts: those it joins, each with the port and the place on it
        radii: of both gears, none for a set in line
        held: ports of what does not turn
        inner: parts on shafts inside the set, such as the bearings of planets
    """

    part: Component
    shafts: tuple[tuple[Shaft, str, float], ...]
    radii: tuple[float, ...] = ()
    held: tuple[str, ...] = ()
    inner: tuple[str, ...] = ()


@dataclass(frozen=True)
class Train:
    """All shafts and what joins them."""

    shafts: tuple[Shaft, ...]
    meshes: tuple[Mesh, ...]


def lay_out(assembly: Assembly) -> Train:
    """The train of a machine, begun at its first shaft end and read from left to right."""
    return _Layout(assembly).train()


class _Layout:
    """The shafts that have their place, and the parts that join them."""

    def __init__(self, assembly: Assembly) -> None:
        self.parts = {part.name: part for part in assembly.parts}
        self.nets = [net for net in nets(assembly) if isinstance(net[0], Flange)]
        self.net = {port.name: k for k, net in enumerate(self.nets) for port in net}
        for part in (part for part in assembly.parts if part.axes == "same"):
            flanges = [port.name for port in part.ports.values() if isinstance(port, Flange)]
            one, other = self.net[flanges[0]], self.net[flanges[-1]]
            self.nets[one] = [*self.nets[one], *self.nets[other]]
            self.net |= {port.name: one for port in self.nets[other]}
            self.nets[other] = []
        self.joins = [part for part in assembly.parts if self._joins(part)]
        self.longest = max((sum(_real(part)) for part in self.joins), default=0.0)
        self.placed: dict[int, Shaft] = {}
        self.meshes: dict[str, Mesh] = {}
        self.groups = 0

    def _flanges(self, part: Component) -> list[tuple[str, int]]:
        ports = ((key, port) for key, port in part.ports.items() if isinstance(port, Flange))
        return [(key, self.net[port.name]) for key, port in ports if port.name in self.net]

    def _joins(self, part: Component) -> bool:
        flanges = self._flanges(part)
        return bool(flanges) and part.axes != "same" and (part.role == "teeth" or len({net for _, net in flanges}) > 1)

    def _role(self, net: int) -> set[str]:
        return {self.parts[port.name.partition(".")[0]].role for port in self.nets[net]}

    def _held(self, net: int) -> bool:
        return any(isinstance(self.parts[port.name.partition(".")[0]], FixedFlange) for port in self.nets[net])

    def train(self) -> Train:
        """Place shaft after shaft."""
        order = sorted((k for k, net in enumerate(self.nets) if net), key=lambda k: "shaft_end" not in self._role(k))
        for k in order:
            inside = all(self.parts[p.name.partition(".")[0]].role != "shaft_end" for p in self.nets[k])
            if k in self.placed or (inside and self.placed):
                continue
            lowest = min((s.origin[1] for s in self.placed.values()), default=2.0) - 2.0
            self._place(k, np.array([0.0, lowest]), np.array([1.0, 0.0]), self.groups)
            self._follow(k, 0.0)
        self._extend()
        return Train(tuple(self.placed.values()), tuple(self.meshes.values()))

    def _place(self, net: int, origin: np.ndarray, axis: np.ndarray, group: int) -> Shaft:
        self.groups = max(self.groups, group + 1)
        names = tuple(dict.fromkeys(port.name.partition(".")[0] for port in self.nets[net]))
        self.placed[net] = Shaft(names, origin, axis, group)
        return self.placed[net]

    def _follow(self, net: int, s: float) -> None:
        """Place what a shaft drives, one part after the other along it, then what those drive."""
        shaft, reached = self.placed[net], []
        for part in self.joins:
            if part.name in self.meshes or net not in (known := dict(self._flanges(part)).values()):
                continue
            free = [(key, k) for key, k in self._flanges(part) if k not in self.placed]
            if len(set(known)) == 2 and part.axes != "coaxial" and free:
                reached.append((free[0][1], self._pair(part, net, free[0][1], s)))
                s += STEP
            elif not free and len(set(known)) > 1:
                self.meshes[part.name] = self._coupling(part)
            else:
                reached += [(k, s + HALF + STEP) for k in self._in_line(part, net, s + HALF)]
                s += 2 * HALF + STEP
        for other, place in reached:
            self._follow(other, place)
        shaft.at.sort()

    def _pair(self, part: Component, net: int, other: int, s: float) -> float:
        """Two gears side by side; where the next one stands on the other shaft."""
        shaft = self.placed[net]
        small, large = self._radii(part)
        first = self._flanges(part)[0][1] == net
        mine, its = (small, large) if first else (large, small)
        away = abs(mine - its) if getattr(part, "turn", -1.0) > 0 else mine + its
        if part.axes == "parallel":
            there = self._place(other, shaft.point(0.0, away), shaft.axis, shaft.group)
            place = s
        else:  # a worm's axes cross at a distance that is seen from above
            crossed = part.axes == "crossed"
            turned = np.array([shaft.axis[1], -shaft.axis[0]])
            there = self._place(other, shaft.point(s + its * (not crossed)), turned, self.groups)
            place = 0.0 if crossed else mine
            shaft.at += [s - its, s + its] if crossed else []
            shaft.closed |= set() if crossed else {"high"}
        shaft.at.append(s)
        there.at.append(place)
        ends = [(shaft, s, net), (there, place, other)]
        keys = {k: key for key, k in self._flanges(part)}
        found = tuple((one, keys[k], at) for one, at, k in (ends if first else ends[::-1]))
        self.meshes[part.name] = Mesh(part, found, (small, large))
        return place + STEP

    def _radii(self, part: Component) -> tuple[float, float]:
        """Radii as they are drawn: their ratio is real, their sum grows with the root of the real one."""
        small, large = _real(part)
        whole = SPREAD * ((small + large) / self.longest) ** 0.5
        r = min(max(whole * small / (small + large), LEAST), whole - LEAST)
        return r, whole - r

    def _in_line(self, part: Component, net: int, s: float) -> list[int]:
        """A set in line with its shaft; the shafts that go on behind it."""
        shaft = self.placed[net]
        shaft.at += [s - SIDE, s]
        flanges = [(key, k) for key, k in self._flanges(part) if k != net]
        held = tuple(key for key, k in flanges if self._held(k))
        on = [(key, k) for key, k in flanges if key not in held and self._goes_on(part, k)]
        inner = [k for key, k in flanges if key not in held and (key, k) not in on]
        if on:
            shaft.closed.add("high")
        shafts = [(shaft, next(key for key, k in self._flanges(part) if k == net), s)]
        for key, k in on:
            if k not in self.placed:
                self._place(k, shaft.origin, shaft.axis, shaft.group)
                self.placed[k].closed.add("low")
                self.placed[k].at += [s, s + SIDE]
            shafts.append((self.placed[k], key, s))
        met = dict.fromkeys(port.name.partition(".")[0] for k in inner for port in self.nets[k])
        inside = tuple(name for name in met if self.parts[name].role == "bearing")
        self.meshes[part.name] = Mesh(part, tuple(shafts), (), held, inside)
        return [k for _, k in on]

    def _goes_on(self, part: Component, net: int) -> bool:
        """Whether a shaft leads to an end or to another part, and not only to bearings inside."""
        owners = {port.name.partition(".")[0] for port in self.nets[net]} - {part.name}
        return any(self.parts[name].role == "shaft_end" or self.parts[name] in self.joins for name in owners)

    def _coupling(self, part: Component) -> Mesh:
        """What joins two shafts in line that have their places already: it stands between them."""
        shafts = sorted((self.placed[k] for _, k in self._flanges(part)), key=lambda shaft: min(shaft.at))
        s = (max(shafts[0].at) + min(shafts[-1].at)) / 2
        shafts[0].closed.add("high")
        shafts[-1].closed.add("low")
        for shaft in shafts:
            shaft.at.append(s)
        return Mesh(part, tuple((shaft, key, s) for shaft, (key, _) in zip(shafts, self._flanges(part), strict=True)))

    def _extend(self) -> None:
        """Let shafts reach the walls, which are common to those that lie along each other."""
        for group in range(self.groups):
            mine = [shaft for shaft in self.placed.values() if shaft.group == group]
            every = [s for shaft in mine for s in shaft.at] or [0.0]
            for shaft in mine:
                shaft.low = min(shaft.at) if "low" in shaft.closed else min(every) - MARGIN
                shaft.high = max(shaft.at) if "high" in shaft.closed else max(every) + MARGIN


def _real(part: Component) -> tuple[float, ...]:
    """Radii of a pair on axes apart [m]; none for a set in line."""
    if part.axes == "coaxial":
        return ()
    return tuple(abs(part.number_at(size, part.values)) for size in part.sizes().values())
