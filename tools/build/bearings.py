"""Bearings of a unit: the smallest of the catalogue with a bore and the wanted life."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from ...model.units import si_of
from ...scenarios.entries import catalogue

#: Wanted life of bearings [h].
LIFE = 20_000.0
#: Least load of a bearing [N].
LIGHT = 100.0
#: Names of the bearings to choose from, by how they begin.
SERIES = {
    "ball": ("SKF 62", "SKF 63"),
    "tapered": ("SKF 302", "SKF 313", "SKF 320"),
    "cylindrical": ("NU ",),
}
#: What the bearings of a unit roll on, and the kinds of shafts with tooth forces: the first that lasts.
CHOICES = {"auto": ("ball", "tapered"), "ball": ("ball",), "roller": ("tapered",)}
#: Those of shafts without, and of shafts that planets drive, which a pair that is set against each other holds.
UNLOADED = CHOICES | {"auto": ("ball", "cylindrical"), "roller": ("cylindrical",)}
HELD = CHOICES | {"auto": ("tapered", "ball", "cylindrical"), "roller": ("tapered", "cylindrical")}
#: Preload of such a pair over the load rating [1].
PRELOAD = 0.05
#: Largest bore over the diameter of a shaft without a pinion, above which bearings of another kind are taken [1].
THICK = 2.5


@dataclass(frozen=True)
class Size:
    """A bearing to choose: bore, outside diameter, load rating, and axial factor of a tapered one."""

    name: str
    d: float
    D: float
    C: float
    Y: float

    def life(self, F_r: float, pushed: float, other: float, n: float) -> float:
        """Rated life [h] at a speed [1/s], as ISO 281 has it.

        Args:
            F_r: radial load [N]
            pushed: force of the shaft towards the bearing [N]
            other: radial load of a like bearing set against it [N]
            n: speed [1/s]
        """
        if self.Y == 0:
            P, exponent = max(F_r, 0.56 * F_r + 1.6 * pushed), 3.0
        else:  # with no less than its own thrust
            F_a = max(F_r / (2 * self.Y), pushed + other / (2 * self.Y))
            P, exponent = max(F_r, 0.4 * F_r + self.Y * F_a), 10 / 3
        return 1e6 / (3600 * n) * float((self.C / max(P, LIGHT)) ** exponent)


@cache
def sizes(kind: str) -> tuple[Size, ...]:
    """The bearings of a kind, a key of `SERIES`, smallest first."""
    found = []
    for name, entry in catalogue("bearing").items():
        v = {key: si_of(entry.values[key]) for key in ("d", "D", "C") if key in entry.values}
        if name.startswith(SERIES[kind]) and "C" in v:
            found.append(Size(name, v["d"], v["D"], v["C"], float(entry.values.get("Y", 0.0))))
    return tuple(sorted(found, key=lambda size: (size.D, size.d)))


def largest_bore(kinds: Sequence[str]) -> float:
    """Of all bearings of some kinds, keys of `SERIES` [m]."""
    return max(size.d for kind in kinds for size in sizes(kind))


def choose(
    d: float, most: float, radial: Sequence[float], axial: float, n: float, kinds: Sequence[str]
) -> list[tuple[str, tuple[Size, Size], tuple[float, float], float]]:
    """Bearings a and b of a shaft by kind, with their lives [h] and how far their bore is above the largest one [m].

    Those that last come first, of these those without too large a bore, of these in the order of the kinds.
    Balls and cylindrical rollers: a locates. Tapered ones are set against each other; the torque has either direction.

    Args:
        d: bore at least [m]
        most: and at most, where a bearing is as small [m]
        radial: loads of a and b [N]
        axial: force along the shaft [N]
        n: speed of the shaft [1/s]
        kinds: to choose from, keys of `SERIES`
    """
    (a, b), found = radial, []
    fitting = {kind: [size for size in sizes(kind) if size.d >= 0.999 * d] for kind in kinds}
    most = max(most, min(size.d for among in fitting.values() for size in among))
    for kind, among in fitting.items():
        loads = [(a, axial, b), (b, axial if kind == "tapered" else 0.0, a)]
        if among:
            (at_a, life_a), (at_b, life_b) = (_choose_one(among, most, load, n) for load in loads)
            excess = max(at_a.d, at_b.d) - most
            found.append((kind, (at_a, at_b), (life_a, life_b), excess if excess > 1e-6 else 0.0))
    return sorted(found, key=lambda one: (min(one[2]) < LIFE, one[3]))


def _choose_one(among: Sequence[Size], most: float, load: tuple[float, float, float], n: float) -> tuple[Size, float]:
    """The smallest bearing with the wanted life, of no more than a bore if there is one, else that of the longest."""
    lasting = [pair for size in among if (pair := (size, size.life(*load, n)))[1] >= LIFE]
    slim = [pair for pair in lasting if pair[0].d <= most + 1e-6]
    longest = max(among, key=lambda size: size.life(*load, n))
    return next(iter(slim or lasting), (longest, longest.life(*load, n)))
