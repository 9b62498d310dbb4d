"""Sizes of a gear unit from its name plate, by usual design rules: stages, shafts, bearings, housing.

Nothing here is measured or verified: the numbers are what a first draft would have, so that a rig runs before its
drawings are at hand. Every rule is told beside the number that it gives. The oil follows from the sizes: how high it
stands, what dips into it and what it wets.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...model.errors import ScenarioError
from ...model.units import si_of
from ...scenarios.entries import catalogue
from .bearings import CHOICES, UNLOADED, largest_bore
from .data_sheet import Wanted
from .shafts import SHEAR, SIDE, Shaft, draw_shafts
from .stages import KINDS, LEAST, MOST, BevelStage, PlanetaryStage, Stage, WormStage
from .teeth import MAKE

#: How much whole numbers of teeth may add to a ratio [1].
ROUNDED = 1.05
#: Kinds of stages of which a centre distance may be given.
CENTRED = ("spur", "helical", "worm")
#: Of the box around the gears, what is room between them and its walls [m].
ROOM = (0.040, 0.050, 0.080)
#: Kinds of stages that stand last: a worm behind helical stages, planets behind any gears or other planets.
LAST = "worm"
IN_LINE = "planetary"
#: Between gears [m].
GAP = 0.010
#: How deep the smallest wheel dips, in modules.
DIP = 3.0
#: Share of what is below the level that is oil [1].
FILLED = 0.8
#: Room below the tips [m].
BELOW = 0.040
#: Share of the housing's volume that is oil where no level follows from wheels.
SHARE = 0.16
#: Share of the walls that bath and splash reach [1].
REACHED = 0.55
#: Speed of the oil along the walls over that of the pitch line [1].
ALONG = 0.5


@dataclass(frozen=True)
class Unit:
    """A gear unit: ratio that is asked for, stages, shafts, the box around them; of a data sheet the oil [m3] and the
    last centre distance [m].
    """

    asked: float
    stages: tuple[Stage, ...]
    shafts: tuple[Shaft, ...]
    wall: float
    length: float
    width: float
    height: float
    volume: float | None = None
    centre: float | None = None

    @property
    def ratio(self) -> float:
        """Of all stages."""
        return math.prod(s.u for s in self.stages)

    @property
    def turn(self) -> int:
        """Sense of rotation of the output, 1 for that of the input."""
        return math.prod(s.turn for s in self.stages)

    @property
    def area(self) -> float:
        """Of the box."""
        return 2 * (self.length * self.width + self.length * self.height + self.width * self.height)


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
        ratio: speed of the input over that of the output
        power: at the input [W]
        speed: of the input [rad/s]
        bearings: "ball", "roller", or "auto" for rollers where balls do not last or have no room
        wanted: what is known beside the name plate

    Raises:
        ScenarioError: unknown kinds, or more than so many stages of so much can do
    """
    check(kinds, ratio, power, speed, bearings, wanted)
    T, n, x = power / speed, speed / (2 * math.pi), SIDE
    found: list[Stage] = []
    left = ratio
    for k, kind in enumerate(kinds):
        centre = wanted.centre if k == len(kinds) - 1 else None
        made = MAKE[kind](kind, _share(left, kinds[k:]), T, n, x, centre)
        found.append(made)
        T, n, x, left = T * made.u, n / made.u, x + made.b + GAP, left / made.u
    span = x - GAP + SIDE
    shafts = draw_shafts(found, span, bearings)
    wall = max(0.008, 0.025 * found[-1].along + 0.003)
    tips = [(s.r_1 + s.m_n, s.r_2 + s.m_n) for s in found]
    length = sum(s.along for s in found) + tips[-1][1] + 0.040 + 2 * wall
    height = 2 * max(max(pair) for pair in tips) + 0.080 + 2 * wall
    if isinstance(found[-1], WormStage):  # the wheel stands on the worm, gears before it at the worm's end
        length = shafts[-2].span + 0.090 + sum(s.b + GAP for s in found[:-1])
        height = max(s.a + sum(pair) for s, pair in zip(found, tips, strict=True)) + 0.080 + 2 * wall
    elif isinstance(found[-1], PlanetaryStage):  # one behind the other, gears before them beside the axis
        ring = max(s.reach + 4 * s.m_n for s in found if isinstance(s, PlanetaryStage))
        gears = [(s, tip) for s, tip in zip(found, tips, strict=True) if not isinstance(s, PlanetaryStage)]
        beside = sum(s.along for s, _ in gears) + sum(_first(found[0], shafts[0]) for _ in gears[:1])
        length = max(beside, ring) + ring + 0.040 + 2 * wall
        height = max([2 * ring + 0.040, *(2 * max(tip) + 0.080 for _, tip in gears)]) + 2 * wall
    else:
        length += _first(found[0], shafts[0])
    drawn = Unit(ratio, tuple(found), shafts, wall, length, span + 0.090, height, wanted.volume, wanted.centre)
    return _boxed(drawn, wanted)


