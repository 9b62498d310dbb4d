"""The card of a campaign: its columns, what its instruments, days and model can be trusted to, how it was run."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from ...model.errors import DataError, GearheatError, Problems, suggestion
from ..document import read_text, read_toml, shown
from ..tables import SensorTable, Strict

#: Versions of the format that are read.
SCHEMAS = ("gearheat.card/1", "gearheat.card/2")
#: Largest prior standard deviation of a parameter, relative to its value.
WIDEST = 3.0
#: Fields of the card that no file gives.
INNER = ("name", "warnings")
#: Viscosity at 40 over that at 100 degC, from silicones to naphthenic oils: least and largest.
THINNING = (1.5, 60.0)
#: Shortest time that a row of a test is held [min].
SHORTEST = 0.01
#: Longest time that a row of a test is held, or stands still [min].
LONGEST = 1e6


def _text(value: Any) -> Any:
    """A number as text, so that one kind of value stands for "0.35" and "0.35 K"."""
    return repr(value) if isinstance(value, int | float) and not isinstance(value, bool) else value


class Channel(Strict):
    """Accuracy of one sensor."""

    repeat_sd: str | None = Field(default=None, description='scatter from reading to reading, "0.35 K"')
    offset_sd: str | None = Field(default=None, description='tolerance fixed over the campaign, "0.3 K"')
    checked: bool = Field(default=False, description="beside a reference and found right: its errors are no cause")
    full_scale: float | None = Field(default=None, gt=0, description="range of the instrument, for the reader")

    _numbers = field_validator("repeat_sd", "offset_sd", mode="before")(_text)


class CardSensor(SensorTable):
    """A sensor that is added, or keys of one that overrule the rig file's."""

    reads: str = Field(default="", description='path in the model, for example "oil.T"')

    _numbers = field_validator("repeat_sd", "offset_sd", mode="before")(_text)


class Protocol(Strict):
    """How the campaign was run."""

    prose: str = Field(default="", description='"steady" where all readings are steady states; other words are for you')
    dwell_min: list[float] = Field(default=[], description="[min] that the rows of a test are held; the column leads")
    stop_min: float | None = Field(
        default=None, ge=0, le=LONGEST, description="[min] without load between the rows of a test"
    )
    T_start_minus_amb_K: float = Field(
        default=0.0, ge=-200, le=200, description="[K] start of a test over its room; the column leads"
    )
    ambient: str = Field(default="linear between the readings", description="of the room; no other is known")
    ambient_start_minus_reading_K: float = Field(
        default=0.0, ge=-200, le=200, description="[K] room at the start less its 1st reading"
    )
    reading: str = Field(default="last sample of the dwell", description="when is read; no other is known")

    @field_validator("dwell_min")
    @classmethod
    def _possible(cls, minutes: list[float]) -> list[float]:
        if not all(SHORTEST <= minute <= LONGEST for minute in minutes):
            raise ValueError(f"it should be minutes, {SHORTEST:g} to {LONGEST:g} each")
        return minutes


class Oil(Strict):
    """An oil of the catalogue, or the data of one that it lacks."""

    name: str = Field(default="", description="an oil of the catalogue; that of the rig where it is empty")
    nu40: float | None = Field(
        default=None, gt=0, le=1e5, description="[mm2/s] viscosity at 40 degC, if it lacks the oil"
    )
    nu100: float | None = Field(default=None, gt=0, le=1e4, description="[mm2/s] viscosity at 100 degC")
    rho15: float | None = Field(default=None, ge=300, le=3000, description="[kg/m3] density at 15 degC")
    alpha_T: float | None = Field(default=None, ge=-5, le=5, description="[kg/(m3.K)] change of the density")


