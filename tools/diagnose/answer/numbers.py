"""Numbers as a result holds them: rounded to the digits that mean something, never an array, never minus zero."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

#: Significant digits of a number.
DIGITS = 6
#: Of the numbers of an array: beyond them the order of sums shows.
ARRAY_DIGITS = 5
#: No null is known further out than this: smaller p are held as this and printed as "< 1e-6".
LEAST_P = 1e-6


def rounded(value: float, digits: int = DIGITS) -> float:
    """A number with so many significant digits."""
    return float(f"{float(value):.{digits}g}") + 0.0


def _down(value: float) -> float:
    """A probability to 1e-6, rounded down so that sums stay below one."""
    return math.floor(min(max(float(value), 0.0), 1.0) * 1e6 + 1e-6) / 1e6


def array(values: Iterable[Any]) -> tuple[float | None, ...]:
    """Numbers to the digits that are kept, None where there is none."""
    numbers = (None if v is None else float(v) for v in values)
    return tuple(rounded(v, ARRAY_DIGITS) if v is not None and math.isfinite(v) else None for v in numbers)


#: A finite number.
Number = Annotated[float, AfterValidator(rounded), Field(allow_inf_nan=False)]
#: A probability of a hypothesis.
Probability = Annotated[float, AfterValidator(_down), Field(ge=0, le=1)]
#: A p value; at 1e-6 it is at most that.
P = Annotated[float, AfterValidator(lambda p: rounded(min(max(float(p), LEAST_P), 1.0), 4)), Field(ge=0, le=1)]
#: An interval.
Interval = tuple[Number, Number]
#: A row of numbers, null where one is missing; takes arrays.
Array = Annotated[tuple[float | None, ...], BeforeValidator(array)]


class Model(BaseModel):
    """Frozen, and without keys that nobody knows."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)


def as_object(result: Model) -> dict[str, Any]:
    """The JSON object of a result, without what is not known."""
    return result.model_dump(mode="json", by_alias=True, exclude_none=True)
