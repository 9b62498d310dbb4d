"""Every cause the bench can hide, by identifier; which count as one answer; which can be limited to a regime."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from . import hidden_cooling as cooling
from . import hidden_instruments as instruments
from . import hidden_losses as losses
from . import outside
from .hidden import Family

#: Identifier of the taxonomy -> the family that draws a form of it.
CAUSES: Mapping[str, Family] = {
    "losses.churning": losses.churning,
    "losses.oil_viscosity": losses.oil_viscosity,
    "losses.oil_level": losses.oil_level,
    "losses.bearing_preload": losses.bearing_preload,
    "losses.seal_drag": losses.seal_drag,
    "losses.mesh_friction": losses.mesh_friction,
    "losses.mesh_direction": losses.mesh_direction,
    "losses.film_starvation": losses.film_starvation,
    "losses.windage": losses.windage,
    "heat.external_source": losses.external_source,
    "cooling.air": cooling.air,
    "cooling.emissivity": cooling.emissivity,
    "cooling.foundation": cooling.foundation,
    "cooling.contact": cooling.contact,
    "cooling.oil_wall": cooling.oil_wall,
    "cooling.humidity": cooling.humidity,
    "thermal.mass": cooling.mass,
    "thermal.split": cooling.split,
    "sensor.torque.offset": instruments.torque_offset,
    "sensor.torque.gain": instruments.torque_gain,
    "sensor.torque.drift": instruments.torque_drift,
    "sensor.torque.step": instruments.torque_step,
    "sensor.oil_temp.offset": instruments.oil_offset,
    "sensor.oil_temp.gain": instruments.oil_gain,
    "sensor.oil_temp.position": instruments.oil_position,
    "sensor.wall_temp.offset": instruments.wall_offset,
    "sensor.ambient.bias": instruments.ambient_bias,
    "sensor.ambient.heated": instruments.ambient_heated,
    "sensor.speed.gain": instruments.speed_gain,
    "procedure.not_stationary": instruments.not_stationary,
    "procedure.order": instruments.order,
    "procedure.day_scatter": instruments.day_scatter,
}

#: What the taxonomy cannot name.
OUTSIDE: Mapping[str, Family] = {
    f"outside.{family.__name__}": family
    for family in (
        outside.swinging_seal,
        outside.thermostat_fan,
        outside.growing_bridge,
        outside.torque_hysteresis,
        outside.resonance,
        outside.crosstalk,
        outside.misalignment,
        outside.lazy_sensor,
    )
}

#: Causes that count as one answer.
CLASSES: tuple[frozenset[str], ...] = (
    frozenset({"losses.bearing_preload", "losses.seal_drag"}),
    frozenset({"losses.churning", "losses.windage", "losses.oil_level"}),
    frozenset({"cooling.humidity", "procedure.day_scatter"}),
)

#: Causes that may act in a part of the conditions only -> what may limit them.
REGIMES: Mapping[str, tuple[str, ...]] = {
    "losses.churning": ("speed", "temperature"),
    "losses.windage": ("speed",),
    "losses.mesh_friction": ("speed", "load", "temperature"),
    "losses.seal_drag": ("speed", "temperature", "direction"),
    "losses.bearing_preload": ("load", "temperature", "direction"),
    "heat.external_source": ("speed", "load", "direction"),
    "cooling.air": ("temperature", "direction"),
}


def merged(cause: str) -> str:
    """The name a cause counts under: the class it belongs to, or itself."""
    for group in CLASSES:
        if cause in group:
            return "/".join(sorted(group))
    return cause


def merged_all(causes: Iterable[str]) -> frozenset[str]:
    """The names that several causes count under."""
    return frozenset(merged(c) for c in causes)
