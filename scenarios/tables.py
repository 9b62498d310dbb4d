"""The fixed tables of a rig file, as pydantic models, and their problems in the project's words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, field_validator

from ..model.errors import ScenarioError, suggestion

#: Kinds of sensors.
Kind = Literal[
    "oil_temp",
    "wall_temp",
    "ambient",
    "torque",
    "speed",
    "power",
    "heat",
    "flow",
    "air_speed",
    "efficiency",
    "current",
]


def _is_sign(value: float) -> float:
    if value not in (1.0, -1.0):
        raise ValueError("it should be 1.0 or -1.0")
    return value


class Strict(BaseModel):
    """Base: no unknown keys, no silent conversion."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    @classmethod
    def read(cls, name: str, raw: object) -> Self:
        """The tables of a file.

        Args:
            name: of the file, for messages
            raw: what TOML makes of it

        Raises:
            ScenarioError: all that does not fit
        """
        try:
            return cls.model_validate(raw)
        except ValidationError as error:
            raise ScenarioError(problem_of(name, dict(e), cls) for e in error.errors()) from None


#: A sign as files write it.
Sign = Annotated[float, AfterValidator(_is_sign)]


class DrivenTable(Strict):
    """One input of the model while a point is held."""

    column: str = Field(description="name of the column that gives it")
    sign: list[Sign] = Field([1.0, 1.0], min_length=2, max_length=2, description="two signs, for direction 1 and 2")


class SensorTable(Strict):
    """One instrument; what is left out follows from what it reads."""

    reads: str = Field(description='path in the model, for example "oil.T"')
    column: str | None = Field(None, description="column of a measured table; the sensor's own name if left out")
    kind: Kind | None = Field(None, description="what it is: the temperature of oil, a body or the room, or a meter")
    role: Literal["given", "read"] | None = Field(None, description='"given" drives the model, "read" is compared')
    unit: str | None = Field(None, description='unit of the column, for example "degC"')
    magnitude: bool = Field(False, description="true where the column holds magnitudes")
    signs: list[Sign] | None = Field(
        None, min_length=2, max_length=2, description="sign of the model's value in direction 1 and 2, for magnitudes"
    )
    repeat_sd: str | None = Field(None, description='scatter from reading to reading, for example "0.35 K"')
    offset_sd: str | None = Field(None, description='tolerance fixed over a campaign, for example "0.3 K"')


class CampaignTable(Strict):
    """Measured data of the rig and how they were taken."""

    data: str = Field("", description="name of the CSV file beside the rig file")
    stop: str = Field(description='time between the halves of a test, for example "5 min"')
    room: str = Field(description='input of the room temperature, for example "room.T"')
    oil: str = Field(description='part that holds the oil, for example "oil"')
    notes: list[str] = Field([], description="further columns of the data, which no sensor reads")
    inputs: dict[str, DrivenTable] = Field(description="input of the model -> column and signs")
    source: str = Field(description="where the protocol is from")


class ErratumTable(Strict):
    """One place where the source is wrong."""

    place: str = Field(description="where in the source")
    says: str = Field(description="what it says")
    should_be: str = Field(description="what it should say")
    evidence: str = Field(description="how we know")


class PartTable(Strict):
    """What every table [part.NAME] may say beside the values of its type, which are checked against the part."""

    type: str = Field("", description='part type, or "my_module:MyClass"; a part of the machine has its own')
    use: str = Field("", description="template of its values, or assembly in its place")
    source: str = Field("", description="where the values are from: a citation, or assumed:, inferred:, calibrated:")
    sources: dict[str, str] = Field({}, description="the same of single values")
    uncertainties: dict[str, Any] = Field({}, description="standard uncertainties of values, with their units")


