"""Families of faults of instruments and of the procedure.

Faults of the torque transducers act on the columns of the files, which are magnitudes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from .hidden import Draw, Effect
from .scene import RATIO, Changes, Scene

if TYPE_CHECKING:
    from .plan import Plan
    from .rig import Readings


def _transducer(d: Draw) -> tuple[str, float]:
    """One of the two torque columns, and its full scale over that of the carrier's."""
    return ("T_carrier_Nm", 1.0) if d.chance(0.5) else ("T_sun_Nm", 1.0 / RATIO)


def torque_offset(d: Draw) -> Effect:
    """A wrong zero."""
    column, scale = _transducer(d)

    def read(r: Readings, a: np.ndarray) -> None:
        r.values[column] = r.values[column] + scale * a

    return Effect("sensor.torque.offset", "N.m at the carrier", 20.0, d.either(), {"column": column}, read=read)


def torque_gain(d: Draw) -> Effect:
    """A wrong slope, slightly bent."""
    column, _ = _transducer(d)
    p = d.uniform(-0.15, 0.25)

    def read(r: Readings, a: np.ndarray) -> None:
        value = r.values[column]
        r.values[column] = value * (1 + a * (r.true["load"] / 2100.0) ** p)

    return Effect("sensor.torque.gain", "1", 0.015, d.either(), {"column": column, "p": p}, read=read)


def torque_drift(d: Draw) -> Effect:
    """A zero that wanders over the campaign: evenly, slowing down, or by a root."""
    column, scale = _transducer(d)
    kind, tau = d.pick("even", "slowing", "root"), d.uniform(0.2, 0.7)
    shapes: dict[str, Callable[[np.ndarray], np.ndarray]] = {
        "even": lambda x: x,
        "slowing": lambda x: (1 - np.exp(-x / tau)) / (1 - np.exp(-1 / tau)),
        "root": np.sqrt,
    }

    def read(r: Readings, a: np.ndarray) -> None:
        r.values[column] = r.values[column] + scale * a * shapes[kind](np.clip(r.progress, 0.0, 1.0))

    form = {"column": column, "kind": kind, "tau": tau}
    return Effect("sensor.torque.drift", "N.m at the carrier", 25.0, d.either(), form, read=read)


def torque_step(d: Draw) -> Effect:
    """A zero that jumps once, and may creep back."""
    column, scale = _transducer(d)
    at, creep = d.uniform(0.25, 0.75), d.uniform(0.0, 0.5) if d.chance(0.3) else 0.0

    def read(r: Readings, a: np.ndarray) -> None:
        since = r.progress - at
        jump = np.where(since > 0, np.exp(-creep * np.maximum(since, 0.0)), 0.0)
        r.values[column] = r.values[column] + scale * a * jump

    form = {"column": column, "at": at, "creep": creep}
    return Effect("sensor.torque.step", "N.m at the carrier", 25.0, d.either(), form, read=read)


def oil_offset(d: Draw) -> Effect:
    """The oil sensor reads too high or too low."""

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["T_oil_C"] = r.values["T_oil_C"] + a

    return Effect("sensor.oil_temp.offset", "K", 9.0, d.either(), read=read)


def oil_gain(d: Draw) -> Effect:
    """The oil sensor's slope is wrong, about the ice point or the temperature it was adjusted at."""
    T_0 = float(d.pick("0", "20", "25"))

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["T_oil_C"] = r.values["T_oil_C"] + a * (r.values["T_oil_C"] - T_0)

    return Effect("sensor.oil_temp.gain", "1", 0.15, d.either(), {"T_0": T_0}, read=read)


def oil_position(d: Draw) -> Effect:
    """The oil sensor stands where wall or room draw on it, or where the oil of the teeth meets it."""
    other = d.pick("wall", "room", "surface", p=(0.3, 0.5, 0.2))

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["T_oil_C"] = r.values["T_oil_C"] + a * (r.true[other] - r.true["oil"])

    high = 0.3 if other == "room" else 0.95
    return Effect("sensor.oil_temp.position", "1", high, 1.0, {"other": other}, read=read)


def wall_offset(d: Draw) -> Effect:
    """The wall sensor reads too high or too low."""

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["T_wall_C"] = r.values["T_wall_C"] + a

    return Effect("sensor.wall_temp.offset", "K", 9.0, d.either(), read=read)


def ambient_bias(d: Draw) -> Effect:
    """The room's sensor reads too high or too low."""

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["T_amb_C"] = r.values["T_amb_C"] + a

    return Effect("sensor.ambient.bias", "K", 9.0, d.either(), read=read)


def ambient_heated(d: Draw) -> Effect:
    """The room's sensor hangs in the warm air of the gearbox."""
    p = d.uniform(0.8, 1.4)

    def read(r: Readings, a: np.ndarray) -> None:
        rise = np.maximum(r.true["surface"] - r.true["room"], 0.0)
        r.values["T_amb_C"] = r.values["T_amb_C"] + a * 35.0 * (rise / 35.0) ** p

    return Effect("sensor.ambient.heated", "1", 0.35, 1.0, {"p": p}, read=read)


def speed_gain(d: Draw) -> Effect:
    """The speed is read wrong by a factor."""

    def read(r: Readings, a: np.ndarray) -> None:
        r.values["n_carrier_rpm"] = r.values["n_carrier_rpm"] * (1 + a)

    return Effect("sensor.speed.gain", "1", 0.12, d.either(), read=read)


def not_stationary(d: Draw) -> Effect:
    """Readings taken before the stated time: in both halves or one, evenly or by chance."""
    kind = d.pick("both", "first", "second", p=(0.6, 0.25, 0.15))
    by_chance = d.chance(0.3)
    ragged = np.abs(d.per_test()) if by_chance else np.full(d.around.tests, 0.8)

    def pace(plan: Plan, half: int, a: np.ndarray) -> np.ndarray:
        if kind == ("second", "first")[half]:
            return np.ones(plan.columns)
        hurry = ragged.mean() if plan.future else ragged[plan.order.astype(int) - 1]
        shortened: np.ndarray = np.exp(-np.minimum(a * hurry / 0.8, 3.5))
        return shortened

    form = {"kind": kind, "by_chance": by_chance}
    return Effect("procedure.not_stationary", "ln", 2.6, 1.0, form, pace=pace)


def order(d: Draw) -> Effect:
    """Losses or cooling that change over the running order: evenly, or fast at first."""
    target = d.pick("mesh", "losses", "cooling", p=(0.45, 0.35, 0.2))
    kind, tau = d.pick("even", "running in"), d.uniform(0.15, 0.5)
    names = {"mesh": ("mesh",), "losses": ("mesh", "bearing", "seal"), "cooling": ("conv", "rad")}[target]

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        x = np.clip(s.progress, 0.0, 1.0)
        factor = np.exp(a * (x if kind == "even" else np.exp(-x / tau)))
        for name in names:
            c.scale(name, factor)

    form = {"target": target, "kind": kind, "tau": tau}
    return Effect("procedure.order", "ln", 0.6, d.either(), form, act)


def day_scatter(d: Draw) -> Effect:
    """Cooling that differs from day to day more than stated."""
    days = d.per_test()

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        z = 0.0 if s.future else days[s.order.astype(int) - 1]
        c.scale("conv", np.exp(a * z))
        c.scale("rad", np.exp(a * z))

    return Effect("procedure.day_scatter", "ln", 0.25, 1.0, {}, act)
