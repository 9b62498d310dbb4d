"""Numbers that stand for no reading: zeros among warm temperatures, and single values far beyond all others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .sensors import SI
from .table import Sensor

#: 0 degC [K].
ZERO = 273.15
#: A zero stands for no reading where all others are this far from it [K].
WARM = 10.0
#: Rows that are all zero before they are taken for none.
LEAST = 4
#: Rooms of a campaign are those of one hall where they are within this: a climate chamber is set to 0 degC, too [K].
HALL = 15.0
#: A given value is alone where it is this many times all others: a digit too many, not an overload.
ALONE = 8.0
#: In a table of at least so many rows.
ROWS = 20


def placeholders(
    name: str, sensors: Sequence[Sensor], values: Mapping[str, np.ndarray], lines: np.ndarray
) -> Iterator[str]:
    """What stands where nothing was read.

    Args:
        name: of the file
        sensors: its columns
        values: sensor -> column in SI (n,)
        lines: line of each row in the file (n,)
    """
    for sensor in sensors:
        column = values[sensor.name]
        if SI[sensor.kind] == "K" and (row := _zero(column, HALL if sensor.role == "given" else np.inf)) is not None:
            said = "is 0 degC, and no other reading is near it" if (column != ZERO).any() else "is 0 degC in all rows"
            yield (
                f"{name} line {lines[row]}: {sensor.column} {said}. Leave a cell empty where nothing was read, and"
                " write 0.01 where it was so cold."
            )
        elif sensor.role == "given" and sensor.kind in ("torque", "speed") and (row := _alone(column)) is not None:
            yield (
                f"{name} line {lines[row]}: {sensor.column} is more than {ALONE:g} times what it is in all other rows."
                " Mend it, or leave the row out."
            )


def _zero(column: np.ndarray, range_: float) -> int | None:
    """The first row (n,) with a zero that is none, where all others are within a range [K]; None without."""
    known = column[np.isfinite(column)]
    others = known[known != ZERO]
    few = len(others) == 0 and len(known) < LEAST
    if len(others) == len(known) or few:
        return None
    if len(others) and (np.abs(others - ZERO).min() < WARM or np.ptp(others) > range_):
        return None
    return int(np.flatnonzero(column == ZERO)[0])


def _alone(column: np.ndarray) -> int | None:
    """The row (n,) of the largest size where it is far beyond all others; None without."""
    size = np.abs(column)
    known = np.sort(size[np.isfinite(size)])
    if len(known) < ROWS or not known[-1] > ALONE * known[-2] > 0:
        return None
    return int(np.nanargmax(size))
