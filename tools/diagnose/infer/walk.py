"""Where the knobs of logs are likeliest, and the filter that suits the logs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..model.curves import FLATTEST, SEEN, Curves
from ..model.logs import Filter, Passed, Quadratics, log_likelihood
from ..model.windows import Windows, at_duty, of_readings

#: Passes over logs at most.
PASSES = 30
#: Windows by which the likeliest knobs are sought, at most.
SOUGHT = 96
#: Numbers move by so many standard deviations between machines at most,
FAR = 1.0
#: and stay where a move makes the logs likelier by less than so much.
LITTLE = 1.0
#: They stay the nearer the less likely the logs become: weights of that, in inverse variances between machines.
DAMPINGS = (0.0, 1.0, 10.0, 100.0, 1000.0)
#: Steps of a sample at most.
PARTS = 8
#: Twice as many change what is foreseen by so little of its errors.
NEAR = 0.1
#: Windows by which the steps of a sample are told.
TIMED = 24
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


@dataclass(frozen=True, eq=False)
class Places:
    """What the knobs of windows are by numbers of their groups, values and slopes by the duty of what they do.

    Args:
        group: number of each window's group (n,)
        duty: of each (n, 1 + d)
        does: what its knobs do without (n, k)
        curves: of the knobs
    """

    group: np.ndarray
    duty: np.ndarray
    does: np.ndarray
    curves: Curves

    def knobs(self, numbers: np.ndarray) -> np.ndarray:
        """Knobs (n, k) by the numbers of all groups (groups, k + k d)."""
        return self.curves.back(self.does + at_duty(self.duty, numbers[self.group]))

    def told(self, passed: Passed, z: np.ndarray) -> Quadratics:
        """What each window says of what its knobs do more, from a pass at knobs (n, k)."""
        told = passed.told(*self.curves.at(z))
        return replace(told, eta=told.eta - (told.H @ self.does[:, :, None])[:, :, 0])


def walk(
    own: Filter,
    data: Windows,
    places: Places,
    expected: np.ndarray,
    progress: Callable[[int, float], None],
) -> tuple[np.ndarray, Passed]:
    """The likeliest numbers of groups of windows: passes, each where the one before points to, until they stay there.

    Args:
        own: the filter; its scatter is fitted
        data: the windows
        places: of their knobs
        expected: covariance of the numbers of each group about nought (k + k d, k + k d)
        progress: told of the number of a pass and the share of it that is done

    Returns:
        knobs of the windows (n, k), and the pass there
    """
    known, sd, many = np.linalg.inv(expected), np.sqrt(np.diag(expected)), int(places.group.max()) + 1
    some = np.linspace(0, len(places.group) - 1, min(len(places.group), SOUGHT)).astype(int)
    of = replace(places, group=places.group[some], duty=places.duty[some], does=places.does[some])
    few, whole = data.some(some), len(places.group) / len(some)

    def value(passed: Passed, y: np.ndarray) -> float:
        return counted * log_likelihood(passed) - float(np.einsum("ni,ij,nj", y, known, y)) / 2

    y = np.zeros((many, len(sd)))
    for n in range(PASSES):
        z, scatter = of.knobs(y), own.scatter
        passed = own.run(few, z, progress=partial(progress, n))
        counted, own.scatter = whole * min(independent(passed), 1.0), _scatter(own, passed)
        told = of.told(passed, z).times(counted).by_duty(of.duty).summed(of.group, many)
        H, least = told.H + known, value(replace(passed, variance=own.scatter**2), y)
        uphill = (told.eta - (H @ y[:, :, None])[:, :, 0])[:, :, None]
        for damping in DAMPINGS:
            step = np.linalg.solve(H + damping * np.diag(sd**-2), uphill)[:, :, 0].clip(-FAR * sd, FAR * sd)
            gained = value(own.run(few, of.knobs(y + step), slopes=False), y + step) - least
            if gained >= 0:
                break
        if n + 1 == PASSES or (gained < LITTLE * counted and np.allclose(scatter, own.scatter, rtol=NEAR)):
            break
        y = y + step if gained > 0 else y
    z = places.knobs(y)
    return z, own.run(data, z)


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
    own.moments = log_likelihood(passed(True, own.parts)) > log_likelihood(found)


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
