"""What a case hides: kind, causes, forms, and amounts in the wanted band of the signal-to-noise ratio."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .classes import class_of
from .signal_to_noise import Noise, Rival, Rivals

#: Kinds in every 25 cases; 150 cases hold 42 clean ones. "alike" has a rival so near that the right answer is a set.
SHARES: Mapping[str, int] = {"clean": 7, "single": 6, "alike": 1, "regime": 4, "pair": 3, "outside": 2, "weak": 2}
KINDS = (*SHARES, "severe")
BLOCK = sum(SHARES.values())

#: Signal-to-noise ratios of what is too weak to be seen, and of what is larger than other kinds have.
BANDS: Mapping[str, tuple[float, float]] = {"weak": (0.7, 2.4), "severe": (60.0, 250.0)}

#: Least distance to the nearest rival of what must be named [sigma].
APART = 3.0
#: Largest distance to the nearest rival of what cannot be told from it [sigma].
ALIKE = 2.5

#: Forms tried of a cause before another cause is taken.
TRIES = 3
#: Sizes tried of a form.
SIZES = 3

#: Amounts at which the signal-to-noise ratio of a form is looked up, over its largest sensible amount.
SURVEYED = np.geomspace(1e-3, 1.0, 9)


@dataclass(frozen=True)
class Hidden:
    """A fault, its amount, its signal-to-noise ratio, and its nearest rival where that was looked for."""

    fault: Any
    amount: float
    snr: float
    rival: Rival | None = None


@dataclass(frozen=True)
class Choice:
    """What faults are chosen for.

    Args:
        kind: of the case
        band: wanted signal-to-noise ratio
        draw: draws a form of a cause
        noise, rivals: of the campaign; no rivals where they do not matter
        rng: source of chance
    """

    kind: str
    band: tuple[float, float]
    draw: Callable[[str], Any]
    noise: Noise
    rivals: Rivals | None
    rng: np.random.Generator


def schedule(sheet: int, seed: int, k: int) -> tuple[str, int]:
    """Kind of case k, and how many cases of that kind come before it."""
    block, place = divmod(k, BLOCK)
    kinds = [kind for kind, count in SHARES.items() for _ in range(count)]
    shuffled = np.random.default_rng([seed, sheet, block, 1]).permutation(kinds)
    kind = str(shuffled[place])
    return kind, block * SHARES[kind] + int((shuffled[:place] == kind).sum())


def causes_to_try(names: Sequence[str], key: Sequence[int], rank: int) -> Iterator[str]:
    """Causes to try for a case: the first goes round through all names, the others follow by chance."""
    turn, place = divmod(rank, len(names))
    yield str(np.random.default_rng([*key, turn, 2]).permutation(list(names))[place])
    rng = np.random.default_rng([*key, rank, 3])
    for _ in range(20):
        yield from (str(name) for name in rng.permutation(list(names)))


def choose(names: Iterator[str], choice: Choice) -> list[Hidden]:
    """The hidden faults of a case; of a pair, two of different classes that each meet the limits beside the other.

    Raises:
        LookupError: no cause that was offered reaches the wanted signal-to-noise ratio as far from its rivals as wanted
    """
    first: Hidden | None = None
    for name in names:
        if first is not None and _is_related(first.fault.cause, name):
            continue
        hidden = _try_forms(name, choice)
        if hidden is None:
            continue
        if choice.kind != "pair":
            return [hidden]
        if first is None:
            first = hidden
        elif (one := _beside(first, hidden, choice)) and (other := _beside(hidden, first, choice)):
            return [one, other]
    raise LookupError(f"no {choice.kind} cause reaches a signal-to-noise of {choice.band[0]:g} apart from its rivals")


def _is_related(a: str, b: str) -> bool:
    """Whether two causes are of one class or one instrument."""
    stems = [name.rpartition(".")[0] for name in (a, b)]
    return class_of(a) == class_of(b) or (stems[0] == stems[1] and stems[0].startswith("sensor"))


def _beside(part: Hidden, other: Hidden, choice: Choice) -> Hidden | None:
    """The part with the signal-to-noise ratio that it has where the other one acts, or None if it misses the limits."""
    if choice.rivals is None:
        return part
    snr, rival = choice.rivals.nearest(part.fault, part.amount, [(other.fault, other.amount)])
    return Hidden(part.fault, part.amount, snr, rival) if snr >= choice.band[0] and rival.distance >= APART else None


def _try_forms(name: str, choice: Choice) -> Hidden | None:
    """A form of the cause with an amount in the band and at the wanted distance, or None after some tries."""
    for _ in range(TRIES):
        hidden = _try_sizes(choice.draw(name), choice)
        if hidden is not None:
            return hidden
    return None


def _try_sizes(fault: Any, choice: Choice) -> Hidden | None:
    """The fault so large that no rival comes near, or, of an "alike" case, so small that one does."""
    band = choice.band
    for _ in range(SIZES):
        hidden = size(fault, band, choice.noise, choice.rng)
        if hidden is None or choice.rivals is None or choice.kind in ("outside", "weak"):
            return hidden
        snr, rival = choice.rivals.nearest(hidden.fault, hidden.amount)
        wanted = rival.distance < ALIKE if choice.kind == "alike" else rival.distance >= APART
        if wanted:
            return Hidden(hidden.fault, hidden.amount, snr, rival)
        reach = snr / max(rival.distance, 1e-3)
        band = (band[0], 0.9 * reach * ALIKE) if choice.kind == "alike" else (1.05 * reach * APART, band[1])
        if band[0] >= band[1]:
            return None
    return None


def size(fault: Any, band: tuple[float, float], noise: Noise, rng: np.random.Generator) -> Hidden | None:
    """An amount whose signal-to-noise ratio is drawn from the band, evenly in its logarithm."""
    sign = float(rng.choice(fault.signs))
    snr, sensible = noise.survey(fault, sign * fault.high * SURVEYED)
    amounts, snr = fault.high * SURVEYED[sensible], np.maximum.accumulate(snr[sensible])
    if not len(snr):
        return None
    low, high = max(1.02 * band[0], float(snr[0])), min(band[1], float(snr[-1]))
    if not low < high:
        return None
    wanted = rng.uniform(np.log(low), np.log(high))
    rising = snr * (1.0 + 1e-9 * np.arange(len(snr))) + 1e-12
    amount = sign * float(f"{np.exp(np.interp(wanted, np.log(rising), np.log(amounts))):.4g}")
    reached, sensible = noise.survey(fault, np.array([amount]))
    if not sensible[0] or not band[0] <= reached[0] <= 1.1 * band[1]:
        return None
    return Hidden(fault, amount, float(reached[0]))
