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
from .habit import HABIT, POWER


@dataclass(frozen=True)
class Group:
    """Parameters that change together: path -> exponent, key of the card's priors, wide standard deviation.

    `share` is that of the key's standard deviation which the group has. What is zero in a rig is `added` to it.
    """

    paths: Mapping[str, float]
    key: str
    wide: float
    share: float = 1.0
    added: bool = False

    @staticmethod
    def of(key: str, wide: float, *paths: str) -> Group:
        """Parameters that change alike."""
        return Group(dict.fromkeys(paths, 1.0), key, wide)


#: All groups by name. Convection is an area that radiates no more for it; of the foundation the card says nothing, and
#: of friction in thin films only a reference campaign tells.
GROUPS: Mapping[str, Group] = {
    "mesh friction": Group.of("mu", 0.4, "gear_set.k_mu"),
    "bearing loss": Group.of("brg", 0.4, "carrier_bearing.k_loss", "sun_bearing.k_loss", "planet_bearing.k_loss"),
    "seal loss": Group.of("seal", 0.5, "carrier_seal.k_loss", "sun_seal.k_loss"),
    "radiation": Group.of("rad", 0.6, "cooling.emissivity"),
    "oil to gears": Group.of("gow", 0.6, "oil_gears.G"),
    "oil to wall": Group.of("gow", 0.6, "oil_wall.G", "oil_carrier_body.G"),
    "wall to surface": Group.of("gwh", 0.6, "wall_surface.G", "carrier_body_wall.G"),
    "capacities": Group.of("cap", 0.5, "gears.C", "carrier_body.C", "wall.C", "surface.C", "oil.V"),
    "capacities inside": Group.of("cap", 0.5, "gears.C", "carrier_body.C"),
    "foundation": Group({"foot.G": 1.0}, "hconv", 0.7, 0.5),
    "convection": Group({"cooling.A": 1.0, "cooling.emissivity": -1.0}, "hconv", 0.6),
    HABIT.id: Group({POWER: 1.0}, "mu", HABIT.size.sd, 0.0, added=True),
}


@dataclass(frozen=True)
class Parameters:
    """The nuisance parameters of a rig: `wide` where a reference campaign will tell them."""

    base: Mapping[str, float]
    sd: Mapping[str, float]

    @staticmethod
    def of(base: Mapping[str, float], card: Card, *, wide: bool) -> Parameters:
        """From the rig's values and the card."""
        sd = {name: (g.wide if wide else g.share * card.prior(g.key)) for name, g in GROUPS.items()}
        return Parameters(base, {name: sd[name] for name, g in GROUPS.items() if wide or g.share})

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(self.sd)

    def values(self, z: np.ndarray) -> dict[str, float]:
        """Changed values by path."""
        logs: dict[str, float] = {}
        added: dict[str, float] = {}
        for name, number in zip(self.sd, z, strict=True):
            changes = added if GROUPS[name].added else logs
            for path, exponent in GROUPS[name].paths.items():
                changes[path] = changes.get(path, 0.0) + exponent * self.sd[name] * float(number)
        return {path: self.base[path] * math.exp(log) for path, log in logs.items()} | added


def day_values(base: Mapping[str, float], size: float) -> dict[str, Any]:
    """A day whose cooling differs by a share from the others'."""
    return {path: base[path] * (1 + size) for path in ("cooling.A", "foot.G")}


#: Channels of places along logged courses -> the readings they hold.
COURSES = {"T_oil course": "T_oil", "T_wall course": "T_wall"}
#: What the model leaves of a course [K], over how long a share of the dwell, and scatter of a dwell as logged.
COURSE, LENGTH, DWELL = 0.25, 0.3, 0.02
#: Variance of a smoothed course over that of independent samples, which those of a probe are not quite.
ALLOWED = 1.5
#: Decay, per dwell, of what a start at another temperature than that of the room as read leaves in a course.
BEGUN = 3.0


@dataclass(frozen=True)
class Channels:
    """The measured vector: channel -> which rows of the readings it holds.

    `scatter` is the covariance of values along courses as a share of the variance of one reading (places, places).
    """

    holds: Mapping[str, np.ndarray]
    scatter: np.ndarray | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Channels in order."""
        return tuple(self.holds)

    @property
    def rows(self) -> np.ndarray:
        """Row of the readings of each entry."""
        return np.concatenate(list(self.holds.values()))

    def stack(self, readings: Mapping[str, np.ndarray]) -> np.ndarray:
        """Readings of all channels as one vector."""
        return np.concatenate([readings[COURSES.get(c, c)][rows] for c, rows in self.holds.items()])

    def part(self, channel: str) -> slice:
        """Place of a channel in the vector."""
        begin = 0
        for name, rows in self.holds.items():
            if name == channel:
                break
            begin += len(rows)
        return slice(begin, begin + len(self.holds[channel]))

    def warm(self) -> np.ndarray:
        """Which entries are temperatures."""
        return np.concatenate([np.full(len(rows), c[:2] == "T_") for c, rows in self.holds.items()])

    def course(self) -> np.ndarray:
        """Which entries lie along logged courses."""
        return np.concatenate([np.full(len(rows), c in COURSES) for c, rows in self.holds.items()])


def instrument_covariance(channels: Channels, rows: Rows, card: Card) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Scatter of the readings: covariance (m, m), and fixed tolerance -> its effect (m), one standard deviation."""
    which = channels.rows
    m = len(which)
    variance, smooth, columns = np.zeros(m), np.zeros((m, m)), dict[str, np.ndarray]()
    for c in channels.names:
        part = channels.part(c)
        if c == "loss":
            carrier, sun = card.channel("T_carrier_Nm"), card.channel("T_sun_Nm")
            variance[part] = carrier.repeat_sd**2 + 16 * sun.repeat_sd**2
            for name, sd in (("T_carrier", carrier.offset_sd), ("T_sun", 4 * sun.offset_sd)):
                columns[name] = _column(m, part, sd * rows.direction[which[part]])
        elif c == "dwell":
            variance[part] = DWELL**2
        else:
            probe = COURSES.get(c, c)
            channel = card.channel(f"{probe}_C")
            if c in COURSES and channels.scatter is not None:
                smooth[part, part] = ALLOWED * channel.repeat_sd**2 * channels.scatter
            else:
                variance[part] = channel.repeat_sd**2
            columns.setdefault(probe, np.zeros(m))[part] = channel.offset_sd
    room, warm, share = card.channel("T_amb_C"), channels.warm(), rows.share[which]
    same = (rows.test[which][:, None] == rows.test[which]) & (rows.direction[which][:, None] == rows.direction[which])
    R = np.diag(variance) + smooth + np.outer(warm * share, warm * share) * same * room.repeat_sd**2
    course = channels.course()
    kind = np.concatenate([np.full(len(channels.holds[c]), k) for k, c in enumerate(channels.names)])
    alike = same & (kind[:, None] == kind) & course[:, None]
    R += np.outer(course * np.exp(-BEGUN * share), np.exp(-BEGUN * share)) * same * course * room.repeat_sd**2
    R += alike * COURSE**2 * np.exp(-0.5 * ((share[:, None] - share) / LENGTH) ** 2)
    columns["T_amb"] = -room.offset_sd * warm
    return R, columns


def _column(m: int, part: slice, values: np.ndarray | float) -> np.ndarray:
    column = np.zeros(m)
    column[part] = values
    return column
