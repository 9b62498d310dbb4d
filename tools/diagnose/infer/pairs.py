"""Pairs of causes that together explain most, to first order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .evidence import WIDTHS
from .fit import Start
from .prior import Prior
from .screen import Look, Looks, limits

#: How far behind the best pair another one may lie.
BEHIND = 10.0


def couples(looks: Looks, prior: Prior) -> list[tuple[Start, Start]]:
    """Pairs of causes, the likeliest first, of those that explain more than any cause alone.

    Args:
        looks: all causes to first order
        prior: of hypotheses
    """
    found: dict[frozenset[str], tuple[float, tuple[Start, Start]]] = {}
    for _, look in looks.each:
        for value, starts in _couples(look, prior):
            names = frozenset(s.acting.id for s in starts)
            if names not in found or found[names][0] < value:
                found[names] = value, starts
    ranked = sorted(found.values(), key=lambda item: -item[0])
    return [starts for value, starts in ranked if value > ranked[0][0] - BEHIND]


def _couples(first: Look, prior: Prior) -> Iterator[tuple[float, tuple[Start, Start]]]:
    """Pairs at one linearisation with what they promise."""
    ids = list(dict.fromkeys(c.id for c in first.candidates))
    begins = np.searchsorted([ids.index(c.id) for c in first.candidates], np.arange(len(ids)))
    ends = [*begins[1:], len(first.candidates)]
    alone = np.maximum.reduceat(first.log_bf + first.weights, begins) + [prior([c]) for c in ids]
    logs, sizes = _together(first)
    logs += first.weights[:, None] + first.weights
    best = np.maximum.reduceat(np.maximum.reduceat(logs, begins, axis=0), begins, axis=1)
    family = [prior.causes[c].family for c in ids]
    for i, one in enumerate(ids):
        for k, other in enumerate(ids):
            best[i, k] += prior([one, other]) if k > i and family[i] != family[k] else -np.inf
    least = max(float(alone.max()), float(best.max()) - BEHIND)
    for place in np.argsort(-best, axis=None)[: int((best > least).sum())]:
        i, k = divmod(int(place), len(ids))
        own = logs[begins[i] : ends[i], begins[k] : ends[k]]
        row, column = divmod(int(np.argmax(own)), own.shape[1])
        one, other = int(begins[i]) + row, int(begins[k]) + column
        starts = first.begun(one, float(sizes[one, other])), first.begun(other, float(sizes[other, one]))
        yield float(best[i, k]), starts


def _together(found: Look) -> tuple[np.ndarray, np.ndarray]:
    """Log Bayes factors (k, k) of all pairs of candidates against none, and the size (k, k) of the first in each.

    The scatter is that as stated, the widths of the sizes are one in the middle; -inf where a size is out of bounds.
    """
    view, low, high = found.views[-1], *limits(found.candidates)
    g, precision = view.white(found.effects), 1 / WIDTHS[2] ** 2
    A, s = g.T @ g, g.T @ view.e
    a = np.diag(A) + precision
    both = np.multiply.outer(a, a)
    det = np.maximum(both - A**2, 1e-9 * both)
    sizes = (np.multiply.outer(s, a) - A * s) / det
    logs = 0.5 * (s[:, None] * sizes + s * sizes.T) - 0.5 * np.log(det / precision**2) + view.log
    inside = (sizes >= low[:, None]) & (sizes <= high[:, None])
    return np.where(inside & inside.T, logs, -np.inf), sizes
