"""Shafts of a gear unit: diameters by torsion, bearings by bore and life that have room on and beside the gears."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

from ...model.errors import ScenarioError
from .bearings import CHOICES, HELD, LIFE, PRELOAD, THICK, UNLOADED, choose, largest_bore
from .stages import BevelStage, PlanetaryStage, Stage, WormStage

#: Shear stress of shafts [Pa].
SHEAR = 25e6
#: Distance of the bearings of a bevel pinion over how far its mid face overhangs [1].
OVERHANG = 2.5
#: Distance of the bearings of a worm over its wheel's diameter [1].
APART = 0.9
#: Distance of bearings over their bore, of a shaft without tooth forces [1].
BARE = 1.3
#: Bore of bearings on a carrier, which its shaft begins at, over the diameter of that shaft [1]: at a diameter [m], and
#: by which power of it less. Fitted to makers' masses: servo units need stiffer carriers than larger ones.
CARRIER = 1.6, 0.025, 0.12
#: Of a housing's wall between two bearings beside each other [m].
WEB = 0.003


@dataclass(frozen=True)
class Shaft:
    """A shaft: torque, speed [1/s], diameters of its larger and smaller seat, that by torsion and that asked of seats,
    places of its gears and bearing b, both bearings with outside diameters, lives [h] and kinds, how much too large
    their bore is for the pinion that is cut on the shaft, and their preload [N] where no teeth load them.
    """

    T: float
    n: float
    d: float
    d_seal: float
    d_torsion: float
    bore: float
    places: tuple[float, ...]
    span: float
    bearings: tuple[str, str]
    outer: tuple[float, float]
    lives: tuple[float, float]
    kinds: tuple[str, str]
    excess: float
    preload: float

    @property
    def lasts(self) -> bool:
        """Whether both bearings have the wanted life."""
        return min(self.lives) >= LIFE


def draw_shafts(stages: Sequence[Stage], bearings: str) -> tuple[Shaft, ...]:
    """The shafts of a unit: of what bearings there are to choose from, those that last and have room.

    Args:
        stages: of the unit
        bearings: a key of `CHOICES`
    """
    options = [list(enumerate(_shafts(stages, k, bearings))) for k in range(len(stages) + 1)]

    def merit(chosen: Sequence[tuple[int, Shaft]]) -> tuple[int, int, int]:
        shafts = [shaft for _, shaft in chosen]
        tight = sum(gap < 0 for gap in gaps(stages, shafts)) + sum(shaft.excess > 0 for shaft in shafts)
        return sum(not shaft.lasts for shaft in shafts), tight, sum(rank for rank, _ in chosen)

    return tuple(shaft for _, shaft in min(product(*options), key=merit))


def gaps(stages: Sequence[Stage], shafts: Sequence[Shaft]) -> list[float]:
    """Of each stage with parallel shafts, what is left of the wall between bearings at the narrower end [m]."""
    beside = [(s, pair) for s, pair in zip(stages, pairwise(shafts), strict=True) if s.parallel]
    return [s.a - WEB - max((D_1 + D_2) / 2 for D_1, D_2 in zip(x.outer, y.outer, strict=True)) for s, (x, y) in beside]


def find_tight(stages: Sequence[Stage], shafts: Sequence[Shaft]) -> set[int]:
    """Stages with parallel shafts whose bearings have no room beside each other, or on the pinion's shaft."""
    beside = [k for k, s in enumerate(stages) if s.parallel]
    return {k for k, gap in zip(beside, gaps(stages, shafts), strict=True) if gap < 0 or shafts[k].excess}


def _carried(d: float) -> float:
    """Bore of the bearings on a carrier with a shaft of a diameter [m]."""
    wider, at, power = CARRIER
    return d * max(wider * math.pow(at / d, power), 1.0)


def _shafts(stages: Sequence[Stage], k: int, bearings: str) -> list[Shaft]:
    """What the shaft behind k stages may be, one for each kind of bearings, the best first."""
    before, behind = stages[k - 1 : k] if k else (), stages[k : k + 1]
    T = behind[0].T if behind else before[0].T * before[0].u
    n = behind[0].n if behind else before[0].n / before[0].u
    d = (16 * T / (math.pi * SHEAR)) ** (1 / 3)
    side = stages[0].x - stages[0].b / 2
    wheels = [s for s in stages if not isinstance(s, PlanetaryStage)]  # forces on sun and carrier are in balance
    gears = [(s.forces[1], s.x, s.r_2) for s in before if s in wheels]
    gears += [(s.forces[0], s.x, s.r_1) for s in behind if s in wheels]
    pairs = (CHOICES if gears else UNLOADED if behind else HELD)[bearings]
    if d > (most := largest_bore(pairs)):
        raise ScenarioError(
            f"{T / 1000:.4g} kN.m at a shaft inside need {1000 * d:.0f} mm, and the catalogue's bearings for it end at"
            f" {1000 * most:.0f} mm. Give another ratio or order of stages, or a lower power."
        )
    bore = d if gears or behind else min(_carried(d), next(most for p in pairs if (most := largest_bore([p])) >= d))
    span = max(s.x + s.b / 2 for s in wheels) + side if gears else BARE * bore
    if k == 0 and isinstance(stages[0], BevelStage):  # the pinion overhangs bearing b, where the apex is
        beyond = side + stages[0].b / 2
        span = OVERHANG * beyond
        gears = [(stages[0].forces[0], span + beyond, stages[0].r_1)]
    elif behind and isinstance(behind[0], WormStage):
        span = max(APART * 2 * behind[0].r_2, span if before else 0.0)
        gears[-1] = behind[0].forces[0], span / 2, behind[0].r_1
    axial = abs(sum((1 if i else -1) * F[2] for i, (F, _, _) in enumerate(gears)))
    planes = [(F[0], (1 if i else -1) * F[1], x, F[2] * r) for i, (F, x, r) in enumerate(gears)]
    far = [sum(p[0] * p[2] for p in planes) / span, sum(p[1] * p[2] + p[3] for p in planes) / span]
    near = [sum(p[i] for p in planes) - far[i] for i in (0, 1)]
    most = min([s.root for s in behind if s in wheels], default=THICK * bore)
    places = tuple(x for _, x, _ in gears)
    return [
        Shaft(
            *(T, n, max(a.d, b.d), min(a.d, b.d), d, bore, places, span, (a.name, b.name), (a.D, b.D), lives),
            (a.kind, b.kind),
            excess,
            PRELOAD * min(a.C, b.C) if a.Y and not gears else 0.0,
        )
        for (a, b), lives, excess in choose(bore, most, [math.hypot(*F) for F in (near, far)], axial, n, pairs)
    ]
