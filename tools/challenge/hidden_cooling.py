"""Families of hidden changes of cooling, heat paths and heat capacities."""

from __future__ import annotations

import numpy as np

from .hidden import Draw, Effect
from .scene import Changes, Scene


def air(d: Draw) -> Effect:
    """More or less convection, by a power of the temperature difference or evenly."""
    p = d.uniform(-0.5, 0.5) if d.chance(0.7) else 0.0

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("conv", np.exp(a * (s.rise / 35.0) ** p * d.gate(s)))

    return Effect("cooling.air", "ln", 1.2, d.either(), {"p": p}, act, regime=d.regime)


def emissivity(d: Draw) -> Effect:
    """A surface that radiates less (or, where it was bright, more)."""
    tilt = d.uniform(-0.2, 0.2)
    sign = -1.0 if d.around.own else d.either(0.3)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("rad", np.exp(a * (1 + tilt * (s.T["surface"] - 50.0) / 40.0)))

    return Effect("cooling.emissivity", "ln", 2.6 if sign < 0 else 0.8, sign, {"tilt": tilt}, act)


def foundation(d: Draw) -> Effect:
    """More or less heat into the foundation, which may depend on how warm the foot is."""
    p, sign = d.uniform(-0.3, 0.3), d.either(0.6)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("foot", np.maximum(1 + a * (s.rise / 35.0) ** p, 0.02))

    return Effect("cooling.foundation", "1", 4.0 if sign > 0 else 0.95, sign, {"p": p}, act)


def contact(d: Draw) -> Effect:
    """A joint in the housing that conducts badly, and changes as it warms."""
    tilt = d.uniform(-0.3, 0.3)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("contact", np.exp(a * (1 + tilt * (s.T["wall"] - 50.0) / 40.0)))

    return Effect("cooling.contact", "ln", 4.2, -1.0, {"tilt": tilt}, act)


def oil_wall(d: Draw) -> Effect:
    """Oil that wets the wall differently, by a power of speed."""
    p = d.uniform(-0.5, 0.6)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("oil_wall", np.exp(np.clip(a * (np.maximum(s.n, 20.0) / 175.0) ** p, -3.5, 2.0)))

    return Effect("cooling.oil_wall", "ln", 2.2, d.either(0.35), {"p": p}, act)


def humidity(d: Draw) -> Effect:
    """Cooling that follows the humidity of the room, in a line or bent."""
    bend = d.uniform(-0.4, 0.4)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        x = (s.humidity - 50.0) / 20.0
        c.scale("conv", np.exp(a * np.clip(x + bend * x * x, -3.0, 3.0)))

    return Effect("cooling.humidity", "ln", 0.35, d.either(), {"bend": bend}, act)


def mass(d: Draw) -> Effect:
    """Heat capacities all larger or smaller, or those of the housing alone."""
    inner = d.pick("all", "housing", p=(0.7, 0.3)) == "all"

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("cap_out", np.exp(a))
        if inner:
            c.scale("cap_in", np.exp(a))

    return Effect("thermal.mass", "ln", 1.3, d.either(0.6), {"all": inner}, act)


def split(d: Draw) -> Effect:
    """Heat capacity that belongs to the housing instead of to gears and shafts, or the other way round; same sum."""
    share = d.around.inner_share

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        inner = np.clip(share * np.exp(a), 0.02, 0.95)
        c.scale("cap_in", inner / share)
        c.scale("cap_out", (1 - inner) / (1 - share))

    sign = d.either()
    return Effect("thermal.split", "ln", 0.6 if sign > 0 else 2.0, sign, {}, act)
