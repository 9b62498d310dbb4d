"""Values with units, as users write them, to SI numbers and back. Temperatures and differences are different kinds."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from .errors import ScenarioError

if TYPE_CHECKING:
    import numpy as np

#: A number, or an array of numbers.
N = TypeVar("N", float, "np.ndarray[Any, Any]")

#: Unit shown to a person for an SI unit of the model, with pint's name for it.
DISPLAY = {"K": "degC", "rad/s": "rpm"}
#: The SI unit of each of them.
SHOWN = {unit: si for si, unit in DISPLAY.items()}

#: Spellings met in practice -> the one that is used here.
SPELLINGS = {
    **dict.fromkeys(("Nm", "N*m", "N m", "N·m"), "N.m"),
    **dict.fromkeys(("kNm", "kN*m", "kN m", "kN·m"), "kN.m"),
    **dict.fromkeys(("C", "°C", "º C", "ºC", "℃", "° C", "deg C", "Celsius", "celsius", "deg_C"), "degC"),
    **dict.fromkeys(("F", "°F", "ºF", "℉", "deg F", "Fahrenheit"), "degF"),
    **dict.fromkeys(("U/min", "r/min", "RPM", "Rpm", "rev/min", "Umdr/min"), "rpm"),
    **dict.fromkeys(("lb ft", "lb-ft", "lb.ft", "lbft", "ft lb", "ft-lb", "ft.lb", "lbf ft", "lbf.ft"), "lbf*ft"),
    "PS": "metric_horsepower",
    "%": "percent",
    "-": "1",
}
#: The same of rotational speeds alone, as they are written in minutes; of other things these are rates.
PER_MINUTE = dict.fromkeys(("1/min", "min-1", "min^-1", "min⁻¹", "/min"), "rpm")
#: A frequency of rotation counts revolutions.
ROTATIONS = dict.fromkeys(("Hz", "rev/s", "r/s", "U/s", "rps"), "revolution/s")


#: Units in which a person may have meant a bare number of what the model has in SI.
USUAL = {"W": ("kW", "W"), "m": ("mm", "m"), "m3": ("l",)}
#: SI units whose values must say whether they hold an angle; of others, as N.m.s, either form is usual.
ANGULAR = ("rad/s", "rad", "1", "N.m")
#: A comma between digits.
_COMMA = re.compile(r"\d,\d")
#: A decimal point.
_POINT = re.compile(r"\.\d")
#: Commas that may stand between thousands.
_THOUSANDS = re.compile(r"(?<![\d.])[1-9]\d{0,2}(,\d{3})+(?![\d,])")
#: A point between thousands, where a comma is that of the decimals.
_GROUPED = re.compile(r"(?<=\d)\.(?=\d{3}(?!\d))")
#: A digit that is not zero.
_DIGIT = re.compile(r"[1-9]")
#: Longest unit [characters].
LONGEST = 80
#: Powers of powers and exponents of three digits, which no unit has and whose values take for ever.
_TOWER = re.compile(r"(\*\*|\^)[\s(+\-\d.]*(\*\*|\^)|(\*\*|\^)[\s(+\-]*\d{3}")


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def spell_unit(unit: str, *, turns: bool = True) -> str:
    """A unit as the rest of the program writes it: "Nm" is "N.m", and "1/min" is "rpm".

    Args:
        unit: as a user writes it
        turns: whether "1/min" may be a rotational speed
    """
    text = " ".join(unit.split())
    return PER_MINUTE.get(text, SPELLINGS.get(text, text)) if turns else SPELLINGS.get(text, text)


def _pint_unit(unit: str) -> str:
    """The model's spelling of a unit in pint's: a dot between letters multiplies, a digit behind one is a power."""
    if len(unit) > LONGEST or _TOWER.search(unit):
        raise ValueError(unit)
    text = re.sub(r"(?<!\d)\.|\.(?!\d)", "*", spell_unit(unit, turns=False).replace("·", "*").replace("^", "**"))
    return "" if text == "1" else re.sub(r"([a-zA-Z])(-?\d)", r"\1**\2", text)


@functools.cache
def _fitting(written: str, target: str, difference: bool = False) -> Any:
    """Pint's unit for what a user writes, judged by what it is: a unit of a speed carries a revolution or a radian.

    Args:
        written: as a user writes it
        target: SI unit of the model that it must fit
        difference: whether it is that of a difference, as of temperatures

    Raises:
        ScenarioError: there is no such unit, or it is of another kind
    """
    ureg = _registry()
    text = ROTATIONS.get(written, spell_unit(written)) if target == "rad/s" else written
    try:
        unit = ureg.Unit(_pint_unit(text))
        if difference and str(unit) in ("degree_Celsius", "degree_Fahrenheit"):
            unit = ureg.Unit("delta_" + str(unit))
        ureg.Quantity(0.0, unit).to(_pint_unit(target))
        turns = target not in ANGULAR or ureg.get_root_units(unit)[1] == ureg.get_root_units(_pint_unit(target))[1]
        energy = target == "N.m" and any(ureg.Unit(name).is_compatible_with("J") for name in unit._units)
    except Exception:  # the parser of units fails on odd text in many ways, and all mean the same to the user
        of = f"{target} (difference)" if difference else target
        raise ScenarioError(
            f'unit "{written}" does not fit {show_unit(of)}. Write for example "{example(of)}".'
        ) from None
    if energy or (not turns and target != "rad/s"):
        kind = "an energy" if energy else "of an angle or a number"
        raise ScenarioError(f'"{written}" is {kind}, and does not fit {show_unit(target)}. Write "{example(target)}".')
    if not turns:
        raise ScenarioError(
            f'"{written}" may mean revolutions or radians. Write rpm, Hz (revolutions per second) or rad/s.'
        )
    return unit


def split_quantity(text: str) -> tuple[float, str]:
    """'62 mm' -> (62.0, 'mm'). Raises ValueError where there is no number."""
    stripped = text.strip().replace("\N{MINUS SIGN}", "-")  # as documents have it
    head, _, tail = stripped.partition(" ")
    try:
        return parse_number(head), tail.strip()
    except ValueError:
        for i in range(len(stripped), 0, -1):
            try:
                return parse_number(stripped[:i]), stripped[i:].strip()
            except ValueError:
                continue
        raise ValueError(f"{text!r} is no number with a unit") from None


def parse_number(text: str) -> float:
    """A number as it is written, also nan and inf. Raises ValueError where it is none, or too small to be held."""
    number = float(text)
    if "_" in text or (number == 0.0 and _DIGIT.search(text.lower().partition("e")[0])):
        raise ValueError(text)
    return number


def refuse_comma(text: str, name: str) -> None:
    """Refuse a number with a decimal comma.

    Args:
        text: as it is written
        name: what to call it in a message

    Raises:
        ScenarioError: a comma between digits, with the number as it should be written
    """
    if _COMMA.search(text):
        ways = [text.replace(",", "")] if _THOUSANDS.search(text) else []
        decimal = text.count(",") == 1 and not _POINT.search(text, text.index(","))
        ways += [_GROUPED.sub("", text).replace(",", ".")] if decimal else []
        written = " or ".join(f'"{way}"' for way in ways)
        kind = "decimal comma" + ", or one between thousands" * (len(ways) > 1)
        raise ScenarioError(
            f'{name} = "{text}" has a {kind}. Write {written or "one number"}: a point, and nothing between thousands.'
        )


def _without_unit(name: str, value: object, written: str, unit: str, usual: Sequence[str]) -> str:
    """What is said of a number without a unit: how it may have been meant."""
    target = unit.removesuffix("(difference)").strip()
    ways = " or ".join(f'"{value} {one}"' for one in usual or USUAL.get(target, (show_unit(unit),)))
    return f"{name} = {written} has no unit. Write {ways} (expected a unit like {target})."


def to_si(value: object, unit: str, *, name: str = "value", usual: Sequence[str] = ()) -> float:
    """A value with its unit as a number in the SI unit `unit` of the model.

    Args:
        value: text such as "62 mm" or "60 degC"; a bare number only where `unit` is "1"
        unit: the model's SI unit: "m", "K", "rad/s", "1", "K (difference)", ...
        name: what to call it in a message
        usual: units to advise where it has none, that which is likeliest first; those of `USUAL` if empty

    Raises:
        ScenarioError: no number, no unit, or a unit of another kind
    """
    difference = unit.endswith("(difference)")
    target = unit.removesuffix("(difference)").strip()
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ScenarioError(f'{name} = {value!r} is no value. Write a number with its unit, like "{example(unit)}".')
    if isinstance(value, int | float):
        if target != "1":
            raise ScenarioError(_without_unit(name, value, str(value), unit, usual))
        return _finite(float(value), name, value)
    refuse_comma(value, name)
    try:
        number, written = split_quantity(value)
    except ValueError:
        raise ScenarioError(
            f'{name} = "{value}" is no number with a unit. Write for example "{example(unit)}".'
        ) from None
    if not written and target != "1":
        raise ScenarioError(_without_unit(name, value, f'"{value}"', unit, usual))
    if written == target:
        return _finite(number, name, value)
    try:
        source = _fitting(written, target, difference)
    except ScenarioError as error:
        raise ScenarioError(f'{name} = "{value}": {error}') from None
    return _finite(float(_registry().Quantity(number, source).to(_pint_unit(target)).magnitude), name, value)


def _magnitude(unit: str) -> Any:
    """One of a unit; "W at 250 rpm" is the torque or conductance that takes one watt there."""
    what, _, at = unit.partition(" at ")
    one = _registry().Quantity(1.0, _pint_unit(what))
    if not at:
        return one
    number, of = split_quantity(at)
    return one / _registry().Quantity(number, _pint_unit(of))


@functools.cache
def kind_of(unit: str) -> str:
    """What a unit measures: the same for "kW" and "N.mm/s", and for "degC" and "K (difference)".

    Args:
        unit: as users write it, also "W at 250 rpm"

    Raises:
        ScenarioError: there is no such unit
    """
    try:
        return str(_magnitude(unit.removesuffix("(difference)").strip()).dimensionality)
    except Exception:  # the parser of units fails on odd text in many ways
        raise ScenarioError(f'there is no unit "{unit}". Write for example "N.m", "degC" or "mPa.s".') from None


def in_unit(number: N, unit: str, si: str = "") -> N:
    """An SI number in a unit of its kind, or an array of them.

    Args:
        number: in SI
        unit: as users write it, such as "degC", "kW" or "W at 250 rpm"
        si: SI unit of the number, where it is known: the other one must fit it

    Raises:
        ScenarioError: there is no such unit, or it does not fit
    """
    if si:
        found: N = _registry().Quantity(number, _pint_unit(si)).to(_fitting(unit, si)).magnitude
        return found
    kind_of(unit)
    base = _magnitude(unit).to_base_units()
    if " at " in unit:
        return number / float(base.magnitude)
    found = _registry().Quantity(number, base.units).to(_pint_unit(unit)).magnitude
    return found


def si_of(value: float | str) -> float:
    """A number as it is, text with a unit in SI, whatever its kind.

    Args:
        value: such as 0.05 or "62 mm"

    Raises:
        ScenarioError: there is no such unit
    """
    if not isinstance(value, str):
        return value
    try:
        number, unit = split_quantity(value)
    except ValueError:
        raise ScenarioError(f'"{value}" is no number with a unit. Write for example "62 mm".') from None
    kind_of(unit)
    return float(_registry().Quantity(number, _pint_unit(unit)).to_base_units().magnitude)


def _finite(number: float, name: str, value: object) -> float:
    if not math.isfinite(number):
        raise ScenarioError(f"{name} = {value!r} is not finite. Write a finite number.")
    return number


def show_unit(unit: str) -> str:
    """The unit in which a quantity of the SI unit `unit` is shown to a person."""
    return "K" if unit.endswith("(difference)") else DISPLAY.get(unit, unit)


def from_si(number: N, unit: str) -> N:
    """An SI number in the unit it is shown in: K -> degC, rad/s -> rpm, else unchanged.

    Args:
        number: a value in SI, or an array of them
        unit: its SI unit, such as "K"
    """
    if unit == "K":
        return number - 273.15
    if unit == "rad/s":
        return number * 30 / math.pi
    return number


def text(number: float, unit: str, digits: int = 6) -> str:
    """A number with the unit it is shown in.

    Args:
        number: a value in SI
        unit: its SI unit, such as "K"
        digits: significant digits to write
    """
    written = f"{from_si(number, unit):.{digits}g}"
    return written if unit == "1" else f"{written} {show_unit(unit)}"


def example(unit: str) -> str:
    """A value a user could write for a unit."""
    typical = {"K": "60 degC", "rad/s": "1450 rpm", "N.m": "40 N.m", "W": "7.5 kW", "1": "0.5"}
    typical |= {"m": "62 mm", "m2": "0.8 m2", "m3": "20 l"}
    return typical.get(unit, f"1 {show_unit(unit)}")
