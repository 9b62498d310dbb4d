"""Units as a result shows them: SI values of sensors, sizes and shapes in degC, rpm and the like."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..campaign.table import Sensor

#: What a kind of sensor is shown in.
KINDS = {"oil_temp": "degC", "wall_temp": "degC", "ambient": "degC", "torque": "N.m", "speed": "rpm", "power": "W"}
#: Unit in SI -> as it is shown, and the factor.
UNITS = {
    "rad/s": ("rpm", 30 / math.pi),
    "m2/s": ("mm²/s", 1e6),
    "m2/s2": ("mm²/s²", 1e6),
    "s": ("min", 1 / 60),
}
#: Endings of keys of an impact, and what changes.
ENDINGS = {"degC": "K", "N.m": "Nm"}
WHAT = {
    "oil_temp": "oil temperature",
    "wall_temp": "wall temperature",
    "ambient": "room temperature",
    "torque": "torque",
    "speed": "speed",
    "power": "power",
}
#: A quantity in K above this is a temperature, not a difference.
ABSOLUTE = 150.0
ZERO = 273.15


@dataclass(frozen=True)
class Scale:
    """How an SI value is shown: factor * value + offset, in a unit."""

    unit: str
    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: np.ndarray) -> np.ndarray:
        """Values as they are shown."""
        return np.asarray(self.factor * value + self.offset)

    @property
    def difference(self) -> Scale:
        """The same for differences."""
        return Scale("K" if self.unit == "degC" else self.unit, self.factor)


def of_sensor(sensor: Sensor) -> Scale:
    """Of a sensor's readings."""
    unit = KINDS[sensor.kind]
    return Scale(unit, *{"degC": (1.0, -ZERO), "rpm": (30 / math.pi, 0.0)}.get(unit, (1.0, 0.0)))


def of_parameter(unit: str, typical: float) -> Scale:
    """Of a size or shape.

    Args:
        unit: SI
        typical: any value that it may have, which tells temperatures from differences
    """
    if unit == "K" and abs(typical) > ABSOLUTE:
        return Scale("degC", 1.0, -ZERO)
    return Scale(*UNITS.get(unit, (unit, 1.0)))


def key_of(sensor: Sensor) -> str:
    """Key of what changes in a sensor's readings: T_oil_K."""
    unit = KINDS[sensor.kind]
    return f"{sensor.name}_{ENDINGS.get(unit, unit)}"
