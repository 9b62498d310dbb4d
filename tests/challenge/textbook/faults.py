"""The faults of the textbook rig by their names, and what limits them to a regime. FROZEN, see the package."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from ..plan import Plan
from . import misreadings as i, physical as p
from .rig import Around, Family, Fault, Now, Stage

CAUSES: Mapping[str, Family] = {
    "losses.churning": p.churning,
    "losses.windage": p.windage,
    "losses.oil_level": p.oil_level,
    "losses.oil_viscosity": p.oil_viscosity,
    "losses.bearing_preload": p.bearing_preload,
    "losses.seal_drag": p.seal_drag,
    "losses.mesh_friction": p.mesh_friction,
    "losses.mesh_direction": p.mesh_direction,
    "losses.film_starvation": p.film_starvation,
    "losses.torque_only": p.torque_only,
    "heat.external_source": p.external_source,
    "cooling.air": p.air,
    "cooling.emissivity": p.emissivity,
    "cooling.foundation": p.foundation,
    "cooling.contact": p.contact,
    "cooling.oil_wall": p.oil_wall,
    "cooling.humidity": p.humidity,
    "thermal.mass": p.mass,
    "thermal.split": p.split,
    "sensor.torque.offset": i.shift("sensor.torque.offset", "torque", lambda shown, plan: 1.0, {}),
    "sensor.torque.gain": i.gain("sensor.torque.gain", "torque", 0.0, 0.03),
    "sensor.torque.drift": i.drift,
    "sensor.torque.step": i.since("sensor.torque.step", "torque"),
    "sensor.torque.by_direction": i.by_direction("sensor.torque.by_direction", "torque"),
    "sensor.torque.random_walk": i.walk("sensor.torque.random_walk", "torque"),
    "sensor.oil_temp.offset": i.shift("sensor.oil_temp.offset", "oil_temp", lambda shown, plan: 1.0, {}),
    "sensor.oil_temp.gain": i.gain("sensor.oil_temp.gain", "oil_temp", 20.0, 0.25),
    "sensor.oil_temp.position": i.position,
    "sensor.oil_temp.since": i.since("sensor.oil_temp.since", "oil_temp"),
    "sensor.oil_temp.by_direction": i.by_direction("sensor.oil_temp.by_direction", "oil_temp"),
    "sensor.oil_temp.random_walk": i.walk("sensor.oil_temp.random_walk", "oil_temp"),
    "sensor.wall_temp.offset": i.shift("sensor.wall_temp.offset", "wall_temp", lambda shown, plan: 1.0, {}),
    "sensor.wall_temp.since": i.since("sensor.wall_temp.since", "wall_temp"),
    "sensor.wall_temp.by_direction": i.by_direction("sensor.wall_temp.by_direction", "wall_temp"),
    "sensor.ambient.bias": i.shift("sensor.ambient.bias", "ambient", lambda shown, plan: 1.0, {}),
    "sensor.ambient.heated": i.heated,
    "sensor.ambient.since": i.since("sensor.ambient.since", "ambient"),
    "sensor.speed.gain": i.gain("sensor.speed.gain", "speed", 0.0, 0.15),
    "procedure.not_stationary": i.not_stationary,
    "procedure.order": i.order,
    "procedure.day_scatter": i.day_scatter,
}

OUTSIDE: Mapping[str, Family] = {
    "outside.crosstalk": i.crosstalk,
    "outside.thermal_zero": i.thermal_zero,
    "outside.leak": i.leak,
    "outside.rub": i.rub,
    "outside.weather": i.weather,
    "outside.gelling": i.gelling,
}

#: What may limit a cause: quantities on one side of a threshold.
REGIMES: Mapping[str, tuple[str, ...]] = {
    "losses.churning": ("speed above", "oil below"),
    "losses.mesh_friction": ("load above", "speed below", "oil above"),
    "losses.seal_drag": ("speed below", "order above", "oil above"),
    "losses.bearing_preload": ("load above", "oil above", "order above"),
    "heat.external_source": ("speed above", "order above"),
    "cooling.air": ("oil above", "order above"),
    "cooling.foundation": ("order above",),
    "cooling.contact": ("oil above", "order above"),
    "sensor.oil_temp.offset": ("oil above", "speed above"),
    "sensor.torque.offset": ("load above", "speed above"),
}


def limited(fault: Fault, rng: np.random.Generator, around: Around) -> Fault:
    """The fault on one side of a threshold only, with a soft border."""
    what, side = str(rng.choice(list(REGIMES[fault.cause]))).split()
    q = rng.uniform(0.3, 0.7)
    spans = {"speed": around.n, "load": around.load, "oil": around.oil, "order": np.linspace(0.0, 1.0, around.tests)}
    at = float(np.quantile(spans[what], q))
    width = {"speed": 6.0, "load": 60.0, "oil": 2.0, "order": 0.01}[what]
    sign = 1.0 if side == "above" else -1.0

    def gate(value: np.ndarray) -> np.ndarray:
        return np.asarray(1.0 / (1.0 + np.exp(np.clip(-sign * (value - at) / width, -60.0, 60.0))))

    def of_now(stage: Stage) -> Stage:
        def act(now: Now, a: np.ndarray) -> None:
            seen = {"speed": now.n, "load": now.load, "oil": now.temperature("oil"), "order": now.progress}[what]
            stage(now, a * gate(seen))

        return act

    def of_readings(stage: Stage) -> Stage:
        def act(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
            progress = np.broadcast_to(plan.progress, shown[0].shape)
            seen = {"speed": shown[0], "load": shown[1], "oil": shown[3], "order": progress}[what]
            stage(shown, plan, a * gate(seen))

        return act

    stages = {name: (of_readings if name == "read" else of_now)(stage) for name, stage in fault.stages.items()}
    # the gate is a tanh of twice its width
    return replace(fault, stages=stages, regime={"where": f"{what} {side}", "at": at, "width": 2 * width})


def names(kind: str) -> Iterable[str]:
    """Causes that a kind of case may hide."""
    return {"regime": REGIMES, "outside": OUTSIDE}.get(kind, CAUSES)
