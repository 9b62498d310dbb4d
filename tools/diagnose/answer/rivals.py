"""Plain statistics that a physical model has to beat on readings that were left out."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..model.observe import Observed

#: Weights of the ridge that are tried, as shares of the number of readings.
RIDGES = np.geomspace(1e-4, 1.0, 9)


def constant_cooling(o: Observed, sensor: int, rows: np.ndarray, kept: np.ndarray) -> np.ndarray | None:
    """One number: a temperature's rise over the room in proportion to the power that passes.

    None for other readings, which nothing cools, and where no power is given.
    """
    passing = [s for s in o.given if s.kind in ("speed", "torque", "power")]
    if not o.read[sensor].kind.endswith("_temp") or not passing:
        return None
    power = np.prod([np.abs(o.sensors[s.name]) for s in passing], axis=0)
    return fitted(power[rows, None] / max(float(np.abs(power).max()), 1e-300), target(o, sensor, rows), kept, 0.0)


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
    room = next((r.name for r in o.given if r.kind == "ambient"), None)
    return np.asarray(values - o.sensors[room][rows] if s.kind.endswith("_temp") and room else values)


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