def _first(stage: Stage, shaft: Shaft) -> float:
    """How far the first gear reaches beyond its axis, or the shaft of a bevel pinion into the housing."""
    return shaft.span if isinstance(stage, BevelStage) else stage.r_1 + stage.m_n


def _boxed(made: Unit, wanted: Wanted) -> Unit:
    """The unit in the housing, and with the oil, that a data sheet says."""
    drawn = made.length, made.width, made.height
    box = wanted.box or tuple(side * math.sqrt((wanted.area or made.area) / made.area) for side in drawn)
    found = replace(made, length=box[0], width=box[1], height=box[2])
    least = [side - room for side, room in zip(drawn, ROOM, strict=True)]
    if any(side < need for side, need in zip(box, least, strict=True)):
        need = replace(made, length=least[0], width=least[1], height=least[2]).area
        raise ScenarioError(
            f"--housing of {_sides(box)} is too small for the gears: expected {_sides(least)} at least, or"
            f" {need:.3g} m2. Give a larger one, or a lower power or ratio."
        )
    level = bath(found)["level"] or (wanted.volume or 0.0) / (found.length * found.width)
    if level > found.height - made.wall:
        most = 1000 * FILLED * (found.length - 2 * made.wall) * (found.width - 2 * made.wall) * height_of_axes(made)
        raise ScenarioError(
            f"--oil-volume of {1000 * (wanted.volume or 0.0):.3g} l stands {1000 * level:.0f} mm high in a housing of"
            f" {_sides(box)}. Give {most:.3g} l or less, which reaches the axes."
        )
    return found


def _sides(box: Sequence[float]) -> str:
    """Sides of a box as the command line has them."""
    return f"{'x'.join(f'{1000 * side:.0f}' for side in box)} mm"


def check(
    kinds: Sequence[str], ratio: float, power: float, speed: float, bearings: str, wanted: Wanted = Wanted()
) -> None:
    """Refuse name plates that the rules have no unit for, all that is wrong at once.

    Args:
        kinds: of the stages
        ratio: speed of the input over that of the output
        power: at the input [W]
        speed: of the input [rad/s]
        bearings: "ball", "roller" or "auto"
        wanted: what is known beside the name plate

    Raises:
        ScenarioError: unknown kinds, stages where they cannot stand, or more than so many stages of so much can do
    """
    problems = [f'there is no stage "{k}". Stages: {", ".join(KINDS)}.' for k in kinds if k not in KINDS]
    if not kinds:
        problems.append("no stage is given. Name them from the input on, for example helical,helical.")
    problems += _misplaced(kinds)
    if wanted.centre and kinds and kinds[-1] in KINDS and kinds[-1] not in CENTRED:
        problems.append(f"a {kinds[-1]} stage has no --centre-distance to choose. Leave it out.")
    if not (power > 0 and speed > 0):
        problems.append('power and speed must be above 0. Give for example --power "7.5 kW" --speed "1450 rpm".')
    if bearings not in CHOICES:
        problems.append(f'there are no bearings "{bearings}". Bearings: {", ".join(CHOICES)}.')
    if not 0 < ratio < math.inf:
        problems.append(f"a ratio of {ratio:g} is none. Give the input's speed over the output's.")
    else:
        problems += _too_much(kinds, ratio)
        if bearings in CHOICES and power > 0 and speed > 0:
            problems += _too_strong(kinds, ratio, power, speed, bearings)
    if problems:
        raise ScenarioError(problems)


def _too_much(kinds: Sequence[str], ratio: float) -> Iterator[str]:
    """A ratio that so many stages have not."""
    least, most = (
        math.prod(limit.get(kind, other) for kind in kinds) ** (1 / max(len(kinds), 1))
        for limit, other in ((LEAST, 1.0), (MOST, MOST["helical"]))
    )
    if kinds and not least <= ratio ** (1 / len(kinds)) <= most:
        yield (
            f"a ratio of {ratio:g} in {len(kinds)} stages is {ratio ** (1 / len(kinds)):.3g} each, expected {least:.3g}"
            f" to {most:.3g}. {_other_stages(kinds, ratio)}"
        )


def _too_strong(kinds: Sequence[str], ratio: float, power: float, speed: float, bearings: str) -> Iterator[str]:
    """A torque that asks for a larger bore than any bearing has."""
    choices = UNLOADED if IN_LINE in kinds else CHOICES
    d, T = largest_bore(choices[bearings]), power / speed * max(ratio, 1.0)
    if (most := math.pi / 16 * SHEAR * d**3 / ROUNDED) < T:
        needed = (16 * T / (math.pi * SHEAR)) ** (1 / 3)
        ways = [f"{most / T * power / 1000:.4g} kW or less", f"{speed * T / most * 30 / math.pi:.4g} rpm or more"]
        if most > power / speed:
            ways.insert(1, f"a ratio of {most / T * ratio:.3g} or less")
        if bearings == "ball" and needed <= largest_bore(choices["roller"]) / ROUNDED:
            ways.append("--bearings roller")
        yield (
            f"{T / 1000:.4g} kN.m at the slow shaft need {1000 * needed:.0f} mm, and the catalogue's bearings end at "
            f"{1000 * d:.0f} mm. Give {', '.join(ways[:-1])} or {ways[-1]}."
        )


