"""Sizes of a gear unit from its name plate, by usual design rules: stages, shafts, bearings, housing.

Nothing here is measured or verified: the numbers are what a first draft would have, so that a rig runs before its
drawings are at hand. Every rule is told beside the number that it gives. The oil follows from the sizes: how high it
stands, what dips into it and what it wets.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from scipy.optimize import brentq

from ...model.errors import ScenarioError
from ...model.units import si_of
from ...scenarios.entries import catalogue
from .allowed import IN_LINE, LAST, check, first_ratio, safe
from .data_sheet import Wanted
from .shafts import Shaft, draw_shafts, find_tight
from .stages import BevelStage, PlanetaryStage, Stage, WormStage
from .teeth import CENTRES, CLOSE, MAKE, larger

#: Thickness of walls: that of the smallest ones [m], and what is added of the largest stage [1].
WALL = 0.003, 0.025
#: From a gear to the middle of a bearing, in thicknesses of a wall; gears, tips and walls have one between them [1].
SIDE = 2.5
#: From there to the end of the housing [1].
END = 4.0
#: Least width of a housing over its largest centre distance [1], fitted to makers' (Flender H1, NMRV): bearings and the
#: foot ask for it; the hub of the wheel of a worm that is alone is a hollow shaft.
WIDE = {"worm": 1.4, "gears": 1.1}
#: Below the tips [1].
BELOW = 4.0
#: How deep the smallest wheel dips, in modules.
DIP = 3.0
#: Least oil of a sump over the power [m3/W], fitted to Flender H1 of 60 to 600 kW: below a single stage it is deeper.
SUMP = 1.1e-7
#: Share of what is below the level that is oil [1].
FILLED = 0.8
#: Share of the housing's volume that is oil where no level follows from wheels: of worms; of planets, fitted to
#: makers' units of 1 to 110 kN.m.
SHARE = {"worm": 0.16, "planetary": 0.11}
#: Surface, and volume, of a cylinder over those of the box around it, whatever its length [1].
ROUND = math.pi / 4
#: On the ratio of the first of several stages, tried in this order until whole teeth come close to the ratio of all.
SHIFTS = (1.0, 0.98, 1.02, 0.96, 1.04)
#: Share of the walls that bath and splash reach [1].
REACHED = 0.55
#: Speed of thrown oil over that of the pitch line [1]; it runs along the walls at most as fast as it falls.
ALONG = 0.5


@dataclass(frozen=True)
class Unit:
    """A gear unit: ratio that is asked for, stages and shafts from the fast one on, the box around them and what is
    free below tips; of a data sheet the oil [m3] and the last centre distance [m]; area of the box around gears [m2].
    """

    asked: float
    stages: tuple[Stage, ...]
    shafts: tuple[Shaft, ...]
    wall: float
    length: float
    width: float
    height: float
    below: float
    volume: float | None = None
    centre: float | None = None
    drawn: float = math.inf

    @property
    def increases(self) -> bool:
        """Whether the input is the slow shaft."""
        return self.asked < 1

    @property
    def ratio(self) -> float:
        """Of all stages."""
        return math.prod(s.u for s in self.stages) ** (-1 if self.increases else 1)

    @property
    def power(self) -> float:
        """At the input [W]."""
        return self.stages[0].T * 2 * math.pi * self.stages[0].n

    @property
    def numbers(self) -> list[int]:
        """Of the stages as they are here, from the fast shaft on, counted from the input."""
        return list(range(1, len(self.stages) + 1))[:: -1 if self.increases else 1]

    @property
    def turn(self) -> int:
        """Sense of rotation of the output, 1 for that of the input."""
        return math.prod(s.turn for s in self.stages)

    @property
    def shape(self) -> float:
        """Surface and volume over those of the box: around a ring the housing is round."""
        return ROUND if isinstance(self.stages[-1], PlanetaryStage) else 1.0

    @property
    def area(self) -> float:
        """Of the housing."""
        return 2 * self.shape * (self.length * (self.width + self.height) + self.width * self.height)


def unit(
    kinds: Sequence[str],
    ratio: float,
    power: float,
    speed: float,
    bearings: str = "auto",
    wanted: Wanted = Wanted(),
) -> Unit:
    """A gear unit for a name plate.

    Args:
        kinds: of the stages, from the input on, keys of `KINDS`
        ratio: speed of the input over that of the output; below 1 the input is the slow shaft
        power: at the input [W]
        speed: of the input [rad/s]
        bearings: "ball", "roller", or "auto" for rollers where balls do not last or have no room
        wanted: what is known beside the name plate

    Raises:
        ScenarioError: unknown kinds, or more than so many stages of so much can do
    """
    check(kinds, ratio, power, speed, bearings, wanted)
    kinds, fast = (kinds, speed) if ratio >= 1 else (kinds[::-1], speed / ratio)
    centres = [None] * (len(kinds) - 1) + [wanted.centre]
    while True:
        stages = _stages(kinds, max(ratio, 1 / ratio), power / fast, fast / (2 * math.pi), centres)
        shafts = draw_shafts(stages, bearings)
        tight = find_tight(stages, shafts) - {len(kinds) - 1 if wanted.centre else -1}
        if not tight or max(stages[k].a for k in tight) > CENTRES[-1] / 2000:
            break
        centres = [larger(max(s.a, centres[k] or 0.0)) if k in tight else centres[k] for k, s in enumerate(stages)]
    last, wall = stages[-1], _wall(stages)
    span = last.x + last.b / 2 + side_of(stages) + sum(s.span for s in (shafts[0], shafts[-1]) if not s.places)
    box = 0.0, span + 2 * END * wall, 0.0, BELOW * wall
    drawn = _around(Unit(ratio, stages, shafts, wall, *box, wanted.volume, wanted.centre))
    return _boxed(drawn, drawn if wanted.box else _enlarged(drawn, power), wanted)


def _stages(
    kinds: Sequence[str], ratio: float, T: float, n: float, centres: Sequence[float | None]
) -> tuple[Stage, ...]:
    """Stages by load, or of centre distances, side by side."""
    shifts = SHIFTS if len(kinds) > 1 else SHIFTS[:1]
    tried = [_geared(kinds, ratio, (T, n), centres, shift) for shift in shifts]
    found = min(tried, key=lambda own: max(abs(math.prod(s.u for s in own) / ratio - 1), CLOSE))
    wall = _wall(found)
    least = WIDE[kind_of_box(found)] * max((s.a for s in found if s.kind != IN_LINE), default=0.0) - 2 * END * wall
    side = max(SIDE * wall, (least - sum(s.b + wall for s in found) + wall) / 2)
    x = accumulate((s.b + wall for s in found), initial=side)
    return tuple(replace(s, x=start + s.b / 2) for s, start in zip(found, x, strict=False))


def _geared(
    kinds: Sequence[str], ratio: float, drive: tuple[float, float], centres: Sequence[float | None], shift: float
) -> list[Stage]:
    """Stages for a torque and a speed; a shift is on the ratio of the first."""
    (T, n), found = drive, list[Stage]()
    for k, kind in enumerate(kinds):
        found.append(made := MAKE[kind](kind, first_ratio(ratio, kinds[k:], shift), T, n, centres[k]))
        T, n, ratio, shift = T * made.u, n / made.u, ratio / made.u, 1.0
    return found


def kind_of_box(stages: Sequence[Stage]) -> str:
    """What the shares of a housing go by: a worm that is alone, or gears."""
    return LAST if [s.kind for s in stages] == [LAST] else "gears"


def side_of(stages: Sequence[Stage]) -> float:
    """From the first and the last gear to the middle of a bearing [m]."""
    return stages[0].x - stages[0].b / 2


def _wall(stages: Sequence[Stage]) -> float:
    """Thickness of the walls."""
    return round(WALL[0] + WALL[1] * max(s.along for s in stages), 4)


def _around(drawn: Unit) -> Unit:
    """The unit in the box around its gears."""
    stages, wall = drawn.stages, drawn.wall
    tips = [(s.r_1 + s.m_n, s.r_2 + s.m_n) for s in stages]
    beyond, room = 4 * wall, (3 + BELOW) * wall
    length = sum(s.along for s in stages) + tips[-1][1] + beyond + _first(stages[0])
    height = 2 * max(max(pair) for pair in tips) + room
    if isinstance(stages[-1], WormStage):  # the wheel stands on the worm, gears before it at the worm's end
        length = drawn.shafts[-2].span + 2 * END * wall + sum(s.b + wall for s in stages[:-1])
        height = max(s.a + sum(pair) for s, pair in zip(stages, tips, strict=True)) + room
    elif isinstance(stages[-1], PlanetaryStage):  # one behind the other, gears before them beside the axis
        rings = [s.reach + 4 * s.m_n for s in stages if isinstance(s, PlanetaryStage)]
        ring = max([*rings, *(D / 2 for D in drawn.shafts[-1].outer)])
        gears = [(s, tip) for s, tip in zip(stages, tips, strict=True) if not isinstance(s, PlanetaryStage)]
        beside = sum(s.along for s, _ in gears) + sum(_first(stages[0]) for _ in gears[:1])
        length = max(beside, ring) + ring + beyond
        height = max([2 * ring + beyond, *(2 * max(tip) + room for _, tip in gears)])
    return replace(drawn, length=length, height=height)


def _enlarged(drawn: Unit, power: float) -> Unit:
    """The unit in a housing larger on all sides that holds the oil which the power asks for, or a data sheet has where
    that is less.
    """

    def grown(by: float) -> Unit:
        length, width, height = (by * side for side in (drawn.length, drawn.width, drawn.height))
        return replace(drawn, length=length, width=width, height=height, below=drawn.below + height - drawn.height)

    def lacks(by: float) -> float:
        return asked - float(bath(replace(grown(by), volume=None))["volume"]) / 1000

    asked = min(SUMP * power, drawn.volume or math.inf)
    if not any(map(dips, drawn.stages)) or lacks(1.0) <= 0:
        return drawn
    return grown(brentq(lacks, 1.0, 1.0 + (asked / FILLED) ** (1 / 3) / min(_floor(drawn) ** 0.5, drawn.height)))


def _floor(made: Unit) -> float:
    """Of the sump [m2]."""
    return (made.length - 2 * made.wall) * (made.width - 2 * made.wall)


def _first(stage: Stage) -> float:
    """How far the first gear reaches beyond its axis; a bevel pinion ends at the wall, its bearings stand outside."""
    return 0.0 if isinstance(stage, BevelStage) else stage.r_1 + stage.m_n


def _boxed(plain: Unit, made: Unit, wanted: Wanted) -> Unit:
    """The unit in the housing, and with the oil, that a data sheet says; plain is that in the box around its gears."""
    sides = made.length, made.width, made.height
    box = wanted.box or tuple(side * math.sqrt((wanted.area or made.area) / made.area) for side in sides)
    below = min(made.below, max(plain.below, made.below + box[2] - made.height))
    found = replace(made, length=box[0], width=box[1], height=box[2], below=below, drawn=made.area)
    drawn = plain.length, plain.width, plain.height
    room = 2 * made.wall + _folded(made), 2 * (END - 1) * made.wall, made.wall + plain.below
    least = [side - part for side, part in zip(drawn, room, strict=True)]
    if any(side < need for side, need in zip(box, least, strict=True)):
        need = made.area * max(part / side for part, side in zip(least, sides, strict=True)) ** 2
        expected = _sides([math.ceil(1000 * side) / 1000 for side in least])
        raise ScenarioError(
            f"--housing of {_sides(box)} is too small for the gears: expected {expected} at least, or"
            f" {safe(need, 3, math.ceil)} m2 by its area alone. Give a larger one, or a lower power or ratio."
        )
    level = bath(found)["level"] or (wanted.volume or 0.0) / (found.length * found.width)
    if level > found.height - made.wall:
        most = 1000 * FILLED * _floor(found) * height_of_axes(made)
        raise ScenarioError(
            f"--oil-volume of {1000 * (wanted.volume or 0.0):.3g} l stands {1000 * level:.0f} mm high in a housing of"
            f" {_sides(box)}. Give {most:.3g} l or less, which reaches the axes."
        )
    return found


def _folded(made: Unit) -> float:
    """How much shorter a housing may be whose output stands behind the input, as of coaxial geared motors [m]."""
    if any(type(s) is not Stage for s in made.stages):
        return 0.0
    last, row = made.stages[-1], sum(s.along for s in made.stages)
    longest = max(s.r_1 + s.a + s.r_2 for s in made.stages)
    return row + made.stages[0].r_1 + last.r_2 - longest


def _sides(box: Sequence[float]) -> str:
    """Sides of a box as the command line has them."""
    return f"{'x'.join(f'{1000 * side:.0f}' for side in box)} mm"


def dips(stage: Stage) -> bool:
    """Whether a stage's wheel dips as the law of churning has it: planets and worms do otherwise."""
    return not isinstance(stage, PlanetaryStage | WormStage)


