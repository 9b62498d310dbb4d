"""The card of a campaign: what its instruments, its days and its model can be trusted to. Every key has a default."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...model.errors import DataError

#: Among the values of a reading: its start temperature is not measured but follows from the room as read.
BY_ROOM = "T_start_by_room"


class Channel(BaseModel):
    """Accuracy of one instrument: scatter from reading to reading, and a tolerance fixed over the campaign."""

    model_config = ConfigDict(extra="ignore")

    repeat_sd: float = Field(ge=0)
    offset_sd: float = Field(ge=0)
    full_scale: float | None = None


#: Accuracies where the card says nothing: industrial Pt100, transducers of a 3 kN.m class.
DEFAULTS = {
    "T_oil_C": Channel(repeat_sd=0.35, offset_sd=0.3),
    "T_oil2_C": Channel(repeat_sd=0.35, offset_sd=0.3),
    "T_wall_C": Channel(repeat_sd=0.35, offset_sd=0.3),
    "T_amb_C": Channel(repeat_sd=0.3, offset_sd=0.3),
    "T_carrier_Nm": Channel(repeat_sd=1.0, offset_sd=2.0),
    "T_sun_Nm": Channel(repeat_sd=0.25, offset_sd=0.5),
    "n_carrier_rpm": Channel(repeat_sd=0.2, offset_sd=0.2),
}
PRIOR = {"mu": 0.10, "brg": 0.12, "seal": 0.15, "hconv": 0.08, "rad": 0.08, "gow": 0.20, "gwh": 0.20, "cap": 0.10}


class Protocol(BaseModel):
    """How the campaign was run."""

    model_config = ConfigDict(extra="ignore")

    dwell_min: list[float] = [240.0, 90.0]
    stop_min: float = Field(default=5.0, ge=0)
    T_start_minus_amb_K: float = 0.0
    ambient: str = "linear between the readings"
    ambient_start_minus_reading_K: float = 0.0
    reading: str = "last sample of the dwell"


class Oil(BaseModel):
    """Data of an oil that the catalogue does not have: viscosities in mm2/s, density in kg/m3, its change in 1/K."""

    model_config = ConfigDict(extra="ignore")

    nu40: float = Field(gt=0)
    nu100: float = Field(gt=0)
    rho15: float | None = Field(default=None, gt=0)
    alpha_T: float | None = None


class Card(BaseModel):
    """The whole card."""

    model_config = ConfigDict(extra="ignore", populate_by_name=True)

    schema_: Literal["gearheat.card/1"] = Field(default="gearheat.card/1", alias="schema")
    units: dict[str, str] = {}
    channels: dict[str, Channel] = {}
    day_cooling_sd: float = Field(default=0.015, ge=0)
    prior_sd: dict[str, float] = {}
    protocol: Protocol | str = Protocol()
    lubrication: dict[str, str] = {}
    oil: Oil | str | None = None
    series: bool = False

    def channel(self, column: str) -> Channel:
        """The accuracy of a column."""
        return self.channels.get(column, DEFAULTS[column])

    def prior(self, name: str) -> float:
        """Relative prior standard deviation of a group of parameters."""
        return self.prior_sd.get(name, PRIOR[name])

    @property
    def run(self) -> Protocol:
        """The protocol; its defaults where the card has prose."""
        return self.protocol if isinstance(self.protocol, Protocol) else Protocol()


def read_card(path: Path | None) -> Card:
    """A card from its file, the defaults without one. Raises DataError with all problems at once."""
    if path is None:
        return Card()
    try:
        raw: Any = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path.name}: cannot be read ({error.strerror}). Check the path.") from None
    except ValueError as error:
        raise DataError(f"{path.name}: no JSON ({error}).") from None
    try:
        return Card.model_validate(raw)
    except ValidationError as error:
        raise DataError(
            [f"{path.name} {'.'.join(map(str, e['loc']))}: {e['msg']}, found {e['input']!r}." for e in error.errors()]
        ) from None
