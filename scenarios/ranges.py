"""What values of gear units are: one beyond is a slip of a digit or a unit, unless the user means it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

from ..model.core.flat import Quantity
from ..model.errors import ScenarioError
from ..model.files import tables
from ..model.units import to_si

#: Least and largest size as they are told, by SI unit and key.
RANGES: Mapping[str, Mapping[str, tuple[str, str]]] = tables("scenarios", "ranges.toml")
#: Whether values beyond are taken.
_OVERRIDDEN: ContextVar[bool] = ContextVar("_OVERRIDDEN", default=False)


@contextmanager
def override(on: bool = True) -> Iterator[None]:
    """Take values beyond what gear units have.

    Args:
        on: whether they are taken

    Example:
        >>> import gearheat as gh
        >>> with gh.override():
        ...     gh.steady("helical_two_stage", {"room.air_speed": "80 m/s"})["oil.T"] < 320
        True
    """
    token = _OVERRIDDEN.set(on)
    try:
        yield
    finally:
        _OVERRIDDEN.reset(token)


def check_range(name: str, written: object, value: float, quantity: Quantity) -> None:
    """Refuse what no gear unit has.

    Args:
        name: of the value, for messages
        written: as it is written
        value: in SI
        quantity: what it is a value of

    Raises:
        ScenarioError: it is smaller or larger than such values of gear units are
    """
    ends = RANGES.get(quantity.unit, {}).get(quantity.name.rpartition(".")[2])
    if ends is None or not value or _OVERRIDDEN.get():
        return
    low, high = (to_si(end, quantity.unit, name=name) for end in ends)
    if not low <= abs(value) <= high:
        raise ScenarioError(
            f"{name} = {written} is beyond what gear units have, {ends[0]} to {ends[1]}. Check its digits and its unit,"
            " or take it all the same by --override."
        )