def lowest(stage: Stage) -> float:
    """Radius of what dips of a stage: of a worm, which stands below its wheel, the worm's own."""
    return stage.r_1 if isinstance(stage, WormStage) else stage.reach


def height_of_axes(made: Unit, k: int = 0) -> float:
    """Height of a shaft's axis above the bottom of the housing: all in one plane, but for that of a worm wheel [m]."""
    raised = made.stages[-1].a if isinstance(made.stages[-1], WormStage) and k == len(made.stages) else 0.0
    return made.below + max(max(s.r_1, lowest(s)) + s.m_n for s in made.stages) + raised


def bath(made: Unit) -> dict[str, Any]:
    """Volume [l] and, where wheels dip, level [m] of the oil of a unit; and their rule."""
    given, floor = made.volume, _floor(made)
    if not any(map(dips, made.stages)):
        share = SHARE[made.stages[-1].kind]
        volume = given or share * made.shape * made.length * made.width * made.height
        rule = "data sheet" if given else f"assumed: {100 * share:.0f} % of the housing's volume"
        return {"volume": 1000 * volume, "level": None, "rule": rule}
    taken = f"gears, ribs and shafts take {100 * (1 - FILLED):.0f} % of what is below it"
    if given:
        return {
            "volume": 1000 * given,
            "level": given / FILLED / floor,
            "rule": f"data sheet; its level assumed: {taken}",
        }
    smallest = min(made.stages, key=lowest)
    level = height_of_axes(made) - lowest(smallest) + min(DIP * smallest.m_n, lowest(smallest))
    named = {"worm": "worm", "planetary": "smallest set of planets"}.get(smallest.kind, "smallest wheel")
    rule = f"assumed: level above the housing's bottom at which the {named} dips by {DIP:g} modules; {taken}"
    return {"volume": 1000 * FILLED * level * floor, "level": level, "rule": rule}


def stands_in_oil(made: Unit, k: int, bearing: str) -> bool:
    """Whether a bearing of the unit reaches below the level.

    Args:
        made: the unit
        k: its shaft, from the input on
        bearing: its name in the catalogue
    """
    level, D = bath(made)["level"], si_of(catalogue("bearing")[bearing].values["D"])
    return level is not None and height_of_axes(made, k) - D / 2 < level


def compute_wetted_area(stage: Stage) -> float:
    """Half of the sides of a stage's wheels and their rims [m2]."""
    return stage.count * (math.pi * stage.r_2**2 + 2 * math.pi * stage.r_2 * stage.b)


def splash(made: Unit) -> dict[str, float]:
    """What a unit's walls have from the gear that throws most: the first that dips, and the shaft it is on."""
    return {
        "A": REACHED * made.area,
        "shaft": 0 if isinstance(made.stages[0], WormStage) else 1,
        "share": ALONG,
    }
