"""What the tables of a rig file must keep to each other: losses and what they sum, a campaign and its rig."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..model.core.component import Component
from ..model.core.declare import Input, list_declared
from ..model.core.flat import Quantity
from ..model.errors import suggestion
from ..model.parts.lubrication import OilBath
from ..model.parts.shaft import ShaftEnd
from ..model.parts.thermal import Room
from .csv_table import split_unit
from .document import paths
from .tables import CampaignTable, SensorTable

Types = Mapping[str, type[Component]]


def losses_problems(file: str, losses: Mapping[str, Sequence[str]], known: Mapping[str, Quantity]) -> Iterator[str]:
    """Sums of losses that sum nothing, no powers, or something twice, or whose name says another unit.

    Args:
        file: name of the rig file
        losses: column -> paths that are summed
        known: path -> what a result can show
    """
    for column, summed in losses.items():
        place, unit = f"{file} [losses] {column}", split_unit(column)[1]
        if not summed:
            yield f"{place}: names nothing. Name the outputs that are summed."
        for path, times in Counter(summed).items():
            if path not in known:
                yield f'{place}: there is no "{path}".{suggestion(path, known)}'
            elif known[path].unit != "W" and (len(summed) > 1 or unit == "W"):
                yield f"{place}: {path} ({known[path].doc}) is no power. Sum powers only."
            elif unit not in ("", own := known[path].unit) and column != path.rpartition(".")[2]:  # as mu_s
                yield f"{place}: {path} is shown in {own}, and the name says {unit}. Give it another ending."
            if times > 1:
                yield f"{place}: {path} is there twice. Name it once."


def point_problems(where: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Inputs of an operating point that are given twice, as carrier.w and as "carrier.w".

    Args:
        where: place of the table, for messages
        table: as written
    """
    counts = Counter(path for path, _ in paths(table))
    yield from (f"{where}: {path} is there twice. Write it once." for path, times in counts.items() if times > 1)


def campaign_problems(
    where: str,
    table: CampaignTable,
    known: Mapping[str, Quantity],
    types: Types,
    sensors: Mapping[str, SensorTable],
) -> Iterator[str]:
    """What a campaign names that the rig does not have, or that is something else.

    Args:
        where: place of the table, for messages
        table: the campaign
        known: path -> what may be set
        types: part -> its type
        sensors: of the rig, by name
    """
    for path in (table.room, *table.inputs):
        part, _, key = path.rpartition(".")
        if path not in known:
            yield f'{where}: there is no input "{path}".{suggestion(path, known)}'
        elif key not in list_declared(types[part], Input) and not issubclass(types[part], ShaftEnd):
            yield f"{where}: {path} ({known[path].doc}) is no input. Name one that is given from outside."
        elif path == table.room and not (issubclass(types[part], Room) and key == "T"):
            yield f"{where}: room = {path} is no temperature of a room. Name one such as room.T."
    if table.oil not in types:
        yield f'{where}: there is no part "{table.oil}".{suggestion(table.oil, types)}'
    elif not issubclass(types[table.oil], OilBath):
        yield f"{where}: oil = {table.oil} is no oil bath. Name the part that the oil of a test fills."
    if table.data and not table.data.endswith(".csv"):
        yield f'{where}: data = "{table.data}" is no CSV file. Name the measured table beside the rig file.'
    columns = {sensor.column or name: sensor.reads for name, sensor in sensors.items()}
    for path, driven in table.inputs.items():
        if sensors and driven.column not in columns:
            yield f"{where}: no sensor reads column {driven.column} of {path}.{suggestion(driven.column, columns)}"
        elif columns.get(driven.column, path) != path:
            yield f"{where}: column {driven.column} of {path} reads {columns[driven.column]}. Name its own column."
    twice = [c for c, times in Counter(d.column for d in table.inputs.values()).items() if times > 1]
    yield from (f"{where}: column {c} gives two inputs. Each needs its own." for c in twice)
