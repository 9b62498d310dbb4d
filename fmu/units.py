"""Unit definitions of an FMU: base units of SI and the unit shown to a person."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ..model import units as model_units
from ..model.core.flat import Quantity
from .fixed import tables


@dataclass(frozen=True)
class Display:
    """A unit in which values from a size on are shown: shown value = factor * value + offset."""

    name: str
    factor: float
    offset: float = 0.0
    least: float = 0.0


#: What is measured in a unit, for the types of an FMU; of some units several things are.
QUANTITIES: Mapping[str, str] = tables("units")["quantities"]


@dataclass(frozen=True)
class Unit:
    """A unit with its base exponents (None when it is not understood) and the units that it is shown in."""

    name: str
    factor: float
    exponents: Mapping[str, int] | None
    shown: tuple[Display, ...]

    @property
    def base(self) -> dict[str, float]:
        """Exponents, and the factor where it is not 1, as attributes of XML."""
        return {**(self.exponents or {}), **({} if self.factor == 1 else {"factor": self.factor})}

    def display(self, size: float) -> Display | None:
        """How a value of a typical size is shown; None where the unit itself serves."""
        return next((d for d in reversed(self.shown) if size >= d.least), None)


def fmi_unit(unit: str) -> str:
    """The unit attribute of a variable: the model's unit without the mark of a difference."""
    return unit.removesuffix("(difference)").strip()


def units_of(quantities: Iterable[Quantity], *also: str) -> list[Unit]:
    """The units of quantities in the order of their names, and others."""
    return [unit(name) for name in sorted({fmi_unit(u) for u in (*also, *(q.unit for q in quantities))})]


def is_difference(unit: str) -> bool:
    """Whether a quantity in `unit` is a difference, which an offset of the shown unit must not touch."""
    return unit.endswith("(difference)")


def unit(name: str) -> Unit:
    """Definition of a unit the model writes, like "W/(m2.K)"."""
    factor, exponents = _parse(name)
    if (shown := tables("units")["shown"].get(name)) is not None:
        return Unit(name, factor, exponents, tuple(Display(**one) for one in shown))
    zero = model_units.from_si(0.0, name)
    slope = model_units.from_si(1.0, name) - zero
    words = model_units.show_unit(name)
    own = () if words == name else (Display(words, float(f"{slope:.15g}"), zero),)
    return Unit(name, factor, exponents, own)


def _parse(name: str) -> tuple[float, Mapping[str, int] | None]:
    """Factor and base exponents: products by '.', powers as digits behind a symbol, one '/' before the divisor."""
    named, factor, total = tables("units")["named"], 1.0, dict[str, int]()
    for sign, side in zip((1, -1), name.split("/"), strict=False):
        for term in side.strip("()").split("."):
            match = re.fullmatch(r"([a-zA-Z]+|1)(-?\d+)?", term)
            if match is None or match[1] not in named or name.count("/") > 1:
                return 1.0, None
            power = sign * int(match[2] or 1)
            exponents = dict(named[match[1]])
            factor *= exponents.pop("factor", 1.0) ** power
            for base, e in exponents.items():
                total[base] = total.get(base, 0) + e * power
    return factor, MappingProxyType({b: e for b, e in sorted(total.items()) if e})
