"""A cause: a typed change of the model or of an instrument, as smooth families of forms with priors.

All formulas of a cause are evaluated with CasADi symbols (to differentiate them) and with numbers alike: they use
arithmetic and `casadi` functions only, never `if`, `numpy` or `math` on what they are given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from scipy.special import ndtr

from ....model.machines.spec import PartSpec

#: A number, an array or a CasADi expression.
Num = Any
#: Size and shapes of a form by name.
Theta = Mapping[str, Num]
#: Values by path, or readings by sensor.
Values = Mapping[str, Num]


@dataclass(frozen=True)
class Size:
    """How much of a cause there is: zero is none. Signed if `low` is negative; `sd` is the prior's half width."""

    name: str
    unit: str
    doc: str
    sd: float
    low: float
    high: float


@dataclass(frozen=True)
class Shape:
    """One continuous parameter of a form: a normal prior cut at its bounds, or an even one where `sd` is None."""

    name: str
    unit: str
    doc: str
    low: float
    high: float
    mean: float = 0.0
    sd: float | None = None

    def at(self, u: Num) -> Num:
        """The value at a standard normal number, which is how the fit counts it."""
        share = 0.5 * (1 + ca.erf(u / 2**0.5))
        if self.sd is None:
            return self.low + share * (self.high - self.low)
        below, above = (float(ndtr((b - self.mean) / self.sd)) for b in (self.low, self.high))
        return self.mean + self.sd * 2**0.5 * ca.erfinv(2 * (below + share * (above - below)) - 1)


@dataclass(frozen=True)
class Mostly(Shape):
    """A share that is usually at its lower bound, sometimes at its upper one, rarely between.

    A uniform prior would cost evidence for putting the share at its bound.
    """

    def at(self, u: Num) -> Num:
        """The value at a standard normal number: at the lower bound below .2, at the upper one above 1.2."""
        return Shape.at(self, 4 * (u - 0.7))


@dataclass(frozen=True)
class Small(Shape):
    """A value usually near its lower bound: the cube root of its position in the range is uniform."""

    def at(self, u: Num) -> Num:
        """The value at a standard normal number."""
        return self.low + (self.high - self.low) * (0.5 * (1 + ca.erf(u / 2**0.5))) ** 3


@dataclass(frozen=True)
class Row:
    """What a formula may know of one reading: symbols in a fit, numbers where a cause is applied.

    Args:
        base: path of a parameter -> its value without the cause, that of the test's oil among them
        sensors: sensor -> what it shows in this row, SI; what is missing in a row stands at the campaign's mean
        order: running order of the row's test, 0 for the first and 1 for the last
        direction: +1 or -1, 0 where the campaign has none
        rise: oil over room as measured [K], smooth in speed, load and running order; 30 K where it is not measured
        humidity: relative humidity [1]; 0.5 where it is not measured
        second: 1 in the second half (and later ones) of a test, else 0
        dwell: time the row was held as stated [s]
    """

    base: Values
    sensors: Values
    order: Num = 0.0
    direction: Num = 0.0
    rise: Num = 30.0
    humidity: Num = 0.5
    second: Num = 0.0
    dwell: Num = 3600.0


@dataclass(frozen=True)
class Form:
    """A smooth family: its shapes are continuous; another part, another side of a threshold is another form.

    Args:
        name: "" for the general form; else what is special: "above a speed", "input shaft"
        weight: share of the cause's prior, those of all its forms add up to 1
        shapes: its continuous parameters
        parts, connections: what is added to the machine, neutral at size zero
        values: (theta, row) -> values of the machine by path that the form changes
        truth: (theta, row) -> sensor of role "given" -> what was truly there [SI], by what it shows in `row.sensors`
        shown: (theta, row, true readings by sensor) -> what sensors of role "read" show [SI], only those it changes
        pace: (theta, row) -> share of the row's stated dwell that took place
        spread: "" for one size; "test", "mounting" or "walk" where the size is the standard deviation of independent
            sizes of every test, of every mounting, or of the steps from each test to the next
        regime: quantity and side it is limited to ("speed above"), with the shape that holds the threshold; for words
        low: its size cannot be below this, whatever the cause's can
        scale: what is told of the cause's size: of an instrument its own error
        size: how much of it there is, where it is not told as the cause's
    """

    name: str = ""
    weight: float = 1.0
    shapes: tuple[Shape, ...] = ()
    parts: tuple[PartSpec, ...] = ()
    connections: tuple[tuple[str, ...], ...] = ()
    values: Callable[[Theta, Row], Values] | None = None
    truth: Callable[[Theta, Row], Values] | None = None
    shown: Callable[[Theta, Row, Values], Values] | None = None
    pace: Callable[[Theta, Row], Num] | None = None
    spread: str = ""
    regime: Mapping[str, str] = field(default_factory=dict)
    low: float = -np.inf
    scale: float = 1.0
    size: Size | None = None


@dataclass(frozen=True)
class Cause:
    """One entry of the taxonomy.

    Args:
        id: stable identifier
        doc: where it acts and what it does, in one sentence
        size: how much of it there is
        forms: its families
        exposes: the experiment that would show it
        like: name of the class of causes that count as one answer, and why
        acts_on: what its effect depends on, for the picture of residuals: a sensor, "rise", "order"
        common: how often it is met, over the causes that are met as a rule
    """

    id: str
    doc: str
    size: Size
    forms: tuple[Form, ...]
    exposes: str = ""
    like: str = ""
    acts_on: str = ""
    common: float = 1.0

    @property
    def family(self) -> str:
        """The class it counts with, itself where it has none."""
        return self.like.partition(":")[0] or self.id

    def size_of(self, form: Form) -> Size:
        """How much of it there is in one of its forms."""
        return form.size or self.size


@dataclass(frozen=True)
class Ranges:
    """What the data and the nominal model say of sizes and ranges: from here come references, thresholds and priors.

    Args:
        low, high, mid: quantity -> 5 %, 95 % and 50 % over the rows: "w" [rad/s] and "tau" [N.m] magnitudes of the
            shaft that `Roles` names (paths `Roles.speed`, `Roles.torque`), "T" of the oil [K], "nu" of the oil [m2/s],
            "film" = w nu [m2/s2], "order", "direction"; and the magnitude of each sensor's column by the sensor's name
        loss: typical total loss of the nominal [W]
        rise: typical rise of the oil over the room [K]
        known: what else is known of the rows: "order", "dwell" (timed ones), "mounting", "humidity", and
            "still: NAME" of sensors that may hang
        powers: part -> typical loss, or heat flow rate, of the nominal [W]
    """

    low: Mapping[str, float]
    mid: Mapping[str, float]
    high: Mapping[str, float]
    loss: float
    rise: float
    known: frozenset[str] = frozenset({"order", "dwell"})
    powers: Mapping[str, float] = field(default_factory=dict)

    @property
    def conductance(self) -> float:
        """Typical conductance from the oil to the room [W/K]."""
        return self.loss / max(self.rise, 1.0)

    def varies(self, quantity: str, share: float = 0.1) -> bool:
        """Whether a quantity ranges over more than a share of its middle, so that a threshold of it makes sense."""
        low, high = self.low.get(quantity, 0.0), self.high.get(quantity, 0.0)
        return high - low > share * abs(self.mid.get(quantity, 0.0))


def as_array(value: Num, n: int) -> np.ndarray:
    """What a formula gives for n rows as an array of n: numbers, arrays or CasADi numbers."""
    return np.broadcast_to(np.asarray(value, dtype=float).ravel(), n)
