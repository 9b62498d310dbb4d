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
SERIES = {"ball": ("SKF 62", "SKF 63"), "tapered": ("SKF 302", "SKF 313", "SKF 320"), "cylindrical": ("NU ",)}
#: What the bearings of a unit roll on, and the kinds of shafts with and without tooth forces: the first that lasts.
CHOICES = {"auto": ("ball", "tapered"), "ball": ("ball",), "roller": ("tapered",)}
UNLOADED = {"auto": ("ball", "cylindrical"), "ball": ("ball",), "roller": ("cylindrical",)}
#: Bore over the diameter of the shaft, above which bearings of another kind are taken if theirs is less [1].
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
    d: float, radial: Sequence[float], axial: float, n: float, kinds: Sequence[str]
) -> tuple[str, list[tuple[Size, float]]]:
    """Kind and bearings a and b of a shaft, each with its life [h]: the first kind that lasts, not too large a bore.

    Balls and cylindrical rollers: a locates. Tapered ones are set against each other; the torque has either direction.

    Args:
        d: bore at least [m]
        radial: loads of a and b [N]
        axial: force along the shaft [N]
        n: speed of the shaft [1/s]
        kinds: to choose from, keys of `SERIES`
    """
    a, b = radial
    found = []
    for kind in kinds:
        fitting = [size for size in sizes(kind) if size.d >= 0.999 * d]
        loads = [(a, axial, b), (b, axial if kind == "tapered" else 0.0, a)]
        if fitting:
            found.append((kind, [_choose_one(fitting, load, n) for load in loads]))
    lasting = [pair for pair in found if all(life >= LIFE for _, life in pair[1])]
    slim = [pair for pair in lasting if all(size.d <= THICK * d for size, _ in pair[1])]
    return (slim or lasting or [max(found, key=lambda pair: min(life for _, life in pair[1]))])[0]


def _choose_one(fitting: Sequence[Size], load: tuple[float, float, float], n: float) -> tuple[Size, float]:
    """The smallest bearing with the wanted life, else the one with the longest."""
    lives = [(size, size.life(*load, n)) for size in fitting]
    return next((pair for pair in lives if pair[1] >= LIFE), max(lives, key=lambda pair: pair[1]))
