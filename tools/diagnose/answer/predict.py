"""What the instruments will show at other points: as calibrated without a cause, and by the weighed hypotheses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....scenarios.measured.table import Campaign
from ..infer.evidence import White
from ..infer.fit import Fit
from ..infer.found import Found
from ..infer.problem import Problem
from ..model.noise import terms
from ..model.observe import Observed
from . import channels
from .findings import Prediction

#: Probability from which a hypothesis counts.
COUNTS = 0.03


def predict(found: Found, points: Campaign) -> tuple[Prediction, ...]:
    """What the instruments will show at points, where the machine can be run."""
    read, told = found.problem.data.read, []
    tables = [list(map(channels.in_unit, read, table)) for table in simulate(found, points)]
    stated = points.points > 0  # else a row that a test lacks
    for row in np.flatnonzero(stated & np.isfinite(tables).all(axis=(0, 1))):
        both = [{s.name: float(line[row]) for s, line in zip(read, t, strict=True)} for t in tables]
        told.append(Prediction(point=str(points.points[row]), nominal=both[0], extended=both[1]))
    return tuple(told)


def simulate(found: Found, points: Campaign) -> tuple[np.ndarray, np.ndarray]:
    """Readings (read, n) at points, calibrated without a cause and extended, NaN where the machine cannot be run."""
    o = _observed(found, points)
    nominal = _predicted(found.problem, found.null, o)
    counted = [(h.fit, p) for h, p in zip(found.hypotheses, found.probabilities, strict=True) if p > COUNTS]
    counted = counted or [(found.hypotheses[0].fit, 1.0)]
    tables = np.ma.masked_invalid([_predicted(found.problem, fit, o) for fit, _ in counted])
    mean = np.ma.average(tables, axis=0, weights=[p for _, p in counted])
    return nominal, np.where(np.ma.getmaskarray(mean), nominal, mean)


def _observed(found: Found, points: Campaign) -> Observed:
    """The points as a campaign that reads all sensors of the data; causes that follow readings take the nominal's."""
    data = found.problem.data
    place = data.campaign.places(points.order) if points.ordered else np.ones(points.n_tests)  # at its end if not told
    guess = {s.name: np.full(points.n, float(np.nanmean(data.campaign.values[s.name]))) for s in data.read}
    filled = replace(points, sensors=(*points.given, *data.read), values={**points.values, **guess})
    for _ in range(2):
        o = data.another(filled)
        o.features[0] = np.clip(place, 0.0, 1.0)[points.test]
        rows = zip(data.read, _predicted(found.problem, found.null, o), strict=True)
        known = {s.name: np.where(np.isfinite(row), row, guess[s.name]) for s, row in rows}
        filled = replace(filled, values={**filled.values, **known})
    return o


def _predicted(problem: Problem, fit: Fit, o: Observed) -> np.ndarray:
    """Readings (read, n): the model, and what tolerances and remainder make of the data there."""
    seen = o.at(np.append(fit.look.z, 0.0), [(a.formula, a.t) for a in fit.look.acting])
    table = np.full((len(o.read), o.campaign.n), np.nan)
    good = np.isfinite(seen.shown)
    if not good.any():
        return table
    joint = terms([*problem.campaigns, o], [*fit.look.seen, seen], problem.day_sd, fit.look.sd, points=1)
    known = {t.name for t in fit.noise.terms}
    V = fit.noise.scaled([t for t in joint if t.name in known])
    told = V[problem.m :, : problem.m] @ White.of(fit.noise.covariance).back(problem.measured - fit.look.shown)
    table[o.kind[good], o.row[good]] = (seen.shown + np.nan_to_num(told))[good]
    return table
