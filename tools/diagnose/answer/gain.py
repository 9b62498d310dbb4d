"""What the causes gain on readings that were left out: in each fold the whole inference runs without them.

Readings are left out together by tests, speeds, loads and oils. A physical model has to beat plain statistics on them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....model.errors import SolveError
from ....scenarios.measured.table import Campaign
from ..infer.evidence import split_error
from ..infer.fit import Fit, Vector
from ..infer.found import Extra, Found
from ..infer.problem import Aside
from ..infer.terms import remainders, spreads
from ..infer.weigh import Options, Weighing
from ..model.observe import Observed
from . import channels
from .decide import temper
from .estimate import loose_variance
from .findings import Gain

#: Draws of the bootstrap.
DRAWS = 2000
#: Rows of a small campaign, of which tests are left out only.
SMALL = 48
#: Folds of its one scheme.
FEW = 4
#: Of the tests of others.
FOLDS = 3
#: Fewer rows than these cannot be kept.
LEAST = 6
#: Weights of the ridge that are tried, as shares of the number of readings.
RIDGES = np.geomspace(1e-4, 1.0, 9)
#: Probability from which a hypothesis counts in what is foreseen.
COUNTS = 0.003


def measure_gains(found: Found, asked: Options, progress: Callable[[float], None] = lambda share: None) -> list[Gain]:
    """All schemes that the data allow, all compared sensors, thermometers of the oil first.

    Args:
        found: the answer of all data; of it the folds use settings, gross readings and prior odds only
        asked: how many causes may act together, and the seed of all draws
        progress: called with the share done
    """
    problem, options = found.problem, Options(seed=asked.seed, most=asked.most, critical=found.critical)
    plans = schemes(problem.data.campaign)
    total, done, told = sum(len(folds) for folds in plans.values()), 0, list[Gain]()
    for scheme, folds in plans.items():
        errors, ran = [], []
        for rows in folds:
            with suppress(SolveError):
                held = np.setdiff1d(np.flatnonzero(np.isin(problem.data.row, rows)), problem.entries_aside)
                errors.append(foresee(found, held, options))
                ran.append(rows)
            done += 1
            progress(done / total)
        sensors = range(len(problem.data.read) if errors else 0)
        told += filter(None, (_gain(found, scheme, ran, errors, i, asked.seed) for i in sensors))
    oil = [s.name for s in problem.data.read if s.kind == "oil_temp"]
    return sorted(told, key=lambda g: g.channel not in oil)


def _gain(
    found: Found, scheme: str, folds: Sequence[np.ndarray], errors: Sequence[Foreseen], sensor: int, seed: int
) -> Gain | None:
    """One sensor's errors over all folds of a scheme."""
    o = found.problem.data
    held = np.concatenate([e.held for e in errors])
    errors_by = {side: np.concatenate([e.by[side] for e in errors], axis=1) for side in errors[0].by}
    mine = o.kind[held] == sensor
    if not mine.any():
        return None
    entries = np.setdiff1d(np.flatnonzero(o.kind == sensor), found.problem.entries_aside)
    rivals, s, rows = {}, o.read[sensor], o.row[entries]
    ways = [kept for fold in folds if not (kept := ~np.isin(rows, fold)).all()]
    for name, rival in RIVALS.items() if all(kept.any() for kept in ways) else ():
        left = [e for kept in ways if (e := rival(o, sensor, rows, kept)) is not None]
        if len(left) == len(ways) and np.isfinite(error := rms(np.concatenate(left))):
            rivals[name] = channels.difference(s, error)
    test = o.campaign.test[o.row[held[mine]]]
    told = {side: [channels.difference(s, rms(line[mine])) for line in lines] for side, lines in errors_by.items()}
    both: dict[str, Any] = {side: dict(zip(("without", "with"), values, strict=True)) for side, values in told.items()}
    return Gain(
        scheme=scheme,
        channel=s.name,
        unit=channels.unit_of_difference(s),
        n=int(mine.sum()),
        rmse_before=told["before"][0],
        rmse_after=told["after"][0],
        **both,
        ratio_ci90=_bootstrap(errors_by["before"][0, mine], errors_by["after"][0, mine], test, seed),
        noise_floor=channels.difference(s, noise_floor(found, sensor)),
        rivals=rivals,
        chosen=dict(Counter(c for e in errors for c in e.causes).most_common()),
        folds=len(folds),
    )


