"""What a case hides: kind, causes, forms, and amplitudes in the wanted band of signal-to-noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .causes import CAUSES, OUTSIDE, REGIMES, merged
from .hidden import Draw, Effect, Surroundings
from .rivals import Rival, Rivals
from .signal import Yardstick

#: "alike" is a single cause that nobody could tell from another one: the right answer is a set.
KINDS = ("clean", "single", "regime", "pair", "outside", "weak", "alike")

#: Kinds in every 25 cases; 150 cases hold 42 clean ones.
SHARES: Mapping[str, int] = {
    "clean": 7,
    "single": 6,
    "alike": 1,
    "regime": 4,
    "pair": 3,
    "outside": 2,
    "weak": 2,
}
BLOCK = sum(SHARES.values())

#: Band of signal-to-noise by sheet; of a pair's parts, where the other acts and may have any size.
BANDS: Mapping[str, tuple[float, float]] = {"own": (5.0, 40.0), "foreign": (5.0, 60.0)}
WEAK = (0.7, 2.4)

#: Least distance to the nearest rival of what must be told by its name, and largest one of what cannot be [sigma].
APART_FROM_RIVALS, ALIKE = 3.0, 2.5

#: Forms tried of a cause before another cause is taken, and sizes of a form.
TRIES, SIZES = 4, 3

#: Magnitudes tried, over the largest sensible one.
_GRID = np.geomspace(1e-3, 1.0, 9)


@dataclass(frozen=True)
class Hidden:
    """An effect, how much of it, how loud it is alone, and what could be taken for it, where that counts."""

    effect: Effect
    amplitude: float
    snr: float
    rival: Rival | None = None


def schedule(sheet_number: int, seed: int, k: int) -> tuple[str, int]:
    """Kind of case k, and how many cases of that kind come before it."""
    block, place = divmod(k, BLOCK)
    kinds = [kind for kind, count in SHARES.items() for _ in range(count)]
    shuffled = np.random.default_rng([seed, sheet_number, block, 1]).permutation(kinds)
    kind = str(shuffled[place])
    return kind, block * SHARES[kind] + int((shuffled[:place] == kind).sum())


def order_of_causes(sheet_number: int, seed: int, kind: str, rank: int) -> Iterator[str]:
    """Causes to try for a case: the first goes round through all names, the others follow in an order of the case."""
    names = list({"regime": REGIMES, "outside": OUTSIDE}.get(kind, CAUSES))
    turn, place = divmod(rank, len(names))
    key = [seed, sheet_number, KINDS.index(kind)]
    yield str(np.random.default_rng([*key, turn, 2]).permutation(names)[place])
    rng = np.random.default_rng([*key, rank, 3])
    for _ in range(20):
        yield from (str(name) for name in rng.permutation(names))


@dataclass(frozen=True)
class Choice:
    """What effects are chosen for: the kind of case, the campaign, and chance.

    Args:
        kind: of the case
        band: wanted signal-to-noise
        yard, around, rivals: of the campaign
        rng: source of chance
    """

    kind: str
    band: tuple[float, float]
    yard: Yardstick
    around: Surroundings
    rivals: Rivals
    rng: np.random.Generator


def choose(
    kind: str,
    sheet: str,
    names: Iterator[str],
    yard: Yardstick,
    around: Surroundings,
    rivals: Rivals,
    rng: np.random.Generator,
) -> list[Hidden]:
    """The hidden effects of a case.

    Raises:
        LookupError: no cause that was offered can be as loud as wanted in this campaign, and as far from its rivals
    """
    band = WEAK if kind == "weak" else BANDS[sheet]
    if kind == "clean":
        return []
    choice = Choice(kind, band, yard, around, rivals, rng)
    if kind == "pair":
        return _pair(names, choice)
    for name in names:
        if found := _single(name, choice):
            return [found]
    raise LookupError(
        f"no {kind} cause reaches a signal-to-noise of {band[0]:g} at the distance wanted from its rivals"
    )


def _single(name: str, choice: Choice, beside: Sequence[str] = ()) -> Hidden | None:
    """A form of the cause with an amplitude in the band, or None after some tries."""
    family = CAUSES.get(name) or OUTSIDE[name]
    for _ in range(TRIES):
        draw = Draw(choice.rng, choice.around)
        if choice.kind == "regime":
            draw = draw.limited(REGIMES[name])
        found = _sized(family(draw), choice.band, choice.yard, choice.rng)
        if found and choice.kind == "alike":
            found = _alike(found, choice)
        elif found and choice.kind in ("single", "regime", "pair"):
            found = _unlike(found, choice, beside)
        if found:
            return found
    return None


def _unlike(found: Hidden, choice: Choice, beside: Sequence[str]) -> Hidden | None:
    """The same, so loud that no rival comes near; None where that is too loud."""
    now: Hidden | None = found
    for _ in range(SIZES):
        if now is None:
            break
        rival = choice.rivals.nearest(now.effect, now.amplitude, beside=beside, enough=APART_FROM_RIVALS)
        if rival.distance >= APART_FROM_RIVALS:
            return replace(now, rival=rival)
        louder = 1.05 * now.snr * APART_FROM_RIVALS / max(rival.distance, 1e-3)
        now = _sized(now.effect, (louder, choice.band[1]), choice.yard, choice.rng) if louder < choice.band[1] else None
    return None


def _alike(found: Hidden, choice: Choice) -> Hidden | None:
    """The same, so quiet that a rival is near; None where that is too quiet."""
    now: Hidden | None = found
    for _ in range(SIZES):
        if now is None:
            break
        rival = choice.rivals.nearest(now.effect, now.amplitude)
        if rival.distance < ALIKE:
            return replace(now, rival=rival)
        quieter = 0.9 * now.snr * ALIKE / rival.distance
        band = (choice.band[0], quieter / 1.1)
        now = _sized(now.effect, band, choice.yard, choice.rng) if band[0] < band[1] else None
    return None


def _sized(effect: Effect, band: tuple[float, float], yard: Yardstick, rng: np.random.Generator) -> Hidden | None:
    """An amplitude whose signal-to-noise is drawn from the band, evenly in its logarithm."""
    snr, sensible = yard.survey(effect, effect.sign * effect.high * _GRID)
    magnitudes, snr = effect.high * _GRID[sensible], np.maximum.accumulate(snr[sensible])
    if not len(snr):
        return None
    quietest, loudest = max(1.02 * band[0], float(snr[0])), min(band[1], float(snr[-1]))
    if not quietest < loudest:
        return None
    wanted = np.exp(rng.uniform(np.log(quietest), np.log(loudest)))
    rising = snr * (1 + 1e-9 * np.arange(len(snr))) + 1e-12
    magnitude = np.exp(np.interp(np.log(wanted), np.log(rising), np.log(magnitudes)))
    amplitude = float(f"{effect.sign * magnitude:.4g}")
    reached = yard.snr(effect, amplitude)
    if not band[0] <= reached <= 1.1 * band[1]:
        return None
    return Hidden(effect, amplitude, reached)


def _pair(names: Iterator[str], choice: Choice) -> list[Hidden]:
    """Two causes of different classes, each as loud and as far from rivals beside the other as if it were alone."""
    first: Hidden | None = None
    for name in names:
        if first and _related(first.effect.cause, name):
            continue
        found = _single(name, choice, [first.effect.cause] if first else [])
        if found is None:
            continue
        if first is None:
            first = found
        elif (one := _beside(first, found, choice)) and (other := _beside(found, first, choice)):
            return [one, other]
    raise LookupError("no two causes that can be told apart")


def _related(a: str, b: str) -> bool:
    """Whether two causes are of one class or one instrument."""
    stems = [name.rpartition(".")[0] for name in (a, b)]
    return merged(a) == merged(b) or (stems[0] == stems[1] and stems[0].startswith("sensor"))


def _beside(part: Hidden, other: Hidden, choice: Choice) -> Hidden | None:
    """The part, as loud as it is where the other one acts; None where it is too quiet or a rival is near.

    Rivals are all other causes beside the other one of whatever size, and that one in another form.
    """
    yard = choice.yard.beside(other.effect, other.amplitude)
    snr = yard.snr(part.effect, part.amplitude)
    if not choice.band[0] <= snr <= 1.1 * choice.band[1]:
        return None
    rival = choice.rivals.seen_by(yard).nearest(part.effect, part.amplitude, enough=APART_FROM_RIVALS)
    return replace(part, snr=snr, rival=rival) if rival.distance >= APART_FROM_RIVALS else None
