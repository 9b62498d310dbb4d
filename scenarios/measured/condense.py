"""Large campaigns: tests under like conditions are joined, so that causes are weighed in a time that one waits for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .card import Card
from .table import Campaign

#: Compared readings above which tests are joined: what is weighed grows with the cube of their number.
LARGE = 900
#: Compared readings that are left, about.
LEFT = 240
#: Running order from first to last test, beside conditions in units of their spread.
ORDER = 1.0
#: Room temperature likewise: readings follow it in proportion, so that little is lost by joining different ones.
ROOM = 0.3
#: Standard deviation of a median over that of a mean.
MEDIAN = 1.25


def condensed(c: Campaign, card: Card) -> tuple[Campaign, Card]:
    """A campaign whose like tests are joined to one with the medians of their readings, if it is large.

    Readings and days scatter less by the number of tests that became one, and so says the card.

    Args:
        c: all readings
        card: of the campaign
    """
    if c.n * len(c.read) <= LARGE or c.series is not None:
        return c, card
    groups = _groups(c, max(LEFT * c.n_tests // (c.n * len(c.read)), 1))
    typical = float(np.median([len(g) for g in groups]))
    less = MEDIAN / typical**0.5 if typical > 1 else 1.0
    begin, height = np.searchsorted(c.test, np.arange(c.n_tests)), np.bincount(c.test)
    rows = [begin[g][:, None] + np.arange(height[g[0]]) for g in groups]
    first = np.concatenate([r[0] for r in rows])
    tests = [int(g[0]) for g in groups]

    def joined(values: np.ndarray) -> np.ndarray:
        """Medians of the rows that become one; those of none known stay unknown."""
        each = [np.nanmedian(np.where(np.isnan(v).all(axis=0), 0.0, v), axis=0) for r in rows for v in [values[r]]]
        known = [np.isfinite(values[r]).any(axis=0) for r in rows]
        return np.where(np.concatenate(known), np.concatenate(each), np.nan)

    said = f"{c.n} readings are many: tests under like conditions are joined, by medians, to {len(first)} readings"
    found = replace(
        c,
        sensors=tuple(replace(s, repeat_sd=less * s.repeat_sd) for s in c.sensors),
        values={name: joined(column) for name, column in c.values.items()},
        test=np.repeat(np.arange(len(groups)), [r.shape[1] for r in rows]),
        order=np.array([c.order[g].mean() for g in groups]),
        direction=c.direction[first],
        dwell=c.dwell[first],
        stop=c.stop[first],
        oil=tuple(c.oil[k] for k in tests),
        mounting=tuple(c.mounting[k] for k in tests),
        T_start=np.array([c.T_start[g].mean() for g in groups]),
        room_start=np.array([c.room_start[g].mean() for g in groups]),
        humidity=np.array([c.humidity[g].mean() for g in groups]),
        date=tuple(c.date[k] for k in tests),
        lines=c.lines[first],
        points=c.points[first],
        names=tuple(c.names[k] for k in tests) if c.names else (),
        others={},
        warnings=(*c.warnings, said),
    )
    return found, card.model_copy(update={"day_cooling_sd": less * card.day_cooling_sd})


def _groups(c: Campaign, most: int) -> list[np.ndarray]:
    """Tests (k,) of each group, in running order: apart where they are of another kind, then where they spread most."""
    begin, height = np.searchsorted(c.test, np.arange(c.n_tests)), np.bincount(c.test)
    kinds: dict[object, list[int]] = {}
    for k in range(c.n_tests):
        rows = slice(begin[k], begin[k] + height[k])
        stated = tuple(map(tuple, (c.direction[rows], c.dwell[rows], c.stop[rows])))
        kinds.setdefault((stated, c.oil[k], c.mounting[k], bool(np.isnan(c.T_start[k]))), []).append(k)
    columns = [np.nan_to_num(c.values[s.name], nan=float(np.nanmean(c.values[s.name]))) for s in c.given]
    at = np.array([[column[begin], column[begin + height - 1]] for column in columns]).reshape(-1, c.n_tests)
    weights = np.repeat([ROOM if s.kind == "ambient" else 1.0 for s in c.given], 2)
    scaled = weights[:, None] * (at - at.mean(axis=1, keepdims=True)) / np.maximum(at.std(axis=1, keepdims=True), 1e-12)
    features = np.vstack([scaled, ORDER * c.progress[begin]]).T
    groups = [np.array(own) for own in kinds.values()]
    splits = [_split(features[g]) for g in groups]
    while len(groups) < most and max(gain for gain, _ in splits) > 0:
        k = int(np.argmax([gain for gain, _ in splits]))
        g, (_, low) = groups.pop(k), splits.pop(k)
        groups += [g[low], g[~low]]
        splits += [_split(features[part]) for part in groups[-2:]]
    return sorted(groups, key=lambda g: float(c.order[g].mean()))


def _split(x: np.ndarray) -> tuple[float, np.ndarray]:
    """What the best cut of points (n, features) takes off their summed squares, and which points lie below it."""
    n, best = len(x), (0.0, np.zeros(len(x), dtype=bool))
    for column in x.T if n > 1 else ():
        order = np.argsort(column, kind="stable")
        sums, k = np.cumsum(column[order] - column.mean())[:-1], np.arange(1, n)
        gain = sums**2 * (1 / k + 1 / (n - k))
        if gain.max() > best[0] + 1e-12:
            low = np.zeros(n, dtype=bool)
            low[order[: int(np.argmax(gain)) + 1]] = True
            best = (float(gain.max()), low)
    return best