class Card(Strict):
    """The whole card. Every key has a default."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False, populate_by_name=True)

    schema_: Literal["gearheat.card/1", "gearheat.card/2"] = Field(
        default="gearheat.card/2", alias="schema", description="version of the format"
    )
    day_cooling_sd: float = Field(
        default=0.015, ge=0, le=1, description="relative scatter from day to day of what surfaces and coolers give off"
    )
    series: bool = Field(default=False, description="whether the tests were logged, too; for the reader")
    columns: dict[str, str] = Field(default={}, description="sensor, path or optional column = column of your table")
    units: dict[str, str] = Field(default={}, description="column of the table = its unit")
    channels: dict[str, Channel] = Field(default={}, description="accuracy of a sensor")
    sensors: dict[str, CardSensor] = Field(default={}, description="a sensor that the rig lacks, or overruled keys")
    prior_sd: dict[str, float] = Field(default={}, description="relative: PartType.parameter or part.parameter = sd")
    protocol: Protocol = Field(default=Protocol(), description="how the campaign was run: a table, or words")
    lubrication: dict[str, str] = Field(default={}, description="part, part type or group of parts = oil or grease")
    oil: Oil = Field(default=Oil(), description="an oil of the catalogue, or the data of one that it lacks")
    name: str = Field(default="", exclude=True, description="of the file")
    warnings: tuple[str, ...] = Field(default=(), exclude=True, description="what the user should know of the file")

    @model_validator(mode="before")
    @classmethod
    def _words(cls, raw: Any) -> Any:
        """Words in the place of the tables [protocol] and [oil], in full."""
        if not isinstance(raw, Mapping):
            return raw
        fields = {"protocol": "prose", "oil": "name"}
        short = {key: {field: raw[key]} for key, field in fields.items() if isinstance(raw.get(key), str)}
        return {key: value for key, value in {**raw, **short}.items() if value is not None}


def read_card(path: Path | None) -> Card:
    """A card from its file, TOML or JSON; the defaults without one.

    Args:
        path: the file; JSON where its name ends in .json

    Raises:
        DataError: all problems at once
    """
    if path is None:
        return Card(warnings=("no card: default accuracies and priors.",))
    raw = _raw(path)
    if not isinstance(raw, dict):
        raise DataError(f"{path.name}: is no card. Write one with `gearheat card RIG -o {path.name}`.")
    first = raw.get("schema") == SCHEMAS[0]
    raw, warnings = _known_only(path.name, raw) if first else (raw, [])
    problems = Problems(f'{path.name}: unknown key "{key}".' for key in INNER if key in raw)
    with problems:
        card = Card.read(path.name, {**raw, "name": path.name, "warnings": tuple(warnings)})
        problems += _problems(card)
    problems.check(DataError)
    return card.model_copy(update={"warnings": (*card.warnings, *_word_warnings(card))})


def _raw(path: Path) -> Any:
    try:
        if path.suffix != ".json":
            return read_toml(path)
        return shown(json.loads(read_text(path, "JSON", DataError), object_pairs_hook=_once))
    except GearheatError as error:
        raise DataError(error.problems) from None
    except ValueError as error:
        raise DataError(f"{path.name}: no JSON ({error}).") from None
    except RecursionError:
        raise DataError(f"{path.name}: its tables are too deep. A card has three levels.") from None


def _once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """A table of JSON. Raises ValueError where a key is there twice."""
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f'key "{next(n for n in names if names.count(n) > 1)}" is there twice')
    return table


def _known_only(name: str, raw: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A card of version 1 without the keys that nothing reads, and a warning for each."""
    warnings: list[str] = []

    def kept(table: Mapping[str, Any], known: Mapping[str, Any], at: str) -> dict[str, Any]:
        names = {str(field.alias or key) for key, field in known.items()}
        warnings.extend(
            f'{name}: "{at}{key}" is not used.{suggestion(key, names)}' for key in table if key not in names
        )
        return {key: value for key, value in table.items() if key in names}

    found = kept(raw, {k: f for k, f in Card.model_fields.items() if k not in INNER}, "")
    for key, model in (("protocol", Protocol), ("oil", Oil)):
        if isinstance(found.get(key), Mapping):
            found[key] = kept(found[key], model.model_fields, f"{key}.")
    if isinstance(channels := found.get("channels"), Mapping):
        found["channels"] = {
            column: kept(table, Channel.model_fields, f"channels.{column}.") if isinstance(table, Mapping) else table
            for column, table in channels.items()
        }
    return found, warnings


def _problems(card: Card) -> list[str]:
    """Values that cannot be."""
    name, oil = card.name, card.oil
    problems = [
        f"{name} prior_sd.{k} = {v:g} is not above 0 and at most {WIDEST:g}. Give a part of the parameter's value."
        for k, v in card.prior_sd.items()
        if not 0 < v <= WIDEST
    ]
    if (oil.nu40 is None) != (oil.nu100 is None):
        problems.append(f"{name} oil: give both nu40 and nu100 [mm2/s], or the name of an oil of the catalogue.")
    if oil.nu40 is not None and oil.nu100 is not None:
        low, high = THINNING
        if oil.nu100 >= oil.nu40:
            problems.append(f"{name} oil: nu100 is not below nu40. An oil gets thinner as it warms up.")
        elif not low <= oil.nu40 / oil.nu100 <= high:
            ratio = oil.nu40 / oil.nu100
            problems.append(
                f"{name} oil: nu40 is {ratio:.3g} times nu100; of oils it is {low:g} to {high:g} times. Check both."
            )
        if oil.nu40 < 1.0:
            problems.append(f"{name} oil: nu40 = {oil.nu40:g} is too small. Give viscosities in mm2/s.")
    return problems


def _word_warnings(card: Card) -> list[str]:
    """A protocol in words, and words of it that are not the ones known."""
    known, stated = Protocol(), card.protocol
    if stated.prose and stated.prose != "steady":
        return [
            f"{card.name}: the protocol is in words. Taken: the stop of the rig file, a start at the room's"
            " temperature, the room in a straight line between its readings."
        ]
    return [
        f'{card.name}: protocol.{key} is taken as "{getattr(known, key)}", the only one known.'
        for key in ("ambient", "reading")
        if getattr(stated, key) != getattr(known, key)
    ]
