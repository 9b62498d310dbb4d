"""What a case hides: kind, causes, forms, and amplitudes in the wanted band of signal-to-noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .causes import CAUSES, OUTSIDE, REGIMES, merged
from .hidden import Draw, Effect, Surroundings
from .signal import Yardstick

KINDS = ("clean", "single", "regime", "pair", "outside", "weak")

#: Kinds in every 25 cases; 150 cases hold 42 clean ones.
SHARES: Mapping[str, int] = {"clean": 7, "single": 7, "regime": 4, "pair": 3, "outside": 2, "weak": 2}
BLOCK = sum(SHARES.values())

#: Band of signal-to-noise by sheet; a pair's parts must each keep `APART` where the other may take any size.
BANDS: Mapping[str, tuple[float, float]] = {"own": (5.0, 40.0), "foreign": (5.0, 60.0)}
WEAK = (0.7, 2.4)
APART = 4.0

#: Forms tried of a cause before another cause is taken.
TRIES = 4

#: Magnitudes tried, over the largest sensible one.
_GRID = np.geomspace(1e-3, 1.0, 9)


@dataclass(frozen=True)
class Hidden:
    """An effect, how much of it, and how loud it is alone."""

    effect: Effect
    amplitude: float
    snr: float


def schedule(sheet_number: int, seed: int, k: int) -> tuple[str, int]:
    """Kind of case k, and how many cases of that kind come before it."""
    block, place = divmod(k, BLOCK)
    kinds = [kind for kind, count in SHARES.items() for _ in range(count)]
    shuffled = np.random.default_rng([seed, sheet_number, block, 1]).permutation(kinds)
    kind = str(shuffled[place])
    return kind, block * SHARES[kind] + int((shuffled[:place] == kind).sum())


def order_of_causes(sheet_number: int, seed: int, kind: str, rank: int) -> Iterator[str]:
    """Causes to try for a case: rounds through all names, each round in another random order, starting at its rank."""
    names = list({"regime": REGIMES, "outside": OUTSIDE}.get(kind, CAUSES))
    for position in range(rank, rank + 20 * len(names)):
        turn, place = divmod(position, len(names))
        mixed = np.random.default_rng([seed, sheet_number, KINDS.index(kind), turn, 2]).permutation(names)
        yield str(mixed[place])


def choose(
    kind: str, sheet: str, names: Iterator[str], yard: Yardstick, around: Surroundings, rng: np.random.Generator
) -> list[Hidden]:
    """The hidden effects of a case.

    Raises:
        LookupError: no cause that was offered can be as loud as wanted in this campaign
    """
    band = WEAK if kind == "weak" else BANDS[sheet]
    if kind == "clean":
        return []
    if kind == "pair":
        return _pair(band, names, yard, around, rng)
    for name in names:
        if found := _single(name, kind, band, yard, around, rng):
            return [found]
    raise LookupError(f"no {kind} cause reaches a signal-to-noise of {band[0]:g}")


def _single(
    name: str, kind: str, band: tuple[float, float], yard: Yardstick, around: Surroundings, rng: np.random.Generator
) -> Hidden | None:
    """A form of the cause with an amplitude in the band, or None after some tries."""
    family = CAUSES.get(name) or OUTSIDE[name]
    for _ in range(TRIES):
        draw = Draw(rng, around)
        if kind == "regime":
            draw = draw.limited(REGIMES[name])
        if found := _sized(family(draw), band, yard, rng):
            return found
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


def _pair(
    band: tuple[float, float], names: Iterator[str], yard: Yardstick, around: Surroundings, rng: np.random.Generator
) -> list[Hidden]:
    """Two causes of different classes, each loud, and each loud beside any amount of the other."""
    first: Hidden | None = None
    for name in names:
        found = _single(name, "pair", band, yard, around, rng)
        if found is None:
            continue
        if first is None:
            first = found
        elif _apart([first, found], yard):
            return [first, found]
    raise LookupError("no two causes that can be told apart")


def _apart(parts: Sequence[Hidden], yard: Yardstick) -> bool:
    """Whether two effects are of different classes and instruments, and neither could stand for the other."""
    names = [merged(part.effect.cause) for part in parts]
    stems = [name.rpartition(".")[0] for name in names]
    if names[0] == names[1] or (stems[0] == stems[1] and stems[0].startswith("sensor")):
        return False
    a, b = (yard.whitened(yard.signatures(p.effect, np.array([p.amplitude])))[:, 0] for p in parts)
    left = [np.linalg.norm(x - y * (x @ y) / (y @ y)) for x, y in ((a, b), (b, a))]
    return bool(min(left) >= APART)
