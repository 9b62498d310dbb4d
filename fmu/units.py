"""Unit definitions of an FMU: base units of SI and the unit shown to a person."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ..model import units as model_units

#: Exponents of the SI base units, and the factor to them, of each unit the model writes.
_NAMED: dict[str, tuple[float, dict[str, int]]] = {
    "1": (1.0, {}),
    "kg": (1.0, {"kg": 1}),
    "m": (1.0, {"m": 1}),
    "s": (1.0, {"s": 1}),
    "A": (1.0, {"A": 1}),
    "K": (1.0, {"K": 1}),
    "mol": (1.0, {"mol": 1}),
    "cd": (1.0, {"cd": 1}),
    "rad": (1.0, {"rad": 1}),
    "Hz": (1.0, {"s": -1}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "Pa": (1.0, {"kg": 1, "m": -1, "s": -2}),
    "J": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, {"kg": 1, "m": 2, "s": -3}),
    "C": (1.0, {"s": 1, "A": 1}),
    "V": (1.0, {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "ohm": (1.0, {"kg": 1, "m": 2, "s": -3, "A": -2}),
    "F": (1.0, {"kg": -1, "m": -2, "s": 4, "A": 2}),
    "H": (1.0, {"kg": 1, "m": 2, "s": -2, "A": -2}),
    "mm": (1e-3, {"m": 1}),
    "min": (60.0, {"s": 1}),
    "h": (3600.0, {"s": 1}),
}


@dataclass(frozen=True)
class Display:
    """A unit in which values from a size on are shown: shown value = factor * value + offset."""

    name: str
    factor: float
    offset: float = 0.0
    least: float = 0.0


#: Units in which values are shown, by SI unit, small ones first; the others are shown as the program shows them.
SHOWN: Mapping[str, tuple[Display, ...]] = {
    "m": (Display("um", 1e6), Display("mm", 1e3, least=1e-4)),
    "m2/s": (Display("mm2/s", 1e6),),
    "m3": (Display("l", 1e3),),
    "rad": (Display("deg", 57.29577951308232),),
    "Pa": (Display("MPa", 1e-6), Display("GPa", 1e-9, least=1e9)),
    "J": (Display("kJ", 1e-3),),
    "W": (Display("kW", 1e-3, least=1e3),),
}


#: What is measured in a unit, for the types of an FMU; of some units several things are.
QUANTITIES: Mapping[str, str] = {
    "K": "ThermodynamicTemperature",
    "K (difference)": "TemperatureDifference",
    "W": "Power",
    "J": "Energy",
    "J/K": "HeatCapacity",
    "J/(kg.K)": "SpecificHeatCapacity",
    "W/m2": "Irradiance",
    "W/K": "ThermalConductance",
    "W/(m.K)": "ThermalConductivity",
    "W/(m2.K)": "CoefficientOfHeatTransfer",
    "rad/s": "AngularVelocity",
    "rad": "Angle",
    "N.m": "Torque",
    "N": "Force",
    "N.m.s/rad": "RotationalDampingConstant",
    "kg.m2": "MomentOfInertia",
    "kg": "Mass",
    "kg/m3": "Density",
    "m": "Length",
    "m2": "Area",
    "m3": "Volume",
    "m/s": "Velocity",
    "m2/s": "KinematicViscosity",
    "Pa": "Pressure",
    "Pa.s": "DynamicViscosity",
    "s": "Time",
}


@dataclass(frozen=True)
class Unit:
    """A unit with its base exponents (None when it is not understood) and the units that it is shown in."""

    name: str
    factor: float
    exponents: Mapping[str, int] | None
    shown: tuple[Display, ...]

    def display(self, size: float) -> Display | None:
        """How a value of a typical size is shown; None where the unit itself serves."""
        return next((d for d in reversed(self.shown) if size >= d.least), None)


def fmi_unit(unit: str) -> str:
    """The unit attribute of a variable: the model's unit without the mark of a difference."""
    return unit.removesuffix("(difference)").strip()


def is_difference(unit: str) -> bool:
    """Whether a quantity in `unit` is a difference, which an offset of the shown unit must not touch."""
    return unit.endswith("(difference)")


def unit(name: str) -> Unit:
    """Definition of a unit the model writes, like "W/(m2.K)"."""
    factor, exponents = _parse(name)
    if name in SHOWN:
        return Unit(name, factor, exponents, SHOWN[name])
    zero = model_units.from_si(0.0, name)
    slope = model_units.from_si(1.0, name) - zero
    words = model_units.shown(name)
    own = () if words == name else (Display(words, float(f"{slope:.15g}"), zero),)
    return Unit(name, factor, exponents, own)


def _parse(name: str) -> tuple[float, Mapping[str, int] | None]:
    """Factor and base exponents: products by '.', powers as digits behind a symbol, one '/' before the divisor."""
    factor, total = 1.0, dict[str, int]()
    for sign, side in zip((1, -1), name.split("/"), strict=False):
        for term in side.strip("()").split("."):
            match = re.fullmatch(r"([a-zA-Z]+|1)(-?\d+)?", term)
            if match is None or match[1] not in _NAMED or name.count("/") > 1:
                return 1.0, None
            power = sign * int(match[2] or 1)
            scale, exponents = _NAMED[match[1]]
            factor *= scale**power
            for base, e in exponents.items():
                total[base] = total.get(base, 0) + e * power
    return factor, MappingProxyType({b: e for b, e in sorted(total.items()) if e})
