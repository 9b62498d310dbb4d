"""What may differ from the nominal without being a cause: parameters with priors, instruments' tolerances, days.

Everything here is a vector of standard normal numbers `z`; a parameter's logarithmic change is z times its standard
deviation, so the prior of all is the unit normal.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..effects.cause import Rows
from .card import Card

#: Groups of parameters that change together: name -> (paths, key of the card's priors, wide standard deviation).
GROUPS: Mapping[str, tuple[tuple[str, ...], str, float]] = {
    "mesh friction": (("gear_set.k_mu",), "mu", 0.4),
    "bearing loss": (("carrier_bearing.count", "sun_bearing.count", "planet_bearing.count"), "brg", 0.4),
    "seal loss": (("carrier_seal.count", "sun_seal.count"), "seal", 0.5),
    "radiation": (("cooling.emissivity",), "rad", 0.4),
    "oil to gears": (("oil_gears.G",), "gow", 0.6),
    "oil to wall": (("oil_wall.G", "oil_carrier_body.G"), "gow", 0.6),
    "wall to surface": (("wall_surface.G", "carrier_body_wall.G"), "gwh", 0.6),
    "capacities": (("gears.C", "carrier_body.C", "wall.C", "surface.C", "oil.V"), "cap", 0.5),
    "foundation": (("foot.G",), "hconv", 0.7),
    "area": (("cooling.A",), "hconv", 0.6),
}


@dataclass(frozen=True)
class Parameters:
    """The nuisance parameters of a rig: `wide` where a reference campaign will tell them."""

    base: Mapping[str, float]
    sd: Mapping[str, float]

    @staticmethod
    def of(base: Mapping[str, float], card: Card, *, wide: bool) -> Parameters:
        """From the rig's values and the card."""
        return Parameters(base, {name: (far if wide else card.prior(key)) for name, (_, key, far) in GROUPS.items()})

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(self.sd)

    def values(self, z: np.ndarray) -> dict[str, float]:
        """Changed values by path."""
        changed: dict[str, float] = {}
        for name, number in zip(self.sd, z, strict=True):
            for path in GROUPS[name][0]:
                changed[path] = self.base[path] * math.exp(self.sd[name] * float(number))
        if "cooling.emissivity" in changed:
            changed["cooling.emissivity"] = min(changed["cooling.emissivity"], 1.0)
        return changed


def day_values(base: Mapping[str, float], size: float) -> dict[str, Any]:
    """A day whose cooling differs by a share from the others'."""
    return {path: base[path] * (1 + size) for path in ("cooling.A", "foot.G")}


@dataclass(frozen=True)
class Channels:
    """The measured vector: which channels, their rows, and how readings and model become it."""

    names: tuple[str, ...]
    n: int

    def stack(self, readings: Mapping[str, np.ndarray]) -> np.ndarray:
        """Readings of all channels as one vector; a second oil probe reads what the first reads."""
        return np.concatenate([readings["T_oil" if c == "T_oil2" else c] for c in self.names])

    def part(self, channel: str) -> slice:
        """Place of a channel in the vector."""
        k = self.names.index(channel)
        return slice(k * self.n, (k + 1) * self.n)


def instrument_covariance(channels: Channels, rows: Rows, card: Card) -> tuple[np.ndarray, np.ndarray]:
    """Scatter of the readings: variances (m, m), and columns (m, k) of the instruments' fixed tolerances, scaled."""
    m = len(channels.names) * channels.n
    R = np.zeros((m, m))
    columns = []
    for c in channels.names:
        part = channels.part(c)
        if c == "loss":
            carrier, sun = card.channel("T_carrier_Nm"), card.channel("T_sun_Nm")
            R[part, part] += np.eye(channels.n) * (carrier.repeat_sd**2 + 16 * sun.repeat_sd**2)
            for sd in (carrier.offset_sd, 4 * sun.offset_sd):
                columns.append(_column(m, part, sd * rows.direction))
            continue
        channel = card.channel(f"{c}_C")
        R[part, part] += np.eye(channels.n) * channel.repeat_sd**2
        columns.append(_column(m, part, np.full(channels.n, channel.offset_sd)))
    room = card.channel("T_amb_C")
    warm = [channels.part(c) for c in channels.names if c != "loss"]
    for a in warm:
        for b in warm:
            R[a, b] += np.eye(channels.n) * room.repeat_sd**2
    shared = np.zeros(m)
    for part in warm:
        shared[part] = -room.offset_sd
    columns.append(shared)
    return R, np.stack(columns, axis=1)


def _column(m: int, part: slice, values: np.ndarray) -> np.ndarray:
    column = np.zeros(m)
    column[part] = values
    return column
