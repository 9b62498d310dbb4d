"""What measured tables allow: too little of them, units that cannot be, causes that they cannot show."""

from __future__ import annotations

import numpy as np

from ...scenarios.measured import Campaign

#: Fewer readings or tests than these say nothing about any cause.
LEAST_READINGS, LEAST_TESTS = 6, 3
#: Readings of temperature beyond this [degC] are taken for another unit.
HOTTEST = 200.0
#: Range of speeds and torques, relative to the largest, below which there is but one of them.
ONE_VALUE = 0.1
#: Points to predict further out than this, relative to what was measured, are extrapolations.
FAR = 0.25


def too_small(data: Campaign) -> list[str]:
    """The problem of a table that is too small to say anything."""
    readings, tests = len(data.readings), len(data.tests())
    if readings >= LEAST_READINGS and tests >= LEAST_TESTS:
        return []
    return [
        f"{data.name}: {readings} readings of {tests} tests are too few to say anything."
        f" Give at least {LEAST_READINGS} readings of {LEAST_TESTS} tests."
    ]


def implausible(campaign: Campaign) -> list[str]:
    """Readings in another unit than their column's name says."""
    return [
        f"{campaign.name} line {reading.line}: {column} = {reading.values[column]:g} is above {HOTTEST:g}."
        " Give temperatures in degrees Celsius."
        for reading in campaign.readings
        for column in ("T_oil_C", "T_oil2_C", "T_wall_C", "T_amb_C")
        if reading.values.get(column, 0.0) > HOTTEST
    ]


def invisible_causes(data: Campaign, *, logged: bool) -> dict[str, str]:
    """Cause -> why these data cannot show it, or cannot tell it from another.

    Args:
        data: the readings
        logged: whether there are time series, too
    """
    readings = data.readings
    found: dict[str, str] = {}
    if not all(r.given("humidity_pct") for r in readings):
        found["cooling.humidity"] = "no humidity_pct: it cannot be told from a scatter of the days"
    if not all(r.given("T_oil2_C") for r in readings):
        found["sensor.oil_temp.position"] = "no T_oil2_C: one oil probe's place is harder to tell from its offset"
    if not any(r.texts.get("date") for r in readings):
        found["procedure.day_scatter"] = "no date: each test counts as a day of its own"
    if len({r.direction for r in readings}) == 1:
        found["sensor.torque.offset"] = "one direction only: it cannot be told from a loss that does not depend on load"
        found["losses.mesh_direction"] = "one direction only: there is nothing to compare it with"
    if len({r.order for r in readings}) == 1:
        ordered = ("sensor.torque.drift", "sensor.torque.step", "procedure.order")
        found |= dict.fromkeys(ordered, "all readings have the same order")
    if _one_value(data, "n_carrier_rpm"):
        found["losses.churning"] = "one speed only: losses that grow with speed cannot be told from each other"
    if _one_value(data, "T_carrier_Nm"):
        found["sensor.torque.gain"] = "one torque only: it cannot be told from an offset"
    if not logged:
        found["thermal.mass"] = "no time series: seen only as far as the readings were not stationary"
    return found


def _one_value(data: Campaign, column: str) -> bool:
    values = data.column(column)
    return bool(np.ptp(values) <= ONE_VALUE * np.max(values))


def small_reference(reference: Campaign | None) -> list[str]:
    """A warning where the model is calibrated on little."""
    if reference is not None and too_small(reference):
        return [f"{reference.name}: so few readings calibrate the model poorly."]
    return []


def outlying(data: Campaign, points: Campaign | None) -> list[str]:
    """Warnings of points to predict that are far outside of what was measured."""
    if points is None:
        return []
    found = []
    for column in ("n_carrier_rpm", "T_carrier_Nm"):
        known, asked = data.column(column), points.column(column)
        far = int(((asked > (1 + FAR) * known.max()) | (asked < (1 - FAR) * known.min())).sum())
        if far:
            found.append(
                f"{points.name}: {column} of {far} points is far outside of {known.min():g} to {known.max():g}."
                " Their prediction is an extrapolation."
            )
    return found
