"""Name plates that the rules have a unit for: order of the stages, their ratios, and torques that bearings hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from ...model.errors import ScenarioError
from .bearings import CHOICES, HELD, largest_bore
from .data_sheet import Wanted
from .shafts import SHEAR
from .stages import KINDS, LEAST, MOST

#: How much whole numbers of teeth may add to a ratio [1].
ROUNDED = 1.05
#: Kinds of stages of which a centre distance may be given.
CENTRED = ("spur", "helical", "worm")
#: Kinds of stages that stand last: a worm behind helical stages, planets behind any gears or other planets.
LAST = "worm"
IN_LINE = "planetary"
#: Usual ratio of planetary stages, which gears before them leave to them [1].
PLANETARY = 5.5


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
    order = -1 if 0 < ratio < 1 else 1
    problems += _misplaced(kinds[::order], order)
    if wanted.centre and kinds and kinds[-1] in KINDS and kinds[-1] not in CENTRED:
        problems.append(f"a {kinds[-1]} stage has no --centre-distance to choose. Leave it out.")
    if not (power > 0 and speed > 0):
        problems.append('power and speed must be above 0. Give for example --power "7.5 kW" --speed "1450 rpm".')
    if bearings not in CHOICES:
        problems.append(f'there are no bearings "{bearings}". Bearings: {", ".join(CHOICES)}.')
    if not 0 < ratio < math.inf:
        problems.append(f"a ratio of {ratio:g} is none. Give the input's speed over the output's.")
    else:
        problems += _too_much(kinds[::order], ratio**order, order)
        if bearings in CHOICES and power > 0 and speed > 0:
            problems += _too_strong(kinds[::order], ratio, power, speed, bearings)
    if problems:
        raise ScenarioError(problems)


def _too_much(kinds: Sequence[str], ratio: float, order: int) -> Iterator[str]:
    """A ratio that so many stages have not, from the fast shaft on; `order` is -1 where that is the output."""
    least, most = (
        math.prod(limit.get(kind, other) for kind in kinds) ** (1 / max(len(kinds), 1))
        for limit, other in ((LEAST, 1.0), (MOST, MOST["helical"]))
    )
    if kinds and not least <= ratio ** (1 / len(kinds)) <= most:
        by = "1/" if order < 0 else ""
        yield (
            f"a ratio of {by}{ratio:g} in {len(kinds)} stages is {by}{ratio ** (1 / len(kinds)):.3g} each, expected"
            f" {by}{least:.3g} to {by}{most:.3g}. {_other_stages(kinds, ratio, order)}"
        )


def _too_strong(kinds: Sequence[str], ratio: float, power: float, speed: float, bearings: str) -> Iterator[str]:
    """A torque that asks for a larger bore than any bearing has."""
    choices = HELD if [*kinds[-1:]] == [IN_LINE] else CHOICES  # kinds from the fast shaft on
    d, T = largest_bore(choices[bearings]), power / speed * max(ratio, 1.0)
    if (most := math.pi / 16 * SHEAR * d**3 / ROUNDED) < T:
        needed = (16 * T * ROUNDED / (math.pi * SHEAR)) ** (1 / 3)
        kW, rpm = most / T * power / 1000, speed * T / most * 30 / math.pi
        ways = [f"{safe(kW, 4, math.floor)} kW or less", f"{safe(rpm, 4, math.ceil)} rpm or more"]
        if most > power / speed:
            ways.insert(1, f"a ratio of {safe(most / T * ratio, 3, math.floor)} or less")
        if bearings == "ball" and needed <= largest_bore(choices["roller"]):
            ways.append("--bearings roller")
        yield (
            f"{T / 1000:.4g} kN.m at the slow shaft need {1000 * needed:.0f} mm, and the catalogue's bearings end at "
            f"{1000 * d:.0f} mm. Give {', '.join(ways[:-1])} or {ways[-1]}; or draw that and put your gears into the"
            " file, with d, D, d_m and B of your bearings beside `bearing`: friction constants are those of a series."
        )


def safe(value: float, digits: int, whole: Callable[[float], int]) -> str:
    """A limit as a user may take it without being beyond it.

    Args:
        value: above 0
        digits: significant ones
        whole: `math.ceil` of one that must not be less, `math.floor` of one that must not be more
    """
    step = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    return f"{whole(value / step) * step:.{digits}g}"


def _misplaced(kinds: Sequence[str], order: int) -> Iterator[str]:
    """Stages that cannot stand where they are, from the fast shaft on."""
    first, last = ("first", "last")[::order]
    if LAST in kinds and order < 0:
        yield f"a {LAST} is not driven by its wheel. Give a ratio of 1 or more, or other stages."
    if "bevel" in kinds[1:]:
        found = sorted(kinds, key=lambda kind: kind != "bevel")[::order]
        yield f"a bevel stage comes {first}: here its pinion is on the fast shaft. Give --stages {','.join(found)}."
    if LAST in kinds[:-1]:
        yield f"a {LAST} stage comes last here, behind helical ones. Give --stages helical,{LAST}."
    if LAST in kinds and "bevel" in kinds:
        yield f"shafts turn by a right angle once. Give --stages helical,{LAST} or --stages bevel,helical."
    if IN_LINE in kinds and set(kinds[kinds.index(IN_LINE) :]) != {IN_LINE}:
        found = sorted(kinds, key=lambda kind: kind == IN_LINE)[::order] if LAST not in kinds else ["helical", LAST]
        yield f"{IN_LINE} stages come {last} here, and none with a {LAST}. Give --stages {','.join(found)}."


def _other_stages(kinds: Sequence[str], ratio: float, order: int) -> str:
    """Stages that have a ratio where others have not, with a worm or a bevel stage as wanted."""
    kept = next((kind for kind in (kinds[-1], kinds[0]) if kind in (LAST, "bevel")), None)
    if kept is None or ratio < LEAST.get(kept, 1.0):
        kept, left = None, ratio
    else:
        left = ratio / MOST[kept]
    kind = IN_LINE if kinds[-1] == IN_LINE and left >= LEAST[IN_LINE] else "helical"
    gears = [kind] * max(math.ceil(math.log(max(left, 1.0)) / math.log(MOST[kind]) - 1e-9), kept is None)
    named = {LAST: [*gears, LAST], "bevel": ["bevel", *gears]}.get(kept or "", gears)
    return f"Give --stages {','.join(named[::order])}."


def last_ratio(kinds: Sequence[str], ratio: float) -> float:
    """Ratio that is left for the last stage.

    Args:
        kinds: of all stages
        ratio: of all together
    """
    for k in range(len(kinds) - 1):
        ratio /= first_ratio(ratio, kinds[k:])
    return ratio


def first_ratio(ratio: float, kinds: Sequence[str], shift: float = 1.0) -> float:
    """Ratio of the next stage: the first ones have more, so that all wheels are of like size.

    Args:
        ratio: of all stages that are left
        kinds: of these
        shift: on it, where that is allowed
    """
    stages = len(kinds)
    if kinds[-1] == LAST and stages > 1:  # gears before a worm have less, as worms need 7 at least
        least, most = LEAST[LAST], MOST[LAST]
        share = min(max(shift * ratio ** (1 / (stages + 1)), (ratio / most) ** (1 / (stages - 1))), ratio / least)
        return float(min(max(share, 1.0), MOST[kinds[0]]))
    share = {1: ratio, 2: 0.8 * ratio ** (2 / 3), 3: 0.6 * ratio ** (4 / 7)}.get(stages, ratio ** (1 / stages))
    if kinds[0] != IN_LINE and (planets := kinds.count(IN_LINE)):  # they are smaller than gears for a torque
        share = (ratio / PLANETARY**planets) ** (1 / (stages - planets))
    least, most = (ratio / math.prod(limit.get(k, 1.0) for k in kinds[1:]) for limit in (LEAST, MOST))
    return float(min(max(shift * share, most, LEAST.get(kinds[0], 1.0)), least, MOST[kinds[0]]))
