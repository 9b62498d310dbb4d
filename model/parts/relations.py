"""What must hold between parameters of parts, by its name in `relations.toml`."""

from __future__ import annotations

from math import inf

from ..core.component import Component, Related
from ..files import tables
from ..laws.smooth import Num

_TOLD: dict[str, dict[str, str]] = tables("model.parts", "relations.toml")


def require(part: Component, name: str, number: Num, low: float = -inf, high: float = inf, **words: str) -> Related:
    """A relation of a part.

    Args:
        part: whose parameters they are
        name: the relation; in a part type of its own entry behind the name of the type
        number: tells whether it holds
        low, high: where the number must lie, in the unit of the entry
        words: what stands for the braces of the entry
    """
    names = (*(f"{cls.__name__}: {name}" for cls in type(part).__mro__), name)
    told = next(_TOLD[key] for key in names if key in _TOLD)
    said = {key: text.format_map(words) for key, text in told.items()}
    unit, remedy = said.get("unit", "1"), said["remedy"]
    return part.relation(name.format_map(words), said["value"], number, low, high, remedy=remedy, unit=unit)
