"""What the model of a rig gives at its operating point and at measured conditions: the yardstick of measured tables.

The power balance of measured rows: what goes in at the shaft ends and does not come out is lost.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...model.core.flat import FlatModel
from ...model.errors import GearheatError
from ...model.parts.shaft import ShaftEnd
from ...model.run.steady import steady
from ...model.units import text
from ..scenario import Scenario
from .table import Campaign, Sensor

#: Speed below which a shaft is at rest [rad/s].
REST = 1e-6


class Nominal:
    """Steady states of a rig, computed when they are asked for.

    Args:
        scenario: the rig, driven as its campaigns are
    """

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.ends = scenario.spec.of_type(ShaftEnd.__name__)

    @cached_property
    def flat(self) -> FlatModel:
        """The flat model."""
        return self.scenario.spec.flat()

    @cached_property
    def operating(self) -> Mapping[str, float]:
        """All values at the operating point, by path."""
        return self.at({}) or {}

    def value(self, path: str) -> float:
        """A value at the operating point, NaN where the model finds none."""
        point = self.scenario.operating_point
        return float(point[path]) if path in point else self.operating.get(path, np.nan)

    def at(self, values: Mapping[str, float]) -> Mapping[str, float] | None:
        """All values at other inputs and parameters, by path; None where there is no steady state."""
        asked = {**self.scenario.operating_point, **values}  # which may name what follows as the rig is driven
        known = {path: v for path, v in asked.items() if self.flat.index.get(path, ("",))[0] in ("input", "parameter")}
        try:
            result = steady(self.flat, known)
        except GearheatError:
            return None
        return {name: float(column[0]) for name, column in result.columns.items()}

    @cached_property
    def ratios(self) -> Mapping[str, float]:
        """Speed of each shaft end over that of the first one that turns at the operating point; NaN of others apart."""
        speeds = {end: self.value(f"{end}.w") for end in self.ends}
        first = next((end for end, w in speeds.items() if abs(w) > REST), None)
        tied = self.scenario.spec.turning_with([first] if first else [])
        return {end: w / speeds[first] if first and end in tied else np.nan for end, w in speeds.items()}


def model_values(campaign: Campaign) -> dict[str, np.ndarray]:
    """Path -> what is measured of it (n,) in SI, with the model's signs; the first sensor of a path leads."""
    found: dict[str, np.ndarray] = {}
    for sensor in campaign.sensors:
        found.setdefault(sensor.reads, campaign.values[sensor.name] * sensor.sign(campaign.direction))
    return found


def shaft_powers(campaign: Campaign, nominal: Nominal) -> dict[str, np.ndarray] | None:
    """Shaft end -> power into the gearbox there (n,) [W], as measured; None where a torque or all speeds are missing.

    Args:
        campaign: what was measured
        nominal: its rig; the ratios of its gears give the speeds that were not measured
    """
    values, ratios = model_values(campaign), nominal.ratios
    speeds = {end: values[f"{end}.w"] for end in nominal.ends if f"{end}.w" in values and abs(ratios[end]) > REST}
    turning = [end for end in nominal.ends if np.isfinite(ratios[end]) and abs(ratios[end]) > REST]
    if not speeds or any(f"{end}.tau" not in values for end in turning):
        return None
    known, w = next(iter(speeds.items()))
    return {end: values[f"{end}.tau"] * speeds.get(end, w * ratios[end] / ratios[known]) for end in turning}


def efficiency(powers: dict[str, np.ndarray]) -> np.ndarray:
    """Power out over power in (n,), NaN where nothing goes in."""
    into = np.asarray(sum(np.maximum(power, 0.0) for power in powers.values()))
    out = np.asarray(sum(np.maximum(-power, 0.0) for power in powers.values()))
    return np.where(into > 0, out / np.where(into > 0, into, 1.0), np.nan)


def drive_by(scenario: Scenario, sensors: Iterable[Sensor]) -> Scenario:
    """The rig driven by what a campaign gives at its shaft ends, at the operating point of its file.

    Args:
        scenario: the rig
        sensors: of the campaign; those that are given drive
    """
    driven = scenario.driven_by([sensor.reads for sensor in sensors if sensor.role == "given"])
    stated = driven.operating_point
    if not (missing := driven.driven_paths() & driven.shaft_paths() - stated.keys()):
        return driven
    own = Nominal(scenario).operating  # a load says no sign
    return replace(driven, operating_point={**stated, **{path: own[path] for path in sorted(missing) if path in own}})


def unmeasured(nominal: Nominal, name: str, sensors: Iterable[Sensor]) -> Iterator[str]:
    """What drives the model at its shafts and no sensor gives, in words.

    Args:
        nominal: the rig as it is driven
        name: of the file
        sensors: that it has
    """
    rig = nominal.scenario
    for path in sorted(rig.driven_paths() & rig.shaft_paths() - {s.reads for s in sensors}):
        taken = text(nominal.value(path), nominal.flat.quantity(path).unit, 4)
        yield f"{name}: nothing says {path}, which drives the model: {taken} of the rig is taken in all rows."
