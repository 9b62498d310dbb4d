"""What hidden effects see and what they may change, whatever simulator runs underneath.

A simulator runs many columns at once: a column is one test of a campaign under one variant of the rig. All arrays of a
`Scene` hold one value per column.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

#: What can be scaled: losses, viscosity of the oil, heat paths to and from the housing, heat capacities.
FACTORS = (
    "mesh",
    "bearing",
    "seal",
    "viscosity",
    "conv",
    "rad",
    "foot",
    "contact",
    "oil_wall",
    "oil_inner",
    "cap_oil",
    "cap_in",
    "cap_out",
)

#: Places that heat can go to.
PLACES = ("oil", "gears", "body", "wall", "surface")

#: Sun speed over carrier speed.
RATIO = 4.0


@dataclass(frozen=True)
class Scene:
    """The rig at one moment.

    Args:
        n: carrier speed [rpm]
        load: carrier torque, magnitude [N.m]
        direction: 1 multiplier, 2 reducer
        order: running order of the test, 1 ...
        progress: running order as a share of the campaign, 0 ... 1
        humidity: relative humidity of the room [%]
        T: temperature of every place [degC]
        room: room temperature [degC]
        nu: kinematic viscosity of the oil before any change [mm2/s]
        future: whether the test lies outside the campaign: no table by running order holds for it
    """

    n: np.ndarray
    load: np.ndarray
    direction: float
    order: np.ndarray
    progress: np.ndarray
    humidity: np.ndarray
    T: Mapping[str, np.ndarray]
    room: np.ndarray
    nu: np.ndarray
    future: bool = False

    @property
    def w(self) -> np.ndarray:
        """Carrier speed [rad/s]."""
        return self.n * (np.pi / 30.0)

    @property
    def running(self) -> np.ndarray:
        """1 where the shafts turn, else 0."""
        return np.where(self.n > 1.0, 1.0, 0.0)

    @property
    def rise(self) -> np.ndarray:
        """Surface above the room, at least 3 K [K]."""
        rise: np.ndarray = np.maximum(self.T["surface"] - self.room, 3.0)
        return rise

    def part(self, which: slice) -> Scene:
        """Some of the columns."""
        return Scene(
            self.n[which],
            self.load[which],
            self.direction,
            self.order[which],
            self.progress[which],
            self.humidity[which],
            {place: T[which] for place, T in self.T.items()},
            self.room[which],
            self.nu[which],
            self.future,
        )


@dataclass
class Changes:
    """What effects change at one moment: factors, braking powers with their heat, and heat from elsewhere."""

    factors: dict[str, np.ndarray | float] = field(default_factory=dict)
    heat: dict[str, np.ndarray | float] = field(default_factory=dict)
    brake_power: np.ndarray | float = 0.0

    def scale(self, name: str, factor: np.ndarray | float) -> None:
        """Multiply what the name stands for."""
        self.factors[name] = self.factors.get(name, 1.0) * factor

    def warm(self, place: str, power: np.ndarray | float) -> None:
        """Bring heat [W] to a place, without any torque."""
        self.heat[place] = self.heat.get(place, 0.0) + power

    def brake(self, power: np.ndarray, shares: Mapping[str, float]) -> None:
        """Take power [W] from the shafts and make it heat, by shares of places."""
        self.brake_power = self.brake_power + power
        for place, share in shares.items():
            self.warm(place, share * power)

    def factor(self, name: str) -> np.ndarray | float:
        """The product of everything that scales the name."""
        return self.factors.get(name, 1.0)
