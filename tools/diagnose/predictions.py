"""Predictions at points without readings: what the oil probe will show, without and with what was found."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...model.errors import SolveError
from ...scenarios.measured import Campaign

#: Nominal and extended oil temperatures [degC] (n, n) of a table's readings, test by test in running order.
Predictor = Callable[[Campaign], tuple[np.ndarray, np.ndarray]]

HEAD = "point,T_oil_nominal_C,T_oil_extended_C"


def predictions_text(points: Campaign, predictor: Predictor) -> str:
    """The table of predictions as CSV, a row per point in the order of the points' table.

    Raises:
        SolveError: a point for which the model has no temperature
    """
    nominal, extended = predictor(points)
    order = [reading.point for test in points.tests() for reading in test.halves]
    found = dict(zip(order, zip(nominal, extended, strict=True), strict=True))
    if lost := [str(point) for point, pair in found.items() if not np.isfinite(pair).all()]:
        raise SolveError(f"{points.name}: no temperature for point {', '.join(lost)}. Check its speed and torque.")
    rows = [f"{r.point},{found[r.point][0]:.4f},{found[r.point][1]:.4f}" for r in points.readings]
    return "\n".join([HEAD, *rows]) + "\n"
