"""Causes in plain words."""

from __future__ import annotations

from collections.abc import Iterable

from ....model.core.faults import listed

#: Names of the taxonomy, but for faults of instruments.
NAMES = {
    "losses.churning": "churning of the oil",
    "losses.oil_viscosity": "viscosity of the oil",
    "losses.oil_level": "oil level",
    "losses.bearing_preload": "bearing preload",
    "losses.seal_drag": "seal drag",
    "losses.mesh_friction": "friction of the teeth",
    "losses.mesh_direction": "friction of the teeth in one direction",
    "losses.film_starvation": "teeth short of oil film",
    "losses.windage": "windage",
    "losses.torque_only": "a torque loss without heat",
    "heat.external_source": "heat from outside",
    "heat.parked": "heat while it stands",
    "cooling.air": "cooling by the air",
    "cooling.emissivity": "cooling by radiation",
    "cooling.foundation": "heat into the foundation",
    "cooling.contact": "thermal contact inside the housing wall",
    "cooling.oil_wall": "heat transfer from oil to wall",
    "cooling.humidity": "cooling that follows the humidity",
    "cooling.cooler": "oil cooler",
    "cooling.thermostat": "thermostat of the cooler",
    "cooling.fan": "fan of the cooler",
    "thermal.mass": "heat capacities",
    "thermal.split": "place where the heat appears",
    "procedure.not_stationary": "readings taken before they were steady",
    "procedure.order": "cooling that changes over the running order",
    "procedure.day_scatter": "scatter from day to day",
    "model.unexplained": "something outside the library",
}
#: Kinds of sensors.
KINDS = {
    "oil_temp": "oil thermometer",
    "wall_temp": "wall thermometer",
    "ambient": "room thermometer",
    "torque": "torque transducer",
    "speed": "speed sensor",
    "power": "power meter",
}
#: Faults of a sensor.
FAULTS = {
    "offset": "zero error of the {}",
    "bias": "zero error of the {}",
    "gain": "gain error of the {}",
    "drift": "drifting zero of the {}",
    "step": "zero of the {} that jumped",
    "position": "place of the {}",
    "heated": "{} warmed by the gearbox",
    "random_walk": "wandering zero of the {}",
    "lag": "lag of the {}",
    "frozen": "frozen {}",
    "spikes": "spikes of the {}",
    "swapped": "swapped leads of the {}",
    "by_direction": "error of the {} that depends on the direction",
    "since": "error of the {} from a test on",
    "mounting": "error of the {} that changes with each mounting",
}


def name_of(cause: str) -> str:
    """A cause in plain words; one of a user's library by the end of its identifier."""
    if cause in NAMES:
        return NAMES[cause]
    family, _, rest = cause.partition(".")
    kind, _, fault = rest.partition(".")
    if family == "sensor" and fault:
        return FAULTS.get(fault, f"{fault.replace('_', ' ')} of the {{}}").format(KINDS.get(kind, f"{kind} sensor"))
    return cause.rpartition(".")[2].replace("_", " ")


def names_of(causes: Iterable[str], last: str = "and", most: int = 100) -> str:
    """Causes in plain words with commas between and a word before the last one; the rest is counted beyond so many."""
    found = [name_of(c) for c in causes]
    more = [f"{len(found) - most} more"] if len(found) > most else []
    return listed([*found[:most], *more], last)


def sentence(text: str) -> str:
    """A text with a capital at its beginning."""
    return text[:1].upper() + text[1:]
