"""How far a hidden effect is from the nearest effect of another class that could stand for it.

A rival is some amount of a form of another cause, as the bench itself would hide it. Its distance is the norm of what
it leaves of the whitened signature: the signal-to-noise at which the two can be told apart by anybody who knows the
rig, all nuisances of `signal` and both forms. Below 2.5 to 3 the right answer names both.

A small amount of some forms of every kind (`forms`), scaled freely, says which kinds are worth a closer look. From the
best form of each of those, amount and shapes are fitted by a few Gauss-Newton steps. What counts are forms that were
simulated.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import lsq_linear

from .causes import CAUSES, merged, merged_all
from .forms import Form, kinds_of
from .hidden import Effect, Surroundings
from .rig import CLOCK, COARSE
from .signal import Yardstick

#: Small amount, and the largest one, over the largest sensible.
PROBE, MOST = 0.05, 1.3

#: What does little until it does much: several amounts of that.
BENT = ("procedure.not_stationary", "thermal.mass", "thermal.split", "losses.film_starvation", "cooling.contact")
AMOUNTS = (PROBE, 0.2, 0.4, 0.8)

#: Kinds of which a small amount, scaled, leaves more than that, or than that share of the whole, are no rivals.
FAR, FAR_SHARE = 8.0, 0.75

#: Small amounts that leave less than this share of what is enough need no closer look.
OBVIOUS = 0.3

#: Kinds that are fitted in each round.
ROUNDS = (12, 6, 4)

#: How far an amount that was simulated may be scaled; step and longest way of a shape in a round.
SCALES, STEP, WAY = (0.5, 1.7), 0.08, 0.4


@dataclass(frozen=True)
class Rival:
    """The nearest cause of another class, and how far it is."""

    cause: str
    distance: float


@dataclass(frozen=True)
class _Guess:
    """A form, how much of it, and how far that should be."""

    form: Form
    amplitude: float
    distance: float


class Rivals:
    """Nearest rivals in one campaign.

    Args:
        yard: of the campaign
        around: what draws may know of it
        humidity: whether the campaign tells the humidity
        seed: the forms follow from it
    """

    def __init__(self, yard: Yardstick, around: Surroundings, *, humidity: bool, seed: Sequence[int]) -> None:
        self._yard, self._around, self._humidity, self._seed = yard, around, humidity, tuple(seed)
        self._causes = [(i, c) for i, c in enumerate(CAUSES) if humidity or c != "cooling.humidity"]
        self._clock = CLOCK if yard.campaign.series else COARSE

    def seen_by(self, yard: Yardstick) -> Rivals:
        """The same rivals, by another yardstick."""
        return Rivals(yard, self._around, humidity=self._humidity, seed=self._seed)

    @cached_property
    def _kinds(self) -> list[list[tuple[Form, float]]]:
        """Small amounts, over the largest sensible ones, of some forms of every kind."""
        found = []
        for i, cause in self._causes:
            shares = AMOUNTS if cause in BENT else (PROBE,)
            for kind in kinds_of(cause, self._around, (*self._seed, i)):
                found.append([(form, share) for form in kind for share in shares])
        return found

    @cached_property
    def _small(self) -> list[np.ndarray]:
        """Whitened signatures (rows, forms) of these; those of the other sign are the same but for the sign."""
        keys = [_key(kind[0][0]) for kind in self._kinds]
        first = [keys.index(key) for key in dict.fromkeys(keys)]
        white = self._white([(form, share * form.largest) for i in first for form, share in self._kinds[i]])
        parts = np.split(white, np.cumsum([len(self._kinds[i]) for i in first])[:-1], axis=1)
        known = dict(zip(first, parts, strict=True))
        found = []
        for key, kind in zip(keys, self._kinds, strict=True):
            twin = keys.index(key)
            found.append(known[twin] * (kind[0][0].largest / self._kinds[twin][0][0].largest))
        return found

    def nearest(self, effect: Effect, amplitude: float, *, beside: Iterable[str] = (), enough: float = 0.0) -> Rival:
        """The nearest rival of an effect.

        Args:
            effect: the effect
            amplitude: how much of it
            beside: causes that are no rivals, besides those of the effect's class
            enough: the search stops when it has found a rival nearer than that
        """
        t = self._yard.whitened(self._yard.signatures(effect, np.array([amplitude])))[:, 0]
        guesses = self._rough(t, merged_all([effect.cause, *beside]))
        found = Rival(guesses[0].form.cause, guesses[0].distance)
        limit = max(FAR, FAR_SHARE * float(np.linalg.norm(t)))
        guesses = [g for g in guesses if g.distance < limit]
        if not guesses or found.distance < OBVIOUS * enough:
            return found
        seen: list[Rival] = []
        for count in ROUNDS:
            left, near = self._round(t, guesses[:count])
            guesses = sorted([*left, *guesses[count:]], key=lambda g: g.distance)
            seen += near
            if any(r.distance < enough for r in seen):
                break
        else:
            seen += self._round(t, guesses[: ROUNDS[-1]], fit=False)[1]
        return min(seen, key=lambda r: r.distance)

    def _round(self, t: np.ndarray, guesses: Sequence[_Guess], fit: bool = True) -> tuple[list[_Guess], list[Rival]]:
        """Better guesses by a step of Gauss-Newton, and how near what was simulated for it is."""
        forms = [[g.form, *(_neighbours(g.form) if fit else ())] for g in guesses]
        amounts = [(form, g.amplitude) for g, some in zip(guesses, forms, strict=True) for form in some]
        whites = np.split(self._white(amounts), np.cumsum([len(some) for some in forms])[:-1], axis=1)
        near = [Rival(g.form.cause, _left(t, w, g)) for g, w in zip(guesses, whites, strict=True)]
        return [_fitted(t, w, g) for g, w in zip(guesses, whites, strict=True)] if fit else [], near

    def _rough(self, t: np.ndarray, known: frozenset[str]) -> list[_Guess]:
        """The best form of every kind by small amounts, nearest kind first."""
        found = []
        for kind, white in zip(self._kinds, self._small, strict=True):
            if merged(kind[0][0].cause) in known:
                continue
            b, own = t @ white, np.maximum((white**2).sum(axis=0), 1e-12)
            most = np.array([MOST / share for _, share in kind])
            c = np.clip(b / own, 0.0, most)
            i = int(np.argmin(c * c * own - 2 * c * b))
            form, share = kind[i]
            found.append(_Guess(form, max(float(c[i]), 1e-3) * share * form.largest, _shared(t, white, most)))
        return sorted(found, key=lambda g: g.distance)

    def _white(self, amounts: Sequence[tuple[Form, float]]) -> np.ndarray:
        """Whitened signatures of amounts of forms (rows, amounts); zero where the rig runs away."""
        change = self._yard.together(
            [f.effect for f, _ in amounts], np.array([a for _, a in amounts]), clock=self._clock
        )
        change[~np.isfinite(change).all(axis=(1, 2))] = 0.0
        return self._yard.whitened(change)


def _key(form: Form) -> tuple[object, ...]:
    """What kinds have in common of which small amounts do the same."""
    return form.cause, form.kind, form.effect.sign if form.cause in BENT else None


def _neighbours(form: Form) -> list[Form]:
    """Forms with one shape a step further in."""
    shares = np.array(form.shares)
    return [form.at(shares + np.where(np.arange(len(shares)) == i, _step(s), 0.0)) for i, s in enumerate(shares)]


def _step(share: float) -> float:
    return STEP if share < 0.5 else -STEP


def _left(t: np.ndarray, white: np.ndarray, guess: _Guess) -> float:
    """What the best of some forms leaves of a signature, each scaled a little."""
    b, own = t @ white, np.maximum((white**2).sum(axis=0), 1e-12)
    c = np.clip(b / own, SCALES[0], _most(guess))
    return float(np.sqrt(max((t @ t - 2 * c * b + c * c * own).min(), 0.0)))


def _most(guess: _Guess) -> float:
    """What the amount of a guess may be scaled by at most."""
    return min(SCALES[1], MOST * abs(guess.form.largest / guess.amplitude))


def _fitted(t: np.ndarray, white: np.ndarray, guess: _Guess) -> _Guess:
    """Amount and shapes by a step of Gauss-Newton from a form and its neighbours."""
    shares = np.array(guess.form.shares)
    base, steps = white[:, 0], np.array([_step(s) for s in shares])
    slopes = np.where(np.abs(white[:, 1:]).max(axis=0, initial=0.0) > 0, (white[:, 1:] - base[:, None]) / steps, 0.0)
    scale = float(np.clip(t @ base / max(base @ base, 1e-12), SCALES[0], _most(guess)))
    low, high = np.maximum(-shares, -WAY), np.minimum(1.0 - shares, WAY)
    Q, R = np.linalg.qr(np.column_stack([base, slopes]))
    bounds = (np.r_[SCALES[0], scale * low - 1e-9], np.r_[_most(guess) + 1e-9, scale * high + 1e-9])
    x = lsq_linear(R, Q.T @ t, bounds).x
    moved = np.clip(shares + x[1:] / x[0], 0.0, 1.0)
    left = float(np.linalg.norm(t - base * x[0] - slopes @ x[1:]))
    return _Guess(guess.form.at(moved) if len(moved) else guess.form, guess.amplitude * float(x[0]), left)


def _shared(t: np.ndarray, white: np.ndarray, most: np.ndarray) -> float:
    """What small amounts leave of a signature, scaled freely: of one form, or of two that share the amount."""
    gram, b, tt = white.T @ white, t @ white, float(t @ t)
    own = np.maximum(np.diag(gram), 1e-12)
    c = np.clip(b / own, 0.0, most)
    i, j = np.triu_indices(len(b), 1)
    det = np.maximum(own[i] * own[j] - gram[i, j] ** 2, 1e-9 * own[i] * own[j])
    first = (b[i] * own[j] - b[j] * gram[i, j]) / det
    second = (b[j] * own[i] - b[i] * gram[i, j]) / det
    fits = (first > 0) & (second > 0) & (first / most[i] + second / most[j] <= 1.0)
    both = tt - np.where(fits, first * b[i] + second * b[j], 0.0)
    return float(np.sqrt(max(min((tt - 2 * c * b + c * c * own).min(), both.min(initial=tt)), 0.0)))
