"""Torques of shaft ends as tables give them: by the power and the speed there, and without a sign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...model.errors import DataError
from ..scenario import Scenario
from .nominal import Nominal
from .sensors import of_power
from .table import Sensor

#: Share of its speed at the operating point below which the power of a shaft says nothing of its torque.
SLOW = 0.01


def torques(
    scenario: Scenario, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], name: str
) -> tuple[tuple[Sensor, ...], dict[str, np.ndarray]]:
    """Sensors and values (n,) with torques in N.m, given ones of one sign as magnitudes.

    Args:
        scenario: the rig
        sensors: of the table
        values: sensor -> column (n,) in the SI unit of what it holds
        name: of the file

    Raises:
        DataError: no column gives the speed at a power
    """
    nominal = Nominal(scenario)
    powers = {s.name: s for s in sensors if of_power(s.kind, s.unit)}
    columns = {**values, **{n: values[n] / _speed(nominal, sensors, values, powers[n], name) for n in powers}}
    return _without_sign(nominal, sensors, columns)


def _speed(
    nominal: Nominal, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], power: Sensor, name: str
) -> np.ndarray:
    """Speed at the end of a power (n,) [rad/s], never at rest, negative where it is turned round from most rows.

    Where its own is not measured it follows from the only one that drives.
    """
    end, turning = power.reads.partition(".")[0], [s for s in sensors if s.kind == "speed"]
    driving = [s for s in turning if s.role == "given"]
    near = [s for s in turning if s.reads.partition(".")[0] == end] or driving
    if not near or (near == driving and len(driving) > 1):
        raise DataError(
            f"{name}: {power.column} is a power, and no column says the speed of {end}, by which it gives the torque"
            " there. Add one."
        )
    own, usual = values[near[0].name], nominal.value(f"{end}.w")
    w = np.abs(own * usual / nominal.value(near[0].reads))
    return np.asarray(np.where(own * np.nansum(np.sign(own)) < 0, -1.0, 1.0) * np.fmax(w, SLOW * abs(usual)))


def _without_sign(
    nominal: Nominal, sensors: Sequence[Sensor], values: dict[str, np.ndarray]
) -> tuple[tuple[Sensor, ...], dict[str, np.ndarray]]:
    """Given torques of one sign as magnitudes, where the rig says at which end power enters."""
    columns = {s.name: values[s.name] for s in sensors if s.role == "given" and s.kind == "torque"}
    loads = [name for name, column in columns.items() if not ((column < 0).any() and (column > 0).any())]
    if not (nominal.scenario.drives and loads):
        return tuple(sensors), values
    ways = {s.name: -1.0 if nominal.value(s.reads) < 0 else 1.0 for s in sensors if s.name in loads}
    signed = (replace(s, signs=(ways[s.name], -ways[s.name])) if s.name in ways else s for s in sensors)
    return tuple(signed), values | {name: np.abs(columns[name]) for name in ways}
