"""What the data show, as plain data: their quality, what each channel says, and what the pictures are drawn from."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .numbers import Array, Interval, Model, Number, P, Probability

Bound = Literal["", "low", "high"]


class Estimate(Model):
    """A fitted parameter with its 95 % interval."""

    name: str
    value: Number
    ci95: Interval
    unit: str
    doc: str = Field(default="", description="what it is, in words")
    at_bound: Bound = Field(default="", description="the bound that the value sits on")


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
    instead: tuple[str, ...] = Field(default=(), description="given channels of the row that explain it as well")


class NuisanceOff(Model):
    """An uncertain value of the rig, or a tolerance, further off than two prior standard deviations."""

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
    """A point measured several times, in running order: measured less calibrated, less the mean of that."""

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
    as_filed: dict[str, Number] = Field(
        default={}, description="thermometer -> mean of measured less rig as filed [K], where it is told"
    )


class ResidualMean(Model):
    """Mean of measured less calibrated readings of a channel in one cell of a table, before any cause."""

    channel: str
    unit: str
    by: tuple[str, ...] = Field(description="what the table is over: mounting, speed, load, direction, oil, order")
    cell: tuple[str, ...] = Field(description="the group of each of them")
    n: int
    mean: Number
    sd: Number = Field(description="standard deviation of such a mean by the stated accuracies, or as found if larger")
    stands_out: bool = Field(description="further from zero than four of its standard deviations")


class View(Model):
    """What one channel says on its own."""

    class Alone(Model):
        """A cause, by this channel alone."""

        id: str
        probability: Probability

    channel: str
    asks: str = Field(description="torque given the measured temperatures; oil thermometer against the others")
    p: P | None = Field(default=None, description="of the channel under the calibrated model")
    nothing: Probability | None = Field(
        default=None, description="probability that nothing is wrong, by this channel alone"
    )
    causes: tuple[Alone, ...] = ()
    unit: str = ""
    order: Array = Field(default=(), description="running order of the deviations below")
    direction: Array = ()
    deviation: Array = Field(default=(), description="measured less what the given channels imply")


class Rows(Model):
    """The readings for pictures: one entry a row."""

    class Values(Model):
        """A channel's readings: measured, calibrated without a cause, with the top hypothesis."""

        measured: Array
        nominal: Array
        extended: Array = ()
        sd: Number | None = Field(
            default=None, description="standard deviation of one reading against the model, as found"
        )

    class Quantity(Model):
        """What readings are drawn against."""

        label: str
        unit: str = ""
        values: Array

    row: tuple[int, ...] = ()
    test: tuple[int, ...] = ()
    direction: tuple[int, ...] = ()
    channels: dict[str, Values] = {}
    quantities: dict[str, Quantity] = Field(default={}, description="sensors, rise, order, time ...")


class Picture(Model):
    """Measured less simulated against what a cause acts on, without and with that cause, the other causes in both."""

    cause: str
    channel: str = Field(description="the channel that shows it best")
    quantity: str = Field(description="key of rows.quantities")
    before: Array
    after: Array
