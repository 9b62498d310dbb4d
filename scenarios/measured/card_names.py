"""Columns that a card names: each must be one of the table, and in a unit that its own name does not contradict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from ...model.errors import suggestion
from ...model.units import spell_unit
from ..csv_table import bare_name, split_unit
from ..scenario import Scenario
from .card import Card
from .sensors import CONTEXT, LOGGED, default_instruments
from .table import Sensor

#: Quantities for whose columns a card may say units, which the columns' own names say again.
QUANTITIES = frozenset({"T", "torque", "speed", "time", "power"})


def misnamed(
    scenario: Scenario, card: Card, declared: Sequence[Sensor], header: Sequence[str], name: str
) -> Iterator[str]:
    """What a card says of columns that a table does not have, or has for something else.

    Args:
        scenario: the rig
        card: of the table
        declared: sensors as rig and card declare them
        header: names of the table's columns
        name: of the table
    """
    usual = {i.column for i in scenario.instruments or default_instruments(scenario)} | {*CONTEXT}
    header = [*header, *(split_unit(column)[0] for column in header)]
    read = {s.name: s.column for s in declared if s.role == "read"}
    free = set(header) - usual - set(read.values())
    for key, column in card.columns.items():
        # one table of a card may lack what another has: what is compared may be missing, but not misspelt
        missing = key not in LOGGED and column not in header and column not in usual
        if missing and (key not in read or suggestion(column, free, bare_name)):
            yield f'{card.name} columns.{key}: {name} has no column "{column}".{suggestion(column, header, bare_name)}'
    known = {*usual, *header, *(s.name for s in declared), *(s.column for s in declared)}
    for column, unit in card.units.items():
        said = split_unit(column)[1]
        if column not in known:
            if column not in QUANTITIES and suggestion(column, header, bare_name):
                yield f'{card.name} units: {name} has no column "{column}".{suggestion(column, header, bare_name)}'
        elif said and column in header and spell_unit(unit) not in ("", said):
            yield (
                f'{card.name} units.{column} = "{unit}": the name of the column says {said}. Rename the column, or take'
                " the unit out."
            )
    for sensor in declared:
        said = split_unit(sensor.column)[1]
        if said and sensor.column in header and sensor.unit not in ("", said):
            yield f"{card.name}: {sensor.name} is read in {sensor.unit}, and its column {sensor.column} says {said}."
    used = Counter(card.columns.get(key, key) for key in CONTEXT)
    used.update(sensor.column for sensor in declared)
    for column in (column for column, times in used.items() if times > 1 and column in header):
        yield f"{card.name} columns: {column} is named for two things. Each needs a column of its own."
