"""Bearings of a unit: the smallest of the catalogue with a bore and the wanted life."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from ...model.units import si_of
from ...scenarios.entries import catalogue

#: Wanted life of bearings [h]: the middle of 10,000 to 25,000 for gears of general use (SKF6000, table 8).
LIFE = 16_000.0
#: Least load of a bearing [N].
LIGHT = 100.0
#: Names of the bearings to choose from, by how they begin.
SERIES = {
    "ball": ("SKF 62", "SKF 63"),
    "tapered": ("SKF 30", "SKF 313", "SKF 320", "SKF 322", "SKF 323"),
    "cylindrical": ("NU ",),
}
#: Pairs that hold a shaft: the bearing that locates, and the other one. Cylindrical rollers carry more than a ball, so
#: beside one they are at the end with more load.
BALLS = ("ball", "ball")
TAPERED = ("tapered", "tapered")
ROLLERS = ("cylindrical", "cylindrical")
FLOATING = ("ball", "cylindrical")
#: What the bearings of a unit roll on, and the pairs of shafts with tooth forces, those that rub least first.
CHOICES = {"auto": (BALLS, FLOATING, TAPERED), "ball": (BALLS,), "roller": (TAPERED,)}
#: Those of shafts without, and of shafts that planets drive, which a pair that is set against each other holds.
UNLOADED = CHOICES | {"auto": (BALLS, ROLLERS), "roller": (ROLLERS,)}
HELD = CHOICES | {"auto": (TAPERED, BALLS, ROLLERS), "roller": (TAPERED, ROLLERS)}
#: Preload of such a pair over the load rating [1].
PRELOAD = 0.05
#: Largest bore over the diameter of a shaft without a pinion, above which bearings of another kind are taken [1].
THICK = 2.5


@dataclass(frozen=True)
class Size:
    """A bearing to choose: kind, bore, outside diameter, load rating, and axial factor of a tapered one."""

    name: str
    kind: str
    d: float
    D: float
    C: float
    Y: float

    @property
    def steep(self) -> bool:
        """Whether a tapered one carries more along the shaft than across."""
        return 0 < self.Y < 1

    def life(self, F_r: float, pushed: float, other: float, n: float) -> float:
        """Rated life [h] at a speed [1/s], as ISO 281 has it.

        Args:
            F_r: radial load [N]
            pushed: force of the shaft towards the bearing [N]
            other: radial load of a like bearing set against it [N]
            n: speed [1/s]
        """
        if self.Y == 0:
            P, exponent = max(F_r, 0.56 * F_r + 1.6 * pushed), 3.0 if self.kind == "ball" else 10 / 3
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
            found.append(Size(name, kind, v["d"], v["D"], v["C"], float(entry.values.get("Y", 0.0))))
    return tuple(sorted(found, key=lambda size: (size.D, size.d, size.C)))


def largest_bore(pairs: Sequence[tuple[str, str]]) -> float:
    """Of all bearings of some pairs [m]."""
    return max(min(max(size.d for size in sizes(kind)) for kind in pair) for pair in pairs)


def choose(
    d: float, most: float, radial: Sequence[float], axial: float, n: float, pairs: Sequence[tuple[str, str]]
) -> list[tuple[tuple[Size, Size], tuple[float, float], float]]:
    """Bearings a and b of a shaft for each pair, with their lives [h] and how far their bore is above the most [m].

    Those that last come first, of these those without too large a bore, of these in the order of the pairs.
    The first of a pair locates, that is a of like ones. Tapered ones are set against each other; the torque has either
    direction.

    Args:
        d: bore at least [m]
        most: and at most, where a bearing is as small [m]
        radial: loads of a and b [N]
        axial: force along the shaft [N]
        n: speed of the shaft [1/s]
        pairs: to choose from, of keys of `SERIES`
    """
    (a, b), found = radial, []
    fitting = [[[size for size in sizes(kind) if size.d >= 0.999 * d] for kind in pair] for pair in pairs]
    most = max(most, min(size.d for both in fitting for among in both for size in among))
    for pair, both in zip(pairs, fitting, strict=True):
        if all(both):
            order = -1 if pair == FLOATING and a > b else 1
            (F, other), pushed = radial[::order], axial if pair == TAPERED else 0.0
            loads = (F, axial, other), (other, pushed, F)
            chosen = [_choose_one(among, most, load, n) for among, load in zip(both, loads, strict=True)]
            (at_a, life_a), (at_b, life_b) = chosen[::order]
            excess = max(at_a.d, at_b.d) - most
            found.append(((at_a, at_b), (life_a, life_b), excess if excess > 1e-6 else 0.0))
    return sorted(found, key=lambda one: (min(one[1]) < LIFE, one[2]))


def _choose_one(among: Sequence[Size], most: float, load: tuple[float, float, float], n: float) -> tuple[Size, float]:
    """The smallest bearing with the wanted life, of no more than a bore if there is one, else that of the longest life.
    Of tapered ones as large, the steep one, which rubs more, is for more axial than radial load.
    """
    rated, along = [(size, size.life(*load, n)) for size in among], load[1] > load[0]
    lasting = [pair for pair in rated if pair[1] >= LIFE]
    slim = [pair for pair in lasting if pair[0].d <= most + 1e-6]
    last = max(rated, key=lambda pair: pair[1])
    return min(slim or lasting, key=lambda pair: (pair[0].D, pair[0].steep != along), default=last)
