"""Readings that are left out together: tests, speeds, loads, oils."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....scenarios.measured.table import Campaign

#: Levels further apart than this share of their range are different ones.
GAP = 0.06
#: Rows of a small campaign, of which tests are left out only.
SMALL = 48
#: Folds of its one scheme.
FEW = 4
#: Of the tests of others.
MOST = 3
#: Fewer rows than these cannot be kept.
LEAST = 6


def schemes(c: Campaign) -> dict[str, list[np.ndarray]]:
    """Scheme -> the rows of each fold; only schemes with two folds or more."""
    small = c.n < SMALL
    most = FEW if small else MOST
    single = c.n_tests <= most
    tests = [np.flatnonzero(c.test == k) for k in range(c.n_tests)]
    # tests next to each other go to different folds, so that each fold has the whole of the campaign's time
    mixed = [np.concatenate(tests[k::most]) for k in range(min(most, c.n_tests))]
    found = {"leave-one-operating-point" if single else "leave-out-tests": tests if single else mixed}
    for scheme, kind in () if small else (("leave-one-speed", "speed"), ("leave-one-load", "torque")):
        given = [s for s in c.given if s.kind == kind]
        if given:
            found[scheme] = levels(np.abs(c.values[given[0].name]))
    oils = np.array(c.oil)[c.test]
    if not small:
        found["leave-one-oil"] = [np.flatnonzero(oils == oil) for oil in dict.fromkeys(c.oil)]
    return {name: folds for name, folds in found.items() if len(folds) > 1 and _sound(folds, c.n)}


def levels(values: np.ndarray) -> list[np.ndarray]:
    """Rows (k,) of each level, lowest first: values with no gap between them."""
    order = np.argsort(values, kind="stable")
    gaps = np.diff(values[order]) > GAP * max(float(np.ptp(values)), 1e-12)
    return [np.sort(rows) for rows in np.split(order, np.flatnonzero(gaps) + 1)]


def _sound(folds: Sequence[np.ndarray], n: int) -> bool:
    return all(n - len(rows) >= LEAST for rows in folds)
