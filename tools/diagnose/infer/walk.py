"""Where the knobs of logs are likeliest, and the filter that suits the logs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..model.curves import FLATTEST, SEEN, Curves
from ..model.logs import Filter, Passed, log_likelihood
from ..model.windows import Windows, of_readings

#: Passes over logs at most.
PASSES = 30
#: Windows by which the likeliest knobs are sought, at most.
SOUGHT = 96
#: Knobs move by so many standard deviations between machines at most,
FAR = 2.0
#: and stay where a move makes the logs likelier by less than so much.
LITTLE = 1.0
#: They stay the nearer the less likely the logs become: weights of that, in inverse variances between machines.
DAMPINGS = (0.0, 1.0, 10.0, 100.0, 1000.0)
#: Passes at first that take every move: what switches makes logs less likely before it makes them likelier.
FREE = 4
#: Steps of a sample at most.
PARTS = 8
#: Twice as many change what is foreseen by so little of its errors.
NEAR = 0.1
#: Windows by which it is told whether logs hold means.
TIMED = 24
#: Share of the range of an input by which one that holds changes, and of the samples in which those that step hold.
STILL = 0.03
STEPPING = 0.5
#: Windows by which it is seen how effects curve, at most.
WINDOWS = 4
#: The slope between larger moves is at most so many times that between the smallest; what switches has no curve.
SMOOTH = 2.0
#: Least square of what a small move does, in standard deviations.
TINY = 1e-12
#: Correlations of errors are summed over so many samples at most, and down to so much.
MEMORY = 36
#: What lasts longer is a matter of windows and years.
CORRELATED = 0.05


def walk(
    own: Filter,
    data: Windows,
    group: np.ndarray,
    expected: tuple[np.ndarray, np.ndarray],
    progress: Callable[[int, float], None],
    share: float = 0.0,
) -> tuple[np.ndarray, Passed]:
    """The likeliest knobs of groups of windows: passes, each where the one before points to, until they stay there.

    Args:
        own: the filter; its scatter is fitted where it learns
        data: the windows
        group: number of the group of each
        expected: where all groups begin and are expected (k,), and their covariance about it (k, k)
        progress: told of the number of a pass and the share of it that is done
        share: of the samples that counts; 0 for what each pass shows

    Returns:
        knobs (groups, k), and the pass there
    """
    begun, known, sd = expected[0], np.linalg.inv(expected[1]), np.array([k.sd for k in own.knobs])
    z, places = np.tile(begun, (int(group.max()) + 1, 1)), np.linspace(0, len(group) - 1, min(len(group), SOUGHT))
    some = places.astype(int)
    few, of, whole = data.some(some), group[some], len(group) / len(some)

    def value(passed: Passed, z: np.ndarray) -> float:
        return counted * log_likelihood(passed) - float(np.einsum("ni,ij,nj", z - begun, known, z - begun)) / 2

    best = -np.inf, z
    for n in range(PASSES):
        passed = own.run(few, z[of], progress=partial(progress, n))
        said, scatter = passed.told(z[of]), own.scatter
        counted = whole * (share or min(independent(passed), 1.0))
        if own.learns:
            own.scatter = _scatter(own, passed)
            passed = own.run(few, z[of], slopes=False)
        told, least = said.times(counted).summed(of, len(z)), value(passed, z)
        H = told.H + known
        uphill = (told.eta - (H @ z[:, :, None])[:, :, 0] + begun @ known)[:, :, None]
        best = max(best, (least, z), key=lambda tried: tried[0])
        free = not own.learns and n < FREE
        if not own.learns and n == FREE and least < best[0]:
            z = best[1]
            continue
        for damping in DAMPINGS:
            step = np.linalg.solve(H + damping * np.diag(sd**-2), uphill)[:, :, 0].clip(-FAR * sd, FAR * sd)
            gained = value(own.run(few, (z + step)[of], slopes=False), z + step) - least
            if free or gained >= 0:
                break
        if n + 1 == PASSES or (not free and gained < LITTLE * counted and np.allclose(scatter, own.scatter, rtol=NEAR)):
            break
        z = z + step if free or gained > 0 else z
    return z, own.run(data, z[group])


def loosen(own: Filter, data: Windows, z: np.ndarray) -> None:
    """Let the scatter be as large as errors are where the knobs have not moved: far ones would not count at all."""
    for _ in range(PASSES):
        before, own.scatter = own.scatter, _scatter(own, own.run(data, z, slopes=False))
        if np.allclose(before, own.scatter, rtol=NEAR):
            break


def suit(own: Filter, data: Windows, z: np.ndarray) -> None:
    """Fit the filter to windows: the steps of a sample, and whether they hold what was read at moments."""
    some = np.linspace(0, len(z) - 1, min(len(z), TIMED)).astype(int)

    def passed(moments: bool, parts: int) -> Passed:
        own.moments, own.parts = moments, parts
        return own.run(data.some(some), z[some], slopes=False)

    found = passed(False, 1)
    while own.parts < PARTS:
        finer = passed(False, 2 * own.parts)
        scale = of_readings(np.median, np.abs(finer.error))
        if not (np.sqrt(np.nanmean((finer.shown - found.shown) ** 2, axis=(0, 1))) > NEAR * scale).any():
            own.parts //= 2
            break
        found = finer
    changes, whole = np.abs(np.diff(data.given, axis=1)), np.ptp(data.given[data.there], axis=0)
    if (changes <= STILL * whole).all(axis=2)[data.there[:, 1:]].mean() >= STEPPING:
        # where inputs change all the time a wider error of each would only hide what else is wrong
        logs = [log_likelihood(passed(moments, own.parts)) for moments in (False, True)]
        own.moments = logs[1] > logs[0]


def _scatter(own: Filter, passed: Passed) -> np.ndarray:
    """Scatter of the readings that makes the prediction errors as large as they are."""
    usual = of_readings(np.median, passed.error**2 / passed.variance) / 0.455
    found = own.scatter * np.clip(np.where(np.isfinite(usual), usual, 1.0), 0.25, 4.0) ** 0.5
    return np.maximum(found, own.least)


def independent(passed: Passed) -> float:
    """Share of the samples that count as independent: one over the sum of the errors' correlations in time."""
    e = np.clip(passed.error / np.sqrt(passed.variance), -3.0, 3.0)
    e = e - of_readings(np.mean, e)
    own = of_readings(np.mean, e**2) + 1e-12
    most = int(np.isfinite(e).any(axis=2).sum(axis=1).max())  # samples that count in the longest window
    shares = []
    for j in np.flatnonzero(np.isfinite(own)):
        pairs = (e[:, k:, j] * e[:, :-k, j] for k in range(1, min(MEMORY, most - 1)))
        lags = [float(np.nansum(both) / max(np.isfinite(both).sum(), 1) / own[j]) for both in pairs]
        first = next((k for k, rho in enumerate(lags) if rho < CORRELATED), len(lags))
        shares.append(1 / (1 + 2 * sum(lags[:first])))
    return float(np.mean(shares))


