"""The cycloidal reducer: input shaft with the eccentric, discs on pins, output rollers, a round housing in a room.

One layout in two versions. In `PARTS` friction and cooling follow from the state of the moment; in `PRINTED_PARTS` they
are those of the source: one efficiency, and cooling proportional to the temperature difference. Heat: friction warms
discs and rollers, they warm the oil, the oil warms flat walls and cylinder of the housing, which cool in the room.
"""

from __future__ import annotations

from collections.abc import Mapping

#: Part name -> type, in the order to show them.
PARTS: Mapping[str, str] = {
    "input": "ShaftEnd",
    "output": "ShaftEnd",
    "reducer": "CycloidalReducer",
    "rotor": "Inertia",
    "oil": "OilBath",
    "internals": "HeatCapacity",
    "flat_inner": "HeatCapacity",
    "flat_outer": "HeatCapacity",
    "cylinder_inner": "HeatCapacity",
    "cylinder_outer": "HeatCapacity",
    "internals_oil": "ThermalConductor",
    "oil_housing": "OilToHousing",
    "housing": "RoundHousing",
    "flat_cooling": "FlatWallCooling",
    "cylinder_cooling": "ShellCooling",
    "foot": "ThermalConductor",
    "room": "Room",
    "efficiency": "Efficiency",
}

#: The same with friction and cooling as the source prints them; it has neither foot nor shafts.
PRINTED_PARTS: Mapping[str, str] = {
    **{name: kind for name, kind in PARTS.items() if name != "foot"},
    "reducer": "MalhotraReducer",
    "flat_cooling": "LinearFlatWallCooling",
    "cylinder_cooling": "LinearShellCooling",
}

#: The groups of ports that meet, but for lubrication and foot.
PRINTED_CONNECTIONS: tuple[tuple[str, ...], ...] = (
    # shafts, and what is read
    ("input.flange", "rotor.flange", "reducer.input"),
    ("reducer.output", "output.flange"),
    ("input.reading", "efficiency.a"),
    ("output.reading", "efficiency.b"),
    # sizes of the housing
    ("housing.flat_inside", "oil_housing.flat_inside"),
    ("housing.cylinder_inside", "oil_housing.cylinder_inside"),
    ("housing.flat_outside", "flat_cooling.size"),
    ("housing.cylinder_outside", "cylinder_cooling.size"),
    # heat
    ("internals.heat", "reducer.heat", "internals_oil.a"),
    ("oil.heat", "internals_oil.b", "oil_housing.oil"),
    ("flat_inner.heat", "oil_housing.flat", "housing.flat_inner"),
    ("flat_outer.heat", "housing.flat_outer", "flat_cooling.surface"),
    ("cylinder_inner.heat", "oil_housing.cylinder", "housing.cylinder_inner"),
    ("cylinder_outer.heat", "housing.cylinder_outer", "cylinder_cooling.surface"),
    ("room.air", "flat_cooling.air", "cylinder_cooling.air"),
)

#: The groups of ports that meet where the oil lubricates and the foot conducts.
CONNECTIONS = (
    *PRINTED_CONNECTIONS,
    ("oil.lubricant", "reducer.lubricant"),
    ("cylinder_outer.heat", "foot.a"),
    ("room.floor", "foot.b"),
)
