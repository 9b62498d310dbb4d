"""Instruments of a campaign: their card, their fixed tolerances, and the noise of their readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .plan import CHANNELS, OIL
from .rig import Readings

#: Usual class of every instrument: repeatability and fixed tolerance, in the unit of the column.
CLASSES: Mapping[str, tuple[float, float]] = {
    "n_carrier_rpm": (0.3, 0.15),
    "T_carrier_Nm": (0.8, 0.9),
    "T_sun_Nm": (0.2, 0.2),
    "T_oil_C": (0.35, 0.15),
    "T_oil2_C": (0.35, 0.3),
    "T_wall_C": (0.4, 0.2),
    "T_amb_C": (0.25, 0.15),
}

UNITS: Mapping[str, str] = {c: {"rpm": "rpm", "Nm": "N.m", "C": "degC"}[c.rpartition("_")[2]] for c in CHANNELS}

FULL_SCALE: Mapping[str, float] = {"T_carrier_Nm": 3000.0, "T_sun_Nm": 1000.0}

DAY_COOLING_SD = 0.015

#: Relative uncertainty of the model's parameters, as the card states it.
PRIOR_SD: Mapping[str, float] = {
    "mu": 0.10,
    "brg": 0.12,
    "seal": 0.15,
    "hconv": 0.08,
    "rad": 0.08,
    "gow": 0.20,
    "gwh": 0.20,
    "cap": 0.10,
}

#: What each of them multiplies.
PRIOR_FACTORS: Mapping[str, tuple[str, ...]] = {
    "mu": ("mesh",),
    "brg": ("bearing",),
    "seal": ("seal",),
    "hconv": ("conv",),
    "rad": ("rad",),
    "gow": ("oil_wall", "oil_inner"),
    "gwh": ("contact",),
    "cap": ("cap_oil", "cap_in", "cap_out"),
}


@dataclass(frozen=True)
class Instruments:
    """Repeatability, fixed tolerance, and the tolerance that these instruments happen to have, per channel."""

    channels: tuple[str, ...]
    repeat_sd: Mapping[str, float]
    offset_sd: Mapping[str, float]
    offset: Mapping[str, float]

    def fixed(self, readings: Readings) -> Readings:
        """Readings with the fixed tolerances, without noise."""
        return self._shifted(readings, {c: self.offset[c] for c in self.channels})

    def noisy(self, readings: Readings, rng: np.random.Generator) -> Readings:
        """Readings as they go into a file."""
        noise = {c: rng.normal(0.0, self.repeat_sd[c], readings.values[c].shape) for c in self.channels}
        return self._shifted(readings, {c: self.offset[c] + noise[c] for c in self.channels})

    def _shifted(self, readings: Readings, shifts: Mapping[str, Any]) -> Readings:
        from dataclasses import replace

        return replace(readings, values={c: readings.values[c] + shifts[c] for c in self.channels})


def draw_instruments(rng: np.random.Generator, octaves: float, second_oil: bool) -> Instruments:
    """Instruments of classes up to some octaves better or worse than usual."""
    channels = tuple(c for c in CHANNELS if second_oil or c != "T_oil2_C")
    scale = {c: 2.0 ** rng.uniform(-octaves, octaves) for c in CHANNELS}
    repeat = {c: float(f"{scale[c] * CLASSES[c][0]:.3g}") for c in channels}
    tolerance = {c: float(f"{scale[c] * CLASSES[c][1]:.3g}") for c in channels}
    z = dict(zip(CHANNELS, rng.normal(0.0, 1.0, len(CHANNELS)), strict=True))
    return Instruments(channels, repeat, tolerance, {c: tolerance[c] * float(z[c]) for c in channels})


def card(instruments: Instruments, *, bearing_oil: bool, room_drift: float, series: bool) -> dict[str, Any]:
    """What the diagnosis is told of the campaign."""
    channels: dict[str, dict[str, float]] = {}
    for c in instruments.channels:
        channels[c] = {"repeat_sd": instruments.repeat_sd[c], "offset_sd": instruments.offset_sd[c]}
        if c in FULL_SCALE:
            channels[c]["full_scale"] = FULL_SCALE[c]
    lubricant = "oil" if bearing_oil else "grease"
    return {
        "schema": "gearheat.card/1",
        "units": {c: UNITS[c] for c in instruments.channels},
        "channels": channels,
        "day_cooling_sd": DAY_COOLING_SD,
        "prior_sd": dict(PRIOR_SD),
        "protocol": {
            "dwell_min": [240, 90],
            "stop_min": 5,
            "T_start_minus_amb_K": 0,
            "ambient": "linear between the readings",
            "ambient_start_minus_reading_K": round(room_drift, 2),
            "reading": "last sample of the dwell",
        },
        "lubrication": {"gears": "oil", "bearings": lubricant, "needles": lubricant},
        "oil": dict(OIL),
        "series": series,
    }


def unequal(rng: np.random.Generator, sds: Mapping[str, float]) -> dict[str, np.ndarray | float]:
    """Factors of a rig that differs from its nominal within the stated uncertainties."""
    found: dict[str, np.ndarray | float] = {}
    for name, sd in sds.items():
        factor = float(np.exp(rng.normal(0.0, sd)))
        found |= dict.fromkeys(PRIOR_FACTORS[name], factor)
    return found


def with_days(base: Mapping[str, Any], days: np.ndarray) -> dict[str, np.ndarray | float]:
    """The same with cooling scaled per test."""
    found = dict(base)
    for name in ("conv", "rad"):
        found[name] = found.get(name, 1.0) * days
    return found


def tiled(base: Mapping[str, Any], copies: int) -> dict[str, np.ndarray | float]:
    """Factors for several copies of the tests."""
    return {name: np.tile(f, copies) if np.ndim(f) else f for name, f in base.items()}


def scaled(base: Mapping[str, Any], names: Sequence[str], factor: np.ndarray) -> dict[str, np.ndarray | float]:
    """The same with some factors multiplied."""
    return {**base, **{name: base.get(name, 1.0) * factor for name in names}}
