"""The RV reducer: an involute first stage that drives cranks, a cycloid-pin second stage, pins held by the housing.

One layout, parts and nets; the rig file supplies the values. The sun and its wheels meet as the carrier sees them, so
that the gear pair and all bearings of the cranks turn against the carrier. Heat: losses of the meshes and of the
bearings of the cranks go to the discs and cranks, those of the main bearings and of the seals half to the carrier and
half to the housing. Grease takes the temperature of what it lubricates.
"""

from __future__ import annotations

from collections.abc import Mapping

#: Part name -> type, in the order to show them.
PARTS: Mapping[str, str] = {
    "input": "ShaftEnd",
    "output": "ShaftEnd",
    "housing_mount": "FixedFlange",
    "frame": "TurningFrame",
    "stage_1": "HelicalGearPair",
    "mesh": "CycloidPinStage",
    "eccentric_bearing": "NeedleBearing",
    "crank_bearing": "TaperedRollerBearing",
    "main_bearing": "TaperedRollerBearing",
    "input_seal": "LipSeal",
    "output_seal": "LipSeal",
    "churning": "Churning",
    "rotor": "Inertia",
    "grease": "Grease",
    "discs": "HeatCapacity",
    "carrier": "HeatCapacity",
    "housing": "HeatCapacity",
    "discs_housing": "ThermalConductor",
    "discs_carrier": "ThermalConductor",
    "carrier_housing": "ThermalConductor",
    "cooling": "CylinderCooling",
    "foot": "ThermalConductor",
    "room": "Room",
    "efficiency": "Efficiency",
}

#: The groups of ports that meet.
CONNECTIONS: tuple[tuple[str, ...], ...] = (
    # shafts
    ("input.flange", "input_seal.shaft", "rotor.flange", "frame.shaft"),
    ("frame.relative", "stage_1.pinion"),
    ("stage_1.wheel", "mesh.crank", "eccentric_bearing.shaft", "crank_bearing.shaft", "churning.shaft"),
    ("output.flange", "output_seal.shaft", "main_bearing.shaft", "mesh.carrier", "frame.carrier"),
    ("mesh.housing", "housing_mount.flange"),
    # what the bearings carry, and what is read
    ("mesh.eccentric_load", "eccentric_bearing.load"),
    ("mesh.crank_load", "crank_bearing.load"),
    ("mesh.main_load", "main_bearing.load"),
    ("input.reading", "efficiency.a"),
    ("output.reading", "mesh.reading", "efficiency.b"),
    # lubrication
    ("grease.lubricant", "stage_1.lubricant", "mesh.lubricant", "eccentric_bearing.lubricant")
    + ("crank_bearing.lubricant", "main_bearing.lubricant", "churning.lubricant"),
    # heat
    ("discs.heat", "grease.heat", "stage_1.gears", "mesh.discs", "churning.inner", "churning.outer")
    + ("eccentric_bearing.inner", "eccentric_bearing.outer", "crank_bearing.inner")
    + ("discs_housing.a", "discs_carrier.a"),
    ("carrier.heat", "crank_bearing.outer", "main_bearing.inner", "input_seal.inner", "output_seal.inner")
    + ("discs_carrier.b", "carrier_housing.a"),
    ("housing.heat", "main_bearing.outer", "input_seal.outer", "output_seal.outer")
    + ("discs_housing.b", "carrier_housing.b", "cooling.surface", "foot.a"),
    ("room.air", "cooling.air"),
    ("room.floor", "foot.b"),
)
