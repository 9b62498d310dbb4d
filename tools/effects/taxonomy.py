"""The causes in the order of the taxonomy, each from its own file."""

from __future__ import annotations

from importlib import import_module

from .cause import Cause

MODULES = (
    *("losses_churning", "losses_oil_viscosity", "losses_oil_level", "losses_bearing_preload", "losses_seal_drag"),
    *("losses_mesh_friction", "losses_mesh_direction", "losses_film_starvation", "losses_windage"),
    *("heat_external_source", "cooling_air", "cooling_emissivity", "cooling_foundation", "cooling_contact"),
    *("cooling_oil_wall", "cooling_humidity", "thermal_mass", "thermal_split"),
    *("sensor_torque_offset", "sensor_torque_gain", "sensor_torque_drift", "sensor_torque_step"),
    *("sensor_oil_temp_offset", "sensor_oil_temp_gain", "sensor_oil_temp_position", "sensor_wall_temp_offset"),
    *("sensor_ambient_bias", "sensor_ambient_heated", "sensor_speed_gain"),
    *("procedure_not_stationary", "procedure_order", "procedure_day_scatter"),
)

CAUSES: dict[str, Cause] = {c.id: c for c in (import_module(f"{__package__}.{name}").CAUSE for name in MODULES)}
