"""The planetary gearbox: carrier and sun shafts, ring held by the housing.

One layout, parts and nets; the rig file supplies the values. Carrier side: two tapered roller bearings, a lip seal and
the oil-moving carrier. Inside: the planetary set with its needle bearings. Sun side: a deep groove ball bearing, a lip
seal and the rotating mass. Heat: losses of the teeth and needles go to the gears, those of bearings and seals half to
the carrier body and half to the housing wall, churning to the oil.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..errors import ScenarioError, suggestion
from .spec import PartSpec, Spec

#: Part name -> type, in the order to show them.
PARTS: Mapping[str, str] = {
    "carrier": "ShaftEnd",
    "sun": "ShaftEnd",
    "ring_mount": "FixedFlange",
    "gear_set": "PlanetarySet",
    "carrier_bearing": "TaperedRollerBearing",
    "sun_bearing": "DeepGrooveBallBearing",
    "planet_bearing": "NeedleBearing",
    "carrier_seal": "LipSeal",
    "sun_seal": "LipSeal",
    "churning": "Churning",
    "rotor": "Inertia",
    "oil": "OilBath",
    "grease": "Grease",
    "gears": "HeatCapacity",
    "carrier_body": "HeatCapacity",
    "wall": "HeatCapacity",
    "surface": "HeatCapacity",
    "oil_gears": "ThermalConductor",
    "oil_carrier_body": "ThermalConductor",
    "oil_wall": "ThermalConductor",
    "carrier_body_wall": "ThermalConductor",
    "wall_surface": "ThermalConductor",
    "cooling": "CylinderCooling",
    "foot": "ThermalConductor",
    "room": "Room",
    "efficiency": "Efficiency",
}

#: The groups of ports that meet.
CONNECTIONS: tuple[tuple[str, ...], ...] = (
    # shafts
    ("carrier.flange", "carrier_bearing.shaft", "carrier_seal.shaft", "churning.shaft", "gear_set.carrier"),
    ("gear_set.sun", "sun_bearing.shaft", "sun_seal.shaft", "rotor.flange", "sun.flange"),
    ("gear_set.planet", "planet_bearing.shaft"),
    ("gear_set.ring", "ring_mount.flange"),
    # what the bearings carry, and what is read
    ("gear_set.carrier_load", "carrier_bearing.load"),
    ("gear_set.sun_load", "sun_bearing.load"),
    ("gear_set.planet_load", "planet_bearing.load"),
    ("carrier.reading", "gear_set.reading", "efficiency.a"),
    ("sun.reading", "efficiency.b"),
    # lubrication: teeth and churning by the oil, bearings by their grease
    ("oil.lubricant", "gear_set.lubricant", "churning.lubricant"),
    ("grease.lubricant", "carrier_bearing.lubricant", "sun_bearing.lubricant", "planet_bearing.lubricant"),
    # heat
    ("oil.heat", "grease.heat", "churning.inner", "churning.outer")
    + ("oil_gears.a", "oil_carrier_body.a", "oil_wall.a"),
    ("gears.heat", "gear_set.gears", "planet_bearing.inner", "planet_bearing.outer", "oil_gears.b"),
    ("carrier_body.heat", "carrier_bearing.inner", "sun_bearing.inner", "carrier_seal.inner", "sun_seal.inner")
    + ("oil_carrier_body.b", "carrier_body_wall.a"),
    ("wall.heat", "carrier_bearing.outer", "sun_bearing.outer", "carrier_seal.outer", "sun_seal.outer")
    + ("oil_wall.b", "carrier_body_wall.b", "wall_surface.a"),
    ("surface.heat", "wall_surface.b", "cooling.surface", "foot.a"),
    ("room.air", "cooling.air"),
    ("room.floor", "foot.b"),
)


def planetary(name: str, doc: str, values: Mapping[str, Mapping[str, Any]]) -> Spec:
    """The planetary gearbox with values per part (SI numbers and choices).

    Args:
        name: of the machine
        doc: what it is, in a line
        values: part -> key -> SI number or choice

    Raises:
        ScenarioError: values for parts that the machine does not have
    """
    if unknown := [part for part in values if part not in PARTS]:
        raise ScenarioError([f'{name}: there is no part "{p}".{suggestion(p, PARTS)}' for p in unknown])
    parts = tuple(PartSpec(part, kind, values.get(part, {})) for part, kind in PARTS.items())
    return Spec(name, doc, parts, CONNECTIONS)
