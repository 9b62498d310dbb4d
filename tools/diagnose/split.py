"""The split certificate: forms are chosen on one half of the tests, what they explain is tested on the other half.

Evidence ranks the causes; this certifies them, with a test that knows nothing of priors. The readings of one half are
taken less all that the other half and a reference campaign let one expect of them: without a cause these innovations
are independent of the half on which the form and the direction of a cause were chosen, whatever tolerances and
calibration both halves share. A cause's coefficient on them has a one-sided t test, which is the F test of one
coefficient with its direction known. The scale of the innovations is estimated from what the cause leaves of them, so
that a card that states its accuracies too well certifies nothing. Both halves serve both ways; as the two p values
depend on each other in unknown ways, twice the smaller is the cause's, which holds whatever the dependence. Of all
causes together, Benjamini and Hochberg's q says what share of those with this q or less is expected to be false.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import t

from .evidence import White, log_bayes_factors
from .family import Family
from .search import Search

#: Steps of speed [rpm] and torque [N.m] within which tests count as the same point.
SPEED, TORQUE = 25.0, 200.0
#: Readings that a half needs beyond the one coefficient.
LEAST = 8


def certified(search: Search) -> dict[str, tuple[float, float]]:
    """Cause -> (p by the split, q over all causes), at the calibration without a cause; none from too few readings.

    A cause that makes days differ has no form to test and is left out.
    """
    problem, c = search.problem, search.problem.data
    rows, place = c.model.rows, problem.place(c)
    w, tau, order = (rows.per_test(values) for values in (rows.w * 30 / np.pi, rows.tau, rows.order))
    first = halves([test.oil for test in c.model.tests], w, tau, order)[rows.test[c.channels.rows]]
    residual, covariance = search.null.residual, search.null.covariance
    own = np.arange(place.start, place.stop)
    p = split_p(residual, covariance, (own[first], own[~first]), search.found)
    return {cause: (p[cause], q) for cause, q in false_shares(p).items()}


def halves(oils: Sequence[str], rpm: np.ndarray, tau: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Which tests are the first half: neighbours in oil, speed and torque are parted, the earlier to sides in turn.

    Args:
        oils: oil of each test
        rpm, tau, order: carrier speed [rpm], carrier torque [N.m] and running order of each test (tests)

    Returns:
        (tests), true for the first half; each half has the whole of the conditions and of the campaign's time
    """
    points = list(zip(oils, np.round(rpm / SPEED), np.round(tau / TORQUE), order, strict=True))
    ranked = sorted(range(len(points)), key=lambda k: points[k])
    first = np.zeros(len(points), dtype=bool)
    for pair in range(0, len(ranked), 2):
        two = sorted(ranked[pair : pair + 2], key=lambda k: order[k])
        first[two[(pair // 2) % 2 :][:1]] = True
    return first


def split_p(
    residual: np.ndarray, covariance: np.ndarray, parts: tuple[np.ndarray, np.ndarray], found: Mapping[str, Family]
) -> dict[str, float]:
    """The p of each cause: twice the smaller of both ways.

    Args:
        residual, covariance: of all readings without a cause (m), (m, m)
        parts: places of the readings of both halves; the rest, which no cause changes, is known beforehand
        found: cause -> its forms, with their signatures (m, forms)
    """
    if min(len(part) for part in parts) < LEAST:
        return {}
    both = [_one_way(residual, covariance, here, there, found) for here, there in (parts, parts[::-1])]
    return {cause: min(1.0, 2 * min(ps[cause] for ps in both)) for cause in found}


def _one_way(
    residual: np.ndarray, covariance: np.ndarray, here: np.ndarray, there: np.ndarray, found: Mapping[str, Family]
) -> dict[str, float]:
    """The p of each cause when its form is chosen `here` and tested `there`."""
    rest = np.setdiff1d(np.arange(len(residual)), np.concatenate([here, there]))
    places, known = np.concatenate([rest, here, there]), len(rest) + len(here)
    white = White.of(residual[places], covariance[np.ix_(places, places)])
    inner = White(white.L[len(rest) :, len(rest) :], white.e[len(rest) :])  # of the rest, no cause has a signature
    g = inner.columns(np.concatenate([f.signatures[places[len(rest) :]] for f in found.values()], axis=1))
    seen, tested = g[: len(here)], g[len(here) :]
    chosen_by, e = white.e[len(rest) : known], white.e[known:]
    p, begin = {}, 0
    for cause, f in found.items():
        own = slice(begin, begin + len(f.forms))
        begin = own.stop
        k, direction = _chosen(f, chosen_by @ seen[:, own], (seen[:, own] ** 2).sum(axis=0))
        p[cause] = _one_sided(direction * tested[:, own][:, k], e)
    return p


def _chosen(f: Family, s: np.ndarray, q: np.ndarray) -> tuple[int, float]:
    """The form of most evidence on a half, and the direction of its size there, the legal one if there is but one."""
    k = int(np.argmax(log_bayes_factors(s, q, f.sd, *f.bounds)))
    low, high = f.cause.size.low, f.cause.size.high
    return k, 1.0 if low >= 0.0 or (high > 0.0 and s[k] > 0.0) else -1.0


def _one_sided(g: np.ndarray, e: np.ndarray) -> float:
    """The p of a positive coefficient of a signature in innovations of unknown scale, both (n)."""
    q, s = float(g @ g), float(g @ e)
    if q <= 0.0:
        return 1.0
    left = max(float(e @ e) - s**2 / q, 1e-300)
    return float(t.sf(s / np.sqrt(q * left / (len(e) - 1)), len(e) - 1))


def false_shares(p: Mapping[str, float]) -> dict[str, float]:
    """Benjamini and Hochberg's q of each p: the least share of false ones at which it is still among the found."""
    ranked = sorted(p, key=lambda cause: (-p[cause], cause))
    q, least = {}, 1.0
    for k, cause in enumerate(ranked):
        least = min(least, p[cause] * len(ranked) / (len(ranked) - k))
        q[cause] = least
    return q
