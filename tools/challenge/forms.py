"""Forms of every cause that stand for its whole family, and the forms next to one.

A form follows from a seed, which decides everything that is no number between two, and from where each such number of
its shape lies between its ends. Forms that a seed decides alike are of one kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from .causes import CAUSES, REGIMES
from .hidden import Draw, Effect, Surroundings

#: Draws to choose from: everywhere, and limited to a regime.
DRAWS = (40, 120)

#: Forms of a cause, shared among its kinds, but at least and at most so many of one kind; of one that is limited to a
#: regime; and of a fault of instruments, which costs no simulation.
FORMS, OF_A_KIND, LIMITED, FREE = 8, (2, 6), 3, 16


@dataclass(frozen=True)
class _Shaped(Draw):
    """A draw whose shapes lie at given shares between their ends, where there are any given.

    It notes the shares, and whatever is drawn that is no number between two and no sign.
    """

    given: Sequence[float] = ()
    shares: list[float] = field(default_factory=list)
    words: list[object] = field(default_factory=list)

    def uniform(self, low: float, high: float) -> float:
        """A number between two, to four digits."""
        share = float(self.rng.random())
        if len(self.shares) < len(self.given):
            share = self.given[len(self.shares)]
        self.shares.append(share)
        return float(f"{low + share * (high - low):.4g}")

    def pick(self, *choices: str, p: Sequence[float] | None = None) -> str:
        """One of several names."""
        picked = super().pick(*choices, p=p)
        self.words.append(picked)
        return picked

    def chance(self, p: float) -> bool:
        """True with some probability."""
        happened = super().chance(p)
        self.words.append(happened)
        return happened

    def either(self, positive: float = 0.5) -> float:
        """A sign."""
        return 1.0 if super().chance(positive) else -1.0


@dataclass(frozen=True)
class Form:
    """One form of a cause.

    Args:
        cause: identifier
        around: what a draw may know of the campaign
        seed: of all that is no number
        limited: whether it is limited to a regime
        given: where its shapes lie between their ends, 0 ... 1; from the seed if empty
    """

    cause: str
    around: Surroundings
    seed: tuple[int, ...]
    limited: bool
    given: tuple[float, ...] = ()

    @cached_property
    def _drawn(self) -> tuple[Effect, _Shaped]:
        notes = _Shaped(np.random.default_rng(self.seed), self.around, given=self.given)
        draw = notes.limited(REGIMES[self.cause]) if self.limited else notes
        return CAUSES[self.cause](draw), notes

    @property
    def effect(self) -> Effect:
        """The effect."""
        return self._drawn[0]

    @property
    def largest(self) -> float:
        """Largest sensible amplitude, with its sign."""
        return self.effect.sign * self.effect.high

    @property
    def shares(self) -> list[float]:
        """Where its shapes lie between their ends."""
        return self._drawn[1].shares

    @property
    def kind(self) -> tuple[object, ...]:
        """What it has in common with the other forms of its kind, but for the sign: words, and place of a regime."""
        limits = [(k, v) for k, v in self.effect.regime.items() if k not in ("threshold", "width")]
        return self.limited, *limits, *self._drawn[1].words

    def at(self, shares: np.ndarray) -> Form:
        """The form of other shapes."""
        return replace(self, given=tuple(float(s) for s in shares))


def kinds_of(cause: str, around: Surroundings, seed: Sequence[int]) -> list[tuple[Form, ...]]:
    """Some forms of every kind and sign of a cause, far apart; of both signs, where there are two, the same shapes."""
    found = []
    for limited in (False, True) if cause in REGIMES else (False,):
        kinds: dict[tuple[object, ...], dict[float, list[Form]]] = {}
        for i in range(DRAWS[limited]):
            form = Form(cause, around, (*seed, int(limited), i), limited)
            kinds.setdefault(form.kind, {}).setdefault(form.effect.sign, []).append(form)
        for signs in kinds.values():
            chosen = _far_apart(max(signs.values(), key=len), _count(form, len(kinds)))
            found += [tuple(forms[0].at(np.array(c.shares)) for c in chosen) for forms in signs.values()]
    return found


def _count(form: Form, kinds: int) -> int:
    """Forms of one kind, where a cause has some kinds."""
    if form.effect.read is not None:
        return FREE
    return LIMITED if form.limited else int(np.clip(FORMS // kinds, *OF_A_KIND))


def _far_apart(forms: Sequence[Form], count: int) -> list[Form]:
    """One in the middle, then always the one farthest from those taken."""
    same = [f for f in forms if len(f.shares) == max(len(g.shares) for g in forms)]
    x = np.array([f.shares for f in same]).reshape(len(same), -1) - 0.5
    taken = [int(np.argmin((x**2).sum(axis=1)))]
    while len(taken) < count:
        gaps = np.min([((x - x[i]) ** 2).sum(axis=1) for i in taken], axis=0)
        if not gaps.max() > 0:
            break
        taken.append(int(np.argmax(gaps)))
    return [same[i] for i in taken]
