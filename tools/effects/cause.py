"""A cause: a typed change of the model or of an instrument, with a family of forms and priors for its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from ...model.machines.spec import PartSpec, Spec
from .parts import FIT_PARTS


@dataclass(frozen=True)
class Size:
    """How much of a cause there is: zero is none. Signed if `low` is negative; `sd` is the prior's half width.

    Where the effect is far from linear, a first look also takes secants to the size `far`.
    """

    name: str
    unit: str
    doc: str
    sd: float
    low: float
    high: float
    far: float | None = None


@dataclass(frozen=True)
class Shape:
    """One parameter of a cause's form: a normal prior cut at its bounds, or an even one where `sd` is None.

    `ends` makes it a choice: upper ends of the shares of the prior that each of its kinds has.
    """

    name: str
    unit: str
    doc: str
    low: float
    high: float
    mean: float = 0.0
    sd: float | None = None
    ends: tuple[float, ...] = ()

    def quantile(self, share: np.ndarray) -> np.ndarray:
        """Values of the prior at shares between 0 and 1."""
        if self.sd is None:
            return self.low + share * (self.high - self.low)
        below, above = ndtr((np.array([self.low, self.high]) - self.mean) / self.sd)
        return np.asarray(self.mean + self.sd * ndtri(below + share * (above - below)))


@dataclass(frozen=True)
class Rows:
    """The readings of a campaign as arrays over its n rows, n_tests tests: what an instrument's fault may depend on.

    `test` is the index of each row's test, `order` its running order from 0 (first) to 1 (last), `direction` +1 for a
    multiplier, -1 for a reducer; `w` [rad/s], `tau` [N.m] magnitude, `T_room` [K], `rise` of the oil over the room [K]
    as measured (0 where it is not), `share` of the dwell that has passed (1 at its end), `humidity` or None.
    """

    test: np.ndarray
    order: np.ndarray
    direction: np.ndarray
    w: np.ndarray
    tau: np.ndarray
    T_room: np.ndarray
    rise: np.ndarray
    share: np.ndarray
    humidity: np.ndarray | None = None

    @property
    def n_tests(self) -> int:
        """Number of tests."""
        return int(self.test.max()) + 1

    @property
    def rise_per_test(self) -> np.ndarray:
        """Mean rise of the oil over the room in each test [K]."""
        return np.array([self.rise[self.test == k].mean() for k in range(self.n_tests)])

    def per_test(self, values: np.ndarray) -> np.ndarray:
        """The first value of each test."""
        return np.array([values[self.test == k][0] for k in range(self.n_tests)])


#: Parameter values of a cause by name: the size and the shapes.
Theta = Mapping[str, float]
#: Channel -> readings (n); channels are T_oil, T_oil2, T_wall [K], loss [N.m], and dwell, its share of what is stated
#: less 1.
Readings = Mapping[str, np.ndarray]


def _no_values(base: Mapping[str, float], theta: Theta, rows: Rows | None) -> Mapping[str, Any]:
    return {}


def _everywhere(theta: Theta) -> tuple[str, float] | None:
    return None


def _no_change(theta: Theta, rows: Rows, readings: Readings) -> Readings:
    return readings


@dataclass(frozen=True)
class Cause:
    """One entry of the taxonomy.

    Args:
        id: stable identifier
        doc: where it acts and what it does
        size: how much of it there is
        shapes: its family of forms
        exposes: the experiment that would show it
        like: name of the class of causes that count as one answer, and why
        parts, connections: what is added to the machine, neutral at size zero
        values: (values of the machine by path, parameters, rows) -> changed values by path, a number or one per test;
            rows are None where no campaign is at hand
        readings: (parameters, rows, true readings) -> what the instruments show
        acts: parameters -> where it acts: quantity with its side ("w+", "tau-", "T+") and threshold in SI, or None
        logged: whether it changes a logged time series
        scatter: whether it makes days differ instead of changing them all
    """

    id: str
    doc: str
    size: Size
    shapes: tuple[Shape, ...] = ()
    exposes: str = ""
    like: str = ""
    parts: tuple[PartSpec, ...] = ()
    connections: tuple[tuple[str, ...], ...] = ()
    values: Callable[[Mapping[str, float], Theta, Rows | None], Mapping[str, Any]] = _no_values
    readings: Callable[[Theta, Rows, Readings], Readings] = _no_change
    acts: Callable[[Theta], tuple[str, float] | None] = _everywhere
    logged: bool = True
    scatter: bool = False

    @property
    def physical(self) -> bool:
        """Whether it changes what happens, not only what is shown."""
        return self.values is not _no_values

    def added_to(self, spec: Spec, theta: Theta | None = None) -> Spec:
        """The machine with the cause in it; neutral where no parameters are given."""
        extended = spec.with_parts(self.parts, self.connections, FIT_PARTS)
        if theta is None:
            return extended
        base = {f"{p.name}.{k}": v for p in extended.parts for k, v in p.values.items()}
        return extended.with_values(self.values(base, theta, None))

    @property
    def choice(self) -> int | None:
        """Place of the shape that is a choice; a family has one at most."""
        return next((k for k, shape in enumerate(self.shapes) if shape.ends), None)

    @property
    def threshold(self) -> int | None:
        """Place of the shape that says where in its range a threshold lies."""
        return next((k for k, shape in enumerate(self.shapes) if shape.name == "threshold"), None)

    def sample(self, n: int, each: int) -> tuple[np.ndarray, np.ndarray]:
        """Shares (m, shapes) spread over the prior, the middle first, and their log weights.

        There are n of them; with a choice n of its first kind and `each` of every other.
        """
        d, place = len(self.shapes), self.choice
        if d == 0:
            return np.zeros((1, 0)), np.zeros(1)
        if place is None:
            return spread(n, d), np.zeros(n)
        ends = np.array(self.shapes[place].ends)
        counts = [n] + [each] * (len(ends) - 1)
        starts, shares, mass = np.concatenate([[0.0], ends[:-1]]), [], []
        for start, end, count in zip(starts, ends, counts, strict=True):
            own = spread(n if start == 0 else n + count, d)[-count:]
            own[:, place] = start + (end - start) * own[:, place]
            shares.append(own)
            mass += [(end - start) / count] * count
        return np.concatenate(shares), np.log(np.array(mass) * len(mass))

    def forms(self, shares: np.ndarray) -> list[dict[str, float]]:
        """Members of the family: shares (n, shapes) of the prior of each shape -> n forms."""
        columns = [shape.quantile(shares[:, k]) for k, shape in enumerate(self.shapes)]
        return [{s.name: float(c[i]) for s, c in zip(self.shapes, columns, strict=True)} for i in range(len(shares))]


def spread(n: int, d: int) -> np.ndarray:
    """n points of the unit cube, evenly spread (additive sequence of the golden ratio), the middle first."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (d + 1))
    steps = ratio ** -np.arange(1.0, d + 1)
    points: np.ndarray = (0.5 + np.arange(n)[:, None] * steps[None, :]) % 1.0
    return np.asarray(np.clip(points, 1e-3, 1 - 1e-3))
