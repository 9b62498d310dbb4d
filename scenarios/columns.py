"""Names of columns as users write them: the unit that a name's ending or its brackets say, and conversion to SI."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from ..model.errors import ScenarioError
from ..model.units import spell_unit, to_si

#: What the ending of a column's name says about its unit.
ENDINGS: Mapping[str, str] = {
    "_rpm": "rpm",
    "_rad_s": "rad/s",
    "_kNm": "kN.m",
    "_Nm": "N.m",
    "_degC": "degC",
    "_C": "degC",
    "_K": "K",
    "_MW": "MW",
    "_kW": "kW",
    "_W": "W",
    "_min": "min",
    "_h": "h",
    "_s": "s",
    "_pct": "percent",
}

_BRACKET = re.compile(r"(.*\S)\s*[\[(]\s*([^\])]+?)\s*[\])]")


def split_unit(column: str) -> tuple[str, str]:
    """The name of a quantity and the unit that stand in a column's name: "T_oil_C" -> ("T_oil", "degC").

    Args:
        column: with a unit as its ending or in brackets ("M_ab [Nm]"); the unit is "" where there is none
    """
    if match := _BRACKET.fullmatch(column.strip()):
        return match[1], spell_unit(match[2])
    for ending, unit in ENDINGS.items():
        if column.endswith(ending) and len(column) > len(ending):
            return column.removesuffix(ending), unit
    return column, ""


def scale(unit: str, si: str, *, name: str) -> tuple[float, float]:
    """Factor and offset that take a value of a unit to SI: value * factor + offset.

    Args:
        unit: of the column
        si: the model's unit of what it holds: "K", "K (difference)", "N.m", ...
        name: of the column, for the message

    Raises:
        ScenarioError: a unit of another kind, or none where there must be one
    """
    if unit in ("", "1") and si != "1":
        usual = {"K": "degC", "rad/s": "rpm", "N.m": "Nm"}.get(si, si)
        raise ScenarioError(
            f'{name}: its unit is not known. Write it behind the column\'s name, "[{usual}]", or in the'
            " card's table [units]."
        )
    zero, one = (to_si(f"{value:g} {'' if unit == '1' else unit}".strip(), si, name=name) for value in (0.0, 1.0))
    return one - zero, zero


def in_si(values: np.ndarray, unit: str, si: str, *, name: str) -> np.ndarray:
    """Values of a column in SI (n,).

    Args:
        values: as they stand (n,)
        unit: of the column
        si: the model's unit of what it holds
        name: of the column, for the message

    Raises:
        ScenarioError: a unit of another kind, or none where there must be one
    """
    factor, offset = scale(unit, si, name=name)
    return np.asarray(values * factor + offset)
