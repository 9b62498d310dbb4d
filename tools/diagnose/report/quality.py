"""What is to be known of the data before any cause is named, as plain data."""

from __future__ import annotations

from pydantic import Field

from .numbers import Interval, Model, Number, P


class GrossReading(Model):
    """A single reading that is wrong."""

    row: int = Field(description="row of the data, from 1")
    line: int | None = Field(default=None, description="line of the file")
    point: str = Field(default="", description="number of the point as in the file")
    channel: str
    size_sd: Number = Field(description="distance from what the other readings say, in its standard deviations")
    shown: Number | None = None
    expected: Number | None = None
    unit: str = ""
    set_aside: bool = True


class NuisanceOff(Model):
    """An uncertain value of the rig, or a tolerance, further off than 2.5 prior standard deviations."""

    name: str
    z: Number = Field(description="prior standard deviations off")
    factor: Number | None = Field(default=None, description="value found over that of the file")
    file: Number | None = None
    found: Number | None = None
    unit: str = ""
    paths: tuple[str, ...] = ()


class VarianceComponent(Model):
    """A scatter as the card states it and as the data show it."""

    name: str = Field(description="room, day, mounting, reading of a channel")
    channel: str = ""
    unit: str = ""
    card: Number
    found: Number
    ratio: Number
    ci95: Interval | None = Field(default=None, description="of what was found")


class Repeat(Model):
    """One repetition of a point."""

    test: int
    order: Number
    date: str = ""
    sum: Number | None = Field(
        default=None, description="half the sum of both directions' deviations; that of one without two"
    )
    difference: Number | None = Field(default=None, description="half the difference of both directions' deviations")


class RepeatedPoint(Model):
    """A point measured several times, in running order: deviations from its mean, temperatures over the room."""

    condition: str
    channel: str
    unit: str
    repeats: tuple[Repeat, ...]
    sd: Number = Field(description="scatter of the sums")
    card: Number | None = Field(default=None, description="the same by the card")


class DataQuality(Model):
    """What is to be known of the data before any cause is named."""

    gross: tuple[GrossReading, ...] = ()
    nuisances: tuple[NuisanceOff, ...] = ()
    variance: tuple[VarianceComponent, ...] = ()
    repeated: tuple[RepeatedPoint, ...] = ()
    adequacy: dict[str, P] = Field(
        default={}, description="channel -> p of what is left in it; near 1 is too good to be true"
    )
