"""A card with every key: the defaults of a rig as TOML with a comment a key, or as JSON."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from ...model.units import text
from ..scenario import Scenario
from ..tables import Strict
from .card import Card, CardSensor, Channel, Protocol
from .lubrication import lubricants
from .sensors import CONTEXT, LOGGED, SI, sensors_of
from .table import Sensor

#: First lines of a card.
HEAD = """\
# Card of a campaign: how its tables are written, and what its instruments, days
# and model can be trusted to. Every key may be left out; what stands here is
# what is taken then. Values with a unit stand in quotation marks.
"""
#: Columns of a card.
WIDTH = 80
#: What columns hold that no sensor has.
COLUMNS = {**LOGGED, **{name: doc for name, (doc, *_) in CONTEXT.items()}}


def default_card(scenario: Scenario, prior_sd: Mapping[str, float], known: Card | None = None) -> Card:
    """The card that is taken where there is none, with every key that the rig has.

    Args:
        scenario: the rig
        prior_sd: relative standard deviation by part type and parameter
        known: columns, units and signs of a table
    """
    given = known or Card()
    sensors = sensors_of(scenario, given)
    context = {name: given.columns.get(name, name) for name in COLUMNS}
    stop = scenario.protocol.stop / 60.0 if scenario.protocol else 0.0
    return Card(
        columns={s.name: s.column for s in sensors} | context,
        units={s.column: s.unit for s in sensors if s.unit},
        channels={s.name: _channel(s) for s in sensors},
        sensors={s.name: _sensor(s, given) for s in sensors},
        prior_sd=dict(prior_sd),
        protocol=Protocol(stop_min=stop),
        lubrication=lubricants(scenario.spec),
    )


def _channel(sensor: Sensor) -> Channel:
    """Accuracies in units that a person writes."""
    if SI[sensor.kind] == "1":
        repeat, offset = (f"{100 * sd:.4g} percent" for sd in (sensor.repeat_sd, sensor.offset_sd))
        return Channel(repeat_sd=repeat, offset_sd=offset, checked=sensor.checked)
    unit = "K (difference)" if SI[sensor.kind] == "K" else SI[sensor.kind]
    repeat, offset = (text(sd, unit, 4) for sd in (sensor.repeat_sd, sensor.offset_sd))
    return Channel(repeat_sd=repeat, offset_sd=offset, checked=sensor.checked)


def _sensor(sensor: Sensor, known: Card) -> CardSensor:
    """A sensor in full; that its column has signs is written where that is said, as the rig's may hold magnitudes."""
    turned, said = sensor.signs != (1.0, 1.0), known.sensors.get(sensor.name)
    signs = {"signs": list(sensor.signs)} if turned or (said and said.signs) else {}
    table = {"reads": sensor.reads, "kind": sensor.kind, "role": sensor.role, "magnitude": turned}
    return CardSensor.model_validate({**table, **signs})


def as_json(card: Card) -> dict[str, Any]:
    """The card as `--json` writes it."""
    return card.model_dump(by_alias=True, exclude_none=True)


def as_toml(card: Card) -> str:
    """The card as TOML with a comment a key."""
    return HEAD + "\n".join(_table("", "", card)) + "\n"


def _table(name: str, doc: str, model: Strict) -> Iterator[str]:
    """A table and the tables in it: first its plain keys."""
    if name:
        yield from ("", *_write_line(f"[{name}]", doc))
    inner: list[tuple[str, str, Any]] = []
    for key, field in type(model).model_fields.items():
        value, written = getattr(model, key), field.alias or key
        doc = field.description or ""
        if field.exclude:
            continue
        if isinstance(value, BaseModel | Mapping):
            inner.append((f"{name}.{written}".lstrip("."), doc, value))
        elif value is None:
            yield from _write_line(f"# {written} = ...", doc)
        else:
            yield from _write_line(f"{written} = {json.dumps(value, ensure_ascii=False)}", doc)
    for path, said, value in inner:
        yield from _table(path, said, value) if isinstance(value, Strict) else _mapping(path, said, value)


def _mapping(name: str, doc: str, entries: Mapping[str, Any]) -> Iterator[str]:
    """A table whose keys are names of the rig."""
    nested = {key: value for key, value in entries.items() if isinstance(value, Strict)}
    if not nested:
        yield from ("", *_write_line(f"[{name}]", doc))
    for key, value in entries.items():
        if key in nested:
            yield from _table(f"{name}.{_key(key)}", doc, value)
        else:
            said = COLUMNS.get(key, "") if name == "columns" else ""
            yield from _write_line(f"{_key(key)} = {json.dumps(value, ensure_ascii=False)}", said)


def _write_line(line: str, doc: str) -> Iterator[str]:
    """A line with its comment behind it, or above it where both are wider than a screen of 80 columns."""
    one = f"{line}  # {doc}" if doc else line
    if len(one) <= WIDTH:
        yield one
    else:
        yield from textwrap.wrap(doc, WIDTH, initial_indent="# ", subsequent_indent="# ", break_long_words=False)
        yield line


def _key(key: str) -> str:
    return key if key.isascii() and key.isidentifier() else json.dumps(key, ensure_ascii=False)
