"""Torques of shaft ends as tables give them: by power and speed, without a sign, in both directions of rotation."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...model.errors import DataError
from ..scenario import Scenario
from .nominal import REST, Nominal, drive_by
from .sensors import of_power
from .table import Sensor

#: Share of its speed at the operating point below which the power of a shaft says nothing of its torque.
SLOW = 0.01
#: Rows of the first direction whose losses the model tells.
SAMPLED = 3


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
    loads = [name for name, column in columns.items() if not _both(column)]
    if not (nominal.scenario.drives and loads):
        return tuple(sensors), values
    ways = {s.name: -1.0 if nominal.value(s.reads) < 0 else 1.0 for s in sensors if s.name in loads}
    signed = (replace(s, signs=(ways[s.name], -ways[s.name])) if s.name in ways else s for s in sensors)
    return tuple(signed), values | {name: _magnitudes(columns[name]) for name in ways}


def _both(column: np.ndarray) -> bool:
    """Whether a column (n,) holds both signs, beyond what an error of its zero makes of no load."""
    least = SLOW * np.nanmax(np.abs(column), initial=0.0)
    return bool((column < -least).any() and (column > least).any())


def _magnitudes(column: np.ndarray) -> np.ndarray:
    """A column of one sign (n,) without it; what an error of the zero puts beyond zero stays there."""
    return column * (-1.0 if np.nansum(column) < 0 else 1.0)


def turned(
    scenario: Scenario,
    sensors: Sequence[Sensor],
    values: dict[str, np.ndarray],
    stated: np.ndarray,
    signed_by_card: Collection[str] = (),
) -> tuple[tuple[Sensor, ...], dict[str, np.ndarray], np.ndarray]:
    """Sensors and values with the signs that columns have in both directions, and the direction of each row (n,).

    Loads without a sign turn with the rotation. A direction that the table states is one of the rotation, too, where
    losses say that power enters at the same end; without torques at both ends, where the speed turns with it.

    Args:
        scenario: the rig
        sensors: of the table
        values: sensor -> column (n,) in SI, loads without a sign as magnitudes
        stated: direction of each row, +1, -1, or 0 where none is stated (n,)
        signed_by_card: sensors, by name or column, whose signs the card says
    """
    nominal = Nominal(drive_by(scenario, sensors))
    usual = {s.name: -1.0 if nominal.value(s.reads) < 0 else 1.0 for s in sensors if s.kind in ("speed", "torque")}
    given = {s.name: s for s in sensors if s.role == "given" and s.name in usual}
    columns = {name: values[name] * usual[name] for name, s in given.items() if s.signs == (1.0, 1.0)}
    columns = {n: np.where(np.abs(v) > SLOW * np.nanmax(np.abs(v)), np.sign(v), 1.0) for n, v in columns.items()}
    turning = {name: way for name, way in columns.items() if _both(way)}
    rotation = next((way for name, way in turning.items() if given[name].kind == "speed"), np.ones(len(stated)))
    signed = next((way for name, way in turning.items() if given[name].kind == "torque"), None)
    loads = [s for s in given.values() if s.kind == "torque" and s.signs[0] == -s.signs[1]]
    direction, signs = stated, dict[str, tuple[float, float]]()
    if signed is not None:
        direction = stated if stated.any() else signed
    elif loads and (stated.any() or _both(rotation)):
        direction = stated if stated.any() else rotation
        same = bool((direction == rotation).all())
        back = _flows_back(nominal, sensors, values, np.where(direction < 0, -1.0, rotation > 0))
        back = not same if back is None else back
        if same and back:  # a load that is let down
            signs = {s.name: (s.signs[0], s.signs[0]) for s in loads}
        elif not (_both(rotation) or back):
            signs = {s.name: (1.0, -1.0) for s in sensors if s.kind == "speed" and s.signs == (1.0, 1.0)}
        elif not same:
            direction = direction * rotation
    if _both(direction) and signs.keys().isdisjoint(s.name for s in loads):
        read = [s for s in sensors if s.role == "read" and s.kind == "torque" and s.signs == (1.0, 1.0)]
        read = [s for s in read if not _both(values[s.name]) and {s.name, s.column}.isdisjoint(signed_by_card)]
        whole = [s.name for s in read if signed is None or (direction == signed).all()]
        signs |= {name: (usual[name], -usual[name]) for name in whole}
        values = values | {name: _magnitudes(values[name]) for name in whole}
    return tuple(replace(s, signs=signs.get(s.name, s.signs)) for s in sensors), values, direction


def _flows_back(
    nominal: Nominal, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], rows: np.ndarray
) -> bool | None:
    """Whether power enters at the other end in the second direction, by losses; None where they leave it open.

    The end where it enters has more power. How far the transducers are off tells the first direction, whose losses
    are those of the model.
    """
    ends = [end for end, ratio in nominal.ratios.items() if abs(ratio) > REST]
    torque = {s.reads.partition(".")[0]: values[s.name] for s in sensors if s.kind == "torque"}
    first, second = np.flatnonzero(rows > 0), np.flatnonzero(rows < 0)
    if len(ends) != 2 or not torque.keys() >= set(ends) or not len(first) or not len(second):
        return None
    ends = sorted(ends, key=lambda end: -nominal.value(f"{end}.tau") * nominal.ratios[end])
    ratios = np.array([nominal.ratios[end] for end in ends])
    first = first[np.linspace(0, len(first) - 1, SAMPLED).round().astype(int)]
    given = {s.reads: values[s.name] * s.signs[0] for s in sensors if s.role == "given"}
    states = [nominal.at({path: float(column[row]) for path, column in given.items()}) for row in first]
    modelled = np.array([[state[f"{end}.tau"] for end in ends] if state else [np.nan, np.nan] for state in states])

    def surplus(torques: np.ndarray) -> float:
        into, out = np.nansum(np.abs(torques * ratios)[np.isfinite(torques).all(axis=1)], axis=0)
        return float(np.log(into / out)) if into > 0 and out > 0 else np.nan

    measured = np.transpose([torque[end] for end in ends])
    before, after = surplus(measured[first]), surplus(measured[second])
    if after < before - surplus(modelled):
        return True
    return False if min(before, after) > 0 else None
