"""Faults of instruments on the sheets "own" and "foreign", and how forms are drawn.

A family states what it does with numbers that are drawn (f): a pair is an even range, a list a choice. Faults of the
torque transducers act on the columns of the files, which are magnitudes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from .plan import Plan
from .rig import CHANNELS, RATIO
from .textbook.rig import Fault

# Conditions at which amounts are stated: the middle of the planetary rig's campaigns.
N = 175.0  #: speed [rpm]
LOAD = 2100.0  #: torque [N.m]
NU = 80.0  #: viscosity of the oil [mm2/s]
T_OIL = 60.0  #: temperature of the oil [degC]

ROW = {c: i for i, c in enumerate(CHANNELS)}
#: Signs that the amount of a fault may have.
UP = (1,)
BOTH = (1, -1)


@dataclass(frozen=True)
class Draw:
    """Chance, and what a draw may know of the campaign.

    Args:
        rng: source of chance
        n, load, oil: speeds, torques and healthy oil temperatures of the readings
        tests: number of tests
        inner: share of gears and shafts in the heat capacity of all but the oil
        steady: whether the campaign holds steady points in one direction
    """

    rng: np.random.Generator
    n: np.ndarray
    load: np.ndarray
    oil: np.ndarray
    tests: int
    inner: float
    steady: bool

    def numbers(self, spans: Mapping[str, Any]) -> SimpleNamespace:
        """One of each list, a number of each pair, a middling quantile of "n", "load", "oil"; and chance by test."""
        numbers: dict[str, Any] = {"z": self.rng.normal(0.0, 1.0, self.tests), "inner": self.inner}
        for name, span in spans.items():
            if isinstance(span, list):
                numbers[name] = span[int(self.rng.integers(len(span)))]
            elif isinstance(span, str):
                numbers[name] = float(np.quantile(getattr(self, span), self.rng.uniform(0.3, 0.7)))
            else:
                numbers[name] = float(f"{self.rng.uniform(*span):.4g}")
        return SimpleNamespace(**numbers)


Family = Callable[[Draw], Fault]


def family(high: float, unit: str, signs: tuple[int, ...], stage: str, what: Any, spans: Mapping[str, Any]) -> Family:
    """Of faults that do something at a stage with the numbers that are drawn."""

    def draw(d: Draw) -> Fault:
        f = d.numbers(spans)
        form = {name: getattr(f, name) for name in spans}
        return Fault("", high, unit, {stage: lambda *arguments: what(*arguments, f)}, form, signs)

    return draw


def by_order(table: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Values of tests by their running order, 1 ..."""
    return np.asarray(table[order.astype(int) - 1])


#: Kind of instrument -> its columns, each with the scale of its error, and its largest error [N.m, K, rpm].
KINDS: Mapping[str, tuple[list[tuple[str, float]], float]] = {
    "torque": ([("T_carrier_Nm", 1.0), ("T_sun_Nm", 1.0 / RATIO)], 22.0),
    "oil_temp": ([("T_oil_C", 1.0)], 9.0),
    "wall_temp": ([("T_wall_C", 1.0)], 9.0),
    "ambient": ([("T_amb_C", 1.0)], 9.0),
    "speed": ([("n_carrier_rpm", 1.0)], 12.0),
}


def add(kind: str, weight: Callable[[Plan, Any], Any], **spans: Any) -> Family:
    """An error [N.m at the carrier, K, rpm] that is an amount times a weight over tests (2, columns)."""
    columns, high = KINDS[kind]

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray, f: SimpleNamespace) -> None:
        column, scale = f.column
        shown[ROW[column]] += scale * a * weight(plan, f)

    return family(
        high, {"torque": "N.m", "speed": "rpm"}.get(kind, "K"), BOTH, "read", read, {"column": columns, **spans}
    )


def _constant(kind: str) -> Family:
    return add(kind, lambda plan, f: 1.0)


def _since(kind: str) -> Family:
    """From a test on, creeping back or not."""

    def weight(plan: Plan, f: SimpleNamespace) -> np.ndarray:
        late = plan.progress - f.since
        return np.where(late > 0, np.exp(-f.creep * np.maximum(late, 0.0)), 0.0)

    return add(kind, weight, since=(0.25, 0.75), creep=[0.0, 0.0, 0.3])


def _one_way(kind: str) -> Family:
    return add(kind, lambda plan, f: np.array(f.parts)[:, None], parts=[(1.0, 0.0), (0.0, 1.0), (1.0, -1.0)])


def _drift(kind: str) -> Family:
    return add(kind, lambda plan, f: plan.progress**f.p, p=[0.5, 0.7, 1.0])


def _random_walk(kind: str) -> Family:
    return add(kind, lambda plan, f: by_order(np.cumsum(f.z), plan.order) / np.sqrt(plan.tests / 2.0))


def follow(high: float, what: Callable[[np.ndarray, Any], tuple[str, Any]], signs: Any = BOTH, **spans: Any) -> Family:
    """An error that follows other readings: a column, and what an amount of one adds to it."""

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray, f: SimpleNamespace) -> None:
        column, error = what(shown, f)
        shown[ROW[column]] += a * error

    return family(high, "1", signs, "read", read, spans)


def gain(high: float, columns: list[str], about: list[float]) -> Family:
    """A wrong slope of a column, about a value at which it was adjusted."""
    return follow(high, lambda y, f: (f.column, y[ROW[f.column]] - f.about), column=columns, about=about)


#: Every error of every kind of instrument: rivals of whatever is hidden.
INSTRUMENTS: Mapping[str, Family] = {
    f"sensor.{kind}.{name}": errors(kind)
    for kind in KINDS
    for name, errors in {
        "offset": _constant,
        "drift": _drift,
        "since": _since,
        "by_direction": _one_way,
        "random_walk": _random_walk,
    }.items()
} | {
    "sensor.torque.gain": gain(0.015, ["T_carrier_Nm", "T_sun_Nm"], [0.0]),
    "sensor.speed.gain": gain(0.12, ["n_carrier_rpm"], [0.0]),
    **{
        f"sensor.{kind}.gain": gain(0.15, [KINDS[kind][0][0][0]], [0.0, 20.0, 25.0])
        for kind in ("oil_temp", "wall_temp", "ambient")
    },
}
