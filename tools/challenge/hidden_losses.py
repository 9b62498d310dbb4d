"""Families of hidden losses and heat sources."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .hidden import Draw, Effect
from .scene import Changes, Scene

#: Conditions at which amplitudes are stated: speed [rpm], torque [N.m], viscosity [mm2/s], oil temperature [degC].
N, LOAD, NU, T_OIL = 175.0, 2100.0, 80.0, 60.0


def _soft_ramp(x: np.ndarray, width: float) -> np.ndarray:
    ramp: np.ndarray = width * np.logaddexp(0.0, x / width)
    return ramp


def churning(d: Draw) -> Effect:
    """Power of speed, a sum of two powers, or a loss that sets in at some speed."""
    kind = d.pick("power", "two powers", "onset", p=(0.5, 0.25, 0.25))
    p, q, oil = d.uniform(1.35, 3.0), d.uniform(-0.1, 0.45), d.uniform(0.55, 1.0)
    n_0, share = d.uniform(50.0, 150.0), d.uniform(0.2, 0.8)

    def shape(s: Scene) -> np.ndarray:
        x = s.n / N
        if kind == "power":
            speed = x**p
        elif kind == "two powers":
            speed = share * x**1.3 + (1 - share) * x**3
        else:
            speed = _soft_ramp((s.n - n_0) / 100.0, 0.08) ** (0.6 * p)
        result: np.ndarray = speed * (s.nu / NU) ** q * d.gate(s)
        return result

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.brake(a * shape(s) * s.running, {"oil": oil, "gears": 1 - oil})

    form = {"kind": kind, "p": p, "q": q, "oil_share": oil, "n_0": n_0, "share": share}
    return Effect("losses.churning", "W", 450.0, form=form, act=act, regime=d.regime)


def windage(d: Draw) -> Effect:
    """A high power of speed, the lighter the warmer the air is."""
    p, oil = d.uniform(2.1, 3.3), d.uniform(0.2, 0.8)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        density = 330.0 / (273.15 + s.T["wall"])
        power = a * (s.n / N) ** p * density * d.gate(s) * s.running
        c.brake(power, {"oil": oil, "gears": 0.5 * (1 - oil), "wall": 0.5 * (1 - oil)})

    form = {"p": p, "oil_share": oil}
    return Effect("losses.windage", "W", 400.0, form=form, act=act, regime=d.regime)


def oil_level(d: Draw) -> Effect:
    """More oil: it is churned, stores heat and wets more."""
    p, q, wet = d.uniform(1.4, 2.6), d.uniform(0.0, 0.4), d.uniform(0.0, 0.3)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.brake(a * (s.n / N) ** p * (s.nu / NU) ** q * s.running, {"oil": 0.9, "gears": 0.1})
        c.scale("cap_oil", 1 + a / 400.0)
        c.scale("oil_inner", 1 + wet * a / 200.0)

    return Effect("losses.oil_level", "W", 400.0, form={"p": p, "q": q, "wet": wet}, act=act)


def oil_viscosity(d: Draw) -> Effect:
    """Another viscosity, by a factor that may depend on temperature."""
    tilt = d.uniform(-0.5, 0.5)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        c.scale("viscosity", np.exp(a * (1 + tilt * (s.T["oil"] - T_OIL) / 40.0)))

    return Effect("losses.oil_viscosity", "ln", 1.6, d.either(), {"tilt": tilt}, act)


def _rubbing(d: Draw, cause: str, heat: Mapping[str, float], p: float, tilt: float) -> Effect:
    """A friction torque that depends on speed by a power and on oil temperature by an exponential."""

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        torque = a * (np.maximum(s.n, 1.0) / N) ** p * np.exp(tilt * (s.T["oil"] - T_OIL) / 40.0) * d.gate(s)
        c.brake(torque * s.w, heat)

    form = {"p": p, "tilt": tilt, "heat": dict(heat)}
    return Effect(cause, "N.m", 14.0, form=form, act=act, regime=d.regime)


def seal_drag(d: Draw) -> Effect:
    """A lip that rubs more, less so when it is warm."""
    oil, outside = d.uniform(0.2, 0.95), d.uniform(0.2, 0.8)
    heat = {"oil": oil, "body": (1 - oil) * (1 - outside), "wall": (1 - oil) * outside}
    return _rubbing(d, "losses.seal_drag", heat, d.uniform(-0.3, 0.5), d.uniform(-0.7, 0.0))


def bearing_preload(d: Draw) -> Effect:
    """Bearings under more axial load, growing or fading with temperature."""
    oil, outside = d.uniform(0.2, 0.95), d.uniform(0.3, 0.7)
    heat = {"oil": oil, "body": (1 - oil) * (1 - outside), "wall": (1 - oil) * outside}
    return _rubbing(d, "losses.bearing_preload", heat, d.uniform(0.0, 0.35), d.uniform(-0.65, 0.45))


def mesh_friction(d: Draw) -> Effect:
    """Teeth that rub differently, by powers of load and speed."""
    p, q = d.uniform(-0.4, 1.0), d.uniform(-0.35, 0.35)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        shape = (np.maximum(s.load, 50.0) / LOAD) ** p * (np.maximum(s.n, 1.0) / N) ** q
        c.scale("mesh", np.exp(a * np.minimum(shape, 4.0) * d.gate(s)))

    return Effect("losses.mesh_friction", "ln", 0.9, d.either(0.7), {"p": p, "q": q}, act, regime=d.regime)


def mesh_direction(d: Draw) -> Effect:
    """Teeth that rub differently in one direction, or apart in both."""
    p, kind = d.uniform(-0.3, 0.7), d.pick("second", "first", "apart")
    parts = {"second": (0.0, 1.0), "first": (1.0, 0.0), "apart": (-0.5, 0.5)}[kind]

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        shape = (np.maximum(s.load, 50.0) / LOAD) ** p
        c.scale("mesh", np.exp(a * shape * parts[int(s.direction) - 1]))

    return Effect("losses.mesh_direction", "ln", 0.8, d.either(), {"p": p, "kind": kind}, act)


def film_starvation(d: Draw) -> Effect:
    """Teeth that rub more where the film is thin: by a power of speed times viscosity, or below some value of it."""
    kind = d.pick("power", "threshold")
    p, ratio, width = d.uniform(0.7, 2.2), d.uniform(0.6, 1.6), d.uniform(0.15, 0.5)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        film = np.maximum(s.n, 20.0) * s.nu / (N * NU)
        thin = np.minimum(film**-p, 5.0) if kind == "power" else 0.5 - 0.5 * np.tanh(np.log(film / ratio) / width)
        c.scale("mesh", 1 + a * thin)

    form = {"kind": kind, "p": p, "ratio": ratio, "width": width}
    return Effect("losses.film_starvation", "1", 1.4, form=form, act=act)


def external_source(d: Draw) -> Effect:
    """Heat from a neighbour (or to a cooler) at the housing, little of it in the oil, by a power of speed."""
    p, oil, wall = d.uniform(0.0, 2.0), d.uniform(0.0, 0.3), d.uniform(0.0, 1.0)
    place = d.pick("surface", "body", p=(0.7, 0.3))

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        power = a * (np.maximum(s.n, 1.0) / N) ** p * d.gate(s) * (s.running if p > 0.3 else 1.0)
        c.warm("oil", oil * power)
        c.warm("wall", (1 - oil) * wall * power)
        c.warm(place, (1 - oil) * (1 - wall) * power)

    form = {"p": p, "oil_share": oil, "wall_share": wall, "place": place}
    sign = d.either(0.75)
    high = 400.0 if sign > 0 else 150.0
    return Effect("heat.external_source", "W", high, sign, form, act, regime=d.regime)