@dataclass(frozen=True)
class Foreseen:
    """Errors of what is foreseen (2, k): by what lasts, and by what passes with a test or mounting, too.

    Args:
        held: entries that are left out (k,)
        by: errors "before", as calibrated without a cause, "after", all hypotheses averaged, and by the "leading" one
        causes: of that one
    """

    held: np.ndarray
    by: Mapping[str, np.ndarray]
    causes: tuple[str, ...]


def foresee(whole: Found, held: np.ndarray, options: Options) -> Foreseen:
    """Everything anew without some readings, and how far it is off there.

    Args:
        whole: the search of all data; its problem, forms and gross readings are used
        held: entries of readings that are left out (k,)
        options: with the prior odds of all data

    Raises:
        SolveError: the model cannot be run without a cause
    """
    problem = whole.problem
    kept = np.setdiff1d(np.arange(problem.m), held)
    found = temper(Weighing(problem.only(kept), whole.formulas, options).glance())
    aside = frozenset(a if a.sensor else Aside(int(kept[a.number])) for a in found.problem.aside)
    anew = problem.without(aside)
    scattering = {e.of.formula for h in found.hypotheses for e in h.extras}
    spread, nominal = [f for f in found.formulas if f in scattering], anew.look(found.null.look.z)
    terms = {t.label: t for t in (*spreads(anew, nominal, spread, found.prior), *remainders(anew))}
    known = np.setdiff1d(kept, anew.entries_aside)

    def left(fit: Fit, extras: Sequence[Extra]) -> np.ndarray:
        """What a fit leaves of those held: by what lasts, and by what passes with a test or mounting, too (2, k)."""
        own = [Extra(terms[e.of.label], e.size) for e in extras if e.of.label in terms]
        look = anew.look(fit.look.z, fit.look.acting, fit.look.sd, fit.look.laws)
        noise = anew.beside(tuple(e.term for e in own)).noise(look, fit.noise.scales)
        S = noise.covariance + look.jacobian / Vector(anew, look).precision @ look.jacobian.T
        r = anew.measured - look.shown + look.jacobian @ look.x
        return split_error(S, noise.passing, r, known, held)

    leader, weights = found.hypotheses[0], np.where(found.probabilities > COUNTS, found.probabilities, 0.0)
    counted = [(h, w) for h, w in zip(found.hypotheses, weights, strict=True) if w or h is leader]  # the leader first
    errors = np.array([left(h.fit, h.extras) for h, _ in counted])
    after = np.average(errors, axis=0, weights=[w for _, w in counted])
    return Foreseen(held, {"before": left(found.null, ()), "after": after, "leading": errors[0]}, leader.causes)


def noise_floor(found: Found, sensor: int) -> float:
    """Standard deviation of one reading: its own scatter, that of the inputs and of the day, as found."""
    mine = found.problem.data.kind == sensor
    return float(np.sqrt(np.mean(loose_variance(found.hypotheses[0].fit)[found.problem.own][mine])))


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