def curves(own: Filter, data: Windows) -> Curves:
    """Curves of all factors about the rig file, as some windows show them."""
    some = np.linspace(0, len(data.read) - 1, min(len(data.read), WINDOWS)).astype(int)
    factors = [j for j, knob in enumerate(own.knobs) if knob.scaled]
    z = np.zeros((len(factors), len(SEEN), len(some), len(own.knobs)))
    for k, j in enumerate(factors):
        z[k, :, :, j] += SEEN[:, None]
    tried = own.run(data.some(np.tile(some, len(factors) * len(SEEN))), z.reshape(-1, z.shape[-1]), slopes=False)
    sound = own.run(data.some(some), np.zeros((len(some), z.shape[-1])), slopes=False)
    found, middle = {}, len(SEEN) // 2
    for j, errors in zip(factors, tried.error.reshape(*z.shape[:-1], *sound.error.shape[1:]), strict=True):
        effects = sound.error - errors
        by = (effects[middle] - effects[middle - 1]) / (SEEN[middle] - SEEN[middle - 1]) / sound.variance
        along = np.nansum(effects * by, axis=(1, 2, 3)) / max(float(np.nansum(by * by * sound.variance)), TINY)
        wide = (along[middle + 1] - along[middle - 2]) / (SEEN[middle + 1] - SEEN[middle - 2])
        if 1 / SMOOTH < wide < SMOOTH:
            x, y = (np.insert(values, middle, 0.0) for values in (SEEN, along))
            rising = np.cumsum([0.0, *np.maximum(np.diff(y), FLATTEST * np.diff(x))])
            found[j] = PchipInterpolator(x, np.arcsinh(rising - rising[middle]))
    return Curves(found, np.zeros(z.shape[-1]))
