"""Power balance of measured rows: what goes in at the shaft ends and does not come out is lost."""

from __future__ import annotations

import numpy as np

from .nominal import REST, Nominal
from .table import Campaign


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


def loss(powers: dict[str, np.ndarray]) -> np.ndarray:
    """Power that is lost (n,) [W]."""
    return np.asarray(sum(powers.values()))


def efficiency(powers: dict[str, np.ndarray]) -> np.ndarray:
    """Power out over power in (n,), NaN where nothing goes in."""
    into = np.asarray(sum(np.maximum(power, 0.0) for power in powers.values()))
    out = np.asarray(sum(np.maximum(-power, 0.0) for power in powers.values()))
    return np.where(into > 0, out / np.where(into > 0, into, 1.0), np.nan)
