"""Instruments read where the truth is known from elsewhere: in a bath, without torque, beside a better instrument."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ..effects.cause import Cause, Rows, Theta

#: Instrument of an input -> what the causes change between its reading and the truth.
INPUTS = {"T_amb": "read.room_bias", "speed": "read.speed_gain"}
#: Instrument -> its fixed tolerances, which a check takes away: what is off from now on is a cause's doing.
TOLERANCES = {"loss": ("T_carrier", "T_sun")}


@dataclass(frozen=True)
class Check:
    """Readings of one instrument less the truth.

    Args:
        instrument: T_oil, T_oil2, T_wall, T_amb [K], loss for both torque transducers [N.m], or speed (relative)
        sd: scatter from reading to reading
        rows: conditions of the readings, torque and running order among them
        T: temperature of all that is around the probes [K]
        standard: standard deviation of what the truth is known from, the same in all readings
    """

    instrument: str
    sd: float
    rows: Rows
    T: float = 293.15
    standard: float = 0.0

    @property
    def n(self) -> int:
        """Number of readings."""
        return len(self.rows.w)

    @property
    def settles(self) -> tuple[str, ...]:
        """Names of the fixed tolerances that it takes away."""
        return TOLERANCES.get(self.instrument, (self.instrument,))

    def covariance(self) -> np.ndarray:
        """Scatter (n, n) of reading less truth without any cause."""
        return np.asarray(self.sd**2 * np.eye(self.n) + self.standard**2)

    def signatures(self, cause: Cause, thetas: Sequence[Theta], base: Mapping[str, float]) -> np.ndarray:
        """Reading less truth (n, forms) per unit of size that a cause makes; `base` are the values of the machine."""
        shown = [self._error(cause, theta, base) / theta[cause.size.name] for theta in thetas]
        return np.stack(shown, axis=1)

    def _error(self, cause: Cause, theta: Theta, base: Mapping[str, float]) -> np.ndarray:
        if self.instrument in INPUTS:
            error = np.asarray(cause.values(base, theta, self.rows).get(INPUTS[self.instrument], 0.0))
            return error[self.rows.test] if error.ndim else np.full(self.n, float(error))
        true = {channel: np.full(self.n, self.T) for channel in ("T_oil", "T_oil2", "T_wall")}
        true |= {"loss": np.zeros(self.n), "dwell": np.zeros(self.n)}
        return np.asarray(cause.readings(theta, self.rows, true)[self.instrument] - true[self.instrument])


def at_rest(n: int = 1, *, tau: float = 0.0, order: np.ndarray | None = None, T: float = 293.15) -> Rows:
    """Conditions of n readings on the bench at one torque [N.m] and temperature [K], by default after the campaign."""
    one, zero = np.ones(n), np.zeros(n)
    return Rows(
        test=np.arange(n),
        order=one if order is None else order,
        direction=one,
        w=20.0 * one,  # not zero: causes act by its powers, on differences of temperature that are zero here
        tau=tau * one,
        T_room=T * one,
        rise=zero,
        share=one,
    )


def first_of(rows: Rows, n: int) -> Rows:
    """The first n rows."""
    humidity = None if rows.humidity is None else rows.humidity[:n]
    return Rows(**{f.name: getattr(rows, f.name)[:n] for f in fields(rows) if f.name != "humidity"}, humidity=humidity)
