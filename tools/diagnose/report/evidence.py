"""What the pictures of a result are drawn from, as plain data."""

from __future__ import annotations

from pydantic import Field

from .estimate import Estimate
from .numbers import Array, Model, Number, P, Probability


class View(Model):
    """What one channel says on its own."""

    class Alone(Model):
        """A cause, by this channel alone."""

        id: str
        probability: Probability
        mc_error: Number = 0.0
        parameters: tuple[Estimate, ...] = ()

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
