"""Effects that the taxonomy has no name for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .hidden import Draw, Effect, step
from .scene import RATIO, Changes, Scene

if TYPE_CHECKING:
    from .rig import Readings


def swinging_seal(d: Draw) -> Effect:
    """A seal that rubs more and less from day to day, in waves."""
    periods, phase = d.uniform(1.5, 5.0), d.uniform(0.0, 6.28)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        torque = a * (1 + np.sin(phase + 2 * np.pi * periods * s.progress))
        c.brake(torque * s.w, {"oil": 0.3, "body": 0.4, "wall": 0.3})

    return Effect("outside.swinging_seal", "N.m", 14.0, form={"periods": periods, "phase": phase}, act=act)


def thermostat_fan(d: Draw) -> Effect:
    """A fan that starts when the wall is warm, on some days only."""
    T_on = float(np.quantile(d.around.oil, d.uniform(0.3, 0.6))) - 3.0
    stuck = d.rng.random(d.around.tests) < d.uniform(0.3, 0.6)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        works = 0.5 if s.future else np.where(stuck[s.order.astype(int) - 1], 0.0, 1.0)
        c.scale("conv", np.exp(a * works * step(s.T["wall"], T_on, 1.5)))

    return Effect("outside.thermostat_fan", "ln", 1.3, form={"T_on": T_on, "days_off": float(stuck.mean())}, act=act)


def growing_bridge(d: Draw) -> Effect:
    """A heat bridge from shafts to the surface that grows over the campaign, and cools by draught through the bore."""
    p, bore = d.uniform(0.6, 2.0), d.uniform(0.3, 0.8)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        G = a * np.clip(s.progress, 0.0, 1.0) ** p
        flow = G * (s.T["gears"] - s.T["surface"])
        c.warm("gears", -flow)
        c.warm("surface", flow)
        c.warm("gears", -bore * 0.1 * G * (s.T["gears"] - s.room))

    return Effect("outside.growing_bridge", "W/K", 250.0, form={"p": p, "bore": bore}, act=act)


def torque_hysteresis(d: Draw) -> Effect:
    """A transducer that remembers where its load came from: rising loads read low, falling ones high."""
    table, column = np.sign(d.per_test()), d.pick("T_carrier_Nm", "T_sun_Nm")
    scale = 1.0 if column == "T_carrier_Nm" else 1 / RATIO

    def read(r: Readings, a: np.ndarray) -> None:
        came = table[r.order.astype(int) - 1] * np.where(r.direction == 1, 1.0, -0.6)
        x = np.clip(r.true["load"] / 3000.0, 0.0, 1.0)
        r.values[column] = r.values[column] + scale * a * came * 4 * x * (1 - x)

    return Effect("outside.torque_hysteresis", "N.m at the carrier", 25.0, d.either(), {"column": column}, read=read)


def resonance(d: Draw) -> Effect:
    """A vibration that eats power around one speed."""
    inner = np.unique(np.round(d.around.speeds, -1))
    n_0, width = float(d.rng.choice(inner)) + d.uniform(-5.0, 5.0), d.uniform(8.0, 20.0)

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        power = a * np.exp(-(((s.n - n_0) / width) ** 2)) * s.load / 2100.0
        c.brake(power * s.running, {"wall": 0.7, "body": 0.3})

    return Effect("outside.resonance", "W", 500.0, form={"n_0": n_0, "width": width}, act=act)


def crosstalk(d: Draw) -> Effect:
    """The drive disturbs the oil sensor: more with speed times torque, and the other way in the other direction."""
    back = d.uniform(-1.0, -0.3)

    def read(r: Readings, a: np.ndarray) -> None:
        power = r.values["n_carrier_rpm"] * r.true["load"] / (175.0 * 2100.0)
        r.values["T_oil_C"] = r.values["T_oil_C"] + a * power**2 * np.where(r.direction == 1, 1.0, back)

    return Effect("outside.crosstalk", "K", 8.0, d.either(), {"back": back}, read=read)


def misalignment(d: Draw) -> Effect:
    """Shafts that line up at one load and speed and rub away from it."""
    load_0 = float(np.quantile(d.around.loads, d.uniform(0.3, 0.7)))
    n_0 = float(np.quantile(d.around.speeds, d.uniform(0.3, 0.7)))

    def act(s: Scene, a: np.ndarray, c: Changes) -> None:
        off = np.abs((s.load - load_0) / 600.0) + np.abs((s.n - n_0) / 80.0)
        c.brake(a * off * s.w, {"body": 0.6, "wall": 0.4})

    return Effect("outside.misalignment", "N.m", 15.0, form={"load_0": load_0, "n_0": n_0}, act=act)


def lazy_sensor(d: Draw) -> Effect:
    """An oil sensor full of sludge on some days: it lags far behind."""
    lazy = d.rng.random(d.around.tests) < d.uniform(0.3, 0.6)

    def read(r: Readings, a: np.ndarray) -> None:
        behind = np.where(lazy[r.order.astype(int) - 1], 1.0, 0.0) * np.where(r.direction == 1, 0.4, 1.0)
        r.values["T_oil_C"] = r.values["T_oil_C"] - a * behind * (r.true["oil"] - r.true["room"])

    return Effect("outside.lazy_sensor", "1", 0.3, 1.0, {"days": float(lazy.mean())}, read=read)
