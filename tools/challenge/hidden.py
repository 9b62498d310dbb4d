"""A hidden effect: what it does to the physics, to the pace of the protocol or to the readings, and how much of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from .scene import Changes, Scene

if TYPE_CHECKING:
    from .plan import Plan
    from .rig import Readings

#: Changes the physics: (scene, amplitude per column, changes).
Act = Callable[[Scene, np.ndarray, Changes], None]

#: Changes what instruments show: (readings, amplitude per column).
Read = Callable[["Readings", np.ndarray], None]

#: Length of a half over what is stated: (plan, half 0 or 1, amplitude per column).
Pace = Callable[["Plan", int, np.ndarray], np.ndarray]

#: Where an effect acts: 0 ... 1 per column.
Gate = Callable[[Scene], np.ndarray | float]


@dataclass(frozen=True)
class Effect:
    """One hidden cause with the form that was drawn for it; its amplitude is found afterwards.

    Args:
        cause: identifier of the taxonomy, or "outside." and a name
        unit: of the amplitude
        high: largest sensible magnitude
        sign: of the amplitude
        form: what was drawn, for the record
        act, pace, read: what it does
        regime: where it acts, for the record; empty everywhere
    """

    cause: str
    unit: str
    high: float
    sign: float = 1.0
    form: Mapping[str, object] = field(default_factory=dict)
    act: Act | None = None
    pace: Pace | None = None
    read: Read | None = None
    regime: Mapping[str, object] = field(default_factory=dict)


def side_by_side(effects: Sequence[Effect]) -> Effect:
    """One effect that is another one in each of as many equal blocks of columns; of the physics and the pace only."""
    count = len(effects)

    def blocks(columns: int) -> list[tuple[Effect, slice]]:
        width = columns // count
        return [(e, slice(i * width, (i + 1) * width)) for i, e in enumerate(effects)]

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        factors: dict[str, np.ndarray] = {}
        heat: dict[str, np.ndarray] = {}
        power = np.zeros(len(a))
        for effect, block in blocks(len(a)):
            changes = Changes()
            if effect.act is not None:
                effect.act(s.part(block), a[block], changes)
            for name, factor in changes.factors.items():
                factors.setdefault(name, np.ones(len(a)))[block] = factor
            for place, watts in changes.heat.items():
                heat.setdefault(place, np.zeros(len(a)))[block] = watts
            power[block] = changes.brake_power
        for name, merged in factors.items():
            c.scale(name, merged)
        for place, merged in heat.items():
            c.warm(place, merged)
        c.brake_power = c.brake_power + power

    def pace(plan: Plan, half: int, a: np.ndarray) -> np.ndarray:
        lengths = np.ones(plan.columns)
        for effect, block in blocks(len(a)):
            if effect.pace is not None:
                lengths[block] = effect.pace(plan, half, a)[block]
        return lengths

    first = effects[0]
    acts, paces = any(e.act is not None for e in effects), any(e.pace is not None for e in effects)
    return Effect(first.cause, first.unit, first.high, act=act if acts else None, pace=pace if paces else None)


def everywhere(scene: Scene) -> float:
    """No regime."""
    return 1.0


def step(x: np.ndarray, threshold: float, width: float) -> np.ndarray:
    """0 far below, 1 far above the threshold."""
    risen: np.ndarray = 0.5 + 0.5 * np.tanh((x - threshold) / width)
    return risen


@dataclass(frozen=True)
class Surroundings:
    """What a draw may know of the campaign: ranges of the conditions and oil temperatures without any effect.

    `own` says whether the physics are those of the project's model; `inner_share` is the share of the heat capacity of
    gears and shafts in that of all but the oil.
    """

    speeds: np.ndarray
    loads: np.ndarray
    oil: np.ndarray
    tests: int
    own: bool
    inner_share: float


@dataclass(frozen=True)
class Draw:
    """Chance, the surroundings, and the regime that an effect shall be limited to."""

    rng: np.random.Generator
    around: Surroundings
    gate: Gate = everywhere
    regime: Mapping[str, object] = field(default_factory=dict)

    def uniform(self, low: float, high: float) -> float:
        """A number between two, to four digits."""
        return float(f"{self.rng.uniform(low, high):.4g}")

    def pick(self, *choices: str, p: Sequence[float] | None = None) -> str:
        """One of several names."""
        return str(self.rng.choice(choices, p=p))

    def chance(self, p: float) -> bool:
        """True with some probability."""
        return bool(self.rng.random() < p)

    def either(self, positive: float = 0.5) -> float:
        """A sign."""
        return 1.0 if self.chance(positive) else -1.0

    def per_test(self) -> np.ndarray:
        """A standard normal number for every running order."""
        return self.rng.normal(0.0, 1.0, self.around.tests)

    def limited(self, kinds: Sequence[str]) -> Draw:
        """The same, limited to one side of a threshold inside the campaign's range, or to one direction."""
        kind = self.pick(*kinds)
        if kind == "direction":
            wanted = 1.0 if self.chance(0.5) else 2.0
            return replace(self, gate=lambda s: float(s.direction == wanted), regime={"direction": wanted})
        side = self.either()
        values, widths = {
            "speed": (self.around.speeds, (2.0, 14.0)),
            "load": (self.around.loads, (20.0, 130.0)),
            "temperature": (self.around.oil, (1.0, 4.0)),
        }[kind]
        threshold, width = float(np.quantile(values, self.uniform(0.28, 0.72))), self.uniform(*widths)

        def gate(s: Scene) -> np.ndarray:
            x = {"speed": s.n, "load": s.load, "temperature": s.T["oil"]}[kind]
            return step(side * x, side * threshold, width)

        regime = {kind: "above" if side > 0 else "below", "threshold": threshold, "width": width}
        return replace(self, gate=gate, regime=regime)


#: A family of forms: draws one of them.
Family = Callable[[Draw], Effect]
