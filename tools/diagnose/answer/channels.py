"""Sensors in the units of a result, and the levels at which they stood."""

from __future__ import annotations

import numpy as np

from ....scenarios.measured.checks import ONE_VALUE
from ....scenarios.measured.table import Sensor
from ..library.entries import TABLE
from ..model.entries import Measured
from .findings import Channel

#: Kind of a sensor -> unit of a result, by how much its numbers are larger than SI, what it measures, ending of a name.
KINDS = TABLE["shown"]
#: Levels further apart than this share of their range are different ones.
GAP = 0.06


def unit(sensor: Sensor) -> str:
    """Unit of its readings."""
    return str(KINDS[sensor.kind][0])


def unit_of_difference(sensor: Sensor) -> str:
    """Unit of a difference of its readings."""
    return "K" if unit(sensor) == "degC" else unit(sensor)


def words(sensor: Sensor) -> str:
    """What it measures."""
    return f"{KINDS[sensor.kind][2]} {sensor.name}"


def in_unit(sensor: Sensor, values: np.ndarray) -> np.ndarray:
    """Readings [SI] in its unit."""
    return np.asarray(values - 273.15 if unit(sensor) == "degC" else values * KINDS[sensor.kind][1])


def difference(sensor: Sensor, value: float) -> float:
    """A difference of readings [SI] in its unit."""
    return float(value * KINDS[sensor.kind][1])


def change_name(sensor: Sensor) -> str:
    """Name of a change of its readings: T_oil_K."""
    ending = KINDS[sensor.kind][3]
    return sensor.name.removesuffix(ending) + ("_K" if ending == "_C" else ending)


def channel(sensor: Sensor) -> Channel:
    """A sensor with its accuracies."""
    return Channel(
        name=sensor.name,
        column=sensor.column,
        kind=sensor.kind,
        role="given" if sensor.role == "given" else "read",
        unit=unit(sensor),
        repeat_sd=difference(sensor, sensor.repeat_sd),
        offset_sd=difference(sensor, sensor.offset_sd),
    )


def compared(o: Measured) -> list[tuple[int, Sensor, np.ndarray]]:
    """Compared sensors that have readings at the ends of dwells: number, sensor, and which entries these are (m,)."""
    return [(i, s, mine) for i, s in enumerate(o.read) if (mine := o.kind == i).any()]


def levels(values: np.ndarray, gap: float = GAP) -> list[np.ndarray]:
    """Rows (k,) of each level, lowest first: no gap is in one, as a share of the range, or of a tenth of the size."""
    order = np.argsort(values, kind="stable")
    gaps = np.diff(values[order]) > gap * max(np.ptp(values), ONE_VALUE * np.abs(values).max())
    return [np.sort(rows) for rows in np.split(order, np.flatnonzero(gaps) + 1)]
