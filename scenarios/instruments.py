"""Instruments as a rig file declares them: which column reads what of the model, and how well."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..model.core.flat import Quantity
from ..model.errors import Problems, suggestion
from .columns import split_unit
from .tables import SensorTable
from .values import standard_deviation


@dataclass(frozen=True)
class Instrument:
    """One instrument of a rig; what is empty or None follows from what it reads.

    Args:
        name: of the instrument
        column: column of a measured table
        reads: path in the model
        kind: what it is: "oil_temp", "wall_temp", "ambient", "torque", "speed" or "power"
        role: "given" drives the model, "read" is compared
        unit: of the column
        magnitude: whether the column holds magnitudes
        signs: sign of the model's value in direction 1 and 2 where it does
        repeat_sd, offset_sd: scatter from reading to reading, and tolerance that is fixed over a campaign [SI]
    """

    name: str
    column: str
    reads: str
    kind: str = ""
    role: str = ""
    unit: str = ""
    magnitude: bool = False
    signs: tuple[float, float] | None = None
    repeat_sd: float | None = None
    offset_sd: float | None = None


def instruments(
    where: str, tables: Mapping[str, SensorTable], known: Mapping[str, Quantity]
) -> tuple[tuple[Instrument, ...], list[str]]:
    """The instruments of a file's table [sensors], and what is wrong with them.

    Args:
        where: name of the file, for messages
        tables: key -> what is written
        known: path -> quantity of all that can be read
    """
    problems = Problems()
    found: list[Instrument] = []
    for key, table in tables.items():
        place = f"{where} [sensors] {key}"
        if table.reads not in known:
            problems.append(f'{place}: there is no "{table.reads}".{suggestion(table.reads, known)}')
            continue
        unit = known[table.reads].unit
        accuracy: dict[str, float | None] = {}
        for name, raw in (("repeat_sd", table.repeat_sd), ("offset_sd", table.offset_sd)):
            with problems:
                accuracy[name] = None if raw is None else standard_deviation(f"{place}: {name}", raw, unit)
        found.append(
            Instrument(
                name=split_unit(key)[0],
                column=table.column or key,
                reads=table.reads,
                kind=table.kind or "",
                role=table.role or "",
                unit=table.unit or "",
                magnitude=table.magnitude or table.signs is not None,
                signs=None if table.signs is None else (table.signs[0], table.signs[1]),
                **accuracy,
            )
        )
    return tuple(found), problems