class RigTable(Strict):
    """A rig file. Values are checked later, against the parts."""

    kind: str = Field(description='a machine such as "planetary", or "network" for parts and connections of its own')
    doc: str = Field(description="what the rig is, in a sentence")
    reproduces: str = Field("", description="what published results the rig reproduces, in a line, or that it has none")
    drive: dict[str, list[Literal["w", "tau", "load"]]] = Field(
        description='what is given at the shaft ends, e.g. carrier = ["w", "tau"], or input = ["w"], output = ["load"]'
    )
    operating_point: dict[str, Any] = Field(
        description="input -> value with its unit, drives = the end where power enters, and a source"
    )
    part: dict[str, dict[str, Any]] = Field(description="a table [part.NAME] for each part")
    connect: dict[str, list[str]] = Field({}, description="name of a net -> list of the ports that meet")
    sensors: dict[str, SensorTable] = Field(
        {}, description="column of a measured table = path in the model, or a table [sensors.NAME]"
    )
    losses: dict[str, list[str]] = Field({}, description="column of the losses table -> outputs that are summed")
    campaign: CampaignTable | None = Field(None, description="measured data and how they were taken")
    uncertainties: dict[str, dict[str, Any]] = Field(
        {},
        description="[uncertainties.NAME]: what values change by together at one standard deviation, with their units",
    )
    errata: list[ErratumTable] = Field([], description="places where the source is wrong")
    template: dict[str, dict[str, Any]] = Field({}, description="values that parts share by use = NAME")
    assembly: dict[str, dict[str, Any]] = Field({}, description="parts and nets that use = NAME stands for")

    @field_validator("sensors", mode="before")
    @classmethod
    def _short(cls, written: Any) -> Any:
        """The short form, column = path, in full."""
        if not isinstance(written, Mapping):
            return written
        return {key: {"reads": value} if isinstance(value, str) else value for key, value in written.items()}


#: Words of pydantic -> those of a file.
WORDS = {
    "Input should": "it should",
    "List should": "it should",
    " after validation": "",
    "Value error, ": "",
    "a valid dictionary": "a table",
    "a valid string": "text in quotation marks",
    "a valid boolean": "true or false",
    "a valid": "a",
    "greater than or equal to": "at least",
    "less than or equal to": "at most",
    "greater than": "above",
    "less than": "below",
}
#: What stands in for a required key that is missing or wrong, so that the rest of the file is still checked.
_STANDING_IN: Mapping[str, Any] = {"kind": "", "doc": "", "drive": {}, "operating_point": {}, "part": {}}


def validate(name: str, raw: Mapping[str, Any]) -> tuple[RigTable, list[str]]:
    """The fixed tables of a file and all that is wrong with them; what is wrong is left out of the tables.

    Args:
        name: name of the file, for messages
        raw: what TOML makes of it
    """
    try:
        return RigTable.model_validate(raw), []
    except ValidationError as error:
        wrong = {str(e["loc"][0]) for e in error.errors()}
        kept = {key: value for key, value in raw.items() if key not in wrong}
        problems = [problem_of(name, dict(e), RigTable) for e in error.errors()]
        return RigTable.model_validate({**_STANDING_IN, **kept}), problems


def problem_of(name: str, error: Mapping[str, Any], top: type[Strict]) -> str:
    """One finding of pydantic: place, what was found, what is expected.

    Args:
        name: name of the file
        error: the finding
        top: model of the whole file
    """
    steps = error["loc"]
    model, expected = _find_expected(steps, top)
    *tables, key = steps if isinstance(steps[-1], str) else steps[:-1]
    place = "".join(f" {t + 1}" if isinstance(t, int) else f".{t}" for t in tables).lstrip(".")
    where = f"{name} [{place}]" if place else name
    if error["type"] == "extra_forbidden" and model:
        close = suggestion(str(key), model.model_fields) or f" Known: {', '.join(model.model_fields)}."
        return f'{where}: unknown key "{key}".{close}'
    if error["type"] == "missing":
        return f'{where}: "{key}" is missing. Expected: {expected}.'
    should = re.sub(r" or instance of \w+", "", error["msg"])
    for theirs, ours in WORDS.items():
        should = should.replace(theirs, ours)
    return f"{where}: {key} = {error['input']!r} does not fit: {should}.{f' Expected: {expected}.' if expected else ''}"


def _find_expected(steps: Iterable[str | int], top: type[Strict]) -> tuple[type[Strict] | None, str]:
    """The innermost model on the way to a place, and what the last known key on it means."""
    model: type[Strict] | None = top
    meaning = ""
    for step in steps:
        if model and (field := model.model_fields.get(str(step))):
            meaning = field.description or ""
            kinds = (m for m in (field.annotation, *get_args(field.annotation)) if isinstance(m, type))
            model = next((m for m in kinds if issubclass(m, Strict)), None)
    return model, meaning
