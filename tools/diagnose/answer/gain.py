"""What the causes gain on readings that were left out: in each fold the whole inference runs without them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ....model.errors import SolveError
from ..infer.foresee import Foreseen, foresee
from ..infer.found import Found
from . import channels
from .findings import Gain
from .folds import schemes
from .rivals import RIVALS

#: Draws of the bootstrap.
DRAWS = 2000
#: Causes that may act together in a fold.
MOST = 8


@dataclass(frozen=True)
class _Fold:
    """Entries that are left out (k,), and what is foreseen of them."""

    held: np.ndarray
    seen: Foreseen


def measure_gains(found: Found, seed: int, progress: Callable[[float], None] = lambda share: None) -> list[Gain]:
    """All schemes that the data allow, all compared sensors, thermometers of the oil first.

    Args:
        found: the answer of all data; only its settings and its gross readings are used
        seed: of all draws
        progress: called with the share done
    """
    plans = schemes(found.problem.data.campaign)
    total, done, told = sum(len(folds) for folds in plans.values()), 0, []
    for scheme, folds in plans.items():
        errors = []
        for rows in folds:
            with suppress(SolveError):
                errors.append(_fold(found, rows, seed))
            done += 1
            progress(done / total)
        if errors:
            told += [
                g for i in range(len(found.problem.data.read)) if (g := _gain(found, scheme, folds, errors, i, seed))
            ]
    oil = [s.name for s in found.problem.data.read if s.kind == "oil_temp"]
    return sorted(told, key=lambda g: g.channel not in oil)


def _fold(found: Found, rows: np.ndarray, seed: int) -> _Fold:
    """Everything anew without the readings of some rows, and what it says of them."""
    gross = {a.number for a in found.problem.aside if not a.sensor}
    held = np.array([i for i in np.flatnonzero(np.isin(found.problem.data.row, rows)) if i not in gross])
    return _Fold(held, foresee(found.problem, found.formulas, held, found.critical, seed, MOST))


def _gain(
    found: Found, scheme: str, folds: Sequence[np.ndarray], errors: Sequence[_Fold], sensor: int, seed: int
) -> Gain | None:
    """One sensor's errors over all folds of a scheme."""
    o = found.problem.data
    held = np.concatenate([e.held for e in errors])
    sides = ("before", "after", "leading")
    errors_by = {side: np.concatenate([getattr(e.seen, side) for e in errors], axis=1) for side in sides}
    mine = o.kind[held] == sensor
    if not mine.any():
        return None
    gross = [a.number for a in found.problem.aside if not a.sensor]
    entries, rivals, s = np.setdiff1d(np.flatnonzero(o.kind == sensor), gross), {}, o.read[sensor]
    rows = o.row[entries]
    for name, rival in RIVALS.items():
        left = [rival(o, sensor, rows, ~np.isin(rows, fold)) for fold in folds if np.isin(rows, fold).any()]
        known = [e for e in left if e is not None]
        if len(known) == len(left) and np.isfinite(error := rms(np.concatenate(known))):
            rivals[name] = channels.difference(s, error)
    test = o.campaign.test[o.row[held[mine]]]
    both = {
        side: Gain.Both.model_validate(
            {key: channels.difference(s, rms(line[mine])) for key, line in zip(("without", "with"), lines, strict=True)}
        )
        for side, lines in errors_by.items()
    }
    return Gain(
        scheme=scheme,
        channel=s.name,
        unit=channels.unit_of_difference(s),
        n=int(mine.sum()),
        rmse_before=both["before"].without,
        rmse_after=both["after"].without,
        before=both["before"],
        after=both["after"],
        leading=both["leading"],
        ratio_ci90=_bootstrap(errors_by["before"][0, mine], errors_by["after"][0, mine], test, seed),
        noise_floor=channels.difference(s, noise_floor(found, sensor)),
        rivals=rivals,
        chosen=dict(Counter(c for e in errors for c in e.seen.causes).most_common()),
        folds=len(folds),
    )


def noise_floor(found: Found, sensor: int) -> float:
    """Standard deviation of one reading: its own scatter, that of the inputs and of the day, as found."""
    o, noise = found.problem.data, found.hypotheses[0].fit.noise
    loose = sum(np.exp(2 * s) * np.diag(t.matrix) for t, s in zip(noise.loose, noise.scales, strict=True))
    return float(np.sqrt(np.mean(np.asarray(loose)[found.problem.own][o.kind == sensor])))


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _bootstrap(before: np.ndarray, after: np.ndarray, test: np.ndarray, seed: int) -> tuple[float, float]:
    """90 % interval of the ratio of errors, tests drawn with replacement."""
    group = np.unique(test, return_inverse=True)[1]
    n = int(group.max()) + 1
    a, b = (np.bincount(group, weights=e**2, minlength=n) for e in (before, after))
    draws = np.random.default_rng(seed).integers(0, n, size=(DRAWS, n))
    ratios = np.sqrt(b[draws].sum(axis=1) / np.maximum(a[draws].sum(axis=1), 1e-300))
    low, high = np.quantile(ratios, [0.05, 0.95])
    return float(low), float(high)
