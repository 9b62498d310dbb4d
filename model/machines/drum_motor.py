"""The drum motor: an electric motor and a harmonic drive inside the drum that drives a conveyor belt.

The motor's shaft turns the wave generator; the flexspline is held by the fixed axle, the circular spline turns with the
drum's shell. Heat: what the motor loses goes to its windings and stator, what gear and wave generator lose to the gear,
churning to the oil; the oil carries all of it to the shell, which turns in the air and touches the belt.
"""

from __future__ import annotations

from collections.abc import Mapping

#: Part name -> type, in the order to show them.
PARTS: Mapping[str, str] = {
    "motor_shaft": "ShaftEnd",
    "drum": "ShaftEnd",
    "axle": "FixedFlange",
    "motor": "Motor",
    "mesh": "HarmonicMesh",
    "wave_bearing": "DeepGrooveBallBearing",
    "belt_pull": "BeltPull",
    "drum_bearing": "DeepGrooveBallBearing",
    "drum_seal": "LipSeal",
    "churning": "DrumChurning",
    "rotor": "Inertia",
    "oil": "DrumOil",
    "windings": "HeatCapacity",
    "stator": "HeatCapacity",
    "gear": "HeatCapacity",
    "shell": "HeatCapacity",
    "windings_stator": "ThermalConductor",
    "windings_oil": "ThermalConductor",
    "stator_oil": "ThermalConductor",
    "gear_oil": "ThermalConductor",
    "oil_shell": "WettedWall",
    "cooling": "DrumCooling",
    "belt": "BeltContact",
    "room": "Room",
    "efficiency": "Efficiency",
}

#: The groups of ports that meet.
CONNECTIONS: tuple[tuple[str, ...], ...] = (
    # shafts
    ("motor_shaft.flange", "rotor.flange", "churning.shaft", "mesh.wave_generator"),
    ("mesh.wave", "wave_bearing.shaft"),
    ("mesh.flexspline", "axle.flange"),
    ("mesh.circular_spline", "drum_bearing.shaft", "drum_seal.shaft", "cooling.shaft", "drum.flange"),
    # what the bearings carry, what is read, and how full the drum is
    ("mesh.wave_load", "wave_bearing.load"),
    ("motor_shaft.reading", "motor.shaft", "efficiency.a"),
    ("drum.reading", "belt_pull.reading", "efficiency.b"),
    ("belt_pull.load", "drum_bearing.load"),
    ("oil.level", "churning.level", "oil_shell.level"),
    # the oil lubricates all
    ("oil.lubricant", "mesh.lubricant", "wave_bearing.lubricant", "drum_bearing.lubricant", "churning.lubricant"),
    # heat
    ("windings.heat", "motor.windings", "windings_stator.a", "windings_oil.a"),
    ("stator.heat", "motor.stator", "windings_stator.b", "stator_oil.a"),
    ("gear.heat", "mesh.flexspline_teeth", "mesh.circular_spline_teeth")
    + ("wave_bearing.inner", "wave_bearing.outer", "gear_oil.a"),
    ("oil.heat", "churning.inner", "churning.outer", "windings_oil.b", "stator_oil.b", "gear_oil.b", "oil_shell.a"),
    ("shell.heat", "oil_shell.b", "cooling.surface", "belt.a")
    + ("drum_bearing.inner", "drum_bearing.outer", "drum_seal.inner", "drum_seal.outer"),
    ("room.air", "cooling.air"),
    ("room.floor", "belt.b"),
)