def schemes(c: Campaign) -> dict[str, list[np.ndarray]]:
    """Scheme -> the rows of each fold; only schemes with two folds or more."""
    small = c.n < SMALL
    most = FEW if small else FOLDS
    tests = [np.flatnonzero(c.test == k) for k in range(c.n_tests)]
    # tests next to each other go to different folds, so that each fold has the whole of the campaign's time
    mixed = [np.concatenate(tests[k::most]) for k in range(min(most, c.n_tests))]
    found = {"leave-one-operating-point" if c.n_tests <= most else "leave-out-tests": mixed}
    if not small:
        for scheme, kind in (("leave-one-speed", "speed"), ("leave-one-load", "torque")):
            if given := c.driving(kind):
                found[scheme] = channels.levels(np.abs(c.values[given.name]))
        oils = np.array(c.oil)[c.test]
        found["leave-one-oil"] = [np.flatnonzero(oils == oil) for oil in dict.fromkeys(c.oil)]
    return {
        name: folds
        for name, folds in found.items()
        if len(folds) > 1 and all(c.n - len(rows) >= LEAST for rows in folds)
    }


def constant_cooling(o: Observed, sensor: int, rows: np.ndarray, kept: np.ndarray) -> np.ndarray | None:
    """One number: a temperature's rise over the room in proportion to the power that passes.

    None for other readings, which nothing cools, and where no power is given.
    """
    power, *passing = (o.campaign.driving(kind) for kind in ("power", "speed", "torque"))
    passing = [power] if power else passing
    if not o.read[sensor].kind.endswith("_temp") or None in passing:
        return None
    passed = np.prod([np.abs(o.sensors[s.name]) for s in passing if s], axis=0)
    return fitted(passed[rows, None] / max(float(passed.max()), 1e-300), target(o, sensor, rows), kept, 0.0)


def linear(o: Observed, sensor: int, rows: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """A rise over the room, or another reading, linear in the given sensors, direction and oil, by ridge regression.

    The weight of the ridge is chosen by generalised cross-validation on the kept readings.
    """
    c = o.campaign
    columns = [np.abs(o.sensors[s.name]) for s in o.given]
    columns += [c.direction, *((np.array(c.oil) == oil)[c.test] for oil in sorted(set(c.oil))[1:])]
    X = np.array(columns, dtype=float).T[rows]
    X = X[:, np.ptp(X[kept], axis=0) > 1e-9]
    X = (X - X[kept].mean(axis=0)) / X[kept].std(axis=0)
    y = target(o, sensor, rows)
    best = min(RIDGES, key=lambda share: _gcv(X[kept], y[kept], share * int(kept.sum())))
    return fitted(np.column_stack([np.ones(len(y)), X]), y, kept, best * int(kept.sum()))


def target(o: Observed, sensor: int, rows: np.ndarray) -> np.ndarray:
    """What is regressed: a temperature over the room, another reading as it is."""
    s = o.read[sensor]
    values = o.campaign.values[s.name][rows]
    room = o.campaign.driving("ambient")
    return np.asarray(values - o.sensors[room.name][rows] if s.kind.endswith("_temp") and room else values)


def fitted(X: np.ndarray, y: np.ndarray, kept: np.ndarray, ridge: float) -> np.ndarray:
    """Errors on the readings that are not kept; the first coefficient is not held back."""
    A = X[kept].T @ X[kept] + ridge * np.diag(np.arange(X.shape[1]) > 0)
    beta = np.linalg.lstsq(A, X[kept].T @ y[kept], rcond=None)[0]
    return np.asarray(y[~kept] - X[~kept] @ beta)


def _gcv(X: np.ndarray, y: np.ndarray, ridge: float) -> float:
    """Generalised cross-validation score of a ridge with a free mean."""
    U, d, _ = np.linalg.svd(X, full_matrices=False)
    shrink = d**2 / (d**2 + ridge)
    centred = y - y.mean()
    left = centred - U @ (shrink * (U.T @ centred))
    return float(left @ left / max(len(y) - 1 - shrink.sum(), 1e-9) ** 2)


#: What is assumed -> errors of a sensor's readings in some rows that are not kept, None where it says nothing of them.
RIVALS: Mapping[str, Callable[[Observed, int, np.ndarray, np.ndarray], np.ndarray | None]] = {
    "constant cooling": constant_cooling,
    "linear in the given sensors": linear,
}
