"""The harmonic drive: wave generator, flexspline with the output shaft, circular spline held by the housing.

One layout, parts and nets; the rig file supplies the values. Input side: a ball bearing and a lip seal on the wave
generator's shaft. Inside: the mesh, and the flexible bearing on which the flexspline is bent. Output side: a ball
bearing and a lip seal. Heat: losses of the teeth go to flexspline and circular spline, those of the flexible bearing to
wave generator and flexspline, those of the other bearings and the seals to the shafts and the housing, churning to the
oil.
"""

from __future__ import annotations

from collections.abc import Mapping

#: Part name -> type, in the order to show them.
PARTS: Mapping[str, str] = {
    "wave_generator": "ShaftEnd",
    "output": "ShaftEnd",
    "mount": "FixedFlange",
    "mesh": "HarmonicMesh",
    "wave_bearing": "DeepGrooveBallBearing",
    "input_bearing": "DeepGrooveBallBearing",
    "output_bearing": "DeepGrooveBallBearing",
    "input_seal": "LipSeal",
    "output_seal": "LipSeal",
    "churning": "Churning",
    "rotor": "Inertia",
    "oil": "OilBath",
    "wave_body": "HeatCapacity",
    "flexspline": "HeatCapacity",
    "circular_spline": "HeatCapacity",
    "housing": "HeatCapacity",
    "oil_wave": "ThermalConductor",
    "oil_flexspline": "ThermalConductor",
    "oil_circular": "ThermalConductor",
    "oil_housing": "ThermalConductor",
    "circular_housing": "ThermalConductor",
    "cooling": "CylinderCooling",
    "foot": "ThermalConductor",
    "room": "Room",
    "efficiency": "Efficiency",
}

#: The groups of ports that meet.
CONNECTIONS: tuple[tuple[str, ...], ...] = (
    # shafts
    ("wave_generator.flange", "input_bearing.shaft", "input_seal.shaft", "churning.shaft", "rotor.flange")
    + ("mesh.wave_generator",),
    ("mesh.wave", "wave_bearing.shaft"),
    ("mesh.flexspline", "output_bearing.shaft", "output_seal.shaft", "output.flange"),
    ("mesh.circular_spline", "mount.flange"),
    # what the bearings carry, and what is read
    ("mesh.wave_load", "wave_bearing.load"),
    ("mesh.shaft_load", "input_bearing.load", "output_bearing.load"),
    ("wave_generator.reading", "efficiency.a"),
    ("output.reading", "efficiency.b"),
    # lubrication
    ("oil.lubricant", "mesh.lubricant", "churning.lubricant")
    + ("wave_bearing.lubricant", "input_bearing.lubricant", "output_bearing.lubricant"),
    # heat
    ("oil.heat", "churning.inner", "churning.outer", "oil_wave.a", "oil_flexspline.a", "oil_circular.a")
    + ("oil_housing.a",),
    ("wave_body.heat", "wave_bearing.inner", "input_bearing.inner", "input_seal.inner", "oil_wave.b"),
    ("flexspline.heat", "mesh.flexspline_teeth", "wave_bearing.outer", "output_bearing.inner", "output_seal.inner")
    + ("oil_flexspline.b",),
    ("circular_spline.heat", "mesh.circular_spline_teeth", "oil_circular.b", "circular_housing.a"),
    ("housing.heat", "input_bearing.outer", "output_bearing.outer", "input_seal.outer", "output_seal.outer")
    + ("oil_housing.b", "circular_housing.b", "cooling.surface", "foot.a"),
    ("room.air", "cooling.air"),
    ("room.floor", "foot.b"),
)