def _misplaced(kinds: Sequence[str]) -> Iterator[str]:
    """Stages that cannot stand where they are."""
    if "bevel" in kinds[1:]:
        first = ",".join(sorted(kinds, key=lambda kind: kind != "bevel"))
        yield f"a bevel stage comes first: here its pinion is on the input shaft. Give --stages {first}."
    if LAST in kinds[:-1]:
        yield f"a {LAST} stage comes last here, behind helical ones. Give --stages helical,{LAST}."
    if LAST in kinds and "bevel" in kinds:
        yield f"shafts turn by a right angle once. Give --stages helical,{LAST} or --stages bevel,helical."
    if IN_LINE in kinds and set(kinds[kinds.index(IN_LINE) :]) != {IN_LINE}:
        last = ",".join(sorted(kinds, key=lambda kind: kind == IN_LINE)) if LAST not in kinds else f"helical,{LAST}"
        yield f"{IN_LINE} stages come last here, and none with a {LAST}. Give --stages {last}."


def _other_stages(kinds: Sequence[str], ratio: float) -> str:
    """Stages that have a ratio where others have not, with a worm or a bevel stage as wanted."""
    if ratio < 1:
        return "Give a ratio of 1 or more: the input is the faster shaft, and the output may drive."
    kept = next((kind for kind in (kinds[-1], kinds[0]) if kind in (LAST, "bevel")), None)
    if kept is None or ratio < LEAST.get(kept, 1.0):
        kept, left = None, ratio
    else:
        left = ratio / MOST[kept]
    kind = IN_LINE if kinds[-1] == IN_LINE and left >= LEAST[IN_LINE] else "helical"
    gears = [kind] * max(math.ceil(math.log(max(left, 1.0)) / math.log(MOST[kind]) - 1e-9), kept is None)
    named = {LAST: [*gears, LAST], "bevel": ["bevel", *gears]}.get(kept or "", gears)
    return f"Give --stages {','.join(named)}."


def last_ratio(kinds: Sequence[str], ratio: float) -> float:
    """Ratio that is left for the last stage.

    Args:
        kinds: of all stages
        ratio: of all together
    """
    for k in range(len(kinds) - 1):
        ratio /= _share(ratio, kinds[k:])
    return ratio


def _share(ratio: float, kinds: Sequence[str]) -> float:
    """Ratio of the next stage: the first ones have more, so that all wheels are of like size."""
    stages = len(kinds)
    if kinds[-1] == LAST and stages > 1:  # gears before a worm have less, as worms need 7 at least
        least, most = LEAST[LAST], MOST[LAST]
        share = min(max(ratio ** (1 / (stages + 1)), (ratio / most) ** (1 / (stages - 1))), ratio / least)
        return float(min(max(share, 1.0), MOST[kinds[0]]))
    share = {1: ratio, 2: 0.8 * ratio ** (2 / 3), 3: 0.6 * ratio ** (4 / 7)}.get(stages, ratio ** (1 / stages))
    least, most = (ratio / math.prod(limit.get(k, 1.0) for k in kinds[1:]) for limit in (LEAST, MOST))
    return float(min(max(share, most, LEAST.get(kinds[0], 1.0)), least, MOST[kinds[0]]))


def dips(stage: Stage) -> bool:
    """Whether a stage's wheel dips as the law of churning has it: planets and worms do otherwise."""
    return not isinstance(stage, PlanetaryStage | WormStage)


def lowest(stage: Stage) -> float:
    """Radius of what dips of a stage: of a worm, which stands below its wheel, the worm's own."""
    return stage.r_1 if isinstance(stage, WormStage) else stage.reach


def height_of_axes(made: Unit, k: int = 0) -> float:
    """Height of a shaft's axis above the bottom of the housing: all in one plane, but for that of a worm wheel [m]."""
    raised = made.stages[-1].a if isinstance(made.stages[-1], WormStage) and k == len(made.stages) else 0.0
    return BELOW + max(max(s.r_1, lowest(s)) + s.m_n for s in made.stages) + raised


def bath(made: Unit) -> dict[str, Any]:
    """Volume [l] and, where wheels dip, level [m] of the oil of a unit; and their rule."""
    given, floor = made.volume, (made.length - 2 * made.wall) * (made.width - 2 * made.wall)
    if not any(map(dips, made.stages)):
        volume = given or SHARE * made.length * made.width * made.height
        rule = "data sheet" if given else f"assumed: {100 * SHARE:.0f} % of the housing's volume"
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
