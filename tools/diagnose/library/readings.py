"""Forms in which an instrument errs, whether it drives the machine or is compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....scenarios.measured.table import Sensor
from .cause import Form, Num, Row, Theta, Values

#: (size and shapes, row, the value the instrument should show) -> error of the reading over the size.
Error = Callable[[Theta, Row, Num], Num]


def wrong(sensor: Sensor, size: str, error: Error) -> Form:
    """A form in which one instrument errs: what it shows is wrong, or what drove the machine.

    Args:
        sensor: the instrument
        size: name of the cause's size
        error: of its reading, over the size
    """
    if sensor.role == "given":

        def truth(theta: Theta, row: Row) -> Values:
            reading = row.sensors[sensor.name]
            return {sensor.name: reading - theta[size] * error(theta, row, reading)}

        return Form(truth=truth)

    def shown(theta: Theta, row: Row, true: Values) -> Values:
        return {sensor.name: true[sensor.name] + theta[size] * error(theta, row, true[sensor.name])}

    return Form(shown=shown)


def one_of(sensor: Sensor, own: Sequence[Sensor]) -> str:
    """Name of a form for one of several instruments.

    Args:
        sensor: the one
        own: all of them
    """
    return sensor.name if len(own) > 1 else ""
